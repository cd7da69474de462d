#!/usr/bin/env bash
# Hides each exciter of the config with values far from its defaults, at sizes of about 20, 100 and up to 1,000 times
# the noise. It counts as found if the verdict names it or its 95 % set contains it, and as lost if its probability is
# below 1 %. None may be lost. SWINGBANK_SIZES="10" selects sizes, in multiples of the detection limit (10).
# SWINGBANK_KEEP=FOLDER keeps cases and verdicts there and continues from them.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

config=$SWINGBANK_SOURCE/configs/blind/exciters.toml
kinds=$(sed -nE 's/^\[kind\.(.*)\]$/\1/p' "$config" | paste -sd,)
folder=${SWINGBANK_KEEP:-$work}
lost=()
for size in ${SWINGBANK_SIZES:-2 10 100}; do
  run=$folder/size$size
  "$swingbank" blind-test --config "$config" --seed 19 --kinds "$kinds" --make 7 --size "$size" --out "$run" \
    >/dev/null 2>"$work/errors" || fail "make: $(tail -n 3 "$work/errors")"
  "$swingbank" blind-test --diagnose --threads 1 --out "$run" >/dev/null 2>"$work/errors" ||
    fail "diagnose: $(tail -n 3 "$work/errors")"
  mapfile -t found < <(
    python3 - "$run" <<'PYTHON'
import json, pathlib, sys
run = pathlib.Path(sys.argv[1])
for file in sorted((run / "truth").glob("*.json")):
    hidden = json.loads(file.read_text())["hidden"][0]
    v = json.loads((run / "verdicts" / file.name).read_text())
    leading = ", ".join(f"{name} {100 * each:.1f} %" for name, each in v["probabilities"][:3])
    share = max((p for name, p in v["probabilities"] if name in hidden["answers"]), default=0)
    inside = bool({*v["effects"], *v["set"]} & {*hidden["answers"]})
    print(f"{'found' if inside else 'beside' if share >= 0.01 else 'lost'}: {hidden['kind']} of {hidden['left_noise']:.0f} x noise, {v['seconds']:.0f} s: "
          f"{v['verdict']}, {leading}")
PYTHON
  )
  printf '%s\n' "${found[@]}"
  ((${#found[@]} == 7)) || fail "${#found[@]} of 7 cases were judged at size $size"
  for line in "${found[@]}"; do
    [[ $line != lost* ]] || lost+=("$line")
  done
done
((${#lost[@]} == 0)) || fail "${#lost[@]} lost"
