#!/usr/bin/env bash
# Two effects hidden together, in three cases in which the search first combines each effect with another partner. The
# true pair must be in the 95 % set (docs/decisions/61-diagnosis-on-a-reduced-plant.md). Without the exchange of
# partners it was in none of the three sets. SWINGBANK_KEEP=FOLDER keeps cases and diagnoses there and continues from
# them.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

run=${SWINGBANK_KEEP:-$work/pairs}
for case in c0043 c0044 c0090; do
  "$swingbank" blind-test --config "$SWINGBANK_SOURCE/configs/blind/cases.toml" --seed 490966968 --make 400 \
    --part "$((10#${case#c}))/400" --out "$run" >/dev/null 2>"$work/errors" || fail "make: $(tail -n 3 "$work/errors")"
  channels=()
  grep -q '"P,Q"' "$run/truth/$case.json" && channels=(--power-only)
  "$swingbank" diagnose --threads 1 --quiet --model "$run/cases/$case/model.toml" --records "$run/cases/$case"/event*.csv \
    "${channels[@]}" --out "$run/$case" >/dev/null 2>"$work/errors" || (($? == 3 || $? == 4)) || fail "$case: $(tail -n 3 "$work/errors")"
  python3 - "$run/truth/$case.json" "$run/$case/diagnosis.json" <<'PYTHON' || fail "$case: the true pair is not in the set"
import json, sys
hidden = {h["kind"] for h in json.load(open(sys.argv[1]))["hidden"]}
said = json.load(open(sys.argv[2]))
print(f"{' + '.join(sorted(hidden))} in {said['seconds']:.0f} s:",
      ", ".join(f"{p['name']} {100 * p['probability']:.0f} %" for p in said["probabilities"] if p["in_set"]))
if "Probability of each effect: " not in said["sentence"]:
    sys.exit("the sentence does not tell each effect by itself")
sys.exit(len(hidden) != 2 or not any(p["in_set"] and set(p["name"].split(" + ")) == hidden for p in said["probabilities"]))
PYTHON
done
