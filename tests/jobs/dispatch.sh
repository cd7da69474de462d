#!/usr/bin/env bash
# swingbank <command> finds its commands, names the nearest to a slip, and speaks once under mpirun.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

"$swingbank" --version | grep -qE '^swingbank [0-9]+\.[0-9]+\.[0-9]+$' || fail "--version"
"$swingbank" --help >"$work/help"
for program in "$SWINGBANK_BIN"/swingbank-*; do
  command=$(basename "$program")
  command=${command#swingbank-}
  grep -qE "^  $command +[a-z].{20,}" "$work/help" || fail "--help says nothing of $command"
  "$swingbank" "$command" --help >"$work/one" 2>&1 || fail "$command --help exits with $?"
  grep -q -- --help "$work/one" || fail "$command --help does not list its options"
done
refuses "slip of the pen" "did you mean 'nightly-compare'" "$swingbank" nightly-compar
refuses "nothing near" 'swingbank --help' "$swingbank" xyzzyxyzzy

export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
mpirun --oversubscribe -n 3 "$swingbank" --version >"$work/three" 2>&1
[[ $(grep -c '^swingbank' "$work/three") == 1 ]] || fail "three ranks, more than one answer: $(cat "$work/three")"
