#!/usr/bin/env bash
# swingbank cross-validate, train and tables: the refusals beside those of bad_input_train.sh.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
export OMP_NUM_THREADS=1

tiny_experiment "$work"
experiment=$work/tiny.toml data=$work/data out=$work/out
"$swingbank" generate "$work/tiny_data.toml" --draws 100 --out "$data" >/dev/null 2>&1
mkdir "$out"
# validate DATA EXPERIMENT [OPTION...]
validate() { "$swingbank" cross-validate "$1" --experiment "$2" --out "$out" "${@:3}"; }
edit() { sed "$2" "$experiment" >"$work/$1.toml"; }

refuses "no dataset given" 'DATASET' "$swingbank" cross-validate --experiment "$experiment" --out "$out"
refuses "unknown preset" 'preset' validate "$data" "$experiment" --preset weekly
refuses "unknown fold" 'fold' validate "$data" "$experiment" --fold 39
refuses "unknown network" 'network' validate "$data" "$experiment" --network transformer
refuses "the other command" 'cross-validate' "$swingbank" train "$data" --experiment "$experiment" --out "$out"
edit type 's/^epochs = .*/epochs = "many"/'
refuses "wrong type" 'type.toml:[0-9]+' validate "$data" "$work/type.toml"
edit channel 's/^channels = .*/channels = ["P", "Efd"]/'
refuses "channel that was not recorded" 'Efd' validate "$data" "$work/channel.toml"
cp -r "$data" "$work/part"
sed -i '$d' "$work/part/journal.jsonl"
refuses "unfinished dataset" "$work/part" validate "$work/part" "$experiment"
refuses "file in place of a folder" "$experiment" "$swingbank" cross-validate "$data" --experiment "$experiment" --out "$experiment/out"
refuses "no results" "$work/out" "$swingbank" tables "$out" --out "$work/tables"
refuses "no such folder" "$work/none" "$swingbank" tables "$work/none" --out "$work/tables"
leaves_nothing "$out"
