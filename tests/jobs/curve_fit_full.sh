#!/usr/bin/env bash
# calibrate --method: plain curve fitting beside the calibration, with known truth.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

records=$SWINGBANK_SOURCE/configs/records/record-example
one=$records/avr_ev1.csv two=$records/avr_ev2.csv model=$work/added/model.toml
"$swingbank" add SEXS --model "$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml" --records "$one" "$two" --hold-out avr_ev2 --power-only \
  --out "$work/added" >/dev/null

# plain curve fitting for comparison, with known truth: table and JSON state which method is closer to the truth
"$swingbank" calibrate --model "$model" --records "$one" "$two" --hold-out avr_ev2 --power-only --draws 0 --starts 0 \
  --method both --truth "$model" --out "$work/both" >"$work/text"
grep -q 'intervals contain the true value' "$work/text" || fail "no comparison with the truth"
grep -q '^# Fitted by least squares of the curves' "$work/both/curve-fit.toml" || fail "no plant file of the curve fit"
python3 - "$work/both/calibrate.json" <<'PYTHON'
import json, sys
r = json.load(open(sys.argv[1]))
model, curve, ours = r["side_by_side"]
assert [w["method"] for w in r["side_by_side"]] == ["model", "curve fit", "calibrate"]
assert model["truth"]["rms_relative"] == 0 and curve["truth"]["mse_raw_units"] > ours["truth"]["mse_raw_units"] > 0, curve["truth"]
assert [e["seen"] for e in curve["events"]] == [True, False] and r["curve_fit"]["format"] == "swingbank-curve-fit-4"
PYTHON
"$swingbank" calibrate --model "$model" --records "$one" --method curve-fit --json --out "$work/curves" >"$work/printed.json" || (($? == 3))
cmp "$work/printed.json" "$work/curves/calibrate.json" || fail "--json prints something else than it writes"
fits_schema "$work/both/calibrate.json" "$work/curves/calibrate.json"
