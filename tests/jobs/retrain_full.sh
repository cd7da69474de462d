#!/usr/bin/env bash
# swingbank add --retrain: existing networks are reused; without a dataset a grid is generated.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/retrain.bash"

retrain_given "$work/text" || (($? == 3)) || fail "$(tail -5 "$work/log")"

# again: datasets and networks exist
before=$(stat -c %Y "$work"/given/retrain/*/results/*.network)
retrain_given "$work/again" || (($? == 3)) || fail "again: $(tail -5 "$work/log")"
cmp "$work/text" "$work/again" || fail "the second run prints another result"
[[ $before == "$(stat -c %Y "$work"/given/retrain/*/results/*.network)" ]] || fail "networks were trained again"

# without a dataset the plant is connected through lines
retrain --out "$work/made" --json >"$work/text" 2>"$work/log" || (($? == 3)) || fail "$(tail -5 "$work/log")"
python3 -c 'import json, sys; json.load(open(sys.argv[1]))' "$work/text" || fail "--json prints more than JSON"
[[ -s $work/made/retrain/grid/plant.raw && -s $work/made/retrain.json ]] || fail "no grid made"
