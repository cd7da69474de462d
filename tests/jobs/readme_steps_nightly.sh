#!/usr/bin/env bash
# The README's commands, word for word: the example's diagnosis, and the steps for the user's plant. Every way to the
# diagnosis must end in the same verdict, even through an inadequate calibration.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
export PATH=$SWINGBANK_BIN:$PATH
readme=$SWINGBANK_SOURCE/README.md

cp -r "$SWINGBANK_SOURCE/configs" "$work/configs"
cd "$work"
chmod -R u+w configs
cp configs/networks/ieee14_genrou.raw configs/networks/mine.raw
cp configs/networks/ieee14_genrou.dyr configs/networks/mine.dyr
for k in 1 2 3 4; do cp "configs/records/record-example/avr_ev$k.csv" "event$k.csv"; done

# step EXIT PATTERN: runs the README's line that matches, which must end with this exit code
step() {
  local expected=$1 pattern=$2 line status=0
  line=$(grep -E "^ *swingbank $pattern" "$readme" | sed 's/^ *//')
  [[ $(wc -l <<<"$line") == 1 && -n $line ]] || fail "the README has not one line of '$pattern': $line"
  echo "$line"
  eval "$line" >said 2>said.errors || status=$?
  ((status == expected)) || fail "exit code $status, expected $expected: $line: $(tail -n 5 said said.errors)"
}
# verdict FOLDER: the accepted effects of a diagnosis
verdict() {
  python3 -c "
import json, sys
d = json.load(open(sys.argv[1] + '/diagnosis.json'))
print(d['verdict'], d['effects'], d['equivalent'], d['sentence'])" "$1"
}

step 3 'diagnose --model configs/plants/ieee14_bus2.toml'
verdict diagnosis >example
grep -q SEXS example || fail "the example's diagnosis: $(cat example)"
step 0 'add SEXS'
[[ -s added/model.dyr ]] || grep -q 'no .dyr' said || fail "add neither writes a .dyr nor reports why"

step 0 'inventory'
step 0 'simulate'
step 0 'plant'
step 3 'compare --model configs/plants/mine.toml'
step 3 'diagnose --model configs/plants/mine.toml'
verdict diagnosis >mine
step 3 'calibrate --model configs/plants/mine.toml'
[[ -s calibrated/model-not-adequate.toml && ! -e calibrated/model.toml && ! -e calibrated/model.dyr ]] || fail "calibrate wrote $(ls calibrated)"
grep -q '^next: .*swingbank diagnose --model configs/plants/mine.toml' said || fail "calibrate does not say what is next: $(tail -n 3 said)"
step 0 'export'
grep -q "^2 'GENROU' '1' " mine_unit.dyr || fail "export: $(cat mine_unit.dyr)"

# Diagnosis of the biased model: the same as of the original.
status=0
swingbank diagnose --model calibrated/model-not-adequate.toml --records event*.csv --out bent >said 2>said.errors || status=$?
((status == 3)) || fail "diagnose of the biased model: exit code $status: $(tail -n 5 said.errors)"
grep -q 'started from the values before' said.errors || fail "the starting values are not reported: $(cat said.errors)"
verdict bent >bent.verdict
cmp mine bent.verdict || fail "the verdict on the biased model differs: $(cat mine bent.verdict)"
refuses "export of a biased model" "not adequate" swingbank export --model calibrated/model-not-adequate.toml
