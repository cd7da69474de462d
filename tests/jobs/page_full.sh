#!/usr/bin/env bash
# The page of a verdict: what stands on it, names that would break it, and printed as PDF; what is said meanwhile.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
# shellcheck disable=SC2154 # what verdict.bash sets
source "$(dirname "${BASH_SOURCE[0]}")/verdict.bash"

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
