#!/usr/bin/env bash
# swingbank cross-validate, train and tables: further refusals in addition to bad_input_train.sh.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/bad_input_train.bash"

# refuses_at_once NAME PATTERN COMMAND...: also checks that the refusal comes before the BLAS kernels are measured
refuses_at_once() {
  refuses "$@"
  [[ $(wc -l <"$work/stderr") == 1 ]] || fail "$1: the kernels were measured before: $(cat "$work/stderr")"
}

refuses "no dataset given" 'DATASET' "$swingbank" cross-validate --experiment "$experiment" --out "$out"
refuses "unknown preset" 'preset' validate "$data" "$experiment" --preset weekly
refuses "unknown fold" 'fold' validate "$data" "$experiment" --fold 39
refuses "unknown network" 'network' validate "$data" "$experiment" --network transformer
refuses_at_once "the other command" 'cross-validate' "$swingbank" train "$data" --experiment "$experiment" --out "$out"
refuses_at_once "additional training rows, unasked" '--training-rows' validate "$data" "$experiment" --training-rows "$data"
sed -e '1i training_dataset = "tiny_data.toml"' -e 's/^networks = .*/&\ntraining_rows = true\ntraining_draws = 1/' "$experiment" >"$work/rows.toml"
refuses_at_once "no additional training rows" '--training-rows' validate "$data" "$work/rows.toml"
edit type 's/^epochs = .*/epochs = "many"/'
refuses "wrong type" 'type.toml:[0-9]+' validate "$data" "$work/type.toml"
edit channel 's/^channels = .*/channels = ["P", "Efd"]/'
refuses "channel that was not recorded" 'Efd' validate "$data" "$work/channel.toml"
cp -r "$data" "$work/part"
sed -i '$d' "$work/part/journal.jsonl"
refuses "incomplete dataset" "$work/part" validate "$work/part" "$experiment"
refuses "file in place of a folder" "$experiment" "$swingbank" cross-validate "$data" --experiment "$experiment" --out "$experiment/out"
refuses "no results" "$work/out" "$swingbank" tables "$out" --out "$work/tables"
refuses "no such folder" "$work/none" "$swingbank" tables "$work/none" --out "$work/tables"
leaves_nothing "$out"
