#!/usr/bin/env bash
# The real pipeline on a real slurmctld with two emulated nodes: databank -> generate -> array of folds -> tables.
# The folds take longer than their time limit: time limit -> signal -> saved -> requeued -> resumed. This script sends
# generate the same signal after its first shards, because Slurm checks time limits only every 30 s, when generate would
# be done. In the end the dataset hash and the scores must equal those of an uninterrupted run.
set -euo pipefail
source "$SWINGBANK_SOURCE/tests/slurm/cluster.bash"

work=$(mktemp -d /tmp/swingbank-slurm.XXXXXX)
chmod 755 "$work" # slurmctld runs under its own user
on_exit() {
  local status=$?
  ((status == 0)) || tail -n 15 "$work"/*/log/*.log >&2 2>/dev/null
  cluster_stop
  rm -rf "$work"
  exit "$status"
}
trap on_exit EXIT
fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# Allows mpirun as root. Each process has one thread, because four ranks may share two cores.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_NUM_THREADS=1
export SWINGBANK_BUILD=${SWINGBANK_BIN%/bin}
source "$SWINGBANK_SOURCE/tests/jobs/tiny_experiment.bash"
export TINY_LANES=1 TINY_TOLERANCE=1e-12 TINY_T_END=8.0 TINY_SHARD=25 TINY_DRAWS=1500
tiny_experiment "$work"

site() { # site FILE KEY=VALUE...
  cp "$SWINGBANK_SOURCE/slurm/site.conf" "$1"
  printf '%s\n' generate_nodes=2 generate_ranks=4 fold_cpus=1 generate_time=1 fold_time=1 tables_time=2 warn_before=58 fold_mem=4G "${@:2}" >>"$1"
}
job_state() { scontrol -o show job "$1" | grep -o 'JobState=[A-Z_]*' | sort -u | cut -d= -f2 | paste -sd,; }
# signal_generate OUT JOB: sends the signal that Slurm sends before the time limit. Slurm's own signal may come first.
has_shards() { [[ $(grep -c . "$1/data/journal.jsonl" 2>/dev/null) -ge 3 ]]; }
has_failed() { [[ $(job_state "$1") == FAILED ]]; }
shards_or_failed() { has_shards "$1" || has_failed "$2"; }
signal_generate() {
  cluster_retry 300 shards_or_failed "$1" "$2" || fail "generate has made nothing after 300 s"
  has_failed "$2" || scancel --batch --signal=USR1 "$2"
}
job_of() { awk -v stage="$1" '$1 == stage {print $2}' "$work/jobs"; }
all_ended() { [[ -z $(squeue -h) ]]; }
dataset_hash() { "$SWINGBANK_BIN/swingbank" verify "$1" | awk '{for (i = 1; i < NF; i++) if ($i == "dataset") hash = $(i + 1)} END {print hash}'; }
scores() { (cd "$1" && grep -H -E '"(mse|baseline_mse|best_epoch)"' ./*-gen30.json); }

# unbroken STAGE [OPTION...]: runs a stage without Slurm and without interruption
unbroken() {
  bash "$SWINGBANK_SOURCE/jobs/run_experiment.sh" --experiment "$work/tiny.toml" --preset quick --ranks 2 --out "$work/unbroken" \
    --stage "$@" >"$work/unbroken.log" 2>&1 || { tail -n 20 "$work/unbroken.log" >&2; fail "the unbroken run"; }
}

echo "unbroken run"
unbroken generate
# Slurm checks time limits every 30 s, so a fold must take longer: the number of epochs is chosen for 50 s on this
# machine.
"$SWINGBANK_BIN/swingbank" cross-validate "$work/unbroken/data" --experiment "$work/tiny.toml" --fold 30 --epochs 3 \
  --out "$work/speed" >/dev/null 2>&1
TINY_EPOCHS=$(grep -ho '"seconds_per_epoch": *[0-9.e-]*' "$work"/speed/*.json | awk '{n = int(50 / $2) + 1; print n < 10 ? 10 : n}')
export TINY_EPOCHS
tiny_experiment "$work"
unbroken train --task 0

cluster_start "$work/cluster"
echo "the pipeline, each attempt cut short; $TINY_EPOCHS epochs (after $SECONDS s)"
site "$work/site.conf"
bash "$SWINGBANK_SOURCE/slurm/submit.sh" "$work/tiny.toml" quick --site "$work/site.conf" --out "$work/broken" | tee "$work/jobs"
rm "$work/tiny.toml" "$work/tiny_data.toml" # the jobs read their own copies
tables=$(job_of tables)
signal_generate "$work/broken" "$(job_of generate)"
cluster_retry 600 all_ended || fail "jobs still there after 600 s: $(squeue)"
tiny_experiment "$work"
[[ $(job_state "$tables") == COMPLETED ]] || fail "tables: $(job_state "$tables")"
for log in generate fold-0; do
  grep -q 'requeued (restart' "$work/broken/log/$log.log" || fail "$log was never cut short: the test shows nothing"
  grep -q 'attempt 2' "$work/broken/log/$log.log" || fail "$log did not start again"
done
[[ -s $work/broken/tables/tables.html ]] || fail "no tables.html"
[[ $(dataset_hash "$work/broken/data") == "$(dataset_hash "$work/unbroken/data")" ]] || fail "the dataset differs"
diff <(scores "$work/unbroken/results") <(scores "$work/broken/results") || fail "the scores differ"
echo "same dataset, same scores (after $SECONDS s)"

site "$work/once.conf" max_restarts=0
bash "$SWINGBANK_SOURCE/slurm/submit.sh" "$work/tiny.toml" quick --site "$work/once.conf" --out "$work/once" >"$work/jobs"
signal_generate "$work/once" "$(job_of generate)"
cluster_retry 90 all_ended || fail "jobs still there after 90 s: $(squeue)"
[[ $(job_state "$(job_of generate)") == FAILED ]] || fail "beyond the retry limit: $(job_state "$(job_of generate)")"
[[ $(job_state "$(job_of tables)") == CANCELLED ]] || fail "a job behind a failed one: $(job_state "$(job_of tables)")"
grep -qE 'no further (restart|retry) of job .* \(.*\): ' "$work/once/log/generate.log" || fail "no sentence about the retry limit"
echo "retry limit kept, dependants cancelled (after $SECONDS s)"

# A job array without a launcher: each task generates one part of the dataset.
array="$SWINGBANK_BIN/swingbank generate $work/tiny_data.toml --draws $TINY_DRAWS --part \$SLURM_ARRAY_TASK_ID/3 --out $work/array --progress none"
sbatch --parsable --array=1-3 --time=2 --output="$work/array-%a.log" --wrap "$array" >/dev/null
cluster_retry 120 all_ended || fail "array tasks still there after 120 s: $(squeue)"
[[ $(dataset_hash "$work/array") == "$(dataset_hash "$work/unbroken/data")" ]] || fail "the array's dataset differs: $(cat "$work"/array-*.log)"
echo "a job array makes the same dataset (after $SECONDS s)"
