#!/usr/bin/env bash
# A small blind test with diagnosis: the missing exciter is named, nothing is named if nothing is missing, and an
# unlisted effect is not called adequate. Its rates are not representative (docs/reference/blind-test-results.md has
# those).
set -euo pipefail
bin=${SWINGBANK_BIN:?} source=${SWINGBANK_SOURCE:?}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
run=$folder/run

"$bin/swingbank-blind-test" --config "$source/configs/blind/tiny.toml" --out "$run" --seed 7 \
  --kinds SEXS,none,sawtooth --size 5 --make 6 >"$folder/log"
for part in 1/2 2/2; do
  "$bin/swingbank-blind-test" --out "$run" --diagnose --part "$part" >>"$folder/log"
done
"$bin/swingbank-blind-test" --out "$run" --score --targets "$source/configs/blind/targets.toml" >>"$folder/log"

python3 - "$run" <<'PY' || { cat "$folder/log"; exit 1; }
import json, pathlib, sys

run, wrong, judged = pathlib.Path(sys.argv[1]), [], 0
for truth in sorted((run / "truth").glob("c*.json")):
    hidden = [h["kind"] for h in json.loads(truth.read_text())["hidden"]]
    said = json.loads((run / "verdicts" / truth.name).read_text())
    named = said["effects"] + said["set"]
    right = {
        (): said["verdict"] in ("adequate", "unexplained"),
        ("SEXS",): "SEXS" in named,
        ("sawtooth",): said["verdict"] == "unexplained",
    }[tuple(hidden)]
    judged += 1
    if not right:
        wrong.append(f"{truth.stem}: {hidden}, said {said['verdict']} {named}")
assert judged == 6, judged
assert not wrong, wrong
PY
