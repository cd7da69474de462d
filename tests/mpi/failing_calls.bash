# Sourced after common.bash and campaign.bash: runs in which one call fails (failing_call.cpp is preloaded). Each must
# end in time: complete with the same data, or with exit code 1 and the injected reason; the next run repairs the data.
# shellcheck disable=SC2154,SC2034,SC2016 # set by common.bash; read by the sourcing scripts
preload=$SWINGBANK_BIN/failing_call.so
limit=60 # [s]; a run takes about 1 s, but the machine may be busy

# counts RANK FOLDER COMMAND...: runs the command; prints how many file calls below FOLDER and allocations RANK makes
counts() {
  local rank=$1 folder=$2
  shift 2
  rm -f "$work/failing"
  FAILING_RANK=$rank FAILING_UNDER=$folder FAILING_LOG=$work/failing with_preload "$@" >"$work/log" 2>&1 ||
    { cat "$work/log" >&2; fail "a run in which nothing fails: $*"; }
  sed -n 's/^count //p' "$work/failing" | sort -n | tail -1
}

# with_preload COMMAND...: preloads the library into the ranks, not into mpirun
with_preload() {
  if [ "$1" = mpirun ]; then
    "${@:1:4}" -x LD_PRELOAD="$preload" "${@:5}"
  else
    LD_PRELOAD=$preload "$@"
  fi
}

declare -A reasons=([5]='Input/output error' [28]='No space left on device' [2]='No such file or directory'
  [4]='Interrupted system call' [122]='Disk quota exceeded' [memory]='bad_alloc|[Mm]emory')

# one_failure ERROR AT RANK FOLDER COMMAND...: sets `what` to a description, and `ended` to whole (complete data), told
# (the injected reason), missed (call AT was not reached) or wrong.
one_failure() {
  local error=$1 at=$2 rank=$3 folder=$4 code=0
  shift 4
  rm -f "$work/failing"
  FAILING_ERROR=$error FAILING_AT=$at FAILING_RANK=$rank FAILING_UNDER=$folder FAILING_LOG=$work/failing \
    timeout -k 5 "$limit" bash -c 'source "$0"; with_preload "$@"' "$SWINGBANK_SOURCE/tests/mpi/failing_calls.bash" "$@" \
    >"$work/log" 2>&1 || code=$?
  what=$( (sed -n 's/^failed //p' "$work/failing" 2>/dev/null || true) | head -1) # no file: ended before its first line
  if [ -z "$what" ]; then
    ended=missed
    if ((code == 124 || code == 137)); then
      ended=wrong
      wrong "no end after $limit s, and call $at was not reached: $*"
    fi
    return
  fi
  what="error $error in call $at of rank $rank ($what): $*"
  case $code in
    0) ended=whole ;;
    124 | 137)
      ended=wrong
      wrong "no end after $limit s: $what"
      ;;
    *)
      ended=told
      if ! grep -qE "${reasons[$error]}" "$work/log"; then
        ended=wrong
        wrong "exit code $code with another reason: $what"
      fi
      ;;
  esac
}

# strike ITEM ERROR RANK FOLDER CALLS BEFORE COMMAND...: one_failure in a call that ITEM selects among the CALLS calls
# after the first BEFORE ones. The number of calls varies slightly between runs: if a run ends before the selected call,
# an earlier call is used. `begin_item` prepares the folder; `check_item` compares the result.
strike() {
  local item=$1 error=$2 rank=$3 folder=$4 of=$5 before=$6 at tries
  shift 6
  # golden ratio: the items are spread evenly over the run, for any number of items
  at=$((1 + of * (item * 618033 % 1000000) / 1000000))
  went_wrong=''
  for ((tries = 0; tries < 20; ++tries)); do
    begin_item
    one_failure "$error" $((before + at)) "$rank" "$folder" "$@"
    [ "$ended" = missed ] || break
    at=$((at - at / 10 - 1))
    if ((at < 1)); then at=1; fi
  done
  case $ended in whole | told) check_item ;; esac
  local outcome=$ended
  if [ -n "$went_wrong" ]; then outcome=wrong; fi
  keep "$item" "$outcome" "$error" "$what"
}

# report_failures N: prints the totals of each error
report_failures() {
  local error
  for error in "${!reasons[@]}"; do
    awk -v error="$error" -v reason="${reasons[$error]}" '
      $3 == error {++n[$2]} END {printf "%s (%s): %d ended with that reason, %d were whole all the same, %d were not reached\n",
        error, reason, n["told"], n["whole"], n["missed"]}' "$results"
  done
  report_campaign "$1"
}
