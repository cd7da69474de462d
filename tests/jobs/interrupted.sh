#!/usr/bin/env bash
# A stop signal at any time ends calibrate, add, compare and diagnose with exit code 2. Results so far are written
# under names that mark them as interrupted; results of an earlier run stay.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

model=$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml
records=$SWINGBANK_SOURCE/configs/records/record-example
cd "$work"
mkdir out
echo earlier >out/model.toml

# interrupted WORDS COMMAND...: sends SIGINT once stderr contains WORDS (empty: as soon as the program has started)
interrupted() {
  local words=$1 status=0 pid
  shift
  "$@" >stdout 2>stderr &
  pid=$!
  for _ in $(seq 6000); do
    if [[ $(readlink "/proc/$pid/exe") == */swingbank_* ]] && grep -q "SigCgt:.*[2367abef]$" "/proc/$pid/status" 2>/dev/null &&
      { [[ -z $words ]] || grep -q -- "$words" stderr; }; then break; fi
    sleep 0.01
  done
  kill -INT $pid
  wait $pid || status=$?
  ((status == 2)) || fail "exit code $status, expected 2, of $*: $(tail -n 3 stderr)"
}
for command in compare calibrate "add SEXS" diagnose; do
  # shellcheck disable=SC2086 # an effect is a word of its own
  interrupted '' "$SWINGBANK_BIN/swingbank-${command%% *}" ${command#"${command%% *}"} --model "$model" \
    --records "$records"/avr_ev1.csv "$records"/avr_ev2.csv --out out
  [[ $(cat out/model.toml) == earlier ]] || fail "$command: an earlier result was replaced"
  [[ ! -e out/report.html && ! -e out/.swingbank-lock ]] || fail "$command: a result that looks whole, or a lock, is left"
done
