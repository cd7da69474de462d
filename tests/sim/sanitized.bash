#!/usr/bin/env bash
# Scalars, effects and SIMD kernels under the address and undefined-behaviour sanitizers, built once for each vector
# width: two doubles (x86-64-v2), four (v3, AVX2) and eight (v4, AVX-512). Each build runs the kernels of 1, 4 and 8 lanes.
#   bash tests/sim/sanitized.bash [LEVEL...]
#     LEVEL   default all that this processor has
# Exit codes: 0 nothing found, 1 something found or not built.
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
tests=(test_sim_core test_sim_effects test_sim_batch)
levels=("$@")
if ((!${#levels[@]})); then levels=(x86-64-v2 x86-64-v3 x86-64-v4); fi
export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
supported=$(/lib64/ld-linux-x86-64.so.2 --help | sed -n 's/^ *\(x86-64-v[234]\) (supported.*/\1/p')
status=0
for level in "${levels[@]}"; do
  if ! grep -qx "$level" <<<"$supported"; then
    echo "$level: skipped, this processor does not have it"
    continue
  fi
  build=$source_folder/build/sanitized-$level
  if ! { cmake -S "$source_folder" --preset fuzz -B "$build" -DSWINGBANK_ARCH="$level" -DSWINGBANK_CHECK_PACKS=ON &&
    cmake --build "$build" --target "${tests[@]}"; } >"$build.log" 2>&1; then
    grep -m 12 -E 'error|FAILED' "$build.log" >&2 || tail -n 12 "$build.log" >&2
    status=1
    continue
  fi
  for test in "${tests[@]}"; do
    echo "$level $test"
    # the excluded test compares kernels with a limit that is valid for GCC's code
    "$build/bin/$test" --gtest_brief=1 '--gtest_filter=-*Full.*:*Nightly.*:UserModelInBatch.NonlinearModelRunsInEveryKernel' || status=1
  done
done
exit "$status"
