#!/usr/bin/env bash
# swingbank diagnose --thresholds prints every threshold of a verdict with value, unit and reason, as a table and as
# JSON; it needs neither model nor records.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

cd "$work"
"$swingbank" diagnose --thresholds >"$work/table.txt"
"$swingbank" diagnose --thresholds --json >"$work/table.json"
[[ ! -e $work/diagnosis ]] || fail "--thresholds writes a diagnosis"

python3 - "$work" "$SWINGBANK_SOURCE" <<'PYTHON'
import json, pathlib, re, sys

work, source = map(pathlib.Path, sys.argv[1:])
printed = json.loads((work / "table.json").read_text())
header = (source / "validate/thresholds/thresholds.hpp").read_text()
declared = re.findall(r"Threshold \w+\{\s*\"([\w.]+)\"", header)
declared += [f"{preset}.{key}" for preset in ("dtr-test", "dtr-simulation")
             for key in [f"{w}.{e}" for w in ("pre_fault", "fault", "post_fault") for e in ("mxe", "me", "mae")] + ["after_fault", "after_clearing"]]
assert [t["name"] for t in printed] == declared, set(declared) ^ {t["name"] for t in printed}
rows = {line.split()[0]: line for line in (work / "table.txt").read_text().splitlines()[1:]}
assert list(rows) == declared
for t in printed:
    assert t["unit"] and t["why"], t
    assert f"{t['value']:g}" in rows[t["name"]].split() and t["unit"] in rows[t["name"]] and t["why"] in rows[t["name"]], t
    for number in re.findall(r"decisions? (\d+)(?: and (\d+))?", t["why"]):
        for n in filter(None, number):
            assert list((source / "docs/decisions").glob(f"{int(n):02d}-*.md")), f"no decision {n}: {t['name']}"
value = {t["name"]: t["value"] for t in printed}
assert value["evidence.accepted"] == 40 and value["adequacy.reduced_chi2"] == 1.12 and value["addition.strong"] == 10
assert value["dtr-test.fault.me"] == 5 and value["dtr-simulation.post_fault.mae"] == 3 and value["dtr-simulation.after_clearing"] == 0.06
PYTHON

code=0
"$swingbank" diagnose --thresholds --model m.toml --records r.csv >"$work/text" 2>&1 || code=$?
((code == 1)) || fail "exit code $code, expected 1, with --thresholds beside --model"
