#!/usr/bin/env bash
# Kills a fleet's diagnosis at times spread evenly over its duration: the process or mpirun, one child or rank, all at
# once, or all after one was stopped. After each kill, one more run must give the same tables.
#   SWINGBANK_KILLS=100 bash tests/jobs/chaos_fleets_nightly.sh      (16 by default; tests/mpi/campaign.bash)
# shellcheck disable=SC2154 # set by lib.bash and two_plants.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/kill.bash"
source "$(dirname "${BASH_SOURCE[0]}")/fleet.bash"
source "$(dirname "${BASH_SOURCE[0]}")/two_plants.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../mpi/campaign.bash"
kills=${SWINGBANK_KILLS:-16}
export OMP_NUM_THREADS=1

# command RANKS OUT: sets `run`; one rank: without a launcher
command() {
  run=("$SWINGBANK_BIN/swingbank-diagnose" --fleet "$fleet_file" --out "$2")
  if (($1 > 1)); then run=(mpirun --oversubscribe -np "$1" "${run[@]}"); fi
}
declare -A lasts
for ranks in 1 2; do
  begin=$(date +%s%N)
  command $ranks "$work/whole"
  rm -rf "$work/whole"
  whole_fleet "${run[@]}" || fail "$ranks ranks: $(cat "$work/log")"
  lasts[$ranks]=$((($(date +%s%N) - begin) / 1000000)) # [ms]
  echo "$ranks ranks take ${lasts[$ranks]} ms"
done
for ((i = from; i < kills; i += stride)); do
  if is_done $i; then continue; fi
  ways=(process child group stopped)
  ranks=$((i % 2 + 1)) way=${ways[i / 2 % 4]} out=$work/run went_wrong=''
  rm -rf "$out"
  command $ranks "$out"
  at=$((lasts[$ranks] * i / kills))
  begin_and_kill "$way" "$at" "${run[@]}"
  what="kill $i ($way of $ranks ranks at $at ms)"
  # Without a launcher, the fleet's process survives a killed child: its plant fails, and the other plants finish.
  for ((wait = 0; wait < 600; ++wait)); do
    pgrep -f -- "--fleet $fleet_file .*--out $out" >/dev/null || break
    sleep 0.1
  done
  if pgrep -f -- "--fleet $fleet_file .*--out $out" >/dev/null; then
    kill -9 -- -$pid
    wrong "$what: processes lived on for a minute"
  fi
  wait $pid 2>/dev/null || true
  command $((2 - i / 8 % 2)) "$out"
  whole_fleet "${run[@]}" || wrong "$what: the next run"
  same_fleet "$out" >"$work/log" 2>&1 || wrong "$what: other tables or leftovers"
  outcome=same
  if [ -n "$went_wrong" ]; then outcome=wrong; fi
  keep $i $outcome $ranks $way "$at" "$went_wrong"
done
awk '{++n[$4]; same[$4] += $2 == "same"} END {for (w in n) printf "%s: %d of %d kills end in the same tables\n", w, same[w], n[w]}' "$results"
report_campaign "$kills"
