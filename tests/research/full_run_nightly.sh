#!/usr/bin/env bash
# research/nightly.sh at tiny size: two nightly runs, trainings at the thesis's size over several nights, two at once, and
# one that fails.
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/tiny_experiment.bash"
export SWINGBANK_BUILD=${SWINGBANK_BIN%/bin} SWINGBANK_NIGHTLY_PAUSE=0 OMP_NUM_THREADS=1

TINY_DRAWS=120 TINY_TRAINING_DRAWS=40 tiny_experiment "$work"
out=$work/nights
night() { bash "$SWINGBANK_SOURCE/research/nightly.sh" --out "$out" --preset quick --tests 0 --fuzz 0 --blind "${BLIND:-0}" --date "$@" </dev/null; }

night 2026-02-01 "$work/tiny.toml" >"$work/log" 2>&1 || fail "first nightly run: $(tail "$work/log")"
grep -q '| V | gru | 0 | 30 | quick | .* | new |' "$out/2026-02-01/report.md" || fail "report: $(cat "$out/2026-02-01/report.md")"
grep -q '| V | mlp | 0 | 31 | quick | .* | new |' "$out/2026-02-01/report.md" || fail "report: $(cat "$out/2026-02-01/report.md")"
[[ -s $out/2026-02-01/tables/tables.html ]] || fail "no tables"
grep -q '^### Table V' "$out/2026-02-01/report.md" || fail "no table in the report: $(cat "$out/2026-02-01/report.md")"
[[ ! -e $out/2026-02-01/tiny/data && ! -e $out/2026-02-01/tiny/training-data ]] || fail "the events were not removed"

# If the nightly run is interrupted after its events are complete, it continues and trains with its own seed.
bash "$SWINGBANK_SOURCE/jobs/run_experiment.sh" --experiment "$work/tiny.toml" --preset quick --stage generate \
  --out "$out/2026-02-02/tiny" >/dev/null 2>&1
touch "$work/before"
night 2026-02-02 --keep-data "$work/tiny.toml" >"$work/log" 2>&1 || fail "second nightly run: $(tail "$work/log")"
[[ -z $(find "$out/2026-02-02/tiny/data/shards" "$out/2026-02-02/tiny/training-data/shards" -newer "$work/before" -name '*.h5') ]] || fail "events were made again"
[[ $(readlink "$out/latest") == 2026-02-02 ]] || fail "latest points to $(readlink "$out/latest")"
grep -q 'fewer than 3 runs, no verdict' "$out/2026-02-02/report.md" || fail "report: $(cat "$out/2026-02-02/report.md")"
first=$(find "$out/2026-02-01" -name '*gru*gen30.json') second=$(find "$out/2026-02-02" -name '*gru*gen30.json')
[[ $(basename "$first") != "$(basename "$second")" ]] || fail "both nightly runs trained with the same seed"

# A nightly run with a blind case: the case is made, judged and counted.
BLIND=1 night 2026-02-02 "$work/tiny.toml" >"$work/log" 2>&1 || fail "nightly run with a blind case: $(tail "$work/log")"
grep -q '^1 cases judged, 0 without a verdict' "$out/2026-02-02/report.md" || fail "report: $(cat "$out/2026-02-02/report.md")"

# Trainings at the thesis's size stop after their share of the hours and continue in the next night. Results of other
# software are kept and marked.
{
  sed 's/^networks = .*/networks = ["gru"]/;s/preset\.quick/preset.nightly/' "$work/tiny.toml" | sed '/^\[preset.nightly.mlp\]/,$d'
  sed -n '/^\[preset.quick\]/,/^validation_share/p' "$work/tiny.toml" |
    sed 's/preset\.quick/preset.thesis-V/;s/^networks = .*/networks = ["gru"]/;s/^epochs = .*/epochs = 4000/'
} >"$work/size.toml"
size() {
  bash "$SWINGBANK_SOURCE/research/nightly.sh" --out "$work/size" --hours "$1" --date "$2" --tests 0 --fuzz 0 --blind 0 \
    "$work/size.toml" </dev/null >"$work/log" 2>&1
}
kept=$work/size/at-size/size/results
size 5 2026-02-04 &
running=$!
for ((i = 0; i < 600; ++i)); do
  grep -q 'size, thesis-V: gru' "$work/log" 2>/dev/null && break
  sleep 0.1
done
kill -TERM "$(pgrep -P "$running" -f research/nightly.sh || echo "$running")"
status=0
wait "$running" || status=$?
((status == 2)) || fail "a nightly run with a stop signal: exit code $status: $(tail "$work/log")"
size 0.008 2026-02-05 || fail "a night that is too short for its training: $(tail "$work/log")"
compgen -G "$kept/checkpoints/*.checkpoint" >/dev/null || fail "no checkpoint: $(tail "$work/log")"
grep -q '^| size at size, seed 1: train |' "$work/size/2026-02-05/report.md" || fail "report: $(cat "$work/size/2026-02-05/report.md")"
sed -i 's/^epochs = 4000/epochs = 3/' "$work/size.toml"
rm -r "$kept"
size 5 2026-02-06 || fail "a night that ends its trainings: $(tail "$work/log")"
for seed in 1 2 3; do
  [[ -e $work/size/at-size/size/trained-seed$seed && -s $kept/V-gru-thesis-V-seed$seed-gen31.json ]] || fail "seed $seed: $(ls "$kept")"
done
[[ ! -e $work/size/at-size/size/data ]] || fail "the events of the trainings were not removed"
sed -i 's/"software": *"[^"]*"/"software": "former"/' "$kept"/*seed1*.json
size 5 2026-02-07 || fail "a night after a change of software: $(tail "$work/log")"
grep -q '^| V, mean, no noise | .* stale,' "$work/size/2026-02-07/report.md" || fail "not stale: $(cat "$work/size/2026-02-07/report.md")"

# Four hours suffice for the tests, unless they took longer in an earlier nightly run. A run interrupted in its tests
# does not count.
for told in '2026-02-06 99999 all passed' '2026-02-07 1 broken off'; do
  read -r date took end <<<"$told"
  mkdir -p "$work/told/$date"
  printf 'tests of the night\t%s\n' "$took" >"$work/told/$date/parts.tsv"
  printf '\n== %s (after %s s)\n' "$end" "$took" >"$work/told/$date/tests.txt"
done
bash "$SWINGBANK_SOURCE/research/nightly.sh" --out "$work/told" --hours 4 --preset quick --fuzz 0 --blind 0 --date 2026-02-08 \
  "$work/tiny.toml" </dev/null >"$work/log" 2>&1 || fail "a nightly run after one with long tests: $(tail "$work/log")"
grep -q '^Not run' "$work/told/2026-02-08/report.md" || fail "tests that take too long: $(cat "$work/told/2026-02-08/report.md")"

exec 8>"$out/.lock"
flock 8
refuses "double run" "$out" night 2026-02-03 "$work/tiny.toml"
exec 8>&-
refuses "no date" '--date tomorrow' night tomorrow "$work/tiny.toml"
experiment=(bash "$SWINGBANK_SOURCE/jobs/run_experiment.sh" --experiment "$work/tiny.toml")
refuses "no seconds" '--seconds soon' "${experiment[@]}" --seconds soon
refuses "no seeds" '--seeds 0' "${experiment[@]}" --seeds 0
"${experiment[@]}" --network gru --seeds 2 --ranks 2 --out "$work/seeds" >"$work/log" 2>&1 || fail "two seeds: $(tail "$work/log")"
grep -q '^| GRU | .* ± .* ² |$' "$work/seeds/tables/tables.md" || fail "no mean of two seeds: $(cat "$work/seeds/tables/tables.md")"
refuses "no switch" '--any-maker yes' "${experiment[@]}" --any-maker yes
refuses "no hours" '--hours none' night 2026-02-03 --hours none "$work/tiny.toml"

sed 's/^epochs = .*/epochs = "many"/' "$work/tiny.toml" >"$work/wrong.toml"
status=0
night 2026-02-03 "$work/wrong.toml" >"$work/log" 2>&1 || status=$?
((status == 1)) || fail "a nightly run that fails: exit code $status"
[[ $(grep -c 'failed with exit code' "$work/log") == 3 ]] || fail "three tries expected: $(cat "$work/log")"
[[ $(readlink "$out/latest") == 2026-02-02 ]] || fail "a failed nightly run became the latest"
echo "ok: two nightly runs, trainings at size, lock, failure"
