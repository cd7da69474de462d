#!/usr/bin/env bash
# Three cases of the blind test, each with an exciter or a governor that the model lacks. Calibration biases the
# parameters to compensate. The diagnosis of the biased model must give the same verdict as that of the original model.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

"$swingbank" blind-test --config "$SWINGBANK_SOURCE/configs/blind/cases.toml" --out "$work/run" --make 3 --seed 16 --size 6 \
  --kinds SEXS,IEEET1,TGOV1 >/dev/null
# verdict FOLDER: the accepted effects of a diagnosis, and its judgement of each effect
verdict() {
  python3 -c "
import json, sys
d = json.load(open(sys.argv[1] + '/diagnosis.json'))
print(d['verdict'], d['effects'], d['equivalent'], d['sentence'])" "$1"
}
# ends_badly COMMAND...: exit code 3 or 4, i.e. the model lacks a component
ends_badly() {
  local code=0
  "$@" >"$work/said" 2>"$work/errors" || code=$?
  ((code == 3 || code == 4)) || fail "exit code $code, expected 3 or 4: $*: $(tail -n 5 "$work/said" "$work/errors")"
}
for folder in "$work"/run/cases/*; do
  records=("$folder"/event*.csv)
  name=$(basename "$folder")
  ends_badly "$swingbank" diagnose --model "$folder/model.toml" --records "${records[@]}" --out "$work/$name/whole"
  ends_badly "$swingbank" calibrate --model "$folder/model.toml" --records "${records[@]}" --out "$work/$name/calibrated"
  bent=$work/$name/calibrated/model-not-adequate.toml
  [[ -s $bent ]] || fail "$name: calibrate wrote $(ls "$work/$name/calibrated")"
  ends_badly "$swingbank" diagnose --model "$bent" --records "${records[@]}" --out "$work/$name/bent"
  verdict "$work/$name/whole" >"$work/expected"
  verdict "$work/$name/bent" >"$work/got"
  cmp "$work/expected" "$work/got" || fail "$name: another verdict on the biased model: $(cat "$work/expected" "$work/got")"
  echo "$name: $(cat "$work/got")"
done
