#!/usr/bin/env bash
# One file call or memory allocation fails in a fleet's diagnosis, on one rank or in the program of one plant. The file
# calls are those on the fleet's output folder, or those on records and models. The run ends in time, complete or with
# the injected error. One more run completes it.
#   SWINGBANK_INJECTIONS=100 bash tests/jobs/failing_fleets_nightly.sh      (24 by default; tests/mpi/campaign.bash)
# shellcheck disable=SC2154,SC2034 # set by lib.bash, two_plants.bash and failing_calls.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/fleet.bash"
source "$(dirname "${BASH_SOURCE[0]}")/two_plants.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../mpi/campaign.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../mpi/failing_calls.bash"
injections=${SWINGBANK_INJECTIONS:-24}
export OMP_NUM_THREADS=1
diagnose=("$SWINGBANK_BIN/swingbank-diagnose" --fleet "$fleet_file")
whole_fleet "${diagnose[@]}" --out "$work/whole" || fail "$(cat "$work/log")"

# command KIND: sets `run`; KIND `plant` is the program that a fleet starts for one plant
command() {
  run=("${diagnose[@]}" --out "$work/run")
  case $1 in
    two) run=(mpirun --oversubscribe -np 2 "${run[@]}") ;;
    plant) run+=(--plant a) ;;
  esac
}
declare -A calls
for kind in alone two plant; do
  for under in run records; do
    command $kind
    rm -rf "$work/run"
    read -r calls[$kind$under] calls[${kind}memory] < <(counts 0 "$work/$under" "${run[@]}")
  done
  echo "$kind: ${calls[${kind}run]} calls on its folder, ${calls[${kind}records]} on records, ${calls[${kind}memory]} allocations"
done
begin_item() { rm -rf "$work/run"; }
check_item() {
  local said=$ended
  cp "$work/log" "$work/before"
  whole_fleet "${diagnose[@]}" --out "$work/run" || wrong "the next run after $what ($said): $(cat "$work/before")"
  same_fleet "$work/run" >"$work/log" 2>&1 || wrong "other tables or leftovers after $what"
}
kinds=(alone two plant) unders=(run run records) errors=(5 28 2 4 122)
for ((i = from; i < injections; i += stride)); do
  if is_done $i; then continue; fi
  kind=${kinds[i % 3]} under=${unders[i / 3 % 3]} error=${errors[i / 9 % 5]} of=0
  if ((i / 3 % 6 == 4)); then error=memory of=${calls[${kind}memory]}; else of=${calls[$kind$under]}; fi
  command "$kind"
  strike $i "$error" 0 "$work/$under" "$of" 0 "${run[@]}"
done
report_failures "$injections"
