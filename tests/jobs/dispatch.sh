#!/usr/bin/env bash
# swingbank <command> finds its commands, suggests the most similar one for a mistyped name, and prints once under
# mpirun.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

"$swingbank" --version | holds -qE '^swingbank [0-9]+\.[0-9]+\.[0-9]+$' || fail "--version"
"$swingbank" --help >"$work/help"
for program in "$SWINGBANK_BIN"/swingbank-*; do
  command=$(basename "$program")
  command=${command#swingbank-}
  internal_commands | grep -qx -e "$command" || grep -qE "^  $command +[a-z].{20,}" "$work/help" || fail "--help says nothing of $command"
  "$swingbank" "$command" --help >"$work/one" 2>&1 || fail "$command --help exits with $?"
  grep -q -- --help "$work/one" || fail "$command --help does not list its options"
  grep -q "^Usage: swingbank $command" "$work/one" || fail "$command --help has another usage line"
  ! grep -qE 'ENUM|OR \{|\{(true|false)\}' "$work/one" || fail "$command --help shows the option parser's notation"
done
refuses "slip of the pen" "did you mean 'nightly-compare'" "$swingbank" nightly-compar
refuses "nothing near" 'swingbank --help' "$swingbank" xyzzyxyzzy

export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
mpirun --oversubscribe -n 3 "$swingbank" --version >"$work/three" 2>&1
[[ $(grep -c '^swingbank' "$work/three") == 1 ]] || fail "three ranks, more than one answer: $(cat "$work/three")"

# The program for the widest instruction set of the processor, unless another is requested.
mkdir -p "$work/bin/x86-64-v3" "$work/bin/x86-64-v4"
cp "$SWINGBANK_BIN/swingbank" "$work/bin"
for folder in . x86-64-v3 x86-64-v4; do
  printf '#!/bin/sh\necho "this is %s, $*"\n' "$folder" >"$work/bin/$folder/swingbank-probe"
  chmod +x "$work/bin/$folder/swingbank-probe"
done
widest=. flags=$(grep -m 1 '^flags' /proc/cpuinfo)
if [[ $flags == *' avx2 '* && $flags == *' fma '* ]]; then widest=x86-64-v3; fi
if [[ $flags == *' avx512f '* && $flags == *' avx512vl '* && $flags == *' avx512dq '* ]]; then widest=x86-64-v4; fi
[[ $("$work/bin/swingbank" probe one) == "this is $widest, one" ]] || fail "not $widest: $("$work/bin/swingbank" probe one)"
[[ $(SWINGBANK_LEVEL=common "$work/bin/swingbank" probe) == "this is ., " ]] || fail "SWINGBANK_LEVEL=common does not start the common program"
rm "$work/bin/$widest/swingbank-probe" && [[ $widest != . ]] &&
  refuses "no such level" 'SWINGBANK_LEVEL' env SWINGBANK_LEVEL="$widest" "$work/bin/swingbank" probe
refuses "unknown level" 'SWINGBANK_LEVEL' env SWINGBANK_LEVEL=x86-64-v9 "$work/bin/swingbank" probe

# Each program loads at its start only what its commands need: programs of datasets load MPI, those of networks
# LibTorch.
# loads PROGRAM: prints which of the libraries MPI, HDF5 and LibTorch the program loads, directly or indirectly
loads() {
  local said
  said=$(ldd "$SWINGBANK_BIN/$1") || fail "ldd $1"
  grep -oE '^\s*lib(mpi|hdf5_openmpi|hdf5_serial|torch)\.so' <<<"$said" | sed 's/^\s*lib//; s/\.so//' | sort | xargs
}
# shellcheck disable=SC2310 # a failure ends the test in any case
needs() { [[ $(loads "$1") == "$2" ]] || fail "$1 loads '$(loads "$1")', expected '$2'"; }
needs swingbank ''
needs swingbank_commands hdf5_serial
needs swingbank-read-hdf5 hdf5_serial
needs swingbank_datasets 'hdf5_openmpi mpi'
if [[ -e $SWINGBANK_BIN/swingbank_learning ]]; then
  needs swingbank_learning 'hdf5_serial torch'
  needs swingbank_learning_ranks 'hdf5_openmpi hdf5_serial mpi torch' # Debian's LibTorch loads the serial HDF5, and calls neither
fi
