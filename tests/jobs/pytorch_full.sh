#!/usr/bin/env bash
# A saved network in PyTorch (examples/python/load_network.py) gives the estimates of swingbank predict.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
export OMP_NUM_THREADS=1

TINY_DRAWS=60 tiny_experiment "$work"
sed -i 's/^channels = \["P", "Q", "speed"\]$/channels = ["P", "Q", "speed", "V", "theta"]/' "$work/tiny_data.toml"
sed -i 's/"gru"/"cnn"/' "$work/tiny.toml"
"$swingbank" generate "$work/tiny_data.toml" --progress none --out "$work/data" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
"$swingbank" cross-validate "$work/data" --experiment "$work/tiny.toml" --fold 30 --out "$work/out" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
plant_of_bus_30 "$work/plant.toml" 0.3

# Learning curve of the training: one line for each epoch, with the losses of the log.
curve=$work/out/curves/V-cnn-quick-seed1-gen30.csv
(($(wc -l <"$curve") == 3)) || fail "the learning curve has not two epochs: $(cat "$curve")"
loss=$(sed -n 's/.*epoch 2 of 2: loss \([0-9.]*\),.*/\1/p' "$work/log")
awk -F, -v loss="$loss" 'NR == 3 && ($2 - loss)^2 < 1e-8 {found = 1} END {exit !found}' "$curve" || fail "loss $loss is not in $(cat "$curve")"

/usr/bin/python3 - "$work" <<'PYTHON'
import glob, sys
import h5py, numpy
work, n = sys.argv[1], 0
for path in sorted(glob.glob(f"{work}/data/shards/*.h5")):
    shard = h5py.File(path)
    for i in numpy.flatnonzero(shard["generator"][:] == 30):
        x = shard["records"][i].astype(float)
        numpy.save(f"{work}/row-{n:03d}.npy", x)
        with open(f"{work}/row-{n:03d}.csv", "w") as file:
            file.write("t_s,P_pu,Q_pu,speed_pu,V_pu,theta_rad\n")
            for k in range(x.shape[1]):
                file.write(",".join(f"{v:.9g}" for v in (k / 60, *x[:, k])) + "\n")
        n += 1
assert n > 5, n
PYTHON
"$swingbank" predict --network "$work/out" --model "$work/plant.toml" --records "$work"/row-*.csv --json >"$work/all.json" 2>"$work/log" || fail "$(head -5 "$work/log")"

/usr/bin/python3 - "$work" "$SWINGBANK_SOURCE/examples/python" <<'PYTHON'
import glob, json, sys
import numpy
work, examples = sys.argv[1:]
sys.path.insert(0, examples)
import load_network
every = json.load(open(f"{work}/all.json"))
network = f"{work}/out/V-cnn-quick-seed1-gen30.network"
header, _ = load_network.read(network)
channels = ["P", "Q", "speed", "V", "theta"]
worst, spread = 0, []
for one, path in zip(every["records"], sorted(glob.glob(f"{work}/row-*.npy")), strict=True):
    row = numpy.load(path)[[channels.index(c) for c in header["channels"]]].astype("float32")
    found = load_network.estimate(network, row)
    spread.append(list(found.values()))
    for parameter, value in zip(every["parameters"], one["estimates"], strict=True):
        worst = max(worst, abs(value / found[parameter["name"]] - 1))
print(f"largest relative difference {worst:.1e} in {len(spread)} records")
assert numpy.std(spread, axis=0).max() > 1e-3, "the network gives one value for all records"
assert worst < 1e-5, worst  # single precision; 8e-8 is usual
PYTHON
