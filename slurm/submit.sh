#!/usr/bin/env bash
# Submits an experiment as jobs that wait for one another: databank, generate, one array task per fold, tables.
#   bash slurm/submit.sh EXPERIMENT PRESET [--out FOLDER] [--site FILE]
#     EXPERIMENT  a file of configs/experiments       PRESET  quick, nightly or thesis
#     --out       folder for results, shared by all nodes (default out/<experiment>-<preset>)
#     --site      partition, ranks, memory, times (default slurm/site.conf); the jobs use a copy of this file
#     --dry-run   check everything and print the sbatch commands
#     --status    print the state of this experiment's jobs
#     --cancel    cancel the jobs that wait or run; finished results stay
# Prints one line per job: "<stage> <job id>", also written to <out>/log/jobs. Submitting again continues from existing
# results; it is an error while jobs of an earlier submission wait or run.
set -euo pipefail

SWINGBANK_SOURCE=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
SWINGBANK_SITE=$SWINGBANK_SOURCE/slurm/site.conf
SWINGBANK_OUT='' positional=() action=submit
while (($#)); do
  case $1 in
    --out) SWINGBANK_OUT=$(realpath -m "${2:?--out needs a folder}"); shift 2 ;;
    --site) SWINGBANK_SITE=$(realpath -m "${2:?--site needs a file}"); shift 2 ;;
    --dry-run | --status | --cancel) action=${1#--}; shift ;;
    -h | --help) sed -n '2,11p' "$0"; exit 0 ;;
    -*) echo "unknown option at '$1' (slurm/submit.sh has no such option): run slurm/submit.sh --help" >&2; exit 1 ;;
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
log=$SWINGBANK_OUT/log
faults=0
fault() { echo "$1 at $SWINGBANK_SITE ($2): $3" >&2; faults=1; }
# whole NAME LEAST: checks that a value of the site file is an integer of at least LEAST
whole() {
  local value=${!1:-}
  if [[ -z $value ]]; then
    fault "no $1" "a site file must set every value" "start from a copy of slurm/site.conf"
  elif [[ ! $value =~ ^[0-9]+$ ]] || ((10#$value < $2)); then
    fault "$1='$value'" "it is not a whole number of at least $2" "write such a number"
  fi
}
check_site() {
  local name
  for name in generate_nodes generate_ranks generate_time fold_cpus fold_time folds_at_once tables_time warn_before; do
    whole "$name" 1
  done
  whole max_restarts 0
  whole max_retries 0
  for name in databank_mem generate_mem_per_rank fold_mem tables_mem; do
    [[ ${!name:-} =~ ^[0-9]+[KMGT]?$ ]] || fault "$name='${!name:-}'" "it is not a memory size of Slurm" "write for example 4G"
  done
  [[ -n ${launcher:-} ]] || fault "no launcher" "no program starts the MPI ranks" "write mpirun or srun --mpi=pmix"
  ((faults)) && exit 1
  for name in generate_time fold_time tables_time; do
    ((60 * ${!name} > warn_before)) ||
      fault "$name=${!name} min" "the warning signal is sent $warn_before s before the end" "give more time, or a shorter warn_before"
  done
  ((!faults)) || exit 1
}

# Copies scripts and programs, so that a new build or an edit does not change waiting jobs. Programs on the same disk
# are hard links, because a build replaces files instead of changing them.
keep_software() {
  local kept=$log/software build=${SWINGBANK_BUILD:-$SWINGBANK_SOURCE/build/release}
  rm -rf "$kept"
  mkdir -p "$kept/build/bin"
  cp -r "$SWINGBANK_SOURCE/jobs" "$SWINGBANK_SOURCE/slurm" "$kept"
  cp -l "$build"/bin/swingbank* "$kept/build/bin" 2>/dev/null || cp "$build"/bin/swingbank* "$kept/build/bin"
  SWINGBANK_SOURCE=$kept SWINGBANK_BUILD=$kept/build
  export SWINGBANK_BUILD
}

# Copies the experiment and every file that it names, so that an edit does not change waiting jobs.
keep_configs() {
  rm -rf "$log/configs"
  SWINGBANK_EXPERIMENT=$("$SWINGBANK_BUILD/bin/swingbank" train --experiment "$SWINGBANK_EXPERIMENT" --keep "$log/configs")
}

# Job ids of the earlier submission, separated by commas; empty if there was none.
earlier_jobs() { if [[ -s $log/jobs ]]; then cut -d' ' -f2 "$log/jobs" | paste -sd,; fi; }
# Job ids of the earlier submission that wait or run.
unfinished_jobs() {
  local ids
  ids=$(earlier_jobs)
  [[ -z $ids ]] || squeue --noheader --format=%i --jobs="$ids" 2>/dev/null || true
}

case $action in
  status)
    ids=$(earlier_jobs)
    if [[ -z $ids ]]; then echo "no jobs were submitted for $SWINGBANK_OUT"; exit 0; fi
    cat "$log/jobs"
    sacct --jobs="$ids" --format=JobID,JobName,State,Elapsed,ExitCode 2>/dev/null || squeue --jobs="$ids"
    exit 0
    ;;
  cancel)
    mapfile -t running < <(unfinished_jobs)
    ((${#running[@]})) && scancel "${running[@]}"
    echo "cancelled: ${running[*]:-no job was pending or running}"
    exit 0
    ;;
esac
check_site

runner=$SWINGBANK_SOURCE/jobs/run_experiment.sh
bash "$runner" --stage check # reports invalid settings now instead of in a job
tasks=$(bash "$runner" --stage count-tasks)

common=(--parsable --export=ALL --chdir="$SWINGBANK_OUT" --kill-on-invalid-dep=yes "${sbatch_extra[@]}")
[[ -z $partition ]] || common+=(--partition="$partition")
[[ -z $account ]] || common+=(--account="$account")
warning=(--signal="B:USR1@$warn_before")

if [[ -n $(unfinished_jobs) ]]; then
  echo "jobs of an earlier submission at $log/jobs (they wait or run: $(unfinished_jobs | paste -sd' ')): wait for them, or" \
    "run slurm/submit.sh with the same words and --cancel" >&2
  exit 1
fi
if [[ $action == submit ]]; then
  mkdir -p "$log"
  cp "$SWINGBANK_SITE" "$log/site.conf" # an edit of the original does not change waiting jobs
  SWINGBANK_SITE=$log/site.conf
  keep_software
  keep_configs
  : >"$log/jobs"
fi

# submit STAGE DEPENDENCY OPTION...: submits a job and sets $id to its id
submit() {
  local stage=$1 before=$2
  shift 2
  local options=("${common[@]}" "$@")
  if [[ $action == submit ]]; then printf '%s\0' "${options[@]}" >"$log/$stage.options"; fi # for job.bash
  [[ -z $before ]] || options+=(--dependency="$before")
  if [[ $action == dry-run ]]; then
    id="<$stage>"
    printf 'sbatch'
    printf ' %q' "${options[@]}" "$SWINGBANK_SOURCE/slurm/$stage.sbatch"
    echo
    return
  fi
  if ! id=$(sbatch "${options[@]}" "$SWINGBANK_SOURCE/slurm/$stage.sbatch"); then
    mapfile -t queued < <(cut -d' ' -f2 "$log/jobs")
    ((${#queued[@]} == 0)) || scancel "${queued[@]}"
    echo "job refused at stage $stage (sbatch says why above): correct the site file and submit again;" \
      "${#queued[@]} jobs before it were cancelled" >&2
    exit 1
  fi
  id=${id%%;*} # sbatch prints "id;cluster" on federations
  echo "$stage $id" | tee -a "$log/jobs"
}

# shellcheck disable=SC2154 # these come from the site file and were checked above
{
  submit databank '' --output="$log/databank.log" --time="$tables_time" --mem="$databank_mem" "${warning[@]}"
  submit generate "afterok:$id" --output="$log/generate.log" --time="$generate_time" "${warning[@]}" \
    --nodes="$generate_nodes" --ntasks="$generate_ranks" --mem-per-cpu="$generate_mem_per_rank"
  generated=afterok:$id
  submit fold "$generated" --output="$log/fold-%a.log" --time="$fold_time" "${warning[@]}" \
    --cpus-per-task="$fold_cpus" --mem="$fold_mem" --array="0-$((tasks - 1))%$folds_at_once"
  # If a fold fails, the tables contain the other folds.
  submit tables "$generated,afterany:$id" --output="$log/tables.log" --time="$tables_time" --mem="$tables_mem"
}
