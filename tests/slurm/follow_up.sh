#!/usr/bin/env bash
# slurm/job.bash with a stub in place of Slurm: a killed job is submitted again without the node on which it failed. A
# job that may not be requeued continues as a new job, and the dependent jobs wait for the new job.
# shellcheck disable=SC2154,SC2034 # set by lib.bash; read by job.bash
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/lib.bash"
mkdir -p "$work/bin" "$work/out/log"
export PATH=$work/bin:$PATH STUB=$work/stub SWINGBANK_OUT=$work/out SWINGBANK_SITE=$work/site.conf
mkdir "$STUB"
cp "$SWINGBANK_SOURCE/slurm/site.conf" "$SWINGBANK_SITE"
cat >"$work/bin/sbatch" <<'STUB'
#!/usr/bin/env bash
printf '%s\n' "$*" >>"$STUB/sbatch"
if [[ "$*" == *--exclude=* && -e $STUB/no-other-node ]]; then echo "sbatch: error: no node" >&2; exit 1; fi
echo "$((200 + $(wc -l <"$STUB/sbatch")))"
STUB
cat >"$work/bin/scontrol" <<'STUB'
#!/usr/bin/env bash
case $1 in
  show) tr ',' '\n' <<<"$3" ;;
  requeue) [[ ! -e $STUB/no-requeue ]] ;;
  *) printf '%s\n' "$*" >>"$STUB/scontrol" ;;
esac
STUB
cat >"$work/bin/srun" <<'STUB'
#!/usr/bin/env bash
[[ "$*" != *--nodelist=bad* ]]
STUB
chmod +x "$work"/bin/*
# job STAGE STATUS [VARIABLE=VALUE...]: the end of a batch script whose program has ended with exit code STATUS
job() {
  rm -f "$STUB/sbatch" "$STUB/scontrol"
  printf 'databank 101\ngenerate 102\nfold 103\ntables 104\n' >"$work/out/log/jobs"
  printf '%s\0' --parsable --time=5 "--output=$work/a b.log" >"$work/out/log/$1.options"
  status=0
  env SLURM_JOB_NAME="swingbank-$1" SLURM_JOB_ID=1 SLURM_JOB_NODELIST=one "${@:3}" bash -c "
    source '$SWINGBANK_SOURCE/slurm/job.bash'; source '$SWINGBANK_SITE'; finish_or_requeue $2" >"$work/said" 2>&1 || status=$?
}
said() { grep -qF -- "$1" "${2:-$work/said}" || fail "no '$1' in: $(cat "${2:-$work/said}")"; }

job generate 137
((status == 0)) || fail "exit code $status: $(cat "$work/said")"
said "--parsable --time=5 --output=$work/a b.log --exclude=one $SWINGBANK_SOURCE/slurm/generate.sbatch" "$STUB/sbatch"
said "JobId=103 Dependency=afterok:201" "$STUB/scontrol"
said "JobId=104 Dependency=afterok:201,afterany:103" "$STUB/scontrol"
said "generate 201" "$work/out/log/jobs"
job generate 139 SLURM_JOB_NODELIST=good,bad SWINGBANK_RETRY=1 SWINGBANK_EXCLUDED=one
said "--exclude=one,bad " "$STUB/sbatch"
job generate 137 SWINGBANK_RETRY=2
((status == 137)) && [[ ! -e $STUB/sbatch ]] || fail "retried beyond the limit"
said "no further retry of job swingbank-generate (exit code 137 on one after 2 retries, limit 2): "
job generate 1
((status == 1)) && [[ ! -e $STUB/sbatch ]] || fail "bad input was tried again"
touch "$STUB/no-other-node"
job databank 137
(($(wc -l <"$STUB/sbatch") == 2)) || fail "no second try where there is no other node"
said "JobId=102 Dependency=afterok:202" "$STUB/scontrol"
echo "ok: retries"

touch "$STUB/no-requeue"
job fold 2 SLURM_ARRAY_JOB_ID=103 SLURM_ARRAY_TASK_ID=7
((status == 0)) || fail "exit code $status: $(cat "$work/said")"
said "--array=7 $SWINGBANK_SOURCE/slurm/fold.sbatch" "$STUB/sbatch"
said "JobId=104 Dependency=afterok:102,afterany:103:201" "$STUB/scontrol"
job fold 2 SLURM_RESTART_COUNT=12 SWINGBANK_SEGMENT=8
((status == 1)) && [[ ! -e $STUB/sbatch ]] || fail "went on beyond max_restarts"
said "no further restart of job swingbank-fold (20 restarts, limit 20): "
echo "ok: follow-up segments"
