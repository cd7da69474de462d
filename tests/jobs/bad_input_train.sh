#!/usr/bin/env bash
# swingbank cross-validate, train and tables on bad input: one message, exit code 1, no result.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
own_mounts
source "$(dirname "${BASH_SOURCE[0]}")/bad_input_train.bash"

refuses "no such experiment" "$work/none.toml" validate "$data" "$work/none.toml"
refuses "no such dataset" "$work/none" validate "$work/none" "$experiment"
misused "unknown option" 'nonsense' validate "$data" "$experiment" --nonsense 3

edit key 's/^patience/patienc/'
refuses "unknown key" 'key.toml:[0-9]+' validate "$data" "$work/key.toml"

cp -r "$data" "$work/cut"
truncate -s 5000 "$work/cut/shards/shard-000003.h5"
refuses "truncated shard" 'shard-000003.h5' validate "$work/cut" "$experiment"
cp -r "$data" "$work/nan"
/usr/bin/python3 - "$work/nan/shards/shard-000002.h5" <<'PYTHON'
import sys, h5py
with h5py.File(sys.argv[1], "r+") as shard:
    shard["records"][1, 0, 40] = float("nan")
PYTHON
refuses "a shard that was changed" 'changed shard at .*shard-000002.h5.*--repair' validate "$work/nan" "$experiment"
refuses "not a number in a shard" 'not a number at .*shard-000002.h5, row 1' validate "$work/nan" "$experiment" --trust
leaves_nothing "$out"

disk "$work/full" 64k
head -c 64k /dev/zero >"$work/full/filler"
refuses "full disk" "$work/full" "$swingbank" cross-validate "$data" --experiment "$experiment" --out "$work/full" --fold 30
left=$(find "$work/full" -name '*.json')
[[ -z $left ]] || fail "a result from a run that failed: $left"

echo '{"table": "V"}' >"$out/V-gru-quick-seed1-gen30.json"
refuses "broken result" 'V-gru-quick-seed1-gen30.json' "$swingbank" tables "$out" --out "$work/tables"
[[ ! -e $work/tables/tables.html ]] || fail "tables of broken results"
