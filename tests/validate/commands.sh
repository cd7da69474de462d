#!/usr/bin/env bash
# swingbank-compare and swingbank-tables: exit codes, output files, and nothing written on bad input.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $1" >&2; exit 1; }
records=$SWINGBANK_SOURCE/configs/records/record-example
model=$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml
compare=$SWINGBANK_BIN/swingbank-compare tables=$SWINGBANK_BIN/swingbank-tables

"$compare" --model "$model" --record "$records/avr_ev1.csv" --record "$records/avr_ev2.csv" --switch avr_ev1.csv=2.0 --switch avr_ev1.csv=2.1 \
  --out "$work/report" --json >"$work/printed.json" && fail "a missing exciter found adequate"
[[ $? == 3 ]] || fail "exit code of a model that is not adequate"
cmp "$work/printed.json" "$work/report/compare.json" || fail "--json prints something else than it writes"
python3 - "$work/printed.json" <<'PYTHON'
import json, sys
events = json.load(open(sys.argv[1]))["events"]
assert [e["record"] for e in events] == ["avr_ev1.csv", "avr_ev2.csv"]
assert [e["switchings_found"] for e in events] == [False, True]
assert json.load(open(sys.argv[1]))["adequate"] is False
assert [s["t_s"] for s in events[0]["switchings"]] == [2.0, 2.1]
PYTHON
[[ $(find "$work/report" -type f ! -name '.*' | wc -l) == 4 ]] || fail "report.html, compare.json and two curves expected"

# refuses WORDS... : exit code 1, a message that contains the first argument, no file
refuses() {
  local words=$1 code=0
  shift
  "$@" --out "$work/none" >"$work/out" 2>&1 || code=$?
  [[ $code == 1 ]] || fail "exit code $code instead of 1: $*"
  grep -q -- "$words" "$work/out" || fail "'$words' not in: $(cat "$work/out")"
  [[ ! -e $work/none ]] || fail "files left behind: $*"
}
one=(--record "$records/avr_ev1.csv") two=(--record "$records/avr_ev2.csv")
refuses 'name one: --switch' "$compare" --model "$model" "${one[@]}" "${two[@]}" --switch 2.0
refuses 'no --record has that file name' "$compare" --model "$model" "${one[@]}" --switch other.csv=2.0
refuses 'not a time in seconds' "$compare" --model "$model" "${one[@]}" --switch 2,0
refuses 'switching time 99 s at avr_ev1.csv (it is outside the record, 0 to ' "$compare" --model "$model" "${one[@]}" --switch 99
refuses '0 s before the event' "$compare" --model "$model" "${one[@]}" --switch 0.01
refuses 'overwrite each other' "$compare" --model "$model" "${one[@]}" "${one[@]}"
refuses '--model' "$compare" "${one[@]}"
mkdir "$work/empty"
refuses 'no results' "$tables" "$work/empty"
echo '{}' >"$work/empty/a.json"
refuses "key 'table'" "$tables" "$work/empty"
