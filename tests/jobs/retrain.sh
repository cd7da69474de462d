#!/usr/bin/env bash
# swingbank add --retrain: two networks made, asked and compared; made ones are found again; what cannot be is told.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

model=$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml
records=$SWINGBANK_SOURCE/configs/records/record-example
one=$records/avr_ev1.csv two=$records/avr_ev2.csv
export OMP_NUM_THREADS=1

add() { "$swingbank" add SEXS --model "$model" --records "$one" "$two" --power-only --train-draws 60 --train-epochs 1 "$@"; }
retrain() { add --hold-out avr_ev2 --retrain "$@"; }

# nothing but a few draws: this is about the way, not about how good the networks are
retrain --dataset "$SWINGBANK_SOURCE/configs/datasets/ieee14_genrou_bus2.toml" --out "$work/given" >"$work/text" 2>"$work/log" ||
  (($? == 3)) || fail "$(tail -5 "$work/log")"
grep -q 'Estimates on the unseen events' "$work/text" || fail "no comparison: $(cat "$work/text")"
for side in without with; do
  [[ -s $work/given/retrain/$side/results/$side-cnn-retrain-seed1.network ]] || fail "no network $side the effect"
done
python3 - "$work/given" <<'PYTHON'
import json, sys
r = json.load(open(f"{sys.argv[1]}/retrain.json"))
assert r["format"] == "swingbank-retrain-1" and r["reference"] == "fitted", r
shared = [p for p in r["parameters"] if not p["of_the_effect"]]
own = [p for p in r["parameters"] if p["of_the_effect"]]
assert len(shared) == 10 and {"SEXS.K", "SEXS.TB"} <= {p["parameter"] for p in own}, r["parameters"]
assert all("without" not in p for p in own)
# D is not fitted (zero in the model), so there is nothing to hold its estimate against
for side in ("without", "with"):
    rms = (sum(p[side]["error"] ** 2 for p in shared) / len(shared)) ** 0.5
    assert abs(rms - r["parameter_error"][side]) < 1e-9, side
    said = json.load(open(f"{sys.argv[1]}/retrain/{side}/estimates.json"))
    H = [p["name"] for p in said["parameters"]].index("H")
    assert abs(said["records"][1]["estimates"][H] - shared[[p["parameter"] for p in shared].index("GENROU.H")][side]["estimate"]) < 1e-9
assert [e["seen"] for e in r["events"]] == [True, False]
PYTHON

# again: datasets and networks stand there
before=$(stat -c %Y "$work"/given/retrain/*/results/*.network)
retrain --dataset "$SWINGBANK_SOURCE/configs/datasets/ieee14_genrou_bus2.toml" --out "$work/given" >"$work/again" 2>"$work/log" ||
  (($? == 3)) || fail "again: $(tail -5 "$work/log")"
cmp "$work/text" "$work/again" || fail "the second run says something else"
[[ $before == "$(stat -c %Y "$work"/given/retrain/*/results/*.network)" ]] || fail "networks were trained again"

# without a dataset the plant stands behind lines
retrain --out "$work/made" --json >"$work/text" 2>"$work/log" || (($? == 3)) || fail "$(tail -5 "$work/log")"
python3 -c 'import json, sys; json.load(open(sys.argv[1]))' "$work/text" || fail "--json prints more than JSON"
[[ -s $work/made/retrain/grid/plant.raw && -s $work/made/retrain.json ]] || fail "no grid made"

out=$work/out
mkdir "$out"
refuses "no event held out" "hold out at least one" add --retrain --out "$out"
refuses "effects looked for" "networks are trained for one effect" "$swingbank" add --until-adequate --retrain --hold-out 1 --model "$model" \
  --records "$one" "$two" --out "$out"
misused "no such dataset" "dataset" retrain --dataset "$work/none.toml" --out "$out"
leaves_nothing "$out"
refuses "dataset of another plant" "the plant is a GENROU" retrain --dataset "$SWINGBANK_SOURCE/configs/datasets/ieee39_gencls.toml" --out "$out"
[[ ! -e $out/retrain ]] || fail "left behind: $(find "$out/retrain")"
