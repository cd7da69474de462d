#!/usr/bin/env bash
# Writes the coverage table of docs/models.md: how many dynamic records of PSS/E cases the effects support, by model.
#   bash docs/coverage_table.sh FILE.dyr...
# The script replaces the lines between `<!-- coverage -->` and `<!-- end of coverage -->`. It runs
# `swingbank effects --coverage --json`; the command must be in the PATH, or in build/release/bin or build/dev/bin.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
(($# > 0)) || { echo "no file at FILE.dyr (the table counts the records of these files): name PSS/E .dyr files" >&2; exit 1; }
for folder in build/release/bin build/dev/bin; do
  if [[ -x $folder/swingbank ]]; then PATH=$PATH:$PWD/$folder; fi
done
swingbank effects --coverage "$@" --json | python3 -c '
import json, pathlib, sys
c = json.load(sys.stdin)
rows = ["| model | records | covered | read as |", "|---|---:|---:|---|"]
for m in c["models"]:
    read_as = "%s %s" % (m["slot"].replace("_", " "), m["effect"]) if m["effect"] else m["missing_because"] or "not supported"
    rows.append("| %s | %d | %d | %s |" % (m["name"].replace("|", ""), m["records"], m["covered"], read_as))
text = "{:,} of {:,} records in {} files are covered ({:.1f} %):\n\n".format(c["covered"], c["records"], c["files"], c["percent"])
page = pathlib.Path("docs/models.md")
old = page.read_text()
begin, end = "<!-- coverage -->\n", "<!-- end of coverage -->\n"
at, stop = old.index(begin) + len(begin), old.index(end)
page.write_text(old[:at] + text + "\n".join(rows) + "\n" + old[stop:])
'
