#!/usr/bin/env bash
# The page of a verdict: what stands on it, names that would break it, and printed as PDF; what is said meanwhile.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

bent=$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml
one=$SWINGBANK_SOURCE/configs/records/record-example/avr_ev1.csv
export OMP_NUM_THREADS=2
# the same plant with the exciter that it lacks, its values near enough for a grid code and not for the noise
sexs() { cat "$bent"; printf '[exciter]\neffect = "SEXS"\nTAoverTB = 0.1\nTB = 10\nK = %s\nTE = 0.05\nEMIN = -4\nEMAX = 5\n' "$1"; }
sexs 100 >"$work/right.toml"

# gives CODE SENTENCE COMMAND...: that exit code, and a line with that sentence
gives() {
  local expected=$1 said=$2 code=0
  shift 2
  "$@" --out "$work/out" >"$work/text" 2>"$work/notes" || code=$?
  ((code == expected)) || fail "exit code $code, expected $expected: $* said: $(tail -n 3 "$work/text" "$work/notes")"
  grep -q -- "$said" "$work/text" || fail "'$said' is not in: $(cat "$work/text")"
}
calibrate() { "$swingbank" calibrate --model "$work/right.toml" --records "$one" --power-only --draws 0 --starts 0 "$@"; }
compare() { "$swingbank" compare --records "$one" "$@"; }
# every command writes a page; a name that is no UTF-8, or a tag, costs nothing
sed 's|^name = .*|name = "</script><b>"|' "$bent" >"$work/tag.toml"
cp "$one" "$work/"$'ev\xff<i>.csv'
gives 3 '^Fit for purpose: no' "$swingbank" compare --model "$work/tag.toml" --records "$work/"$'ev\xff<i>.csv' --by 'A. Engineer'
hash=$(sha256sum "$work/tag.toml" | cut -d' ' -f1)
for words in 'A. Engineer' "$hash" 'Five words' "X''d" 'V, played in' 'Error map'; do
  grep -qF -- "$words" "$work/out/report.html" || fail "'$words' is not on the page of compare"
done
! grep -qF '</script><b>' "$work/out/report.html" || fail "a name breaks the page"
python3 -c 'import json, sys; json.load(open(sys.argv[1]))' "$work/out/compare.json"
calibrate --out "$work/out" >/dev/null 2>&1
for words in 'Five words' '95 % interval' 'calibrated' 'submitted' 'Error map' 'SHA-256'; do
  grep -qF -- "$words" "$work/out/report.html" || fail "'$words' is not on the page of calibrate"
done

# the page as PDF, printed; --quiet says nothing but the result; progress on a terminal is in a person's words
if command -v chromium >/dev/null; then
  gives 3 '^Fit for purpose: no' compare --model "$bent" --pdf "$work/page #1.pdf" --quiet
  [[ $(head -c 5 "$work/page #1.pdf") == %PDF- && ! -s $work/notes ]] || fail "no PDF, or --quiet told: $(cat "$work/notes")"
fi
python3 - "$swingbank" calibrate --model "$work/right.toml" --records "$one" --power-only --draws 0 --starts 0 --out "$work/out" >"$work/tty" <<'PYTHON'
import pty, sys
pty.spawn(sys.argv[1:])
PYTHON
grep -qE '[0-9]+ % done, about [0-9]+ s left: parameters are fitted' "$work/tty" || fail "no progress: $(head -c 600 "$work/tty")"
