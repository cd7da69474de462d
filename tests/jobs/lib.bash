# To be sourced by the tests of the commands. ctest sets SWINGBANK_BIN and SWINGBANK_SOURCE.
set -euo pipefail

# shellcheck disable=SC2034 # for the tests that source this
swingbank=$SWINGBANK_BIN/swingbank
work=$(mktemp -d)
lib_cleanup() { rm -rf "$work"; }
trap lib_cleanup EXIT

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# An error message is one sentence: "<what> at <where> (<why>): <what to do>".
sentence='.+ at .+ \(.+\): .+'

# refuses NAME PATTERN COMMAND...: the command must fail with a sentence that matches PATTERN
refuses() {
  local name=$1 pattern=$2 status=0
  shift 2
  "$@" >"$work/stdout" 2>"$work/stderr" </dev/null || status=$?
  ((status == 1)) || fail "$name: exit code $status, expected 1; it said: $(tail -n 5 "$work/stderr")"
  grep -qE "$sentence" "$work/stderr" || fail "$name: no sentence with place, reason and remedy: $(cat "$work/stderr")"
  grep -qE "$pattern" "$work/stderr" || fail "$name: nothing matches '$pattern' in: $(cat "$work/stderr")"
  if grep -qiE 'terminate called|core dumped|segmentation' "$work/stderr"; then fail "$name: it crashed"; fi
  echo "ok: $name: $(grep -E "$sentence" "$work/stderr" | head -1)"
}
