#!/usr/bin/env bash
# On a real slurmctld with two emulated nodes: a job that is killed on one node continues on the other node. A job that
# may not be requeued continues as a new job, and the dependent job waits for the new job.
set -euo pipefail
source "$SWINGBANK_SOURCE/tests/slurm/cluster.bash"
work=$(mktemp -d /tmp/swingbank-retry.XXXXXX)
chmod 755 "$work"
on_exit() {
  local status=$?
  ((status == 0)) || tail -n 15 "$work"/out/log/*.log >&2 2>/dev/null
  cluster_stop
  rm -rf "$work"
  exit "$status"
}
trap on_exit EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }
all_ended() { [[ -z $(squeue -h) ]]; }

mkdir -p "$work/out/log" "$work/source/slurm"
cp "$SWINGBANK_SOURCE/slurm/site.conf" "$work/site.conf"
cp "$SWINGBANK_SOURCE/slurm/job.bash" "$work/source/slurm"
mkdir "$work/source/jobs" && cp "$SWINGBANK_SOURCE/jobs/run_saving.bash" "$work/source/jobs"
# Substitutes for the real stages: generate is killed on the first node that it gets; each fold once ends with exit code
# 2 (saved at the time limit).
head='#!/bin/bash
source "$SWINGBANK_SOURCE/slurm/job.bash"
job_start
'
cat >"$work/source/slurm/generate.sbatch" <<STAGE
$head
[[ -e $work/bad ]] || hostname >$work/bad
run_saving bash -c '[[ \$(hostname) != "\$(cat $work/bad)" ]] || kill -9 \$\$' || finish_or_requeue \$?
hostname >>$work/generated
STAGE
cat >"$work/source/slurm/fold.sbatch" <<STAGE
$head
[[ -s $work/generated ]] || exit 1
run_saving bash -c '[[ -e $work/saved-\$SLURM_ARRAY_TASK_ID ]] || { touch $work/saved-\$SLURM_ARRAY_TASK_ID; exit 2; }' || finish_or_requeue \$?
echo "\$SLURM_ARRAY_TASK_ID" >>$work/trained
STAGE
printf '%s\n[[ $(wc -l <%s) == 2 ]] || exit 1\ntouch %s\n' "$head" "$work/trained" "$work/tabled" >"$work/source/slurm/tables.sbatch"
export SWINGBANK_SOURCE=$work/source SWINGBANK_SITE=$work/site.conf SWINGBANK_OUT=$work/out

cluster_start "$work/cluster"
common=(--parsable --export=ALL --chdir="$work" --kill-on-invalid-dep=yes --open-mode=append --time=2 --no-requeue)
log=$work/out/log
submit() { # STAGE OPTION...
  local stage=$1
  shift
  printf '%s\0' "${common[@]}" --job-name="swingbank-$stage" --output="$log/$stage.log" "$@" >"$log/$stage.options"
  id=$(sbatch "${common[@]}" --job-name="swingbank-$stage" --output="$log/$stage.log" "$@" ${before:+--dependency="$before"} \
    "$SWINGBANK_SOURCE/slurm/$stage.sbatch")
  echo "$stage $id" >>"$log/jobs"
}
before=''
submit generate
generated=afterok:$id before=afterok:$id
submit fold --array=0-1
before=$generated,afterany:$id
submit tables
cluster_retry 120 all_ended || fail "jobs still there after 120 s: $(squeue)"
[[ -e $work/tabled ]] || fail "the last stage did not run: $(cat "$log"/*.log)"
[[ $(cat "$work/generated") != "$(cat "$work/bad")" ]] || fail "the job continued on the node that failed"
grep -q "exit code 137 on $(cat "$work/bad"); trying again, without $(cat "$work/bad")" "$log/generate.log" || fail "the retry is not reported"
(($(grep -c 'requeueing is not allowed here' "$log/fold.log") == 2)) || fail "no follow-up segments: $(cat "$log/fold.log")"
(($(grep -c '^fold ' "$log/jobs") == 3)) || fail "jobs: $(cat "$log/jobs")"
echo "killed on $(cat "$work/bad"), went on on $(cat "$work/generated"); two tasks went on as new jobs"
