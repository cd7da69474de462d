#!/usr/bin/env bash
# slurm/submit.sh with a stub in place of Slurm: the requested resources, refused inputs, and no jobs left in the queue
# by a submission that fails half way.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/tiny_experiment.bash"
export SWINGBANK_BUILD=${SWINGBANK_BIN%/bin}
tiny_experiment "$work"
mkdir "$work/bin"
export PATH=$work/bin:$PATH STUB=$work/stub
mkdir "$STUB"
cat >"$work/bin/sbatch" <<'SBATCH'
#!/usr/bin/env bash
# Prints a job id; fails in the call whose number is in $STUB/refuse.
count=$(($(cat "$STUB/count" 2>/dev/null || echo 0) + 1))
echo $count >"$STUB/count"
printf '%s\n' "$*" >>"$STUB/sbatch"
if [[ $count == "$(cat "$STUB/refuse" 2>/dev/null)" ]]; then echo "sbatch: error: no such partition" >&2; exit 1; fi
echo $((100 + count))
SBATCH
# shellcheck disable=SC2016 # for the stub
printf '#!/usr/bin/env bash\ncat "$STUB/queue" 2>/dev/null\n' >"$work/bin/squeue"
# shellcheck disable=SC2016 # for the stub
printf '#!/usr/bin/env bash\necho "$*" >>"$STUB/scancel"\n' >"$work/bin/scancel"
printf '#!/usr/bin/env bash\nexit 1\n' >"$work/bin/sacct"
chmod +x "$work"/bin/*
site=$work/site.conf
cp "$SWINGBANK_SOURCE/slurm/site.conf" "$site"
submit() { bash "$SWINGBANK_SOURCE/slurm/submit.sh" "$work/tiny.toml" quick --site "$site" --out "$work/out" "$@"; }

submit --dry-run >"$work/said"
(($(grep -c '^sbatch ' "$work/said") == 4)) || fail "a dry run prints: $(cat "$work/said")"
grep -q -- '--mem-per-cpu=2G .*generate.sbatch' "$work/said" || fail "no memory is requested: $(cat "$work/said")"
grep tables.sbatch "$work/said" | grep -qF 'afterany:\<fold\>' || fail "a failed fold cancels the tables: $(cat "$work/said")"
[[ ! -e $STUB/sbatch && ! -e $work/out ]] || fail "a dry run did something"
echo "ok: dry run"

submit >"$work/said"
diff "$work/said" "$work/out/log/jobs" || fail "the jobs are not kept"
[[ $(tr '\n' ' ' <"$work/said") == "databank 101 generate 102 fold 103 tables 104 " ]] || fail "it says: $(cat "$work/said")"
cmp "$site" "$work/out/log/site.conf" || fail "the site file as it was is not kept"
kept=$work/out/log/software
(($(grep -c " $kept/slurm/[a-z]*.sbatch$" "$STUB/sbatch") == 4)) || fail "the jobs do not run what was kept: $(cat "$STUB/sbatch")"
cmp "$SWINGBANK_BIN/swingbank-train" "$kept/build/bin/swingbank-train" || fail "the programs as they were are not kept"
copy=$work/out/log/configs
sed 's/^dataset = .*/dataset = ""/' "$work/tiny.toml" >"$work/expected"
sed 's/^dataset = .*/dataset = ""/' "$copy/tiny.toml" | cmp "$work/expected" || fail "the experiment as it was is not kept"
echo 'draws = 0' >>"$work/tiny_data.toml"
SWINGBANK_EXPERIMENT=$copy/tiny.toml bash "$kept/jobs/run_experiment.sh" --stage check || fail "the copy cannot be read"
again=$("$swingbank" train --experiment "$copy/tiny.toml" --keep "$work/again") || fail "the copy depends on the original"
sed -i '$d' "$work/tiny_data.toml"
diff -r "$copy" "$(dirname "$again")" || fail "a copy of the copy differs"
for kind in raw dyr; do
  cmp "$copy"/dataset/*/"ieee39_dataset_gencls.$kind" "$SWINGBANK_SOURCE/configs/networks/ieee39_dataset_gencls.$kind" || fail "no $kind"
done
[[ -s $kept/jobs/run_experiment.sh && -s $kept/slurm/job.bash && -s $work/out/log/fold.options ]] || fail "the scripts are not kept"
printf '103_1\n104\n' >"$STUB/queue"
refuses "submitted twice" "they wait or run: 103_1 104" submit
(($(wc -l <"$STUB/sbatch") == 4)) || fail "a second submission reached Slurm"
submit --status >"$work/said"
grep -q '^fold 103' "$work/said" || fail "status says: $(cat "$work/said")"
submit --cancel >"$work/said"
[[ $(cat "$STUB/scancel") == "103_1 104" ]] || fail "cancelled: $(cat "$STUB/scancel")"
rm "$STUB/queue" "$STUB/scancel"

echo 7 >"$STUB/refuse" # call 7: the third job of the second submission
refuses "a job that Slurm refuses" "refused at stage fold .*2 jobs before it were cancelled" submit
[[ $(cat "$STUB/scancel") == "105 106" ]] || fail "left in the queue: $(cat "$STUB/scancel")"

sed -i -e "s/^launcher=.*/launcher=''/" -e 's/^generate_ranks=.*/generate_ranks=abc/' -e 's/^fold_mem=.*/fold_mem=much/' "$site"
refuses "a bad site file" "generate_ranks='abc' at $site" submit
grep -q "fold_mem='much' at $site" "$work/stderr" || fail "not all faults: $(cat "$work/stderr")"
grep -q "no launcher at $site" "$work/stderr" || fail "not all faults: $(cat "$work/stderr")"
cp "$SWINGBANK_SOURCE/slurm/site.conf" "$site"
echo fold_time=2 >>"$site"
refuses "a warning longer than the job" "fold_time=2 min at $site" submit
