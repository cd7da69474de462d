# To be sourced after common.bash: runs in which one call fails (failing_call.cpp is preloaded). Each must end in time:
# whole with the same data, or with exit code 1 and the reason that was injected; the next run mends it.
# shellcheck disable=SC2154,SC2034,SC2016 # what common.bash sets; what those who source this read
preload=$SWINGBANK_BIN/failing_call.so
limit=60 # [s] of a run that takes about one; the machine may be busy

# The calls that a run makes on a rank below its folder, and its allocations.
# counts RANK FOLDER COMMAND...
counts() {
  local rank=$1 folder=$2
  shift 2
  rm -f "$work/failing"
  FAILING_RANK=$rank FAILING_UNDER=$folder FAILING_LOG=$work/failing with_preload "$@" >"$work/log" 2>&1 ||
    { cat "$work/log" >&2; fail "a run in which nothing fails: $*"; }
  sed -n 's/^count //p' "$work/failing" | sort -n | tail -1
}

# with_preload COMMAND...: mpirun itself is left alone
with_preload() {
  if [ "$1" = mpirun ]; then
    "${@:1:4}" -x LD_PRELOAD="$preload" "${@:5}"
  else
    LD_PRELOAD=$preload "$@"
  fi
}

declare -A reasons=([5]='Input/output error' [28]='No space left on device' [2]='No such file or directory'
  [4]='Interrupted system call' [122]='Disk quota exceeded' [memory]='bad_alloc|[Mm]emory')
declare -A struck=() survived=() told=()
not_reached=0

# one_failure ERROR AT RANK FOLDER COMMAND...: sets `ended` to whole, told or missed; fails where it hangs or says
# something else.
one_failure() {
  local error=$1 at=$2 rank=$3 folder=$4 code=0
  shift 4
  rm -f "$work/failing"
  FAILING_ERROR=$error FAILING_AT=$at FAILING_RANK=$rank FAILING_UNDER=$folder FAILING_LOG=$work/failing \
    timeout -k 5 "$limit" bash -c 'source "$0"; with_preload "$@"' "$SWINGBANK_SOURCE/tests/mpi/failing_calls.bash" "$@" \
    >"$work/log" 2>&1 || code=$?
  local what
  what=$( (sed -n 's/^failed //p' "$work/failing" 2>/dev/null || true) | head -1) # no file: it was ended before its first line
  if [ -z "$what" ]; then
    if ((code == 124 || code == 137)); then wrong "no end after $limit s, and call $at was not reached: $*"; fi
    not_reached=$((not_reached + 1)) ended=missed
    return
  fi
  what="error $error in call $at of rank $rank ($what): $*"
  struck[$error]=$((${struck[$error]:-0} + 1))
  case $code in
    0) survived[$error]=$((${survived[$error]:-0} + 1)) ended=whole ;;
    124 | 137) wrong "no end after $limit s: $what" ;;
    *)
      told[$error]=$((${told[$error]:-0} + 1)) ended=told
      grep -qE "${reasons[$error]}" "$work/log" || wrong "exit code $code with another reason: $what"
      ;;
  esac
}

# wrong WORDS: ends the campaign, or with SWINGBANK_GO_ON only counts
wrongs=0
wrong() {
  wrongs=$((wrongs + 1)) ended=wrong
  echo "WRONG: $*" >&2
  sed 's/^/  | /' "$work/log" | tail -12 >&2
  [ -n "${SWINGBANK_GO_ON:-}" ] || exit 1
}

tell_failures() {
  local error
  for error in "${!struck[@]}"; do
    echo "$error (${reasons[$error]}): ${struck[$error]} injected, ${told[$error]:-0} ended with that reason, ${survived[$error]:-0} made the data all the same"
  done
  echo "injections that the run did not reach: $not_reached; wrong: $wrongs"
  [ "$wrongs" = 0 ]
}
