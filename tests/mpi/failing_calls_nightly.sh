#!/usr/bin/env bash
# One file call or allocation fails on one rank of generate, at any position. Errors: input/output, no space, missing
# file, interrupted call, quota, no memory.
#   SWINGBANK_INJECTIONS=500 bash tests/mpi/failing_calls_nightly.sh      (200 by default; campaign.bash)
# shellcheck disable=SC2154 # failing_calls.bash sets it
source "$(dirname "$0")/common.bash"
source "$(dirname "$0")/campaign.bash"
source "$(dirname "$0")/failing_calls.bash"
injections=${SWINGBANK_INJECTIONS:-200}
errors=(5 28 2 4 122 memory)
make=("$generate" "$configs/ieee14_genrou_bus3.toml" --draws 100 --draws-per-shard 20 --progress none --lease-timeout 20 --out "$work/run")
two=(mpirun --oversubscribe -np 2 "${make[@]}")
"${make[@]}" >/dev/null 2>&1
whole=$(hash_of "$work/run")
[ -n "$whole" ] || fail "no hash"
cp -r "$work/run" "$work/whole"
# state after a run was killed half way: its journal has two of five shards
head -2 "$work/whole/journal.jsonl" >"$work/two_lines"

# begin KIND: prepares the folder for this kind of run; sets `command`
begin() {
  rm -rf "$work/run"
  case $1 in
    half)
      mkdir "$work/run"
      cp -r "$work/whole/dataset.json" "$work/whole/shards" "$work/run"
      cp "$work/two_lines" "$work/run/journal.jsonl"
      ;;
  esac
  case $1 in
    alone) command=("${make[@]}") ;;
    group) command=("${two[@]}" --writer-ranks 2) ;;
    *) command=("${two[@]}") ;;
  esac
}
declare -A calls allocated
for kind in alone two group half; do
  for rank in 0 1; do
    if [ $kind$rank = alone1 ]; then continue; fi
    begin $kind
    read -r calls[$kind$rank] allocated[$kind$rank] < <(counts $rank "$work/run" "${command[@]}")
    echo "$kind, rank $rank: ${calls[$kind$rank]} calls on files, ${allocated[$kind$rank]} allocations"
  done
done
places=(alone0 two0 two1 group0 group1 half0 half1)
begin_item() { begin "$kind"; }
check_item() {
  if [ "$ended" = told ]; then
    cp "$work/log" "$work/before"
    "${make[@]}" >"$work/log" 2>&1 || wrong "the next run after $what: $(cat "$work/before")"
    grep -q "dataset $whole" "$work/log" || wrong "another hash after $what"
  else
    [ "$(hash_of "$work/run")" = "$whole" ] || wrong "other data after $what"
  fi
  diff -r "$work/whole/shards" "$work/run/shards" >"$work/log" || wrong "other bytes or leftovers after $what"
}
for i in $(seq "$from" "$stride" $((injections - 1))) ${SWINGBANK_ALSO:-}; do
  if is_done $i; then continue; fi
  place=${places[i % ${#places[@]}]} error=${errors[i / ${#places[@]} % ${#errors[@]}]}
  kind=${place%?} rank=${place: -1}
  begin "$kind" # sets `command`
  of=${calls[$place]}
  if [ "$error" = memory ]; then of=${allocated[$place]}; fi
  strike $i "$error" "$rank" "$work/run" "$of" 0 "${command[@]}"
done
report_failures "$injections"
