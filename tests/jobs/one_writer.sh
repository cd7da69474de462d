#!/usr/bin/env bash
# Two commands cannot write into one folder: the second is refused while the first runs, and runs afterwards.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

configs=$SWINGBANK_SOURCE/configs
cd "$work"
with=(--model "$configs/plants/ieee14_bus2.toml" --records "$configs"/records/record-example/avr_ev{1,2}.csv --out out)

"$SWINGBANK_BIN/swingbank-diagnose" "${with[@]}" >first 2>&1 &
first=$!
for _ in $(seq 6000); do
  [[ ! -e out/.swingbank-lock ]] || break
  kill -0 $first 2>/dev/null || fail "the first ended before it locked its folder: $(cat first)"
  sleep 0.01
done
kill -STOP $first
refuses "compare beside diagnose" 'at --out|out' "$swingbank" compare "${with[@]}"
[[ ! -e out/compare.json && ! -e out/report.html ]] || fail "the refused command wrote into the folder"
kill -KILL $first
wait $first || true
status=0
"$swingbank" compare "${with[@]}" >second 2>&1 || status=$?
((status == 3)) || fail "exit code $status, expected 3, after a killed writer: $(tail -n 3 second)"
[[ -s out/compare.json ]] || fail "no result"
