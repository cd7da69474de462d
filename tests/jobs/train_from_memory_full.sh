#!/usr/bin/env bash
# Training directly from memory, without a dataset on a disk: the results equal those from shards to the last digit,
# and are reproducible.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
source "$(dirname "${BASH_SOURCE[0]}")/same_training.bash"
export OMP_NUM_THREADS=2

TINY_DRAWS=80 TINY_EPOCHS=1 TINY_T_END=2.0 tiny_experiment "$work"
sed 's/^split = .*/split = "by-databank-point"/;/^folds/d' "$work/tiny.toml" >"$work/split.toml"
# The result and the network without times.
told() {
  /usr/bin/python3 - "$work/$1" <<'PYTHON'
import glob, json, sys
result, = glob.glob(f"{sys.argv[1]}/*.json")
print("\n".join(f"{key} {value}" for key, value in json.load(open(result)).items() if "seconds" not in key and key != "history"))
PYTHON
  /usr/bin/python3 "$work/network.py" "$work/$1"/*.network
}
train() { # OUT ARGUMENTS
  "$swingbank" train --experiment "$work/split.toml" --out "$work/$1" "${@:2}" >"$work/log" 2>&1 || fail "$1: $(cat "$work/log")"
  told "$1" >"$work/$1.told" || fail "$1: no result or network"
}

for storage in float32 int16; do
  mkdir "$work/$storage"
  sed "s/^rate = .*/&\nstorage = \"$storage\"/" "$work/tiny_data.toml" >"$work/$storage/tiny_data.toml"
  "$swingbank" generate "$work/$storage/tiny_data.toml" --progress none --out "$work/$storage/data" >/dev/null 2>&1
  train "$storage-disk" "$work/$storage/data"
  train "$storage-memory" --simulate "$work/$storage/tiny_data.toml"
  diff "$work/$storage-disk.told" "$work/$storage-memory.told" || fail "$storage: the results from memory differ"
done
cmp -s "$work/float32-disk.told" "$work/int16-disk.told" && fail "the int16 dataset gives the same result as float32"
train again --simulate "$work/float32/tiny_data.toml"
cmp "$work/float32-memory.told" "$work/again.told" || fail "a repeated run gives other results"
train seed --simulate "$work/float32/tiny_data.toml" --draw-seed 8
cmp -s "$work/float32-memory.told" "$work/seed.told" && fail "the seed changes nothing"

# Folds in two processes that divide the rows among them, with noise.
for from in disk memory; do
  rows=("$work/float32/data")
  [[ $from == disk ]] || rows=(--simulate "$work/float32/tiny_data.toml")
  "$swingbank" cross-validate "${rows[@]}" --experiment "$work/tiny.toml" --processes 2 --noise 0.001 --out "$work/folds-$from" \
    >"$work/log" 2>&1 || fail "folds from $from: $(cat "$work/log")"
done
for fold in 30 31; do
  name=V-gru-quick-noise0.001-seed1-gen$fold.json
  diff <(grep -v seconds "$work/folds-disk/$name") <(grep -v seconds "$work/folds-memory/$name") || fail "a fold trained from memory differs"
done

# Rows of a second dataset, for training only.
mkdir "$work/more"
TINY_DRAWS=80 TINY_TRAINING_DRAWS=40 TINY_EPOCHS=3 TINY_T_END=2.0 tiny_experiment "$work/more"
sed 's/^split = .*/split = "by-databank-point"/;/^folds/d' "$work/more/tiny.toml" >"$work/more/split.toml"
"$swingbank" generate "$work/more/tiny_points.toml" --draws 40 --progress none --out "$work/more/points" >/dev/null 2>&1
with_more() { # OUT ARGUMENTS
  "$swingbank" train --experiment "$work/more/split.toml" --network mlp --out "$work/$1" "${@:2}" >"$work/log" 2>&1 || return
  told "$1" >"$work/$1.told" || fail "$1: no result or network"
}
simulated=(--simulate "$work/float32/tiny_data.toml" --training-rows "$work/more/tiny_points.toml" --training-draws 40)
with_more more-disk "$work/float32/data" --training-rows "$work/more/points" || fail "more rows: $(cat "$work/log")"
with_more more-memory "${simulated[@]}" || fail "more rows from memory: $(cat "$work/log")"
diff "$work/more-disk.told" "$work/more-memory.told" || fail "the results with training rows from memory differ"

# New events in each epoch: reproducible, also after an interruption.
with_more fresh "${simulated[@]}" --fresh-rows || fail "new rows: $(cat "$work/log")"
cmp -s "$work/more-memory.told" "$work/fresh.told" && fail "new rows change nothing"
[[ $(grep -c 'new training rows' "$work/log") == 2 ]] || fail "new rows are not simulated in two of three epochs"
"$swingbank" train --experiment "$work/more/split.toml" --network mlp --out "$work/stopped" "${simulated[@]}" --fresh-rows \
  >"$work/log" 2>&1 &
until grep -q 'new training rows' "$work/log" 2>/dev/null && ls "$work/stopped" >/dev/null 2>&1; do sleep 0.02; done
kill -TERM $!
code=0
wait $! || code=$?
((code == 0 || code == 2)) || fail "interrupted with $code: $(cat "$work/log")"
with_more stopped "${simulated[@]}" --fresh-rows || fail "continued: $(cat "$work/log")"
diff "$work/fresh.told" "$work/stopped.told" || fail "the continued run gives another result"
refuses "new rows of a stored dataset" "no config to simulate at --draws" "$swingbank" train "$work/float32/data" \
  --experiment "$work/split.toml" --fresh-rows --out "$work/none"
refuses "new rows with shuffled labels" "new rows with shuffled labels at --fresh-rows" "$swingbank" train \
  --simulate "$work/tiny_data.toml" --experiment "$work/split.toml" --fresh-rows --shuffle-labels --out "$work/none"

sed 's/^networks = .*/networks = ["closed-form"]/' "$work/split.toml" >"$work/direct.toml"
refuses "a method that reads records" "network closed-form at --simulate" "$swingbank" train --experiment "$work/direct.toml" \
  --simulate "$work/tiny_data.toml" --out "$work/direct"
refuses "no room" "too little memory for the rows of tiny_data at shard" "$swingbank" train --experiment "$work/split.toml" \
  --simulate "$work/tiny_data.toml" --memory-limit 0.00001 --out "$work/room"
refuses "two datasets" "two datasets at --simulate" "$swingbank" train "$work/float32/data" --experiment "$work/split.toml" \
  --simulate "$work/tiny_data.toml" --out "$work/two"
