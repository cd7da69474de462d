#!/usr/bin/env bash
# swingbank night-plan: the cost of a preset, and the preset for a given number of hours.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../jobs/tiny_experiment.bash"

TINY_DRAWS=4000 TINY_TRAINING_DRAWS=1000 TINY_EPOCHS=100 tiny_experiment "$work"
plan() { "$swingbank" night-plan "$work/tiny.toml" --preset quick --rates "${RATES:-$SWINGBANK_SOURCE/research/rates.toml}" "$@"; }
written() { "$swingbank" train --experiment "$work/made/tiny.toml" --preset night --print "$1"; }
hours() { sed -nE 's/^Preset .* scaled by [^:]*: ([0-9.]+) core-hours.*/\1/p' "$work/plan"; }

plan >"$work/plan"
grep -qF '| V | events | 1 | 4000 | – |' "$work/plan" || fail "events: $(cat "$work/plan")"
grep -qF '| V | events that only train | 1 | 3000 | – |' "$work/plan" || fail "three rows an event: $(cat "$work/plan")"
grep -qF '| V | mlp | 2 | 3100 | 100 |' "$work/plan" || fail "1,600 own rows and half of 3,000: $(cat "$work/plan")"
plan --seeds 3 | grep -qF '| V | mlp | 6 | 3100 | 100 |' || fail "three seeds"

sed 's/^\[preset.quick.mlp\]/&\nshares = [0.25, 0.5]/' "$work/tiny.toml" >"$work/shares.toml"
"$swingbank" night-plan "$work/shares.toml" --preset quick --rates "$SWINGBANK_SOURCE/research/rates.toml" |
  grep -qF '| V | mlp | 4 | 3100 | 100 |' || fail "two shares of the training rows"

plan --hours 2 --cores 3 --name night --out "$work/made" >"$work/plan"
awk -v h="$(hours)" 'BEGIN {exit !(h > 5.9 && h < 6.1)}' || fail "2 h on 3 cores: $(tail -n 2 "$work/plan")"
(($(written draws) > 4000 && $(written training_draws) > 1000)) || fail "a longer night has no more events"
[[ $(written training_dataset) == "$work/tiny_points.toml" ]] || fail "dataset: $(written training_dataset)"
[[ $(written training_rows) == mlp ]] || fail "the network's own table is gone"
if grep -qF 'preset.quick' "$work/made/tiny.toml"; then fail "the old preset stands beside the new one"; fi

plan --hours 0.0001 --name night --out "$work/made" >"$work/plan"
[[ $(written draws) == 120 ]] || fail "least size: $(written draws)"
grep -q 'the preset is at its smallest size' "$work/plan" || fail "a plan beyond its hours: $(tail -n 2 "$work/plan")"

grep -v '^\[network.gru\]' "$SWINGBANK_SOURCE/research/rates.toml" | sed 's/^\[network.lstm\]/[network.none]/;/network.none/,/run/!b' |
  awk '/^\[network.none\]/ {skip = 1} /^\[network.mlp\]/ {skip = 0} !skip' >"$work/rates.toml"
RATES=$work/rates.toml refuses "no rate" "no rate of 'gru'" plan
sed -i 's/^epochs = \(.*\)/"epochs" = \1/' "$work/tiny.toml"
refuses "sizes in another way" 'cannot be scaled' plan --hours 1 --name night --out "$work/made"
refuses "a name with a dot" "night.5" plan --hours 1 --name night.5 --out "$work/made"
refuses "no name" '--name' plan --hours 1 --out "$work/made"
echo "ok: plan, seeds, larger, least, refusals"
