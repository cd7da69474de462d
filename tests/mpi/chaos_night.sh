#!/usr/bin/env bash
# Kills spread evenly over a run, from its first millisecond to its end: of one process, of mpirun, of one rank, of a rank
# that was stopped before, of one part of three. One more run ends each with the same hash and the same bytes.
#   SWINGBANK_KILLS=500 bash tests/mpi/chaos_night.sh      (60 by default; docs/faults.md has the figures of 500)
source "$(dirname "$0")/common.bash"
kills=${SWINGBANK_KILLS:-60}
make=("$generate" "$configs/ieee14_genrou_bus3.toml" --draws 600 --draws-per-shard 20 --progress none)
start=$(date +%s%N)
"${make[@]}" --out "$work/whole" >/dev/null 2>&1
lasts=$((($(date +%s%N) - start) / 1000000)) # [ms] one process
whole=$(hash_of "$work/whole")
[ -n "$whole" ] || fail "no hash"
declare -A tried early
RANDOM=11
for ((i = 0; i < kills; ++i)); do
  kinds=(process mpirun rank stopped part)
  kind=${kinds[i % 5]} out=$work/run
  rm -rf "$out"
  at=$((i * (lasts + 300) / kills)) # [ms]; a start under mpirun takes longer
  case $kind in
    process) setsid "${make[@]}" --out "$out" >/dev/null 2>&1 & ;;
    part) setsid "${make[@]}" --part $((i % 3 + 1))/3 --out "$out" >/dev/null 2>&1 & ;;
    *) setsid mpirun --oversubscribe -np $((i % 2 + 2)) "${make[@]}" --out "$out" >/dev/null 2>&1 & ;;
  esac
  pid=$!
  sleep "$((at / 1000)).$(printf %03d $((at % 1000)))"
  rank=$(pgrep -P $pid -f "$out" | shuf -n 1 --random-source=<(yes $i)) || true
  case $kind in
    rank) kill -9 "${rank:-$pid}" 2>/dev/null || true ;;
    stopped)
      kill -STOP "${rank:-$pid}" 2>/dev/null || true
      sleep 0.1
      kill -9 $pid 2>/dev/null || true
      ;;
    *) kill -9 $pid 2>/dev/null || true ;;
  esac
  # Ranks of a killed mpirun end by themselves, a stopped one does not. OpenMPI's launcher may hang when a rank dies
  # in MPI_Init (known of 4.1): after ten seconds it is ended, as jobs/run_saving.bash does.
  for ((wait = 0; wait < 100; ++wait)); do
    pgrep -g $pid >/dev/null || break
    [ "$kind" = stopped ] && pkill -9 -g $pid || true
    sleep 0.1
  done
  pkill -9 -g $pid 2>/dev/null && early[hung]=$((${early[hung]:-0} + 1))
  wait $pid 2>/dev/null || true
  tried[$kind]=$((${tried[$kind]:-0} + 1))
  [ -e "$out/dataset.json" ] || early[$kind]=$((${early[$kind]:-0} + 1))
  "${make[@]}" --out "$out" >"$work/log" 2>&1 || { cat "$work/log"; fail "kill $i of $kind at $at ms: the next run"; }
  grep -q "dataset $whole" "$work/log" || { cat "$work/log"; fail "kill $i of $kind at $at ms: another hash"; }
  diff -r "$work/whole/shards" "$out/shards" >"$work/log" || { cat "$work/log"; fail "kill $i of $kind at $at ms: other bytes or leftovers"; }
done
for kind in "${!tried[@]}"; do
  echo "$kind: ${tried[$kind]} of ${tried[$kind]} kills end in the same bytes, ${early[$kind]:-0} of them before the header stood"
done
echo "launchers that hung until they were ended: ${early[hung]:-0}"
