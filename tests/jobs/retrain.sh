#!/usr/bin/env bash
# swingbank add --retrain: two networks are trained, applied and compared; errors are reported.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/retrain.bash"

retrain_given "$work/text" || (($? == 3)) || fail "$(tail -5 "$work/log")"
grep -q 'Estimates on held-out events' "$work/text" || fail "no comparison: $(cat "$work/text")"
for side in without with; do
  [[ -s $work/given/retrain/$side/results/$side-cnn-retrain-seed1.network ]] || fail "no network $side the effect"
done
python3 - "$work/given" <<'PYTHON'
import json, sys
r = json.load(open(f"{sys.argv[1]}/retrain.json"))
assert r["format"] == "swingbank-retrain-2" and r["reference"] == "fitted", r
shared = [p for p in r["parameters"] if not p["added"]]
own = [p for p in r["parameters"] if p["added"]]
assert len(shared) == 10 and {"SEXS.K", "SEXS.TB"} <= {p["parameter"] for p in own}, r["parameters"]
assert all("without" not in p for p in own)
# D is not fitted (zero in the model), so its estimate has no reference
for side in ("without", "with"):
    rms = (sum(p[side]["error"] ** 2 for p in shared) / len(shared)) ** 0.5
    assert abs(rms - r["parameter_error"][side]) < 1e-9, side
    said = json.load(open(f"{sys.argv[1]}/retrain/{side}/estimates.json"))
    H = [p["name"] for p in said["parameters"]].index("H")
    assert abs(said["records"][1]["estimates"][H] - shared[[p["parameter"] for p in shared].index("GENROU.H")][side]["estimate"]) < 1e-9
assert [e["seen"] for e in r["events"]] == [True, False]
PYTHON

out=$work/out
mkdir "$out"
refuses "no event held out" "hold out at least one" add --retrain --out "$out"
refuses "effects looked for" "networks are trained for one effect" "$swingbank" add --until-adequate --retrain --hold-out 1 --model "$model" \
  --records "$one" "$two" --out "$out"
misused "no such dataset" "dataset" retrain --dataset "$work/none.toml" --out "$out"
leaves_nothing "$out"
refuses "dataset of another plant" "the plant is a GENROU" retrain --dataset "$SWINGBANK_SOURCE/configs/datasets/ieee39_gencls.toml" --out "$out"
[[ ! -e $out/retrain ]] || fail "left behind: $(find "$out/retrain")"
