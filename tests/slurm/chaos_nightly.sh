#!/usr/bin/env bash
# Signals and kills, with an emulated scheduler, at times spread evenly over the batch scripts of databank, generate and
# a fold. Kinds: SIGUSR1 to the script (warning before the time limit); SIGTERM to the script; SIGTERM to all processes
# and SIGKILL two seconds later (preemption); SIGKILL of the script and then of its remaining processes; SIGKILL of all
# processes at once (failure of the node). The job is started again until it ends, and must give the same bytes.
#   SWINGBANK_KILLS=100 bash tests/slurm/chaos_nightly.sh      (20 by default; tests/mpi/campaign.bash)
# shellcheck disable=SC2154,SC2034 # set by lib.bash; read by tiny_experiment
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/tiny_experiment.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/same_training.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../mpi/campaign.bash"
kills=${SWINGBANK_KILLS:-20}
TINY_DRAWS=240 TINY_EPOCHS=2
tiny_experiment "$work"
mkdir "$work/bin" "$work/stub"
export PATH=$work/bin:$PATH STUB=$work/stub OMP_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export SWINGBANK_BUILD=${SWINGBANK_BIN%/bin} SWINGBANK_SITE=$work/site.conf SWINGBANK_EXPERIMENT=$work/tiny.toml SWINGBANK_PRESET=quick
sed '/^launcher=/d' "$SWINGBANK_SOURCE/slurm/site.conf" >"$SWINGBANK_SITE"
echo 'launcher="mpirun --oversubscribe"' >>"$SWINGBANK_SITE"
# scontrol requeue: ends the job's processes, as in Slurm.
cat >"$work/bin/scontrol" <<'STUB'
#!/usr/bin/env bash
[[ $1 == requeue ]] || exit 0
touch "$STUB/requeued"
group=$(ps -o pgid= -p $PPID | tr -d ' ')
setsid bash -c "sleep 0.2; kill -9 -- -$group" >/dev/null 2>&1 &
STUB
# sbatch, which job.bash calls for a retry after a crash: `finish` then starts the job again.
cat >"$work/bin/sbatch" <<'STUB'
#!/usr/bin/env bash
touch "$STUB/requeued"
echo 7
STUB
chmod +x "$work"/bin/*

# start STAGE OUT: starts one attempt in a separate process group; sets `pid`
start() {
  rm -f "$STUB/requeued"
  mkdir -p "$2/log"
  printf '%s 1\n' databank generate fold tables >"$2/log/jobs"
  printf '%s\0' --parsable >"$2/log/$1.options"
  SWINGBANK_OUT=$2 SLURM_JOB_NAME=swingbank-$1 SLURM_JOB_ID=1 SLURM_JOB_NODELIST=one SLURM_NTASKS=2 SLURM_ARRAY_TASK_ID=0 \
    SLURM_RESTART_COUNT=$attempts setsid bash "$SWINGBANK_SOURCE/slurm/$1.sbatch" >>"$work/log" 2>&1 &
  pid=$!
}
# finish STAGE OUT: starts attempts, six in all, until one ends with exit code 0 and without a requeue
finish() {
  local code
  for (( ; attempts < 6; )); do
    attempts=$((attempts + 1)) code=0
    start "$1" "$2"
    wait "$pid" 2>/dev/null || code=$?
    if ((code == 0)) && [[ ! -e $STUB/requeued ]]; then return 0; fi
  done
  return 1
}
# made STAGE OUT: prints the results of a stage, one line per file
made() {
  case $1 in
    databank) (cd "$2" && sha256sum data-databank-*.h5) ;;
    generate) (cd "$2/data" && sha256sum shards/*.h5 && find shards ! -name '*.h5') ;;
    fold) essence "$2/results" ;;
  esac
}
# ready STAGE OUT: copies the results of the earlier stages to OUT
ready() {
  mkdir -p "$2"
  if [[ $1 != databank ]]; then cp "$work/whole"/data-databank-*.h5 "$2"; fi
  if [[ $1 == fold ]]; then cp -r "$work/whole/data" "$2"; fi
}
declare -A lasts
for stage in databank generate fold; do
  attempts=0
  begin=$(date +%s%N)
  finish $stage "$work/whole" || fail "$stage: $(cat "$work/log")"
  lasts[$stage]=$((($(date +%s%N) - begin) / 1000000)) # [ms]
  echo "$stage takes ${lasts[$stage]} ms"
  made $stage "$work/whole" >"$work/$stage.whole"
done
gone() { ! pgrep -g "$pid" >/dev/null; }
for ((i = from; i < kills; i += stride)); do
  if is_done $i; then continue; fi
  stages=(generate databank generate fold) ways=(usr1 term preempted script node)
  stage=${stages[i % 4]} way=${ways[i % 5]} out=$work/run went_wrong='' attempts=1
  rm -rf "$out"
  ready $stage "$out"
  : >"$work/log"
  at=$((lasts[$stage] * i / kills))
  start $stage "$out"
  sleep "$((at / 1000)).$(printf %03d $((at % 1000)))"
  case $way in
    usr1) kill -USR1 $pid 2>/dev/null || true ;;
    term) kill -TERM $pid 2>/dev/null || true ;;
    preempted)
      kill -TERM -- -$pid 2>/dev/null || true
      for ((wait = 0; wait < 20; ++wait)); do if gone; then break; else sleep 0.1; fi; done
      kill -9 -- -$pid 2>/dev/null || true
      ;;
    script)
      kill -9 $pid 2>/dev/null || true
      sleep 0.3
      kill -9 -- -$pid 2>/dev/null || true
      ;;
    node) kill -9 -- -$pid 2>/dev/null || true ;;
  esac
  what="kill $i ($way of $stage at $at ms)"
  for ((wait = 0; wait < 1200; ++wait)); do if gone; then break; else sleep 0.1; fi; done
  if ! gone; then
    kill -9 -- -$pid
    wrong "$what: processes lived on for two minutes"
  fi
  wait $pid 2>/dev/null || true
  finish $stage "$out" || wrong "$what: it does not end"
  made $stage "$out" | diff "$work/$stage.whole" - >"$work/difference" || { cat "$work/difference" >>"$work/log"; wrong "$what: other bytes or leftovers"; }
  outcome=same
  if [[ -n $went_wrong ]]; then outcome=wrong; fi
  keep $i $outcome $stage $way "$at" "$went_wrong"
done
awk '{++n[$4]; same[$4] += $2 == "same"} END {for (w in n) printf "%s: %d of %d end in the same bytes\n", w, same[w], n[w]}' "$results"
report_campaign "$kills"
