#!/usr/bin/env bash
# Kills one process, mpirun, one rank, a stopped rank, or one of three parts of a dataset, at times spread evenly over a
# run, from its first millisecond to its end. After each kill, one more run completes with the same hash and bytes.
#   SWINGBANK_KILLS=500 bash tests/mpi/chaos_nightly.sh      (60 by default; campaign.bash; docs/reference/faults.md has figures)
source "$(dirname "$0")/common.bash"
source "$(dirname "$0")/campaign.bash"
kills=${SWINGBANK_KILLS:-60}
make=("$generate" "$configs/ieee14_genrou_bus3.toml" --draws 600 --draws-per-shard 20 --progress none)
# lasts OUT [LAUNCHER...]: prints the duration of a complete run [ms]
lasts() {
  local start out=$1
  start=$(date +%s%N)
  shift
  "$@" "${make[@]}" --out "$out" >/dev/null 2>&1
  echo $((($(date +%s%N) - start) / 1000000))
}
alone=$(lasts "$work/whole") launched=$(lasts "$work/two" mpirun --oversubscribe -np 2)
whole=$(hash_of "$work/whole")
[ -n "$whole" ] || fail "no hash"
for ((i = from; i < kills; i += stride)); do
  if is_done $i; then continue; fi
  kinds=(process mpirun rank stopped part)
  kind=${kinds[i % 5]} out=$work/run began=later ended=by-itself went_wrong=''
  rm -rf "$out"
  case $kind in process | part) long=$alone ;; *) long=$launched ;; esac
  at=$((i * (long + 100) / kills)) # [ms]
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
  # Ranks of a killed mpirun end by themselves, but a stopped rank does not. OpenMPI's launcher may hang if a rank dies
  # in MPI_Init (known in 4.1): the launcher is killed after ten seconds, as in jobs/run_saving.bash.
  for ((wait = 0; wait < 100; ++wait)); do
    pgrep -f -- "--out $out" >/dev/null || break # ranks have process groups of their own
    [ "$kind" = stopped ] && pkill -9 -f -- "--out $out" || true
    sleep 0.1
  done
  pkill -9 -f -- "--out $out" 2>/dev/null && ended=hung
  wait $pid 2>/dev/null || true
  [ -e "$out/dataset.json" ] || began=early
  what="kill $i of $kind at $at ms"
  if [ "$ended" = hung ]; then wrong "$what: something hung until it was ended"; fi
  "${make[@]}" --out "$out" >"$work/log" 2>&1 || wrong "$what: the next run"
  grep -q "dataset $whole" "$work/log" || wrong "$what: another hash"
  diff -r "$work/whole/shards" "$out/shards" >"$work/log" || wrong "$what: other bytes or leftovers"
  outcome=same
  if [ -n "$went_wrong" ]; then outcome=wrong; fi
  keep $i $outcome $kind $began $ended "$at" "$went_wrong"
done
awk '{++n[$3]; same[$3] += $2 == "same"; early[$3] += $4 == "early"; hung += $5 == "hung"}
  END {for (k in n) printf "%s: %d of %d kills end in the same bytes, %d of them before the header stood\n", k, same[k], n[k], early[k]
    printf "runs of which something hung until it was ended: %d\n", hung}' "$results"
report_campaign "$kills"
