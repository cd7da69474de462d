#!/usr/bin/env bash
# Runs one experiment from its config to its tables; finished parts are skipped. The quickstart, the
# nightly benchmark and the Slurm jobs use this script.
#   bash jobs/run_experiment.sh [--experiment FILE] [--preset NAME] [--out FOLDER] [--stage STAGE] [--task N]
#                               [--network NAME] [--seed N] [--seeds N] [--ranks N] [--launcher WORDS] [--build FOLDER]
#                               [--seconds N] [--any-maker 0|1]
#     --stage     check, databank, generate, train, tables, or all (default: all); count-tasks prints the number of
#                 tasks of the stage train: for each seed, one per combination of network, noise level and fold, and
#                 one per combination of network and share of the training rows
#     --task      number of the only task of the stage train to run, from 0
#     --network   the only network or method of the stage train (default: all)
#     --seed      seed of the training (default 1)
#     --seeds     number of seeds, from --seed on; the tables give the mean and the standard deviation (default 1)
#     --ranks     number of MPI processes that generate (default: one per core)
#     --launcher  command that starts these processes (default mpirun)
#     --build     build folder (default build/release)
#     --seconds   save and end after this time [s] with exit code 2 (default: no limit)
#     --any-maker 1: keep results and checkpoints of other software (default 0: refuse them)
# $SWINGBANK_EXPERIMENT, $SWINGBANK_PRESET, $SWINGBANK_OUT, $SWINGBANK_SEEDS and $SWINGBANK_BUILD are the defaults of
# the options.
# Exit codes: 0 done, 1 failed, 2 saved on a signal (run it again to continue).
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
experiment=${SWINGBANK_EXPERIMENT:-} preset=${SWINGBANK_PRESET:-quick} out=${SWINGBANK_OUT:-}
build=${SWINGBANK_BUILD:-$source_folder/build/release}
stage=all task='' network='' seed=1 seeds=${SWINGBANK_SEEDS:-1} ranks=$(nproc) launcher=mpirun seconds='' any_maker=0
# shellcheck source=jobs/run_saving.bash
source "$source_folder/jobs/run_saving.bash"
while (($#)); do
  case $1 in
    --experiment) experiment=${2:?} ;;
    --preset) preset=${2:?} ;;
    --out) out=${2:?} ;;
    --stage) stage=${2:?} ;;
    --task) task=${2:?} ;;
    --network) network=${2:?} ;;
    --seed) seed=${2:?} ;;
    --seeds) seeds=${2:?} ;;
    --ranks) ranks=${2:?} ;;
    --launcher) launcher=${2:?} ;;
    --build) build=${2:?} ;;
    --seconds) seconds=${2:?} ;;
    --any-maker) any_maker=${2:?} ;;
    -h | --help) sed -n '2,21p' "$0"; exit 0 ;;
    *) echo "unknown option at '$1' (jobs/run_experiment.sh has no such option): run it with --help" >&2; exit 1 ;;
  esac
  shift 2
done
if [[ -z $experiment ]]; then
  echo "experiment missing at --experiment (it is required): give a file of configs/experiments" >&2
  exit 1
fi
if [[ -n $seconds && ! $seconds =~ ^[1-9][0-9]*$ ]]; then
  echo "no time at --seconds $seconds (it must be a whole number of seconds above 0): give one like 3600" >&2
  exit 1
fi
if [[ ! $seed =~ ^[0-9]+$ || ! $seeds =~ ^[1-9][0-9]*$ ]]; then
  echo "no seeds at --seed $seed, --seeds $seeds (whole numbers, the second above 0): give for example 1 and 3" >&2
  exit 1
fi
seed=$((10#$seed)) seeds=$((10#$seeds)) # a leading zero is not octal
if [[ ! $any_maker =~ ^[01]$ ]]; then
  echo "no switch at --any-maker $any_maker (it must be 0 or 1): give one of these" >&2
  exit 1
fi
out=$(realpath -m "${out:-$source_folder/out/$(basename "$experiment" .toml)-$preset}")
swingbank=$build/bin/swingbank
if [[ ! -x $swingbank ]]; then
  echo "swingbank missing at $swingbank (it is not built): run bash jobs/setup.sh" >&2
  exit 1
fi

if [[ -n $seconds ]]; then
  ( # keeps no output open, and takes its sleep with it
    trap 'kill $(jobs -p); exit' TERM
    sleep "$seconds" &
    wait && kill -USR1 $$
  ) >/dev/null 2>&1 9>&- &
  timer=$!
  trap 'kill $timer 2>/dev/null || true' EXIT
fi

# ask KEY: prints a property of the experiment, such as dataset, draws or tasks
ask() { "$swingbank" train --experiment "$experiment" --preset "$preset" --print "$1"; }

# Folders of the dataset, and of the dataset whose rows are for training only.
dataset_folder() { echo "$out/data"; }
training_folder() { echo "$out/training-data"; }

say() { printf '\n-- %s, %s: %s\n' "$(basename "$experiment" .toml)" "$preset" "$1"; }

# databank_file DATASET-FOLDER DRAWS: prints the path of the databank
databank_file() { echo "$1-databank-$2.h5"; }

# draw_databank CONFIG DRAWS FOLDER: draws the databank unless its file exists; `generate` reads the file
draw_databank() {
  local file
  file=$(databank_file "$3" "$2")
  if [[ -s $file ]]; then return; fi
  say "databank of $1 ($2 draws)"
  run_saving "$swingbank" databank "$1" --draws "$2" --out "$file"
}

databank() {
  draw_databank "$(ask dataset)" "$(ask draws)" "$(dataset_folder)" || return $?
  if [[ $(ask training_rows) == none ]]; then return; fi
  draw_databank "$(ask training_dataset)" "$(ask training_draws)" "$(training_folder)"
}

# generate_events CONFIG DRAWS FOLDER: simulates the missing events of a dataset
generate_events() {
  say "events for $1 ($2 draws) on $ranks processes"
  local root=() file
    # OpenMPI refuses to run as root unless two variables allow it. A user who starts this script as root wants it.
  if ((EUID == 0)); then root=(env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1); fi
  local command=("${root[@]}")
  # shellcheck disable=SC2206 # the launcher is a list of words
  command+=($launcher -n "$ranks")
  if [[ $launcher == mpirun* && -z ${SLURM_JOB_ID:-} ]]; then command+=(--oversubscribe); fi
  command+=("$swingbank" generate "$1" --draws "$2" --out "$3")
  file=$(databank_file "$3" "$2")
  if [[ -s $file ]]; then command+=(--databank "$file"); fi
  run_saving "${command[@]}"
}

generate() {
  local config draws
  config=$(ask dataset)
  draws=$(ask draws)
  generate_events "$config" "$draws" "$(dataset_folder)" || return $?
  if [[ $(ask training_rows) == none ]]; then return; fi
  config=$(ask training_dataset)
  draws=$(ask training_draws)
  generate_events "$config" "$draws" "$(training_folder)"
}

# run_task SEED NETWORK NOISE FOLD [SHARE OF THE TRAINING ROWS]
run_task() {
  local seed=$1 network=$2 noise=$3 fold=$4 share=${5:-} common with_more
  say "$network, noise $noise, fold $fold${share:+, share $share of the training rows}, seed $seed"
  common=("$(dataset_folder)" --experiment "$experiment" --preset "$preset" --seed "$seed" --network "$network" --noise "$noise"
    --out "$out/results")
  if [[ -n $share ]]; then common+=(--train-share "$share"); fi
  if [[ $any_maker != 0 ]]; then common+=(--any-maker); fi
  with_more=$(ask training_rows)
  if grep -qxF "$network" <<<"$with_more"; then common+=(--training-rows "$(training_folder)"); fi
  if [[ $fold == none ]]; then
    run_saving "$swingbank" train "${common[@]}"
  else
    run_saving "$swingbank" cross-validate "${common[@]}" --fold "$fold"
  fi
}

# of_all_seeds TASKS: prints each task once for every seed, which precedes it
of_all_seeds() {
  local of line
  for ((of = seed; of < seed + seeds; ++of)); do
    while read -r line; do echo "$of $line"; done <<<"$1"
  done
}

train() {
  local all lines line
  all=$(ask tasks)
  if [[ -n $network ]] && ! all=$(grep "^$network " <<<"$all"); then
    echo "no such network at --network $network (the preset has: $(ask tasks | cut -d' ' -f1 | uniq | xargs)): give one" >&2
    return 1
  fi
    # If all tasks run here, one process trains all folds of a network, so that the dataset is read once.
  if [[ -z $task ]]; then all=$(sed -E 's/^([^ ]+ [^ ]+) [0-9]+$/\1 all/' <<<"$all" | uniq); fi
  mapfile -t lines < <(of_all_seeds "$all")
  if [[ -n $task ]]; then
    if [[ ! $task =~ ^[0-9]+$ ]] || ((10#$task >= ${#lines[@]})); then
      echo "no such task at --task $task (the experiment has ${#lines[@]}, counted from 0): give a lower number" >&2
      return 1
    fi
    lines=("${lines[10#$task]}")
  fi
  for line in "${lines[@]}"; do
    # shellcheck disable=SC2086 # words: seed, network, noise, fold, and the share of the training rows if less than all
    run_task $line || return $?
  done
}

tables() {
  say "tables"
  "$swingbank" tables "$out/results" --out "$out/tables"
}

ask table >/dev/null # reports errors of the experiment before any work
case $stage in
  check) ;;
  count-tasks) echo "$(($(ask tasks | wc -l) * seeds))" ;;
  databank | generate | train | tables)
    mkdir -p "$out"
    "$stage"
    ;;
  all)
    mkdir -p "$out"
    databank
    generate
    train
    tables
    ;;
  *) echo "unknown stage at --stage $stage (there is no such stage): choose one that --help lists" >&2; exit 1 ;;
esac
