#!/usr/bin/env bash
# swingbank predict: estimates from records equal the network's estimates for the same rows of the dataset in its test.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
export OMP_NUM_THREADS=1

TINY_DRAWS=150 tiny_experiment "$work"
sed -i 's/^channels = \["P", "Q", "speed"\]$/channels = ["P", "Q", "speed", "V", "theta"]/' "$work/tiny_data.toml"
"$swingbank" generate "$work/tiny_data.toml" --progress none --out "$work/data" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
"$swingbank" cross-validate "$work/data" --experiment "$work/tiny.toml" --fold 30 --out "$work/out" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
network=$work/out/V-gru-quick-seed1-gen30.network
[[ -s $network ]] || fail "no network beside the result"
grep -q '"name": "tiny_data"' "$work/out/V-gru-quick-seed1-gen30.json" || fail "the dataset has not its config's name"

plant_of_bus_30 "$work/plant.toml" 0.3

# Every row of the excluded generator as a separate record. P and Q are already on the machine's base.
/usr/bin/python3 - "$work" <<'PYTHON'
import glob, sys
import h5py, numpy
work, n, gentlest = sys.argv[1], 0, 0
def write(name, t, x):
    with open(f"{work}/{name}.csv", "w") as file:
        file.write("t_s,P_pu,Q_pu,speed_pu,V_pu,theta_rad\n")
        for k in range(len(t)):
            file.write(",".join(f"{v:.9g}" for v in (t[k], *x[:, k])) + "\n")
truth = []
for path in sorted(glob.glob(f"{work}/data/shards/*.h5")):
    shard = h5py.File(path)
    for i in numpy.flatnonzero(shard["generator"][:] == 30):
        x = shard["records"][i].astype(float)
        t = numpy.arange(x.shape[1]) / 60
        write(f"row-{n:03d}", t, x)
        if n == 0:
            # The same row as recorded with another clock, rate and base, and with a longer pre-event window.
            fine = numpy.arange(-120, 2 * len(t) - 1) / 120
            y = numpy.array([numpy.interp(fine, t, c) for c in x])
            y[:2] *= 100 / 250
            write("other", fine + 17, y)
        if abs(x[3]).min() > gentlest:
            # All swings three times as large: outside the training data.
            gentlest = abs(x[3]).min()
            write("wild", t, x[:, :1] + 3 * (x - x[:, :1]))
        truth.append(shard["parameters"][i])
        n += 1
numpy.savetxt(f"{work}/truth.txt", truth)
PYTHON

"$swingbank" predict --network "$work/out" --model "$work/plant.toml" --records "$work"/row-*.csv --json >"$work/all.json" 2>"$work/log" || fail "$(head -5 "$work/log")"
"$swingbank" predict --network "$network" --model "$work/plant.toml" --records "$work/row-000.csv" --out "$work/one.json" >"$work/table" || fail "one record"
grep -qE '^H .* s +2 to 8$' "$work/table" || fail "no table: $(cat "$work/table")"
sed -i '/^\[record\]/,/^base_mva/s/^base_mva = .*/base_mva = 250.0/' "$work/plant.toml"
"$swingbank" predict --network "$network" --model "$work/plant.toml" --records "$work/other.csv" --json >"$work/other.json" || fail "other clock, rate and base"

/usr/bin/python3 - "$work" <<'PYTHON'
import json, sys
import numpy
load = lambda name: json.load(open(f"{sys.argv[1]}/{name}"))
every, one, other = load("all.json"), load("one.json"), load("other.json")
result, truth = load("out/V-gru-quick-seed1-gen30.json"), numpy.loadtxt(f"{sys.argv[1]}/truth.txt")
estimates = numpy.array([r["estimates"] for r in every["records"]])
assert estimates.shape == truth.shape and len(truth) == result["test_rows"], (estimates.shape, result["test_rows"])
mse = ((estimates - truth) ** 2).mean(axis=0)
said = [p["mse"] for p in result["per_parameter"]]
# Tolerance: records have nine digits of single-precision values, and their steady level is a median, not one sample.
assert numpy.allclose(mse, said, rtol=2e-3), (mse, said)
assert one["records"][0]["estimates"] == every["records"][0]["estimates"]
assert abs(one["records"][0]["event_s"] - 0.5) < 0.02, one
# Another clock and rate move the detected event by less than a sample, 17 ms of a 1 s window.
a, b = (numpy.array([p["estimate"] for p in j["parameters"]]) for j in (one, other))
assert numpy.allclose(a, b, rtol=0.02), (a, b)
assert abs(other["records"][0]["event_s"] - 17.5) < 0.02 and other["records"][0]["held_before_record_s"] == 0
assert every["parameters"][0]["name"] == "H" and every["parameters"][0]["spread"] > 0.1, every["parameters"]
assert every["parameters"][0]["unit"] == "s" and every["parameters"][0]["effect"] == "GENCLS"
PYTHON

# Impossible estimates are reported.
predict() { "$swingbank" predict --network "$network" --model "$work/plant.toml" "$@"; }
cut -d, -f1-3,5,6 "$work/row-000.csv" >"$work/no-speed.csv"
refuses "channel that was not measured" 'channel speed at no-speed.csv' predict --records "$work/no-speed.csv"
refuses "record ends too early" 'give a longer record' predict --records "$work/row-000.csv" --event 3.0
refuses "nothing before the event" 'give a record that begins earlier' predict --records "$work/row-000.csv" --event 0.01
predict --records "$work/wild.csv" >"$work/log" 2>&1 || fail "a record outside the training data: $(cat "$work/log")"
awk '/^warning: wild.csv differs from the training data/ {told = 1} /^parameter / {exit !told}' "$work/log" || fail "the record unlike the training data is not reported before its estimate: $(cat "$work/log")"
predict --records "$work/wild.csv" "$work/row-000.csv" --json 2>/dev/null >"$work/printed.json" || fail "a record outside the training data, as JSON"
/usr/bin/python3 -c 'import json, sys; j = json.load(open(sys.argv[1])); most = 1.5 * j["network"]["input_rms_seen"]; assert j["records"][0]["unlike_training"] and all(r["unlike_training"] == (r["input_rms"] > most) for r in j["records"])' "$work/printed.json" ||
  fail "the JSON does not name the record outside the training data: $(cat "$work/printed.json")"
refuses "no network" 'none.network' "$swingbank" predict --network "$work/none.network" --model "$work/plant.toml" --records "$work/row-000.csv"
head -c 3000 "$network" >"$work/cut.network"
refuses "truncated network" 'cut.network .its checksum is wrong' "$swingbank" predict --network "$work/cut.network" --model "$work/plant.toml" --records "$work/row-000.csv"
refuses "another machine model" 'the network was trained on GENCLS' "$swingbank" predict --network "$network" --model "$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml" --records "$work/row-000.csv"
misused "unknown option" 'nonsense' predict --records "$work/row-000.csv" --nonsense 3

# calibrate runs the network itself: its estimate is a start and is reported with the fit; held-out events are not
# used
sed -i '/^\[record\]/,/^base_mva/s/^base_mva = .*/base_mva = 100.0/' "$work/plant.toml"
status=0
"$swingbank" calibrate --model "$work/plant.toml" --records "$work"/row-00[0-3].csv --hold-out row-003 --network "$network" --draws 0 --starts 0 \
  --prior-sd 0.5 --out "$work/calibrated" --json >"$work/printed.json" 2>"$work/log" || status=$?
((status == 0 || status == 3)) || fail "calibrate --network: $(cat "$work/log")"
"$swingbank" predict --network "$network" --model "$work/plant.toml" --records "$work"/row-00[0-2].csv --out "$work/seen.json" >"$work/log" 2>&1 || fail "predict for --start"
"$swingbank" calibrate --model "$work/plant.toml" --records "$work"/row-00[0-3].csv --hold-out row-003 --start "$work/seen.json" --draws 0 --starts 0 \
  --prior-sd 0.5 --out "$work/started" --json >"$work/started.json" 2>"$work/log" || (($? == 3)) || fail "calibrate --start: $(cat "$work/log")"
/usr/bin/python3 - "$work" <<'PYTHON'
import json, sys
load = lambda name: json.load(open(f"{sys.argv[1]}/{name}"))
asked, given, seen = load("printed.json"), load("started.json"), load("seen.json")
assert sorted(s["name"] for s in asked["started"]) == ["closed form", "model", "network"], asked["started"]
assert all(s["reduced_chi2_after"] <= s["reduced_chi2_before"] for s in asked["started"]), asked["started"]
model, network, fit = asked["side_by_side"]
assert [w["method"] for w in asked["side_by_side"]] == ["model", "network", "calibrate"]
said = {p["effect"] + "." + p["name"]: p["estimate"] for p in seen["parameters"]}
for p in network["parameters"]:
    assert p["value"] == said[p["parameter"]] and p["low_95"] < p["value"] < p["high_95"], p
assert network["parameters"] == given["side_by_side"][1]["parameters"], "asked and given differ"
assert [e["seen"] for e in fit["events"]] == [True, True, True, False]
PYTHON
calibrate() { "$swingbank" calibrate --model "$work/plant.toml" --records "$work"/row-00[0-3].csv --out "$work/refused" "$@"; }
refuses "network of another plant" 'was trained on GENCLS' "$swingbank" calibrate --model "$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml" \
  --records "$SWINGBANK_SOURCE/configs/records/record-example/avr_ev1.csv" --start "$work/seen.json" --out "$work/refused"
refuses "no network" 'the message of swingbank predict above' calibrate --network "$work/none.network"
refuses "estimate of an event held out" 'that event is held out' calibrate --start "$work/seen.json" --hold-out 1
refuses "curve fitting with a network" 'starts from the model.s own values' calibrate --start "$work/seen.json" --method curve-fit
misused "network and start" 'excludes' calibrate --start "$work/seen.json" --network "$network"
[[ ! -e $work/refused ]] || fail "left behind: $(find "$work/refused")"
