#!/usr/bin/env bash
# Every reader detects a shard that differs from its journal entry: verify, a resumed run, a training.
source "$(dirname "$0")/common.bash"
make=("$generate" "$configs/ieee14_genrou_bus3.toml" --draws 100 --draws-per-shard 20 --progress none)
"${make[@]}" --out "$work/data" >/dev/null 2>&1
whole=$(hash_of "$work/data")
# alter FOLDER SHARD: copies the data and damages that shard without changing its length
alter() {
  cp -r "$work/data" "$1"
  "$python3" - "$1/shards/shard-00000$2.h5" <<PYTHON
import sys, h5py
with h5py.File(sys.argv[1], "r+") as shard:
    shard["parameters"][...] *= 1.5
    shard["records"][...] = shard["records"][...][::-1]
PYTHON
}
bad=$work/bad
alter "$bad" 3
[ "$(stat -c %s "$bad/shards/shard-000003.h5")" = "$(stat -c %s "$work/data/shards/shard-000003.h5")" ] || fail "another length"
where="changed shard at $bad/shards/shard-000003.h5"
expect 1 "$where" "$verify" "$bad"
expect 1 "$where" "$verify" --processes 3 "$bad"
expect 1 "$where" "${make[@]}" --out "$bad"
grep -q -- "--repair" "$work/output" || fail "no remedy"
expect 0 "dataset $whole" "${make[@]}" --trust --out "$bad"
expect 0 "dataset $whole" ranks 3 "${make[@]}" --repair --out "$bad"
expect 0 "every shard agrees with its journal" "$verify" --processes 2 "$bad"

# Journal lines with wrong counts of rows, draws or outcomes.
for edit in 's/"rows":/&1/' 's/"draws":20/"draws":21/' 's/"stable":/&1/' 's/"rows":/&1000000000000000/'; do
  rm -rf "$bad"
  cp -r "$work/data" "$bad"
  sed -i "/shard-000002/$edit" "$bad/journal.jsonl"
  cmp -s "$bad/journal.jsonl" "$work/data/journal.jsonl" && fail "nothing edited: $edit"
  expect 1 "damaged journal line at $bad/journal.jsonl:3 (its checksum is wrong)" "$verify" "$bad"
  expect 0 "dataset $whole" "${make[@]}" --repair --out "$bad"
done
