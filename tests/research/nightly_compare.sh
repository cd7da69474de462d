#!/usr/bin/env bash
# Changes of a result beyond the noise between nights are reported, smaller changes are not, and fewer than three runs
# give no verdict.
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/lib.bash"

# night DATE MSE-30 MSE-31
night() {
  local folder=$work/nights/$1/ieee39_gencls/results generator
  mkdir -p "$folder"
  for generator in 30 31; do
    shift
    cat >"$folder/V-cnn-nightly-seed1-gen$generator.json" <<JSON
{"table": "V", "network": "cnn", "generator": $generator, "preset": "nightly", "mse": $1, "baseline_mse": 1.0,
 "shuffled_labels": false, "software": "swingbank", "blas": "${BLAS:-one}", "dataset": {"config_hash": "00", "hash": "00", "rows": 1}}
JSON
  done
}
compare() { "$swingbank" nightly-compare "$work/nights" >"$work/report"; }

night 2026-01-01 0.200 0.100
night 2026-01-02 0.210 0.103
compare
grep -q '^| V | cnn | 0 | 30 .* fewer than 3 runs, no verdict |$' "$work/report" || fail "a verdict from one night: $(cat "$work/report")"

night 2026-01-03 0.190 0.098
night 2026-01-04 0.204 0.400
compare
grep -q '^# Nightly benchmark 2026-01-04: 1 of 2 judged' "$work/report" || fail "headline: $(cat "$work/report")"
grep -q '^| V | cnn | 0 | 31 .* +300.0 % .* \*\*worse\*\* |$' "$work/report" || fail "fourfold error not named: $(cat "$work/report")"
grep -q '^| V | cnn | 0 | 30 .* within noise |$' "$work/report" || fail "2 % called a move: $(cat "$work/report")"

BLAS=other night 2026-01-05 0.204 0.100
compare
grep -q '^| V | cnn | 0 | 30 .* within noise; software or kernels differ from the previous run |$' "$work/report" ||
  fail "other kernels without a word: $(cat "$work/report")"
rm -r "$work/nights/2026-01-05"

echo '{"table": "V"' >"$work/nights/2026-01-04/ieee39_gencls/results/broken.json"
refuses "broken result" 'broken.json' "$swingbank" nightly-compare "$work/nights"
refuses "no folder" "$work/none" "$swingbank" nightly-compare "$work/none"
misused "unknown option" nonsense "$swingbank" nightly-compare "$work/nights" --nonsense
misused "unknown option" nonsense "$swingbank" effects --nonsense
