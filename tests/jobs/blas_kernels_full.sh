#!/usr/bin/env bash
# Training commands use the BLAS kernels that suit the processor, even if OpenBLAS does not support this processor. A
# kernel chosen by the user is kept, with a warning.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
export OMP_NUM_THREADS=1
unset OPENBLAS_CORETYPE SWINGBANK_OPENBLAS_ALONE

has() { grep -qw "$1" /proc/cpuinfo; }
best=SSE name=Prescott
if has avx; then best=AVX name=Sandybridge; fi
if has avx2 && has fma; then best=AVX2 name=Haswell; fi
if has avx512f && has avx512cd && has avx512bw && has avx512dq && has avx512vl; then best=AVX-512 name=SkylakeX; fi

# starts NAME PATTERN [VARIABLE=VALUE...]: runs the three commands up to the missing dataset or network. They must
# print PATTERN once; all other output is in $work/said.
starts() {
  local case=$1 pattern=$2 command
  shift 2
  for command in train cross-validate predict; do
    local experiment=ieee14_genrou options=()
    if [[ $command == cross-validate ]]; then experiment=ieee39_gencls; fi
    options=("$work/no data" --experiment "$SWINGBANK_SOURCE/configs/experiments/$experiment.toml" --out "$work/out")
    if [[ $command == predict ]]; then options=(--network "$work/no data" --model none.toml --records none.csv); fi
    if env "$@" "$swingbank" "$command" "${options[@]}" >"$work/said" 2>&1; then fail "$case: $command without data"; fi
    (($(grep -cE "$pattern" "$work/said") == 1)) || fail "$case: $command does not say '$pattern' once: $(cat "$work/said")"
    (($(grep -c '^BLAS: ' "$work/said") == 1)) || fail "$case: $command does not state its kernels once: $(cat "$work/said")"
    grep -q "no data" "$work/said" || fail "$case: $command has lost its arguments: $(cat "$work/said")"
  done
  echo "ok: $case: $(grep -E "$pattern" "$work/said")"
}

starts "by itself" '^BLAS: OpenBLAS [0-9.]+ [A-Za-z]+[ ,].* [0-9]+ GFLOP/s on one core, [0-9]+ % of its [0-9]+ GFLOP/s'
if grep -q "warning: .* kernels" "$work/said"; then fail "not the best kernels: $(cat "$work/said")"; fi
if [[ $best != SSE ]]; then
  starts "the user's wish" '^BLAS: OpenBLAS [0-9.]+ Prescott \(forced by OPENBLAS_CORETYPE=PRESCOTT\)' OPENBLAS_CORETYPE=PRESCOTT
  grep -qE "^warning: Prescott kernels \(SSE\) at OPENBLAS_CORETYPE=PRESCOTT \(this processor has $best, .*unset" "$work/said" ||
    fail "no warning of slow kernels: $(cat "$work/said")"
fi
if ! has fma4; then
  refuses "kernels that the processor cannot run" 'OPENBLAS_CORETYPE=BULLDOZER \(they need instructions' \
    env OPENBLAS_CORETYPE=BULLDOZER "$swingbank" predict --network none --model none.toml --records none.csv
fi
for words in "--help" "--experiment $SWINGBANK_SOURCE/configs/experiments/ieee14_genrou.toml --print table"; do
  # shellcheck disable=SC2086 # words
  "$swingbank" train $words >"$work/said" 2>&1 || fail "train $words: $(cat "$work/said")"
  if grep -q BLAS: "$work/said"; then fail "train $words mentions BLAS"; fi
done

disguise=LD_PRELOAD=$SWINGBANK_BIN/unknown_processor.so
status=0
env "$disguise" true || status=$?
if ((status == 77)); then
  echo "skipped: no other processor can be emulated here (no CPUID faulting)"
  exit 0
fi
((status == 0)) || fail "the emulated processor: exit code $status"
if [[ $best != SSE ]]; then
  starts "a processor that OpenBLAS does not know" "^BLAS: OpenBLAS [0-9.]+ $name \(chosen by OpenBLAS: Prescott\)" "$disguise"
  if grep -q "warning: .* kernels" "$work/said"; then fail "a warning without a cause: $(cat "$work/said")"; fi
  starts "there, the user's wish" 'Prescott \(forced by OPENBLAS_CORETYPE=PRESCOTT\)' "$disguise" OPENBLAS_CORETYPE=PRESCOTT
fi
