# Functions of the batch scripts. The site file sets modules, launcher, max_restarts and max_retries.
# shellcheck disable=SC2154

# shellcheck source=jobs/run_saving.bash
source "$SWINGBANK_SOURCE/jobs/run_saving.bash"

# finish_or_requeue STATUS: ends the job. Exit code 2 requeues the job, or submits it again if the site forbids
# requeueing, at most max_restarts times. A job whose failure a node may have caused is submitted again on other nodes,
# at most max_retries times.
finish_or_requeue() {
  local status=$1 restarts=$((${SLURM_RESTART_COUNT:-0} + ${SWINGBANK_SEGMENT:-0}))
  ((status > 2)) && retry_elsewhere "$status"
  ((status == 2)) || exit "$status"
  if [[ $stop_signal == TERM ]]; then # cancelled by a person, or preempted and requeued by Slurm itself
    echo "saved; stopped by a signal"
    exit "$status"
  fi
  if ((restarts >= max_restarts)); then
    echo "no further restart of job $SLURM_JOB_NAME ($restarts restarts, limit $max_restarts): raise max_restarts in the" \
      "site file or the time per attempt, then submit again; nothing done so far is lost" >&2
    exit 1
  fi
  echo "saved before the time limit; requeued (restart $((restarts + 1)) of at most $max_restarts)"
  local id=$SLURM_JOB_ID
  if [[ -n ${SLURM_ARRAY_JOB_ID:-} ]]; then id=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID; fi
  if ! scontrol requeue "$id"; then
    echo "requeueing is not allowed here"
    SWINGBANK_SEGMENT=$((${SWINGBANK_SEGMENT:-0} + 1)) follow_up
    exit 0
  fi
  sleep 60 # requeueing ends this script; if it exited earlier, the job would count as finished
  exit 1
}

# retry_elsewhere STATUS: submits the job again after its program was killed or crashed. Invalid input is not the cause,
# because it gives exit code 1.
retry_elsewhere() {
  local retries=${SWINGBANK_RETRY:-0} nodes
  if ((retries >= max_retries)); then
    echo "no further retry of job $SLURM_JOB_NAME (exit code $1 on $SLURM_JOB_NODELIST after $retries retries, limit" \
      "$max_retries): see the lines above; if they name no reason, raise max_retries in the site file" >&2
    exit "$1"
  fi
  nodes=$(failed_nodes | paste -sd,)
  export SWINGBANK_EXCLUDED=${SWINGBANK_EXCLUDED:-}${SWINGBANK_EXCLUDED:+${nodes:+,}}$nodes
  echo "exit code $1 on $SLURM_JOB_NODELIST; trying again, without ${SWINGBANK_EXCLUDED:-any node excluded}" \
    "(retry $((retries + 1)) of at most $max_retries)"
  SWINGBANK_RETRY=$((retries + 1)) follow_up
  exit 0
}

# Prints the nodes of the job that no longer start a program; for a job on one node, that node.
failed_nodes() {
  local nodes node
  mapfile -t nodes < <(scontrol show hostnames "$SLURM_JOB_NODELIST")
  if ((${#nodes[@]} == 1)); then
    echo "${nodes[0]}"
    return
  fi
  for node in "${nodes[@]}"; do
    timeout 30 srun --overlap --nodes=1 --ntasks=1 --nodelist="$node" true </dev/null >/dev/null 2>&1 || echo "$node"
  done
}

# Submits this job again with the same options, and makes the dependent jobs wait for the new one.
follow_up() {
  local log=$SWINGBANK_OUT/log stage=${SLURM_JOB_NAME#swingbank-} options id
  export SWINGBANK_SEGMENT SWINGBANK_RETRY
  mapfile -d '' options <"$log/$stage.options"
  if [[ -n ${SLURM_ARRAY_TASK_ID:-} ]]; then options+=(--array="$SLURM_ARRAY_TASK_ID"); fi
  {
    flock 8
    if [[ -z ${SWINGBANK_EXCLUDED:-} ]] ||
      ! id=$(sbatch "${options[@]}" --exclude="$SWINGBANK_EXCLUDED" "$SWINGBANK_SOURCE/slurm/$stage.sbatch"); then
      # without exclusion: no other node may exist
      id=$(sbatch "${options[@]}" "$SWINGBANK_SOURCE/slurm/$stage.sbatch") || {
        echo "no job continues $stage at slurm/job.bash (sbatch's message is above): submit the experiment again;" \
          "finished parts are kept" >&2
        exit 1
      }
    fi
    id=${id%%;*}
    echo "$stage $id" >>"$log/jobs"
    wait_for_the_new_one "$stage"
  } 8>"$log/.jobs.lock"
  echo "it continues as job $id"
}

# `newest` prints the last job of a stage, and `all_of` prints all its jobs. Later jobs depend on these.
newest() { awk -v stage="$1" '$1 == stage {id = $2} END {print id}' "$SWINGBANK_OUT/log/jobs"; }
all_of() { awk -v stage="$1" '$1 == stage {printf ":%s", $2}' "$SWINGBANK_OUT/log/jobs"; }
wait_for_the_new_one() {
  local generated
  generated=afterok:$(newest generate)
  case $1 in
    databank) scontrol update JobId="$(newest generate)" Dependency="afterok:$(newest databank)" ;;
    generate)
      scontrol update JobId="$(newest fold)" Dependency="$generated"
      scontrol update JobId="$(newest tables)" Dependency="$generated,afterany$(all_of fold)"
      ;;
    fold) scontrol update JobId="$(newest tables)" Dependency="$generated,afterany$(all_of fold)" ;;
  esac
}

job_start() {
  # shellcheck disable=SC1090 # the user's file
  source "$SWINGBANK_SITE"
  # shellcheck disable=SC2086 # modules is a list of words
  if [[ -n $modules ]]; then module load $modules; fi
  echo "$(date '+%F %T') $SLURM_JOB_NAME on $SLURM_JOB_NODELIST, attempt $((${SLURM_RESTART_COUNT:-0} + 1))"
}
