#!/usr/bin/env bash
# Training directly from memory, without a dataset on a disk: the results equal those from shards to the last digit,
# and are reproducible.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
export OMP_NUM_THREADS=2

TINY_DRAWS=80 TINY_EPOCHS=1 TINY_T_END=2.0 tiny_experiment "$work"
sed 's/^split = .*/split = "by-databank-point"/;/^folds/d' "$work/tiny.toml" >"$work/split.toml"
train() { # OUT ARGUMENTS
  "$swingbank" train --experiment "$work/split.toml" --out "$work/$1" "${@:2}" >"$work/log" 2>&1 || fail "$1: $(cat "$work/log")"
}
# The result without times, and the network's bytes.
told() {
  /usr/bin/python3 - "$work/$1" <<'PYTHON'
import glob, hashlib, json, sys
result, = glob.glob(f"{sys.argv[1]}/*.json")
network, = glob.glob(f"{sys.argv[1]}/*.network")
print("\n".join(f"{key} {value}" for key, value in json.load(open(result)).items() if "seconds" not in key and key != "history"))
data = open(network, "rb").read()
# The header contains the training time, the last bytes are the checksum; the weights lie between.
start = data.index(b"{")
header, length = json.JSONDecoder().raw_decode(data[start:].decode("latin-1"))
weights = data[start + length:-64]
assert len(weights) > 10000, len(weights)
del header["training"]["seconds"]
print(hashlib.sha256(weights).hexdigest(), header)
PYTHON
}

for storage in float32 int16; do
  mkdir "$work/$storage"
  sed "s/^rate = .*/&\nstorage = \"$storage\"/" "$work/tiny_data.toml" >"$work/$storage/tiny_data.toml"
  "$swingbank" generate "$work/$storage/tiny_data.toml" --progress none --out "$work/$storage/data" >/dev/null 2>&1
  train "$storage-disk" "$work/$storage/data"
  train "$storage-memory" --simulate "$work/$storage/tiny_data.toml"
  diff <(told "$storage-disk") <(told "$storage-memory") || fail "$storage: the results from memory differ"
done
cmp -s <(told float32-disk) <(told int16-disk) && fail "the int16 dataset gives the same result as float32"
train again --simulate "$work/float32/tiny_data.toml"
cmp <(told float32-memory) <(told again) || fail "a repeated run gives other results"
train seed --simulate "$work/float32/tiny_data.toml" --draw-seed 8
cmp -s <(told float32-memory) <(told seed) && fail "the seed changes nothing"

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

sed 's/^networks = .*/networks = ["closed-form"]/' "$work/split.toml" >"$work/direct.toml"
refuses "a method that reads records" "network closed-form at --simulate" "$swingbank" train --experiment "$work/direct.toml" \
  --simulate "$work/tiny_data.toml" --out "$work/direct"
refuses "no room" "too little memory for the rows of tiny_data at shard" "$swingbank" train --experiment "$work/split.toml" \
  --simulate "$work/tiny_data.toml" --memory-limit 0.00001 --out "$work/room"
refuses "two datasets" "two datasets at --simulate" "$swingbank" train "$work/float32/data" --experiment "$work/split.toml" \
  --simulate "$work/tiny_data.toml" --out "$work/two"
