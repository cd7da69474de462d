# Shared by the batch scripts. modules, launcher and max_restarts come from the site file.
# shellcheck disable=SC2154

# shellcheck source=jobs/run_saving.bash
source "$SWINGBANK_SOURCE/jobs/run_saving.bash"

# Exit code 2 puts the job back into the queue, until max_restarts is reached.
finish_or_requeue() {
  local status=$1 restarts=${SLURM_RESTART_COUNT:-0}
  ((status == 2)) || exit "$status"
  if [[ $stop_signal == TERM ]]; then # cancelled by a person, or preempted: then Slurm itself requeues
    echo "saved; stopped from outside"
    exit "$status"
  fi
  if ((restarts >= max_restarts)); then
    echo "job given up at $SLURM_JOB_NAME ($restarts restarts, limit $max_restarts): raise max_restarts in the site file" \
      "or the time per attempt, then submit again; nothing done so far is lost" >&2
    exit 1
  fi
  echo "saved before the time limit; going back into the queue (restart $((restarts + 1)) of at most $max_restarts)"
  local id=$SLURM_JOB_ID
  if [[ -n ${SLURM_ARRAY_JOB_ID:-} ]]; then id=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID; fi
  scontrol requeue "$id"
  sleep 60 # the requeue ends this script; leaving first would let the job count as finished
  exit 1
}

job_start() {
  # shellcheck disable=SC1090 # the user's file
  source "$SWINGBANK_SITE"
  # shellcheck disable=SC2086 # modules is a list of words
  if [[ -n $modules ]]; then module load $modules; fi
  echo "$(date '+%F %T') $SLURM_JOB_NAME on $SLURM_JOB_NODELIST, attempt $((${SLURM_RESTART_COUNT:-0} + 1))"
}
