#!/usr/bin/env bash
# The live page in a browser: its numbers equal those of compare, and the saved model gives the numbers of the page.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
# shellcheck source=tests/jobs/serve.bash
source "$(dirname "${BASH_SOURCE[0]}")/serve.bash"

records=("$SWINGBANK_SOURCE"/configs/records/record-example/avr_ev*.csv)
screens=${SWINGBANK_SCREENS:-$work/screens}
mkdir -p "$screens"
serve "${records[@]}"
/usr/bin/python3 "$SWINGBANK_SOURCE/tests/jobs/serve_browser.py" "$(<url)" "$screens" >seen || fail "in the browser: $(<seen) $(<log)"
cat seen

# the dragged value gives the same error on the command line
value=$(sed -n 's/^value //p' seen)
sed "s/^H = 6.54 /H = $value /" "$model" >dragged.toml
"$swingbank" compare --model dragged.toml --records "${records[@]}" --power-only --out dragged --quiet >/dev/null || true
python3 - "$(sed -n 's/^rms //p' seen)" <<'PYTHON'
import json, sys
told, unit = sys.argv[1].split()
errors = [c["whole"]["rms_pu"] * c["units_in_pu"] for e in json.load(open("dragged/compare.json"))["events"] for c in e["channels"]]
assert any(abs(e - float(told)) < 1e-3 * e for e in errors), (told, errors)
PYTHON

# the saved model is complete and fit for purpose, for compare and calibrate too
status=0
"$swingbank" compare --model saved/model.toml --records "${records[@]}" --power-only --out compared --quiet >text || status=$?
((status == 0)) || fail "compare of the saved model ends with $status: $(<text)"
status=0
"$swingbank" calibrate --model saved/model.toml --records "${records[@]}" --power-only --out calibrated --quiet >text || status=$?
((status == 0)) || fail "calibrate of the saved model ends with $status: $(<text)"
grep -q 'SEXS' saved/model.dyr || fail "the PSS/E records lack the exciter"
kill -TERM "$server"
wait "$server" || fail "the server ends with an error"
