#!/usr/bin/env bash
# The network of the swing equation learns from a tiny dataset and is far better than predicting the mean. From records
# (swingbank predict) it gives the same estimates as from the same rows in its test. X'd comes from the plant file. A
# likelihood search from its estimates (steps_from) first trains the network, and reduces the error of noisy records.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
export OMP_NUM_THREADS=1

TINY_DRAWS=300 TINY_T_END=6 tiny_experiment "$work"
sed -i 's/^channels = .*/channels = ["P", "Q", "V", "theta", "speed", "frequency"]\nfrequency_washout = 0.1\nfrequency_filter = 0.02/' "$work/tiny_data.toml"
sed -i 's/^networks = .*/networks = ["swing"]/;s/^channels = .*/channels = ["P", "Q", "V", "speed", "frequency"]/
  s/^start_s = .*/start_s = 0.6/;s/^end_s = .*/end_s = 6.0/;s/^slice = .*/slice = 1/;s/^form = .*/form = "swing"/' "$work/tiny.toml"
"$swingbank" generate "$work/tiny_data.toml" --progress none --out "$work/data" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
"$swingbank" cross-validate "$work/data" --experiment "$work/tiny.toml" --fold 30 --out "$work/out" >"$work/log" 2>&1 || fail "$(cat "$work/log")"

plant_of_bus_30 "$work/plant.toml" 0.3
plant_of_bus_30 "$work/wrong.toml" 0.6
/usr/bin/python3 - "$work" <<'PYTHON'
import glob, sys
import h5py, numpy
work, truth = sys.argv[1], []
for path in sorted(glob.glob(f"{work}/data/shards/*.h5")):
    shard = h5py.File(path)
    for i in numpy.flatnonzero(shard["generator"][:] == 30):
        x = shard["records"][i].astype(float)
        with open(f"{work}/row-{len(truth):03d}.csv", "w") as file:
            file.write("t_s,P_pu,Q_pu,V_pu,theta_rad,speed_pu\n")
            for k in range(x.shape[1]):
                file.write(",".join(f"{v:.9g}" for v in (k / 60, *x[:5, k])) + "\n")
        truth.append(shard["parameters"][i])
numpy.savetxt(f"{work}/truth.txt", truth)
PYTHON
for model in plant wrong; do
  "$swingbank" predict --network "$work/out" --model "$work/$model.toml" --records "$work"/row-*.csv --json >"$work/$model.json" 2>"$work/log" ||
    fail "predict: $(head -5 "$work/log")"
done
/usr/bin/python3 - "$work" <<'PYTHON'
import json, sys
import numpy
work = sys.argv[1]
result, truth = json.load(open(f"{work}/out/V-swing-quick-seed1-gen30.json")), numpy.loadtxt(f"{work}/truth.txt")
mse = {}
for model in ("plant", "wrong"):
    estimates = numpy.array([r["estimates"] for r in json.load(open(f"{work}/{model}.json"))["records"]])
    mse[model] = ((estimates - truth) ** 2).mean()
assert len(truth) == result["test_rows"], (len(truth), result["test_rows"])
assert result["ratio"] < 0.01, result["ratio"]
assert abs(mse["plant"] - result["mse"]) < 1e-3 * result["mse"], (mse, result["mse"])
assert mse["wrong"] > 10 * mse["plant"], mse
PYTHON

sed -i 's/^networks = .*/networks = ["swing", "swing-steps"]/' "$work/tiny.toml"
cat >>"$work/tiny.toml" <<'TOML'
[preset.quick.swing]
noise = [0.001]
training_noise = [0.0003, 0.006]
training_noise_zero = 0.0
[preset.quick.swing-steps]
steps_from = "swing"
TOML
"$swingbank" cross-validate "$work/data" --experiment "$work/tiny.toml" --network swing-steps --noise 0.001 --fold 30 --out "$work/noisy" \
  >"$work/log" 2>&1 || fail "steps: $(cat "$work/log")"
/usr/bin/python3 - "$work/noisy" <<'PYTHON'
import json, sys
mse = {n: json.load(open(f"{sys.argv[1]}/V-{n}-quick-noise0.001-seed1-gen30.json"))["mse"] for n in ("swing", "swing-steps")}
assert 0 < mse["swing-steps"] < 0.8 * mse["swing"], mse
PYTHON
