#!/usr/bin/env bash
# Reproduces the tables with the preset `nightly`, keeps a dated report and says what moved since the nights before.
#   bash jobs/nightly.sh [--out FOLDER] [--date YYYY-MM-DD] [--preset NAME] [--seed N] [--keep-data] [--fuzz SECONDS]
#                        [--blind CASES] [EXPERIMENT...]
#     --out        default out/nightly; one folder per night in it, `latest` points to the last one
#     --date       default today; a night that was broken off goes on when started again on its date
#     --preset     default nightly
#     --seed       of the training; default the day's number, so that every night trains with another seed: the nights
#                  then show how much a result moves by itself
#     --keep-data  keeps the simulated events (gigabytes; the same config makes the same bytes again)
#     --fuzz       time of each fuzz target of the readers, after the tables; default 600, 0 leaves them out
#     --blind      cases of a blind test of the diagnosis with the night's seed, after the fuzz targets; default 25,
#                  0 leaves it out
#     EXPERIMENT   default every file of configs/experiments
# Exit codes: 0 done, 1 failed, 2 saved on a signal.
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=$source_folder/out/nightly date=$(date +%F) preset=nightly seed='' keep_data=0 fuzz=600 blind=25 experiments=()
tries=3 pause=${SWINGBANK_NIGHTLY_PAUSE:-60} # [s] between tries
while (($#)); do
  case $1 in
    --out) out=$(realpath -m "${2:?--out needs a folder}"); shift 2 ;;
    --date) date=${2:?--date needs a day}; shift 2 ;;
    --preset) preset=${2:?--preset needs a name}; shift 2 ;;
    --seed) seed=${2:?--seed needs a number}; shift 2 ;;
    --keep-data) keep_data=1; shift ;;
    --fuzz) fuzz=${2:?--fuzz needs seconds}; shift 2 ;;
    --blind) blind=${2:?--blind needs a number of cases}; shift 2 ;;
    -h | --help) sed -n '2,15p' "$0"; exit 0 ;;
    -*) echo "unknown option at '$1' (jobs/nightly.sh does not have it): run it with --help" >&2; exit 1 ;;
    *) experiments+=("$(realpath -m "$1")"); shift ;;
  esac
done
if [[ ! $date =~ ^[0-9]{4}-[0-9]{2}-[0-9]{2}$ ]] || ! day=$(date -u -d "$date" +%s 2>/dev/null); then
  echo "no date at --date $date (YYYY-MM-DD is wanted): give one like $(date +%F)" >&2
  exit 1
fi
((${#experiments[@]})) || experiments=("$source_folder"/configs/experiments/*.toml)
seed=${seed:-$((day / 86400))}
build=${SWINGBANK_BUILD:-$source_folder/build/release}
night=$out/$date

mkdir -p "$night"
exec 9>"$out/.lock"
if ! flock -n 9; then
  echo "nightly run refused at $out (another one is running there): wait for it, or give another --out" >&2
  exit 1
fi

# shellcheck source=jobs/run_saving.bash
source "$source_folder/jobs/run_saving.bash"

# with_tries COMMAND...: what failed by accident (a killed rank, a full disk that was cleared) goes on where it stopped
with_tries() {
  local try status
  for ((try = 1; try <= tries; try++)); do
    status=0
    run_saving "$@" || status=$?
    ((status == 0 || status == 2)) && return "$status"
    echo "try $try of $tries failed with exit code $status" >&2
    ((try == tries)) || sleep "$pause"
  done
  return 1
}

run_all() {
  local experiment name status
  for experiment in "${experiments[@]}"; do
    name=$(basename "$experiment" .toml)
    status=0
    with_tries bash "$source_folder/jobs/run_experiment.sh" --experiment "$experiment" --preset "$preset" --seed "$seed" \
      --out "$night/$name" || status=$?
    ((status == 0)) || return "$status"
    ((keep_data)) || rm -rf "$night/$name/data"
  done
}

# A part of the blind test (docs/blind-test.md); what is made and judged stays when it is broken off.
blind_test() {
  local swingbank=$build/bin/swingbank configs=$source_folder/configs/blind run=$night/blind
  "$swingbank" blind-test --config "$configs/cases.toml" --out "$run" --make "$blind" --seed "$seed" &&
    "$swingbank" blind-test --out "$run" --diagnose &&
    "$swingbank" blind-test --out "$run" --score --targets "$configs/targets.toml"
}

if [[ -z ${SWINGBANK_BUILD:-} ]]; then bash "$source_folder/jobs/setup.sh" 9>&-; fi
exec > >(exec tee -a "$night/log.txt" 9>&-) 2>&1
status=0
run_all || status=$?
if ((status != 0)); then
  echo "nightly run of $date stopped (exit code $status); log: $night/log.txt" >&2
  exit "$status"
fi
"$build/bin/swingbank" nightly-compare "$out" --night "$date" >"$night/report.md.part"
mv "$night/report.md.part" "$night/report.md"
ln -sfn "$date" "$out/latest"
if [[ $fuzz != 0 ]]; then
  {
    printf '\n## Fuzz targets\n\n'
    bash "$source_folder/tests/fuzz/run.bash" "$fuzz" 2>&1 | sed 's/^/- /' || status=1
  } >>"$night/report.md"
fi
if [[ $blind != 0 ]]; then
  blind_test || status=1
  { printf '\n## Blind test, seed %s\n\n' "$seed" && sed '1,2d;s/^## /### /' "$night/blind/score.md"; } >>"$night/report.md" || status=1
fi
cat "$night/report.md"
echo "report: $night/report.md"
exit "$status"
