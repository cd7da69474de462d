#!/usr/bin/env bash
# While one rank draws the databank, the other ranks sleep, and all ranks react to a signal. In a group that writes a
# shard together, every rank flushes its own data.
# shellcheck disable=SC2154 # set by common.bash
source "$(dirname "$0")/common.bash"
config=$configs/ieee39_genrou.toml
# Drawing 500,000 points at the config's minimum distance takes minutes, and the forecast of the draws does not abort
# it.
options=("$config" --draws 50000000 --faults-per-point 100 --progress none)
ticks() { awk '{print $14 + $15}' "/proc/$1/stat"; } # processor time in units of 0.01 s
# ends_softly PID: a signal ends the drawing long before it is complete
ends_softly() {
  local code=0 start=$SECONDS
  kill -USR1 "$1"
  wait "$1" || code=$?
  [ $code = 2 ] || { cat "$work/drawing" >&2; fail "exit code $code after a signal while the databank was drawn"; }
  ((SECONDS - start < 20)) || fail "the run ended only $((SECONDS - start)) s after the signal"
  grep -q 'stopped on a signal' "$work/drawing" || fail "the signal is not reported: $(cat "$work/drawing")"
}

"$SWINGBANK_BIN/swingbank-databank" "$config" --points 500000 --out "$work/bank.csv" >"$work/drawing" 2>&1 &
sleep 2
ends_softly $!
[ ! -e "$work/bank.csv" ] || fail "half a databank was written"

mpirun --oversubscribe -np 3 "$generate" "${options[@]}" --out "$work/data" >"$work/drawing" 2>&1 &
launcher=$!
busiest=0 begun=
for _ in $(seq 600); do # until the drawing rank has used two more seconds after its first second of processor time
  sleep 0.1
  total=0 busiest=0
  for pid in $(pgrep -P $launcher); do
    one=$(ticks "$pid") || continue
    total=$((total + one))
    if ((one > busiest)); then busiest=$one; fi
  done
  if [ -z "$begun" ] && ((busiest >= 100)); then begun=$((total - busiest)) drawn=$busiest; fi
  if ((busiest >= 300)); then break; fi
done
((busiest >= 300)) || fail "no rank has drawn: $(cat "$work/drawing")"
waited=$((total - busiest - begun)) drawn=$((busiest - drawn))
((waited < drawn / 3)) || fail "two ranks that wait took $waited hundredths of a second beside $drawn of the one that draws"
ends_softly $launcher

# An injected failure of fsync on one rank of the group ends the run, which shows that this rank flushes.
small=("$configs/ieee14_genrou_bus3.toml" --draws 60 --draws-per-shard 20 --writer-ranks 3 --progress none)
for rank in 0 1 2; do
  expect 1 "Input/output error" env FAILING_CALL=fsync FAILING_ERROR=5 FAILING_AT=1 FAILING_RANK=$rank \
    FAILING_UNDER="$work/flushed/shards" FAILING_LOG="$work/failing" timeout -k 5 60 \
    mpirun --oversubscribe -np 3 -x LD_PRELOAD="$SWINGBANK_BIN/failing_call.so" "$generate" "${small[@]}" --out "$work/flushed"
  grep -q "^failed fsync $work/flushed/shards/.*\.h5" "$work/failing" || fail "rank $rank flushed no shard: $(cat "$work/failing")"
  rm -r "$work/flushed" "$work/failing"
done
