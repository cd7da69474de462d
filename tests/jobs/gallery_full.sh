#!/usr/bin/env bash
# The commands of docs/gallery/README.md give the outcomes that it states: the same words, and numbers within a tenth.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
gallery=$SWINGBANK_SOURCE/docs/gallery
bash "$gallery/make.sh" "$work/gallery" >"$work/said" 2>&1 || fail "make.sh: $(tail -n 5 "$work/said")"
/usr/bin/python3 - "$work/gallery/outcome.txt" "$gallery/README.md" <<'PYTHON'
import pathlib, re, sys
outcomes, stated = (pathlib.Path(f).read_text() for f in sys.argv[1:])
stated = [line for line in stated.splitlines() if re.match(r"(missing \w+|wrong values): ", line)]
assert len(stated) == len(outcomes.splitlines()) == 3, stated
NUMBER = r"(?<![\w.])\d+(?:\.\d+)?"
for made, line in zip(outcomes.splitlines(), stated):
    assert re.sub(NUMBER, "#", made) == re.sub(NUMBER, "#", line), (made, line)
    for a, b in zip(re.findall(NUMBER, made), re.findall(NUMBER, line)):
        assert abs(float(a) - float(b)) <= 0.1 * float(b), (a, b, made, line)
PYTHON
for picture in "$gallery"/*.png; do
  (($(stat -c %s "$picture") <= 150000)) || fail "$picture is larger than 150 kB"
  grep -qF "$(basename "$picture")" "$gallery/README.md" "$SWINGBANK_SOURCE/README.md" || fail "no page shows $picture"
done
