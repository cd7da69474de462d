#!/usr/bin/env bash
# swingbank compare --system: the example, a record of the same grid, output files, and one message for each bad
# input.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

networks=$SWINGBANK_SOURCE/configs/networks
# the example: a record with an exciter that the grid lacks
code=0
"$swingbank" compare --system "$SWINGBANK_SOURCE/configs/systems/ieee14_fault_at_5.toml" --out "$work/example" \
  --json >"$work/printed.json" || code=$?
((code == 3)) || fail "exit code $code of a grid without the exciter"
cmp "$work/printed.json" "$work/example/compare.json" || fail "--json prints something else than it writes"
[[ $(find "$work/example" -type f ! -name '.*' | wc -l) == 3 ]] || fail "report.html, compare.json and one terminal's curves expected"
/usr/bin/python3 - "$work/printed.json" <<'PYTHON'
import json, sys
r = json.load(open(sys.argv[1]))
first = r["ranking"][0]
assert r["adequate"] is False and first["terminal"] == "gen2" and first["alone_adequate"] is False
start = r["terminals"][0]["initial"]  # the record's power flow; standard error of its means: 0.002 / sqrt(121)
assert abs(start["P_pu"]) < 6e-4 and abs(start["Q_pu"]) < 6e-4 and abs(start["V_pu"]) < 1e-4, start
PYTHON

# records of the same grid: adequate; records with one modified governor: its terminal is ranked first
simulate() {
  "$swingbank" simulate --raw "$networks/ieee14_genrou.raw" --dyr "$networks/ieee14_genrou.dyr" --attach all:SEXS --t-end 8 --rate 60 \
    --fault 4:2:2.1 --channels V,theta,P,Q --buses 5 --out "$1.h5" --out "$1.csv" "${@:2}" >/dev/null
}
simulate "$work/same" --attach all:TGOV1:R=0.05,T1=0.5
simulate "$work/changed" --attach 2:TGOV1:R=0.02,T1=0.2 --attach 1:TGOV1:R=0.05,T1=0.5 --attach 3:TGOV1:R=0.05,T1=0.5 \
  --attach 6:TGOV1:R=0.05,T1=0.5 --attach 8:TGOV1:R=0.05,T1=0.5
# system RUN [EVENT LINE]: prints a system file for the records of RUN
system() {
  cat <<TOML
[system]
name = "IEEE 14"
raw = "$networks/ieee14_genrou.raw"
dyr = "$networks/ieee14_genrou.dyr"
conventions = "psse"
attach = ["all:SEXS", "all:TGOV1:R=0.05,T1=0.5"]
[event]
${2:-fault = [\"4:2:2.1\"]}
[record]
base_mva = 100.0
[terminal.gen1]
plant = "1"
record = "$1.h5#1"
[terminal.gen2]
plant = "2"
record = "$1.h5#2"
[terminal.bus5]
bus = 5
record = "$1.csv#bus5"
TOML
}
system same >"$work/same.toml"
"$swingbank" compare --system "$work/same.toml" --out "$work/good" >"$work/text" || fail "the same grid: $(tail -3 "$work/text")"
grep -q '^Adequate' "$work/text" || fail "no verdict: $(cat "$work/text")"
system changed >"$work/changed.toml"
code=0
"$swingbank" compare --system "$work/changed.toml" --out "$work/bad" >"$work/text" || code=$?
((code == 3)) || fail "exit code $code with a changed governor"
grep -q '^The model of the plant at terminal gen2 fails in playback' "$work/text" || fail "the changed terminal is not named: $(tail -4 "$work/text")"
for file in report.html compare.json curves-bus5.csv curves-gen1.csv curves-gen2.csv; do
  [[ -s $work/bad/$file ]] || fail "no $file"
done

compare() { "$swingbank" compare --out "$work/none" "$@"; }
refuses "no system file" 'nowhere.toml' compare --system "$work/nowhere.toml"
sed '201s/,[^,]*$//' "$work/same.csv" >"$work/cut.csv"
changed_system() { sed "$1" "$work/same.toml" >"$work/wrong.toml"; }
changed_system 's|same.csv|cut.csv|'
refuses "a line that is cut off" 'cut.csv:201' compare --system "$work/wrong.toml"
# missing frames are interpolated, reported and not compared
sed '50,52s/,[^,]*$/,NaN/' "$work/same.csv" >"$work/lost.csv"
changed_system 's|same.csv|lost.csv|'
"$swingbank" compare --system "$work/wrong.toml" --out "$work/lost" >"$work/text" || fail "three lost frames: $(tail -3 "$work/text")"
grep -q '^note on bus5: 3 of [0-9]* samples are missing' "$work/text" || fail "the missing samples are not reported: $(cat "$work/text")"
sed '50,69s/,[^,]*$/,NaN/' "$work/same.csv" >"$work/nan.csv"
changed_system 's|same.csv|nan.csv|'
refuses "not a number" 'nan.csv:50' compare --system "$work/wrong.toml"
changed_system 's|#2"|#3x"|'
refuses "no such terminal" "no plant '3x'" compare --system "$work/wrong.toml"
changed_system 's|4:2:2.1|44:2:2.1|'
refuses "no such bus" 'no bus 44' compare --system "$work/wrong.toml"
changed_system 's|4:2:2.1|4:2:12|'
refuses "an event after the records" 'a fault that ends at 12' compare --system "$work/wrong.toml"
changed_system 's|^base_mva|base_mwa|'
refuses "a key that is misspelt" 'base_mwa' compare --system "$work/wrong.toml"
misused "a plant beside a system" 'excludes' compare --system "$work/same.toml" --model m.toml --record e.csv
misused "what a system file says" 'excludes' compare --system "$work/same.toml" --switch 2
misused "neither" 'system' compare
[[ ! -e $work/none ]] || fail "something was written"
echo 'a file' >"$work/file"
refuses "a file in place of the folder" "$work/file" "$swingbank" compare --system "$work/same.toml" --out "$work/file"
