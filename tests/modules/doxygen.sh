#!/usr/bin/env bash
# Every public name of the installed library has documentation. Members declared on one line share its comment.
set -euo pipefail
cd "${SWINGBANK_SOURCE:?}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
(cat docs/Doxyfile; echo "OUTPUT_DIRECTORY = $work"; echo "GENERATE_HTML = NO"; echo "GENERATE_TAGFILE = $work/tags") |
  doxygen - >"$work/log" 2>&1 || { tail -n 5 "$work/log" >&2; exit 1; }
[[ -s $work/tags ]] || { echo "doxygen found no header" >&2; exit 1; }
/usr/bin/python3 - "$work/log" <<'PYTHON'
import pathlib
import re
import sys

failed = False
for line in pathlib.Path(sys.argv[1]).read_text().splitlines():
    match = re.match(r"(.*):(\d+): warning: (.*) is not documented\.", line)
    if not match:
        continue
    source = pathlib.Path(match[1]).read_text().splitlines()
    number = int(match[2])
    statement = source[number - 1]
    while not re.search(r"[;{}]", statement.split("//")[0]) and number < len(source):  # a declaration of several lines
        statement += source[number]
        number += 1
    after = source[number].strip() if number < len(source) else ""
    if "///<" in statement or after.startswith("///<"):
        continue
    failed = True
    print(f"no documentation of {match[3]} at {match[1]}:{match[2]} (the library is installed): add a comment", file=sys.stderr)
sys.exit(failed)
PYTHON
