#!/usr/bin/env bash
# Two effects hidden together. Each pair is named or in what makes up 95 %, also where the search has met its effects beside
# other partners first (docs/decisions/57-crossed-pairs.md).
# SWINGBANK_KEEP=FOLDER keeps cases and verdicts there, and goes on with what is there.
# shellcheck disable=SC2154 # what lib.bash sets
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

run=${SWINGBANK_KEEP:-$work/pairs}
kinds=IEEEG1+IEEET1,ESAC1A+GAST,IEEEG1+STEPUP
"$swingbank" blind-test --config "$SWINGBANK_SOURCE/configs/blind/cases.toml" --seed 57 --kinds "$kinds" --make 3 --out "$run" \
  >/dev/null 2>"$work/errors" || fail "make: $(tail -n 3 "$work/errors")"
"$swingbank" blind-test --diagnose --threads 1 --out "$run" >/dev/null 2>"$work/errors" ||
  fail "diagnose: $(tail -n 3 "$work/errors")"
mapfile -t found < <(
  python3 - "$run" <<'PYTHON'
import json, pathlib, sys
run = pathlib.Path(sys.argv[1])
for file in sorted((run / "truth").glob("*.json")):
    hidden = [h["kind"] for h in json.loads(file.read_text())["hidden"]]
    v = json.loads((run / "verdicts" / file.name).read_text())
    said = [v["effects"], *(entry.split(" + ") for entry in v["set"])]
    inside = any(set(hidden) == set(each) for each in said)
    leading = ", ".join(f"{name} {100 * each:.0f} %" for name, each in v["probabilities"][:3])
    print(f"{'found' if inside else 'lost'}: {' + '.join(hidden)}, {v['seconds']:.0f} s: {v['verdict']}, {leading}")
PYTHON
)
printf '%s\n' "${found[@]}"
((${#found[@]} == 3)) || fail "${#found[@]} of 3 cases were judged"
for line in "${found[@]}"; do
  [[ $line == found* ]] || fail "$line"
done
