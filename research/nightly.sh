#!/usr/bin/env bash
# Computes the tables within a given number of hours, writes a dated report and lists the changes since earlier runs.
#   bash research/nightly.sh [--hours N] [--out FOLDER] [--date YYYY-MM-DD] [--preset NAME] [--seed N] [--seeds K]
#                        [--keep-data] [--tests 0|1] [--fuzz SECONDS] [--blind CASES] [EXPERIMENT...]
#     --hours      duration of the whole run on this machine (default 2). The preset `nightly` is scaled so that the
#                  tables take two thirds of it; the nightly tests, the blind test and the fuzz targets share the
#                  remaining time
#     --out        folder with one folder per nightly run (default out/nightly); `latest` points to the last run
#     --date       date of the run (default today); an interrupted run that is started again with its date continues
#                  with its original sizes
#     --preset     run this preset without scaling, however long it takes
#     --seed       first seed of the training (default ten times the number of days since 1970). Every nightly run thus
#                  has new seeds, and the runs show the random variation of a result
#     --seeds      number of seeds to train with, from --seed on (default 3 if --hours is 4 or more, else 1)
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
out=$source_folder/out/nightly date=$(date +%F) preset='' seed='' seeds='' hours=2 keep_data=0 fuzz='' blind='' tests='' experiments=()
tries=3 pause=${SWINGBANK_NIGHTLY_PAUSE:-60} # [s] between tries
hours_of_seeds=4                             # [h]; from this duration on, three seeds are used
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
    --seeds) seeds=${2:?--seeds needs a number}; shift 2 ;;
    --keep-data) keep_data=1; shift ;;
    --tests) tests=${2:?--tests needs 0 or 1}; shift 2 ;;
    --fuzz) fuzz=${2:?--fuzz needs seconds}; shift 2 ;;
    --blind) blind=${2:?--blind needs a number of cases}; shift 2 ;;
    -h | --help) sed -n '2,23p' "$0"; exit 0 ;;
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
seeds=${seeds:-$(awk "BEGIN {print ($hours >= $hours_of_seeds ? 3 : 1)}")}
if [[ ! $seeds =~ ^([1-9]|10)$ ]]; then
  echo "no number of seeds at --seeds $seeds (the next run's seeds start ten higher): give 1 to 10" >&2
  exit 1
fi
((${#experiments[@]})) || experiments=("$source_folder"/configs/experiments/*.toml)
seed=${seed:-$((day / 86400 * 10))}
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
# left SHARE: prints the remaining time [s] times SHARE
left() { awk -v used="$(used)" "BEGIN {left = ($hours * 3600 - used) * $1; printf \"%d\", (left > 0 ? left : 0)}"; }

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

# keep NAME...: saves these variables for a restart of this nightly run
keep() { declare -p "$@" | sed 's/^declare -[-a]* //' >>"$night/sizes.conf"; }

# Determines the sizes of the nightly run once. A restart uses them again; of the options of a restart, only --tests,
# --blind, --fuzz and --keep-data have an effect.
settle() {
  if [[ -s $night/sizes.conf ]]; then
    local asked_tests=$tests asked_blind=$blind asked_fuzz=$fuzz
    # shellcheck source=/dev/null
    source "$night/sizes.conf"
    tests=${asked_tests:-$tests} blind=${asked_blind:-$blind} fuzz=${asked_fuzz:-$fuzz}
    return
  fi
  local name=$preset table_hours i
  rm -rf "$night/experiments"
  mkdir -p "$night/experiments"
  if [[ -z $preset ]]; then
        name=nightly-${hours/./_}h # a dot would separate two keys
    table_hours=$(awk "BEGIN {print $hours * $table_share}")
    "$swingbank" night-plan "${experiments[@]}" --preset nightly --hours "$table_hours" --cores "$(nproc)" --seeds "$seeds" \
      --rates "$source_folder/research/rates.toml" --name "$name" --out "$night/experiments" >"$night/plan.md" || return 1
    for i in "${!experiments[@]}"; do experiments[i]=$night/experiments/$(basename "${experiments[i]}"); done
    cat "$night/plan.md"
  fi
  preset=$name
  keep hours preset seed seeds experiments
}

# run_stage STAGE SEED EXPERIMENT: runs one stage of an experiment, with repetitions
run_stage() {
  with_tries bash "$source_folder/jobs/run_experiment.sh" --experiment "$3" --preset "$preset" --seed "$2" \
    --out "$night/$(basename "$3" .toml)" --stage "$1"
}

run_tables() {
  local experiment name k folders=()
  for experiment in "${experiments[@]}"; do
    name=$(basename "$experiment" .toml)
        if [[ ! -e $night/$name/trained ]]; then # otherwise its events may be removed already
      part "$name: events" run_stage generate "$seed" "$experiment" || return $?
      for ((k = 0; k < seeds; ++k)); do
        part "$name: training, seed $((seed + k))" run_stage train $((seed + k)) "$experiment" || return $?
      done
      touch "$night/$name/trained"
    fi
    ((keep_data)) || rm -rf "$night/$name/data" "$night/$name/training-data"
    folders+=("$night/$name/results")
  done
  part tables "$swingbank" tables "${folders[@]}" --out "$night/tables"
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
    printf '\n## Time\n\n%s of %s requested hours, on %d cores, preset %s, seed %d (%d of them).\n\n' \
      "$(awk -v s="$(used)" 'BEGIN {printf "%.2f", s / 3600}')" "$hours" "$(nproc)" "$preset" "$seed" "$seeds"
    printf '| part | time [s] |\n|---|---:|\n'
    awk -F'\t' '!($1 in sum) {order[++n] = $1} {sum[$1] += $2} END {for (i = 1; i <= n; ++i) print "| " order[i] " | " sum[order[i]] " |"}' \
      "$night/parts.tsv"
    if [[ -s $night/plan.md ]]; then printf '\n## Plan\n\nBy the rates of research/rates.toml:\n\n' && cat "$night/plan.md"; fi
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
settle || stopped $?
status=0
run_tables || stopped $?
report || stopped 1
ln -sfn "$date" "$out/latest"

if [[ -z $tests ]]; then tests=$(($(left 0.7) >= $(tests_took))) && keep tests; fi
if [[ $tests != 0 ]]; then part "tests of the night" night_tests || status=$?; fi
((status != 2)) || stopped 2
if [[ -z $blind ]]; then blind=$(($(left "$blind_share") / blind_case)) && keep blind; fi
if [[ $blind != 0 ]]; then part "blind test, $blind cases" blind_test || status=$?; fi
((status != 2)) || stopped 2
if [[ -z $fuzz ]]; then fuzz=$(fuzz_seconds) && keep fuzz; fi
if [[ $fuzz != 0 ]]; then part "fuzz targets, $fuzz s each" fuzz_targets || status=1; fi
report || status=1
cat "$night/report.md"
echo "report: $night/report.md; $(used) s of $hours h"
exit "$status"
