#!/usr/bin/env bash
# swingbank diagnose --fleet: one sound plant among bad ones, on two ranks and on one; errors.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/fleet.bash"

sed '101s/,[^,]*$//' "$work/records/e1.csv" >"$work/records/cut.csv"
sed '50,69s/,[^,]*/,NaN/' "$work/records/e2.csv" >"$work/records/nan.csv"
{
  echo '[options]'
  echo 'power_only = true'
  model=whole.toml plant sound '"records/e[12].csv"'
  plant cut '"records/e1.csv", "records/cut.csv"'
  plant nan '"records/e1.csv", "records/nan.csv"'
  plant gone '"records/e1.csv", "records/e9.csv"'
  plant alone '"records/e1.csv"'
  plant nobody '"records/x*.csv"'
} >"$work/fleet.toml"
expect 1 fleet "$work/fleet.toml" "$work/ranks" 2
! grep 'failure at rank' "$work/ranks.log" || fail "a rank failed"
"$swingbank" compare --model "$work/whole.toml" --records "$work"/records/e[12].csv --power-only --json \
  --out "$work/alone" >"$work/compare.json" || fail "compare: exit code $?"
/usr/bin/python3 - "$work/ranks" "$work/compare.json" <<'PYTHON'
import csv, json, sys
folder = sys.argv[1]
fleet = json.load(open(folder + "/fleet.json"))
plants = {p["plant"]: p for p in fleet["plants"]}
assert fleet["failed"] == 5 and len(plants) == 6, fleet["summary"]
sound = plants["sound"]
assert sound["verdict"] == "adequate" and not sound["effects"], sound
words = {"cut": "cut.csv:101", "nan": "nan.csv:50", "gone": "e9.csv", "alone": "two events", "nobody": "x*.csv"}
for name, where in words.items():
    assert plants[name]["verdict"] == "failed" and where in plants[name]["sentence"], plants[name]
rows = list(csv.DictReader(open(folder + "/fleet.csv")))
failed = sorted(name for name in plants if name != "sound")
assert [r["plant"] for r in rows] == failed + ["sound"] == [p["plant"] for p in fleet["plants"]], rows
assert all(r["fit_for_purpose"] == "not judged" and r["report"] == "" for r in rows[:-1]), rows
# the error of the submitted model equals the error that compare reports
errors = json.load(open(sys.argv[2]))["fitness"]["errors_percent_of_mva"]
largest = max(errors, key=lambda e: e["mxe"])
row = rows[-1]
assert abs(float(row["largest_error [% of MVA]"]) - largest["mxe"]) < 1e-5 * largest["mxe"], (row, largest)
assert [row["channel"], row["window"], row["event"]] == [largest[k] for k in ("channel", "window", "record")], row
assert (row["verdict"], row["fit_for_purpose"], row["report"]) == ("adequate", "yes", "sound/report.html"), row
whole = json.load(open(folder + "/sound/diagnosis.json"))
assert whole["sentence"] == sound["sentence"]
PYTHON
grep -q '^6/6 plants (100 %' "$work/ranks.log" || fail "progress: $(cat "$work/ranks.log")"
grep -q 'adequate' "$work/ranks/sound/report.html" || fail "no report of the sound plant"

# again, on one rank: existing results are not computed again, and the table is the same
before=$(stat -c %y "$work/ranks/sound/plant.json")
expect 1 fleet "$work/fleet.toml" "$work/ranks"
grep -q 'sound: .* (existed already)' "$work/ranks.log" || fail "computed again: $(cat "$work/ranks.log")"
[[ $before == "$(stat -c %y "$work/ranks/sound/plant.json")" ]] || fail "written again"
grep -q '5 failed' "$work/table" || fail "table: $(cat "$work/table")"
[[ -z $(find "$work/ranks" -name '*.part' -o -name '*.old') ]] || fail "left behind: $(find "$work/ranks")"

# a plant that exceeds its time limit is ended, and the others continue
expect 1 fleet "$work/fleet.toml" "$work/late" 1 --plant-timeout 0.01
grep -q 'sound: failed: The diagnosis took longer than 0.01 s' "$work/late.log" || fail "no limit: $(cat "$work/late.log")"
grep -q '6 failed' "$work/table" || fail "table: $(cat "$work/table")"

# bad input: nothing is computed or written
diagnose() { "$swingbank" diagnose "$@" --out "$work/none"; }
{
  plant a '"records/e1.csv"' 'colour = 3'
  echo '[option]'
} >"$work/wrong.toml"
refuses "unknown key" 'colour' diagnose --fleet "$work/wrong.toml"
refuses "unknown section" 'option ' diagnose --fleet "$work/wrong.toml"
refuses "no fleet file" 'nowhere.toml' diagnose --fleet "$work/nowhere.toml"
refuses "no such plant" 'no plant z' diagnose --fleet "$work/fleet.toml" --plant z
misused "options of the fleet's file" 'excludes' diagnose --fleet "$work/fleet.toml" --power-only
misused "a plant beside a fleet" 'excludes' diagnose --fleet "$work/fleet.toml" --model m.toml --records e.csv
misused "neither" 'fleet' diagnose
[[ ! -e $work/none ]] || fail "something was written"
echo 'a file' >"$work/file"
refuses "a file in place of the folder" "$work/file" "$swingbank" diagnose --fleet "$work/fleet.toml" --out "$work/file"
exec 9>"$work/ranks/.lock"
flock -n 9
refuses "a second run" 'folder in use' "$swingbank" diagnose --fleet "$work/fleet.toml" --out "$work/ranks"
