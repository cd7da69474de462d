#!/usr/bin/env bash
# Builds the fuzz targets (preset fuzz) and runs each from its committed corpus, two at a time.
#   bash tests/fuzz/run.bash SECONDS [TARGET...]
#     SECONDS   time of each target
#     TARGET    default every tests/fuzz/*.cpp
# Findings are kept in build/fuzz/found/TARGET; new corpus entries of this machine in build/fuzz/corpus.
# Exit codes: 0 nothing found, 1 a crash, a hang, a leak or a violated property.
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$source_folder/build/fuzz
if [[ ! ${1:-} =~ ^[1-9][0-9]*$ ]]; then
  echo "no number of seconds at tests/fuzz/run.bash (each target runs that long): give one, like 30" >&2
  exit 1
fi
seconds=$1
shift
targets=("$@")
if ((!${#targets[@]})); then
  for file in "$source_folder"/tests/fuzz/*.cpp; do targets+=("$(basename "$file" .cpp)"); done
fi
for target in "${targets[@]}"; do
  if [[ ! -f $source_folder/tests/fuzz/$target.cpp ]]; then
    echo "no fuzz target '$target' at tests/fuzz (there is no $target.cpp): choose one of its .cpp files" >&2
    exit 1
  fi
done

# Runs a command of the build and records its errors among the findings.
built() {
  "$@" >"$build.log" 2>&1 && return
  mkdir -p "$build/found/build"
  {
    echo "fuzz: the targets cannot be built, see $build.log"
    grep -m 12 -E 'error|FAILED' "$build.log" || tail -n 30 "$build.log"
  } | tee "$build/found/build/summary.txt" >&2
  return 1
}
rm -rf "$build/found/build"
mkdir -p "$build"
built cmake -S "$source_folder" --preset fuzz
built cmake --build "$build" --target "${targets[@]/#/fuzz_}"

# run_target NAME
run_target() {
  local found=$build/found/$1 corpus=$build/corpus/$1
  rm -rf "$found"
  mkdir -p "$found" "$corpus"
  if "$build/bin/fuzz_$1" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -max_len=1048576 -print_final_stats=1 \
    -artifact_prefix="$found/" "$corpus" "$source_folder/tests/fuzz/corpus/$1" >"$found/log.txt" 2>&1; then
    echo "fuzz $1: $(sed -n 's/^stat::number_of_executed_units: *//p' "$found/log.txt") inputs in $seconds s, nothing found"
  else
    {
      echo "fuzz $1: found something, see $found"
      grep -m 3 -E 'violated|runtime error|ERROR' "$found/log.txt" || tail -n 5 "$found/log.txt"
      # prints small inputs, so that the log keeps them if the machine is discarded
      find "$found" -type f ! -name log.txt -size -3k -printf '%f, in base64: ' -exec base64 -w 0 {} \; -printf '\n'
    } | tee "$found/summary.txt" >&2
    return 1
  fi
}
export build source_folder seconds
export -f run_target
printf '%s\0' "${targets[@]}" | xargs -0 -P 2 -I{} bash -c 'run_target {}' || exit 1
