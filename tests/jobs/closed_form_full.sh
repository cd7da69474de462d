#!/usr/bin/env bash
# Methods without training (closed-form, refined, floor) as rows of a table: exact for noise-free records, refused where
# an estimate is impossible.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
export OMP_NUM_THREADS=1

TINY_DRAWS=60 tiny_experiment "$work"
sed -i 's/^networks = .*/networks = ["closed-form", "gru"]/' "$work/tiny.toml"
judge() {
  "$swingbank" cross-validate "$1" --experiment "$work/tiny.toml" --network "${network:-closed-form}" --fold 30 --out "$work/out" "${@:2}" >"$work/log" 2>&1
}

"$swingbank" generate "$work/tiny_data.toml" --progress none --out "$work/blind" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
if judge "$work/blind"; then fail "an estimate was made from a record without a voltage"; fi
for name in V "theta or frequency"; do
  grep -q "no channel $name at" "$work/log" || fail "channel $name is not named: $(cat "$work/log")"
done

sed -i '/^\[record\]/,$ s/^channels = .*/channels = ["P", "Q", "speed", "V", "frequency"]\nfrequency_washout = 0.1\nfrequency_filter = 0.02/' "$work/tiny_data.toml"
"$swingbank" generate "$work/tiny_data.toml" --progress none --out "$work/data" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
cp -r "$work/data" "$work/edited"
sed -i '/^ "frequency": 60.0,$/d' "$work/edited/dataset.json"
if judge "$work/edited"; then fail "an edited header was accepted"; fi
grep -q 'damaged dataset header at' "$work/log" || fail "$(cat "$work/log")"
judge "$work/data" || fail "$(cat "$work/log")"
/usr/bin/python3 - "$work/out/V-closed-form-quick-seed1-gen30.json" <<'PYTHON'
import json, sys
r = json.load(open(sys.argv[1]))
# records have single precision: an error of 1e-7 in P, integrated over 3 s, relative to 2H times a speed of 1e-3 pu
assert r["mse"] < 1e-5, r["mse"]
assert r["baseline_mse"] > 0.5 and r["epochs"] == 0 and r["input"] is None and r["test_rows"] > 10, r
PYTHON
if judge "$work/data" --shuffle-labels; then fail "--shuffle-labels was accepted for a method without training"; fi
grep -q -- '--shuffle-labels' "$work/log" || fail "$(cat "$work/log")"

# With noise: the error of `refined` is at most a few times the floor; the floor is refused without noise.
sed -i 's/^networks = .*/networks = ["closed-form", "refined", "floor"]/' "$work/tiny.toml"
for network in floor refined closed-form; do
  judge "$work/data" --noise 0.001 || fail "$(cat "$work/log")"
done
unset network
/usr/bin/python3 - "$work/out" <<'PYTHON'
import json, sys
mse = {m: json.load(open(f"{sys.argv[1]}/V-{m}-quick-noise0.001-seed1-gen30.json"))["mse"] for m in ("floor", "refined", "closed-form")}
assert 0 < mse["floor"] and mse["refined"] < 3 * mse["floor"], mse
assert mse["refined"] < mse["closed-form"], mse
PYTHON
if network=floor judge "$work/data"; then fail "a floor was computed without noise"; fi
grep -q 'method floor without noise at --network floor' "$work/log" || fail "$(cat "$work/log")"
"$swingbank" tables "$work/out" --out "$work/tables" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
grep -q 'not trained' "$work"/tables/*.md || fail "the table does not mark the methods as not trained"
