#!/usr/bin/env bash
# The page of a verdict: its content, names that would break it, and its PDF; the progress messages.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
# shellcheck disable=SC2154 # set by verdict.bash
source "$(dirname "${BASH_SOURCE[0]}")/verdict.bash"

# every command writes a page; names with invalid UTF-8 or a tag are harmless
sed 's|^name = .*|name = "</script><b>"|' "$bent" >"$work/tag.toml"
cp "$one" "$work/"$'ev\xff<i>.csv'
gives 3 '^Fit for purpose: no' "$swingbank" compare --model "$work/tag.toml" --records "$work/"$'ev\xff<i>.csv' --by 'A. Engineer'
hash=$(sha256sum "$work/tag.toml" | cut -d' ' -f1)
for words in 'A. Engineer' "$hash" 'Glossary' "X''d" 'V, played in' 'Error map'; do
  grep -qF -- "$words" "$work/out/report.html" || fail "'$words' is not on the page of compare"
done
! grep -qF '</script><b>' "$work/out/report.html" || fail "a name breaks the page"
python3 - "$work/out/compare.json" "$hash" "$(sha256sum <"$one" | cut -d' ' -f1)" <<'PYTHON'
import json, sys
rows = json.load(open(sys.argv[1]))["provenance"]
hashes = [row["value"].split()[0] for row in rows if row["what"] == "SHA-256"]
assert sorted(hashes) == sorted(sys.argv[2:]), hashes
command = next(row["value"] for row in rows if row["what"] == "command")
assert " --by 'A. Engineer' " in command, command  # as a shell reads it
PYTHON
rm -r "$work/out"
calibrate --out "$work/out" >/dev/null 2>&1
for words in 'Glossary' '95 % interval' 'calibrated' 'submitted' 'Error map' 'SHA-256'; do
  grep -qF -- "$words" "$work/out/report.html" || fail "'$words' is not on the page of calibrate"
done

# at a phone's width of 390 px the first table (fitness) fits; on A4 every table fits
if command -v chromium >/dev/null; then
  # too_wide WIDTH MEDIA: tables wider than WIDTH px, by their index on the page
  too_wide() {
    python3 - "$work/out/report.html" "$work/measured.html" "$1" "$2" <<'PYTHON'
import re, sys
page, width, media = open(sys.argv[1]).read(), sys.argv[3], sys.argv[4]
page = re.sub(r"(<td class=.cell[^>]*>)[^<]* of [^<]*", r"\1-11.06 of ±5 % *", page)  # the widest possible value
page = page.replace(media, "@media all", 1).replace("</main>", """</main><script>addEventListener('load', () => {
  document.querySelectorAll('details').forEach((d) => d.open = true);
  document.body.style.width = '%spx';
  const width = document.querySelector('main').clientWidth - 2 * parseFloat(getComputedStyle(document.querySelector('main')).paddingLeft);
  document.body.innerText = 'over:' + [...document.querySelectorAll('table')].map((t, i) => t.scrollWidth > width + 1 ? i : '').join(' ') + ';';
})</script>""" % width, 1)
open(sys.argv[2], "w").write(page)
PYTHON
    chromium --headless --no-sandbox --disable-gpu --window-size=1000,800 --dump-dom "file://$work/measured.html" 2>/dev/null |
      grep -o 'over:[0-9 ]*;'
  }
  [[ $(too_wide 390 '@media (max-width: 600px)') =~ ^over:[^0]*\;$ ]] || fail "the fitness table is wider than a phone: $(too_wide 390 '@media (max-width: 600px)')"
  [[ $(too_wide 718 '@media print') =~ ^over:\ *\;$ ]] || fail "wider than A4: $(too_wide 718 '@media print')"
  # in print a long table continues on the next page, a short one stays whole, and a heading stays with its content
  python3 - "$work/out/report.html" "$work/printed.html" <<'PYTHON'
import sys
page = open(sys.argv[1]).read()
open(sys.argv[2], "w").write(page.replace("@media print", "@media all", 1).replace("</main>", """</main><script>addEventListener('load', () => {
  const [short, long] = document.querySelectorAll('table'), heading = document.querySelector('h3');
  for (let k = 0; k < 60; ++k) long.tBodies[0].append(long.tBodies[0].rows[0].cloneNode(true));
  document.body.innerText = 'breaks:' + [getComputedStyle(short).breakInside, getComputedStyle(long).breakInside, getComputedStyle(heading).breakAfter] + ';';
})</script>""", 1))
PYTHON
  breaks=$(chromium --headless --no-sandbox --disable-gpu --window-size=1000,800 --dump-dom "file://$work/printed.html" 2>/dev/null |
    grep -o 'breaks:[a-z,]*;')
  [[ $breaks == 'breaks:avoid,auto,avoid;' ]] || fail "a short table, a long one and a heading break in print as $breaks"
fi

# the page as PDF, printed; --quiet prints only the result; progress on a terminal is in plain words
if command -v chromium >/dev/null; then
  gives 3 '^Fit for purpose: no' compare --model "$bent" --pdf "$work/page #1.pdf" --quiet
  [[ $(head -c 5 "$work/page #1.pdf") == %PDF- && ! -s $work/notes ]] || fail "no PDF, or --quiet printed: $(cat "$work/notes")"
fi
python3 - "$swingbank" calibrate --model "$work/right.toml" --records "$one" --power-only --draws 0 --starts 0 --out "$work/tty-out" >"$work/tty" <<'PYTHON'
import pty, sys
pty.spawn(sys.argv[1:])
PYTHON
grep -qE '[0-9]+ % done, about [0-9]+ s left: fit of the parameters' "$work/tty" || fail "no progress: $(head -c 600 "$work/tty")"
