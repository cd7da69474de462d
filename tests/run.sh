#!/usr/bin/env bash
# Installs missing packages, builds and runs the tests.
#   bash tests/run.sh [--fast | --nightly] [--without-psse] [--sanitize] [--ci]
#     --fast          the fast tier only (about 2 minutes once built)
#     --nightly       only the nightly tier: long tests, the one-definition rule across all modules, thread sanitizer, the
#                     tests of the modules that read files under both sanitizers, and the SIMD batches, one instruction set
#                     per run: more than an hour (research/nightly.sh runs it, and the fuzz targets after it)
#     --without-psse  skips the tests that read PSS/E's and other external records, which are not part of this repository
#     --sanitize      also the fast tier's unit tests under the address and undefined-behaviour sanitizers (their build
#                     takes longer than everything else: Eigen's sparse solvers are slow to compile with checks)
#     --ci            as on the integration machine: warnings are errors, scripts and formatting are checked, SIMD code is
#                     compiled for AVX2 on any processor; the benchmarks are not built
# PSS/E's records are read from $SWINGBANK_REFERENCE, else from ../shared/reference beside the repository.
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
of_others='PsseRecords|OpenipslRecords|MatpowerRecords|RecorderFiles|DynawoRecords|EveryUnitFull|ReplayFull|others_plants|cases_as_found' # tests that read external files
fast_only=0 nightly=0 with_psse=1 sanitize=0 ci=0
while (($#)); do
  case $1 in
    --fast) fast_only=1 ;;
    --nightly) nightly=1 ;;
    --without-psse) with_psse=0 ;;
    --sanitize) sanitize=1 ;;
    --ci) ci=1 ;;
    -h | --help) sed -n '2,13p' "$0"; exit 0 ;;
    *) echo "unknown option at '$1' (tests/run.sh has no such option): run tests/run.sh --help" >&2; exit 1 ;;
  esac
  shift
done
preset=release
((ci)) && preset=ci
build=$source_folder/build/$preset
failed=()

say() { printf '\n== %s (after %d s)\n' "$*" "$SECONDS"; }

# phase NAME: begins a phase; the summary at the end lists how long each took.
phases=() phase_began=0
phase() {
  end_phase
  phases+=("$*")
  say "$*"
}
end_phase() {
  ((!${#phases[@]})) || phases[-1]+=": $((SECONDS - phase_began)) s"
  phase_began=$SECONDS
}

check_reference() {
  local folder=${SWINGBANK_REFERENCE:-$source_folder/../shared/reference}
  if [[ ! -d $folder/psse ]]; then
    echo "PSS/E records missing at $folder/psse (they are not part of this repository): set SWINGBANK_REFERENCE" \
      "to the folder that holds psse/, or run with --without-psse" >&2
    return 1
  fi
  SWINGBANK_REFERENCE=$(cd "$folder" && pwd)
  export SWINGBANK_REFERENCE
}

# The tests of the modules that read a user's files, in the build of the fuzz targets.
run_readers() {
  local folder=$source_folder/build/fuzz left_out='*Full.*:*Nightly.*'
  ((with_psse)) || left_out+=":*${of_others//|/*:*}*"
  mkdir -p "$folder"
  cmake --preset fuzz -S "$source_folder" >"$folder.log" 2>&1 && cmake --build "$folder" --target tests_of_readers >>"$folder.log" 2>&1 ||
    { grep -m 12 -E 'error|FAILED' "$folder.log" >&2; return 1; }
  printf '%s\0' "$folder"/bin/test_* |
    xargs -0 -P "$(nproc)" -I{} bash -c '"$1" --gtest_brief=1 "--gtest_filter=-$2" || { echo "failed: $1" >&2; exit 1; }' _ {} "$left_out"
}

check_scripts() {
  local scripts
  mapfile -t scripts < <(cd "$source_folder" && git ls-files '*.sh' '*.bash' '*.sbatch' .ci/run)
  (cd "$source_folder" && shellcheck -s bash -S warning -x -P SCRIPTDIR "${scripts[@]}")
}

check_format() {
  local sources
  mapfile -t sources < <(cd "$source_folder" && git ls-files '*.cpp' '*.hpp')
  (cd "$source_folder" && clang-format --dry-run -Werror "${sources[@]}")
}

# run_tests NAME BUILD-FOLDER CTEST-ARGUMENT...
run_tests() {
  local name=$1 folder=$2
  shift 2
  local exclude=()
  ((with_psse)) || exclude=(-E "$of_others")
  ctest --test-dir "$folder" --output-on-failure --no-tests=error --timeout 1500 "${exclude[@]}" "$@" || failed+=("$name")
}

# One-definition rule: all modules linked with their types must give no warning (decision 31; four minutes of two
# cores).
one_definition() {
  local log=$source_folder/build/odr.log
  cmake --preset odr -S "$source_folder" >"$log" && cmake --build "$source_folder/build/odr" --target all_modules >>"$log" 2>&1 &&
    ! grep -m 12 -E 'warning:|error:' "$log" >&2
}

# Each source includes what it uses, so that a build with other unity groups does not fail. The objects are not
# linked.
each_alone() {
  local folder=$source_folder/build/alone log=$source_folder/build/alone.log
  cmake --preset release -S "$source_folder" -B "$folder" -DCMAKE_UNITY_BUILD=OFF -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON \
    -DCMAKE_CXX_FLAGS_RELEASE=-O0 -DSWINGBANK_TESTS=OFF >"$log" &&
    cmake --build "$folder" -- -k 0 >>"$log" 2>&1 && return
  grep -m 12 -E 'error:|FAILED' "$log" >&2
  return 1
}

# Most processors lack AVX-512. SIMD code must compile for them without a warning, on whatever machine the check runs.
# Builds the tests of the SIMD types, the effects and the batched kernel, but not the libraries that these only link.
# A machine with AVX2 and without AVX-512 needs no extra build, because its main build is for AVX2.
for_avx2() {
  if grep -qw avx2 /proc/cpuinfo && ! grep -qw avx512f /proc/cpuinfo; then return; fi
  local folder=$source_folder/build/ci-x86-64-v3
  cmake --preset ci -S "$source_folder" -B "$folder" -DSWINGBANK_ARCH=x86-64-v3 -DCMAKE_OPTIMIZE_DEPENDENCIES=ON >"$folder.log" &&
    cmake --build "$folder" --target test_sim_core swingbank_sim_effects swingbank_sim_batch >>"$folder.log" 2>&1 ||
    { grep -m 12 -E 'error|FAILED' "$folder.log" >&2; return 1; }
  ! grep -qw avx2 /proc/cpuinfo || "$folder/bin/test_sim_core" --gtest_brief=1
}

# Threaded code under the thread sanitizer: takes seven seconds; the timeout ends a deadlock.
threads() {
  local log=$source_folder/build/tsan.log
  cmake --preset tsan -S "$source_folder" >"$log" && cmake --build "$source_folder/build/tsan" --target test_threads >>"$log" 2>&1 &&
    TSAN_OPTIONS=halt_on_error=1:ignore_noninstrumented_modules=1 \
      timeout -k 5 300 "$source_folder/build/tsan/bin/test_threads" --gtest_brief=1
}

run_sanitized() {
  bash "$source_folder/jobs/setup.sh" --preset sanitize --tests
  # Memory that OpenMPI keeps until the process ends.
  export LSAN_OPTIONS=suppressions=$source_folder/tests/leaks.txt:print_suppressions=0
  export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
  # Scripts start the commands of the full build; only the unit tests run here.
  run_tests sanitize "$source_folder/build/sanitize" -L fast -LE script -j "$(nproc)"
}

((!with_psse)) || check_reference
phase "packages and build ($preset)"
bash "$source_folder/jobs/setup.sh" --preset "$preset" --tests
if ((ci)); then
  phase "scripts and formatting"
  check_scripts || failed+=(shellcheck)
  check_format || failed+=(clang-format)
fi
if ((ci)); then
  phase "SIMD code for AVX2"
  for_avx2 || failed+=(avx2)
fi
if ((sanitize)); then
  phase "fast tier under the sanitizers"
  run_sanitized
fi
# tier NAME: runs the tests of a tier. Of the full tier's scripts, one per folder runs at a time; the nightly tier's
# scripts run alone. Tests of the fast tier often wait for processes and disks, so one test more than there are cores
# runs at a time.
tier() {
  local jobs
  jobs=$(nproc)
  [[ $1 != fast ]] || ((++jobs))
  phase "tier $1"
  run_tests "$1" "$build" -L "^$1\$" -j "$jobs"
}
if ((nightly)); then
  phase "one definition of each name"
  one_definition || failed+=(one_definition)
  phase "each source alone"
  each_alone || failed+=(each_alone)
  phase "readers' tests under the sanitizers"
  LSAN_OPTIONS=suppressions=$source_folder/tests/leaks.txt:print_suppressions=0 UBSAN_OPTIONS=print_stacktrace=1 \
    run_readers || failed+=(readers)
  phase "threads"
  threads || failed+=(threads)
  # One instruction set per nightly run: without ccache its build takes some ten minutes of two cores.
  levels=(x86-64-v2 x86-64-v3 x86-64-v4)
  level=${levels[10#$(date +%j) % ${#levels[@]}]}
  phase "SIMD batches under the sanitizers, $level"
  bash "$source_folder/tests/sim/sanitized.bash" "$level" || failed+=(sanitized)
  tier nightly
else
  tier fast
  ((fast_only)) || tier full
fi
end_phase
printf '\n== time of each phase\n'
printf '%s\n' "${phases[@]}"
if ((${#failed[@]})); then
  say "failed: ${failed[*]}"
  exit 1
fi
say "all passed"
