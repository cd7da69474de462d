# tiny_experiment FOLDER: a dataset and an experiment that take a core under a minute, slow enough to be interrupted.
# With TINY_TRAINING_DRAWS it adds a network `mlp` that also trains on the rows of a second dataset.
tiny_experiment() {
  local more='' names='"gru"'
  if [[ -n ${TINY_TRAINING_DRAWS:-} ]]; then more='"tiny_points.toml"' names='"gru", "mlp"'; fi
  local networks=$SWINGBANK_SOURCE/configs/networks
  cat >"$1/tiny_data.toml" <<TOML
raw = "$networks/ieee39_dataset_gencls.raw"
dyr = "$networks/ieee39_dataset_gencls.dyr"
convention = "psse"
draws = ${TINY_DRAWS:-400}
draws_per_shard = ${TINY_SHARD:-20}
seed = 3
[vary]
who = "one"
generators = [30, 31, 32]
model = "GENCLS"
[vary.box]
H = [2.0, 8.0]  # s
D = [1.0, 4.0]  # pu
[databank]
distance = 0.0
[fault]
buses = "any"
start = 0.5             # s
duration = [0.05, 0.1]  # s
[record]
t_end = ${TINY_T_END:-3.5}  # s
rate = 60.0  # 1/s
channels = ["P", "Q", "speed"]
[kernel]
lanes = ${TINY_LANES:-8}
tolerance = ${TINY_TOLERANCE:-1e-6}
TOML
  cat >"$1/tiny.toml" <<TOML
table = "V"
title = "tiny"
dataset = "tiny_data.toml"
${more:+training_dataset = $more}
split = "leave-one-generator-out"
folds = [30, 31]
[preset.quick]
draws = ${TINY_DRAWS:-400}
networks = [$names]
${TINY_TRAINING_DRAWS:+training_draws = $TINY_TRAINING_DRAWS}
noise = [0.0]
channels = ["P", "Q", "speed"]
start_s = 0.4
end_s = 1.4
slice = 2
form = "deviation"
pca_components = 0
epochs = ${TINY_EPOCHS:-2}
batch = 32
learning_rate = 1e-3
schedule = "constant"
patience = 1000
validation_share = 0.2
TOML
  if [[ -n ${TINY_TRAINING_DRAWS:-} ]]; then
    sed 's/^who = .*/who = "all"/;s/^seed = .*/seed = 4/' "$1/tiny_data.toml" >"$1/tiny_points.toml"
    printf '[preset.quick.mlp]\ntraining_rows = true\n' >>"$1/tiny.toml"
  fi
}

# plant_of_bus_30 FILE XDP: a GENCLS plant file for records of generator 30
plant_of_bus_30() {
  cat >"$1" <<TOML
[plant]
name = "bus 30"
base_mva = 100.0
frequency_hz = 60.0
conventions = "psse"
origin = "test"
[record]
base_mva = 100.0
[machine]
effect = "GENCLS"
H = 4.0
D = 2.0
Ra = 0.0
Xdp = $2
TOML
}
