#!/usr/bin/env bash
# Runs the methods without training anew, continues the trainings at the thesis's size, writes a dated report and lists
# the changes since earlier runs.
#   bash research/nightly.sh [--hours N] [--out FOLDER] [--date YYYY-MM-DD] [--preset NAME] [--seed N] [--keep-data]
#                        [--tests 0|1] [--fuzz SECONDS] [--blind CASES] [EXPERIMENT...]
#     --hours      duration of the whole run on this machine (default 2). The trainings at the thesis's size end after two
#                  thirds of it; the nightly tests, the blind test and the fuzz targets share the remaining time
#     --out        folder with one folder per nightly run, and `at-size` with the trainings at the thesis's size (default
#                  out/nightly); `latest` points to the last run
#     --date       date of the run (default today); an interrupted run that is started again with its date continues
#     --preset     preset that is run as a whole (default nightly)
#     --seed       seed of that preset (default: the number of days since 1970). Every nightly run thus has another
#                  seed, and the runs show the random variation of a result
#     --keep-data  keep the simulated events (gigabytes; the same config generates the same bytes again)
#     --tests      1: run the nightly tier of the tests (tests/run.sh --nightly), 0: skip it; default 1 if the tests, as
#                  measured last, take at most 70 % of the remaining time (before the first measurement: 1.5 h)
#     --fuzz       time for each fuzz target [s] (default: the remaining time; 0: none)
#     --blind      number of cases of a blind test of the diagnosis, with the same seed (default: as many as the time
#                  permits; 0: none)
#     EXPERIMENT   file of an experiment (default: all of configs/experiments)
# Exit codes: 0 done, 1 failed, 2 saved on a signal.
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=$source_folder/out/nightly date=$(date +%F) preset=nightly seed='' hours=2 keep_data=0 fuzz='' blind='' tests='' experiments=()
tries=3 pause=${SWINGBANK_NIGHTLY_PAUSE:-60} # [s] between tries
seeds_at_size=3                              # seeds of the trainings at the thesis's size
table_share=0.67                             # share of the hours for the tables
tests_take=5400                              # [s] of two cores with builds; default before the first measurement
blind_share=0.6                              # share of the time that remains before the blind test
blind_case=80                                # [s] of two cores; docs/reference/blind-test-results.md
fuzz_build=300 fuzz_least=10                 # [s]; docs/reference/performance.md
while (($#)); do
  case $1 in
    --hours) hours=${2:?--hours needs a number}; shift 2 ;;
    --out) out=$(realpath -m "${2:?--out needs a folder}"); shift 2 ;;
    --date) date=${2:?--date needs a day}; shift 2 ;;
    --preset) preset=${2:?--preset needs a name}; shift 2 ;;
    --seed) seed=${2:?--seed needs a number}; shift 2 ;;
    --keep-data) keep_data=1; shift ;;
    --tests) tests=${2:?--tests needs 0 or 1}; shift 2 ;;
    --fuzz) fuzz=${2:?--fuzz needs seconds}; shift 2 ;;
    --blind) blind=${2:?--blind needs a number of cases}; shift 2 ;;
    -h | --help) sed -n '2,21p' "$0"; exit 0 ;;
    -*) echo "unknown option at '$1' (research/nightly.sh has no such option): run it with --help" >&2; exit 1 ;;
    *) experiments+=("$(realpath -m "$1")"); shift ;;
  esac
done
if [[ ! $date =~ ^[0-9]{4}-[0-9]{2}-[0-9]{2}$ ]] || ! day=$(date -u -d "$date" +%s 2>/dev/null); then
  echo "no date at --date $date (it must be YYYY-MM-DD): give one like $(date +%F)" >&2
  exit 1
fi
if [[ ! $hours =~ ^[0-9]*\.?[0-9]+$ ]] || ! awk "BEGIN {exit !($hours > 0)}"; then
  echo "no hours at --hours $hours (it must be a number above 0): give one like 2 or 0.5" >&2
  exit 1
fi
((${#experiments[@]})) || experiments=("$source_folder"/configs/experiments/*.toml)
seed=${seed:-$((day / 86400))}
build=${SWINGBANK_BUILD:-$source_folder/build/release}
swingbank=$build/bin/swingbank
night=$out/$date

mkdir -p "$night"
exec 9>"$out/.lock"
if ! flock -n 9; then
  echo "nightly run refused at $out (another one is running there): wait for it, or give another --out" >&2
  exit 1
fi

# shellcheck source=jobs/run_saving.bash
source "$source_folder/jobs/run_saving.bash"

# with_tries COMMAND...: runs a command and repeats it after a failure, such as a killed rank or a full disk. The
# command then continues where it stopped
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

# part NAME COMMAND...: runs a command; prints and records its time, also if it was interrupted
part() {
  local name=$1 begin=$SECONDS status=0
  shift
  "$@" || status=$?
  printf '%s\t%d\n' "$name" $((SECONDS - begin)) >>"$night/parts.tsv"
  printf '\n== %s: %d s\n' "$name" $((SECONDS - begin))
  return "$status"
}
used() { awk -F'\t' '{sum += $2} END {printf "%d", sum}' "$night/parts.tsv"; }
# left SHARE [OF-HOURS]: prints the remaining time [s] of a share of the hours (default 1), times SHARE
left() {
  awk -v used="$(used)" "BEGIN {left = ($hours * ${2:-1} * 3600 - used) * $1; printf \"%d\", (left > 0 ? left : 0)}"
}

# Prints the duration of the nightly tests when they last ran to the end [s].
tests_took() {
  local folder took=$tests_take
  for folder in "$out"/????-??-??; do # in the order of their dates
    if grep -qsE '^== (all passed|failed)' "$folder/tests.txt"; then
      took=$(awk -F'\t' '$1 == "tests of the night" {sum += $2} END {print sum + 0}' "$folder/parts.tsv")
    fi
  done
  echo "$took"
}

# run_stage STAGE EXPERIMENT OPTION...: runs one stage of an experiment, with repetitions
run_stage() {
  with_tries bash "$source_folder/jobs/run_experiment.sh" --stage "$1" --experiment "$2" "${@:3}"
}
remove_events() { ((keep_data)) || rm -rf "$1/data" "$1/training-data"; }

# Runs the preset that is repeated every night.
run_preset() {
  local experiment name folder options
  for experiment in "${experiments[@]}"; do
    name=$(basename "$experiment" .toml)
    folder=$night/$name
    options=(--preset "$preset" --seed "$seed" --out "$folder")
    if [[ ! -e $folder/trained ]]; then # otherwise its events may be removed already
      part "$name: events" run_stage generate "$experiment" "${options[@]}" || return $?
      part "$name: methods" run_stage train "$experiment" "${options[@]}" || return $?
      touch "$folder/trained"
    fi
    remove_events "$folder"
  done
}

# train_at_size EXPERIMENT SEED: continues the trainings of preset thesis-TABLE until their time has passed. Results of
# former software are kept; the page marks them as stale.
train_at_size() {
  local name folder options stage status=0 seconds
  name=$(basename "$1" .toml)
  folder=$out/at-size/$name
  if [[ -e $folder/trained-seed$2 ]]; then return; fi
  options=(--preset "$(size_preset "$1")" --seed "$2" --out "$folder")
  for stage in databank generate train; do
    seconds=$(left 1 "$table_share")
    if ((seconds == 0)); then return; fi
    part "$name at size, seed $2: $stage" run_stage "$stage" "$1" "${options[@]}" --seconds "$seconds" --any-maker 1 ||
      status=$?
    if ((status == 2 && !stop_wanted)); then return; fi # its time has passed
    if ((status != 0)); then return "$status"; fi
  done
  touch "$folder/trained-seed$2"
}
size_preset() { echo "thesis-$("$swingbank" train --experiment "$1" --preset "$preset" --print table)"; }
# Trains at the thesis's size, each night first another experiment. An experiment without preset thesis-TABLE has none.
train_all_at_size() {
  local sized=() experiment k of_seed
  for experiment in "${experiments[@]}"; do
    if grep -qF "[preset.$(size_preset "$experiment")]" "$experiment"; then sized+=("$experiment"); fi
  done
  for ((of_seed = 1; of_seed <= seeds_at_size; ++of_seed)); do
    for ((k = 0; k < ${#sized[@]}; ++k)); do
      train_at_size "${sized[(day / 86400 + k) % ${#sized[@]}]}" "$of_seed" || return $?
    done
  done
  for experiment in "${sized[@]}"; do remove_events "$out/at-size/$(basename "$experiment" .toml)"; done
}

# Makes one page of tonight's results and of those at the thesis's size. The software of tonight's results is the present
# one.
run_tables() {
  local folders=() folder
  for folder in "$night"/*/results "$out"/at-size/*/results; do
    if compgen -G "$folder/*.json" >/dev/null; then folders+=("$folder"); fi
  done
  part tables "$swingbank" tables "${folders[@]}" --out "$night/tables" \
    --software "$(grep -ho '"software": *"[^"]*"' "$night"/*/results/*.json | sed 's/.*: *"//;s/"$//' | sort | tail -n 1)"
}

# Runs a blind test (docs/reference/blind-test-results.md). After an interruption, finished cases and verdicts remain.
blind_test() {
  local configs=$source_folder/configs/blind run=$night/blind
  run_saving "$swingbank" blind-test --config "$configs/cases.toml" --out "$run" --make "$blind" --seed "$seed" &&
    run_saving "$swingbank" blind-test --out "$run" --diagnose &&
    run_saving "$swingbank" blind-test --out "$run" --score --targets "$configs/targets.toml"
}
night_tests() {
  local status=0
  run_saving bash "$source_folder/tests/run.sh" --nightly >"$night/tests.txt" 2>&1 || status=$?
  tail -n 40 "$night/tests.txt"
  return "$status"
}
fuzz_targets() {
  local status=0
  run_saving bash "$source_folder/tests/fuzz/run.bash" "$fuzz" >"$night/fuzz.txt" 2>&1 || status=$?
  cat "$night/fuzz.txt"
  return "$status"
}
fuzz_seconds() { # time for each target [s], from the remaining time; two targets run at a time
  local targets=("$source_folder"/tests/fuzz/*.cpp) budget
  budget=$(left 1)
  if [[ ! -d $source_folder/build/fuzz/bin ]]; then budget=$((budget - fuzz_build)); fi
  budget=$((budget / ((${#targets[@]} + 1) / 2)))
  echo $((budget < fuzz_least ? 0 : budget))
}

# report: writes the results of the nightly run so far
report() {
  {
    "$swingbank" nightly-compare "$out" --night "$date" || return 1
    printf '\n## Time\n\n%s of %s requested hours, on %d cores, preset %s, seed %d.\n\n' \
      "$(awk -v s="$(used)" 'BEGIN {printf "%.2f", s / 3600}')" "$hours" "$(nproc)" "$preset" "$seed"
    printf '| part | time [s] |\n|---|---:|\n'
    awk -F'\t' '!($1 in sum) {order[++n] = $1} {sum[$1] += $2} END {for (i = 1; i <= n; ++i) print "| " order[i] " | " sum[order[i]] " |"}' \
      "$night/parts.tsv"
    printf '\n'
        sed 's/^#/##/;s,](tables/,](tables/tables/,' "$night/tables/tables.md" # adapts the links to the pictures
    if [[ -s $night/blind/score.md ]]; then
      printf '\n## Blind test, seed %s\n\n' "$seed"
      sed '1,2d;s/^## /### /' "$night/blind/score.md"
    elif [[ $blind == 0 ]]; then
      printf '\n## Blind test\n\nNot run.\n'
    fi
    if [[ -s $night/tests.txt ]]; then
      printf '\n## Nightly tests\n\n'
      sed -n '/tests passed/,$p' "$night/tests.txt" | sed 's/^/    /'
    elif [[ $tests == 0 ]]; then
      printf '\n## Nightly tests\n\nNot run.\n'
    fi
    if [[ -s $night/fuzz.txt ]]; then
      printf '\n## Fuzz targets\n\n'
      sed 's/^/- /' "$night/fuzz.txt"
    elif [[ $fuzz == 0 ]]; then
      printf '\n## Fuzz targets\n\nNot run.\n'
    fi
  } >"$night/report.md.part" || return 1
  mv "$night/report.md.part" "$night/report.md"
}
# stopped STATUS: ends the nightly run if a signal or failure prevents its continuation
stopped() {
  echo "nightly run of $date stopped (exit code $1) after $(used) s; log: $night/log.txt" >&2
  exit "$1"
}

touch "$night/parts.tsv"
exec > >(exec tee -a "$night/log.txt" 9>&-) 2>&1
build_all() { bash "$source_folder/jobs/setup.sh" 9>&-; }
if [[ -z ${SWINGBANK_BUILD:-} ]]; then part build build_all || stopped $?; fi
status=0
run_preset || stopped $?
train_all_at_size || stopped $?
run_tables || stopped $?
report || stopped 1
ln -sfn "$date" "$out/latest"

if [[ -z $tests ]]; then tests=$(($(left 0.7) >= $(tests_took))); fi
if [[ $tests != 0 ]]; then part "tests of the night" night_tests || status=$?; fi
((status != 2)) || stopped 2
if [[ -z $blind ]]; then blind=$(($(left "$blind_share") / blind_case)); fi
if [[ $blind != 0 ]]; then part "blind test, $blind cases" blind_test || status=$?; fi
((status != 2)) || stopped 2
if [[ -z $fuzz ]]; then fuzz=$(fuzz_seconds); fi
if [[ $fuzz != 0 ]]; then part "fuzz targets, $fuzz s each" fuzz_targets || status=1; fi
report || status=1
cat "$night/report.md"
echo "report: $night/report.md; $(used) s of $hours h"
exit "$status"
