#!/usr/bin/env bash
# Installs missing Debian packages, configures and builds.
#   bash jobs/setup.sh [--preset NAME | --any-processor] [--tests] [--target NAME]... [--packages-only]
#     --preset         one of CMakePresets.json (default release); the build folder is build/<preset>
#     --any-processor  build three times: for any x86-64 processor of the last fifteen years (build/portable), for
#                      AVX2 and for AVX-512; swingbank selects the programs for the processor
#     --tests          also install the packages that packages.txt marks "tests:", and build the tests
#     --target         build only this target
#     --packages-only  install packages, do not build
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
preset=release levels=() tests=0 build=1 targets=()
while (($#)); do
  case $1 in
    --preset) preset=${2:?--preset needs a name}; shift 2 ;;
    --any-processor) preset=portable levels=(x86-64-v3 x86-64-v4); shift ;;
    --tests) tests=1; shift ;;
    --target) targets+=("${2:?--target needs a name}"); shift 2 ;;
    --packages-only) build=0; shift ;;
    -h | --help) sed -n '2,9p' "$0"; exit 0 ;;
    *) echo "unknown option at '$1' (jobs/setup.sh has no such option): run jobs/setup.sh --help" >&2; exit 1 ;;
  esac
done

wanted_packages() {
  local line name
  while IFS= read -r line; do
    name=${line%%#*}
    name=${name//[[:space:]]/}
    if [[ -n $name ]] && { ((tests)) || [[ $line != *'# tests:'* ]]; }; then echo "$name"; fi
  done <"$source_folder/packages.txt"
}

missing_packages() {
  local name
  while IFS= read -r name; do
    [[ $(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null) == installed ]] || echo "$name"
  done < <(wanted_packages)
}

install_packages() {
  local missing
  if ! command -v dpkg-query >/dev/null; then
    echo "packages cannot be installed at this machine (not a Debian system): install those of packages.txt by hand" >&2
    return 1
  fi
  mapfile -t missing < <(missing_packages)
  ((${#missing[@]})) || return 0
  local command="apt-get install -y --no-install-recommends ${missing[*]}"
  if ((EUID != 0)); then
    echo "packages missing at this machine (only root can install them): run this once, then start again:" >&2
    echo "  sudo sh -c 'apt-get update && $command'" >&2
    return 1
  fi
  echo "installing ${#missing[@]} packages"
  local log
  log=$(mktemp)
  # shellcheck disable=SC2086 # the command is a list of words
  if ! { apt-get update && DEBIAN_FRONTEND=noninteractive $command; } </dev/null >"$log" 2>&1; then
    tail -n 30 "$log" >&2
    echo "packages cannot be installed at apt-get (log $log): see the lines above" >&2
    return 1
  fi
  rm -f "$log"
}

# Number of parallel compile jobs: a file that includes LibTorch's headers takes up to 3 GiB of memory.
compile_jobs() {
  local cores memory_gib
  cores=$(nproc)
  memory_gib=$(awk '/MemAvailable/ {print int($2 / 1048576)}' /proc/meminfo)
  local by_memory=$((memory_gib / 3 > 0 ? memory_gib / 3 : 1))
  echo $((cores < by_memory ? cores : by_memory))
}

build_all() {
  cd "$source_folder"
  local log=build/$preset-configure.log
  mkdir -p build
  if ! cmake --preset "$preset" -DSWINGBANK_TESTS="$( ((tests)) && echo ON || echo OFF)" >"$log" 2>&1; then
    tail -n 30 "$log" >&2
    echo "configuration failed at preset $preset (log $source_folder/$log): see the lines above" >&2
    return 1
  fi
  local jobs
  jobs=$(compile_jobs)
  echo "building build/$preset with $jobs compile jobs"
  cmake --build "build/$preset" -j "$jobs" ${targets[@]+--target "${targets[@]}"}
}

# build_level NAME: builds the programs for one instruction set in a separate folder
build_level() {
  local folder=build/portable-$1 log=build/portable-$1-configure.log
  if ! cmake --preset portable -B "$folder" -DSWINGBANK_ARCH="$1" -DSWINGBANK_TESTS=OFF -DSWINGBANK_PYTHON=OFF >"$log" 2>&1; then
    tail -n 30 "$log" >&2
    echo "configuration failed at instruction set $1 (log $source_folder/$log): see the lines above" >&2
    return 1
  fi
  cmake --build "$folder" -j "$(compile_jobs)" ${targets[@]+--target "${targets[@]}"}
  ln -sfn "../../portable-$1/bin" "build/portable/bin/$1"
}

install_packages
if ((build)); then
  build_all
  for level in ${levels[@]+"${levels[@]}"}; do build_level "$level"; done
fi
