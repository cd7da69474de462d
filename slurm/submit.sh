#!/usr/bin/env bash
# Submits an experiment: databank -> generate -> one array task per fold -> tables, each after the one before.
#   bash slurm/submit.sh EXPERIMENT PRESET [--out FOLDER] [--site FILE]
#     EXPERIMENT  a file of configs/experiments       PRESET  quick, nightly or thesis
#     --out       results (default out/<experiment>-<preset>); on a file system that every node sees
#     --site      partition, ranks, times (default slurm/site.conf)
# Prints one line per job: "<stage> <job id>". Submitting again goes on with what is there.
set -euo pipefail

SWINGBANK_SOURCE=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
SWINGBANK_SITE=$SWINGBANK_SOURCE/slurm/site.conf
SWINGBANK_OUT='' positional=()
while (($#)); do
  case $1 in
    --out) SWINGBANK_OUT=$(realpath -m "${2:?--out needs a folder}"); shift 2 ;;
    --site) SWINGBANK_SITE=$(realpath -m "${2:?--site needs a file}"); shift 2 ;;
    -h | --help) sed -n '2,7p' "$0"; exit 0 ;;
    -*) echo "unknown option at '$1' (slurm/submit.sh does not have it): run slurm/submit.sh --help" >&2; exit 1 ;;
    *) positional+=("$1"); shift ;;
  esac
done
if ((${#positional[@]} != 2)); then
  echo "arguments missing at slurm/submit.sh (${#positional[@]} given, 2 needed): give EXPERIMENT and PRESET" >&2
  exit 1
fi
SWINGBANK_EXPERIMENT=$(realpath -m "${positional[0]}")
SWINGBANK_PRESET=${positional[1]}
for file in "$SWINGBANK_EXPERIMENT" "$SWINGBANK_SITE"; do
  [[ -r $file ]] || { echo "file missing at $file (it cannot be read): give an existing one" >&2; exit 1; }
done
SWINGBANK_OUT=${SWINGBANK_OUT:-$SWINGBANK_SOURCE/out/$(basename "$SWINGBANK_EXPERIMENT" .toml)-$SWINGBANK_PRESET}
export SWINGBANK_SOURCE SWINGBANK_SITE SWINGBANK_OUT SWINGBANK_EXPERIMENT SWINGBANK_PRESET
# shellcheck source=slurm/site.conf
source "$SWINGBANK_SITE"
lacks() { echo "no $1 at $SWINGBANK_SITE (a site file sets everything): start from a copy of slurm/site.conf" >&2; exit 1; }
for name in generate_nodes generate_ranks generate_time fold_cpus fold_time folds_at_once tables_time warn_before; do
  [[ -n ${!name:-} ]] || lacks "$name"
done
mkdir -p "$SWINGBANK_OUT/log"

runner=$SWINGBANK_SOURCE/jobs/run_experiment.sh
bash "$runner" --stage check # bad settings are told now, not by a job in the night
tasks=$(bash "$runner" --stage count-tasks)

common=(--parsable --export=ALL --chdir="$SWINGBANK_OUT" --kill-on-invalid-dep=yes "${sbatch_extra[@]}")
[[ -z $partition ]] || common+=(--partition="$partition")
[[ -z $account ]] || common+=(--account="$account")
warning=(--signal="B:USR1@$warn_before")

# submit STAGE JOB-BEFORE OPTION...
submit() {
  local stage=$1 before=$2 id
  shift 2
  local options=("${common[@]}" "$@")
  [[ -z $before ]] || options+=(--dependency="afterok:$before")
  id=$(sbatch "${options[@]}" "$SWINGBANK_SOURCE/slurm/$stage.sbatch")
  id=${id%%;*} # "id;cluster" on federations
  echo "$stage $id" >&2
  echo "$id"
}

log=$SWINGBANK_OUT/log
# shellcheck disable=SC2154 # these come from the site file, and were looked for above
{
  databank=$(submit databank '' --output="$log/databank.log" --time="$tables_time" "${warning[@]}")
  generate=$(submit generate "$databank" --output="$log/generate.log" --time="$generate_time" "${warning[@]}" \
    --nodes="$generate_nodes" --ntasks="$generate_ranks")
  fold=$(submit fold "$generate" --output="$log/fold-%a.log" --time="$fold_time" "${warning[@]}" \
    --cpus-per-task="$fold_cpus" --array="0-$((tasks - 1))%$folds_at_once")
  submit tables "$fold" --output="$log/tables.log" --time="$tables_time" >/dev/null
} 2>&1
