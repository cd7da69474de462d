#!/usr/bin/env bash
# Parts in separate folders, as from machines without a common disk, are merged into the dataset; a killed merge is
# resumed.
source "$(dirname "$0")/common.bash"
merge=$SWINGBANK_BIN/swingbank-merge
make=("$generate" "$configs/ieee14_genrou_bus3.toml" --draws 600 --draws-per-shard 20 --progress none)
"${make[@]}" --out "$work/whole" >/dev/null 2>&1
whole=$(hash_of "$work/whole")
for k in 1 2 3; do "${make[@]}" --part $k/3 --out "$work/part$k" >/dev/null 2>&1 || true; done
code=0
"$merge" "$work/part1" "$work/part2" --out "$work/out" --progress none >"$work/log" 2>&1 || code=$?
[ $code = 2 ] || { cat "$work/log"; fail "exit code $code while a part is missing"; }
# a merge that is killed instead of renaming its fourth shard (failing_call.cpp)
code=0
FAILING_ERROR=kill FAILING_CALL=rename FAILING_AT=4 FAILING_UNDER=$work/killed/shards FAILING_LOG=$work/failing \
  LD_PRELOAD=$SWINGBANK_BIN/failing_call.so "$merge" "$work"/part? --out "$work/killed" --progress none >"$work/log" 2>&1 || code=$?
[ $code = 137 ] || { cat "$work/log"; fail "exit code $code of a merge that was to be killed"; }
[ "$(lines "$work/killed")" = 3 ] || fail "$(lines "$work/killed") shards in the journal when the merge was killed"
for out in out killed; do
  expect 0 "dataset $whole" "$merge" "$work/part1" "$work/part2" "$work/part3" --out "$work/$out" --progress none
  diff -r "$work/whole/shards" "$work/$out/shards" || fail "other bytes in $out"
  [ "$(hash_of "$work/$out")" = "$whole" ] || fail "another hash in $out"
done
expect 0 "dataset $whole" "${make[@]}" --out "$work/out" # nothing remains to be done
# --trust recognises a finished dataset by its manifest and reads no shard.
cp -r "$work/whole" "$work/trusted"
rm "$work/trusted/shards/shard-000003.h5"
expect 0 "dataset $whole" "${make[@]}" --trust --out "$work/trusted"
expect 1 "missing shard at $work/trusted/shards/shard-000003.h5" "${make[@]}" --out "$work/trusted"
expect 0 "dataset $whole" "${make[@]}" --repair --out "$work/trusted"
diff -r "$work/whole/shards" "$work/trusted/shards" || fail "other bytes after a repair"
"${make[@]}" --seed 2 --part 1/3 --out "$work/other" >/dev/null 2>&1 || true
expect 1 "a dataset of another config at $work/other" "$merge" "$work/part1" "$work/other" --out "$work/new" --progress none
[ ! -e "$work/new" ] || fail "a refused merge left a folder"
expect 1 "no dataset at $work/absent (the folder does not exist): give a folder" "$merge" "$work/part1" "$work/absent" --out "$work/new"
[ ! -e "$work/new" ] || fail "a merge of a missing folder left an output folder"
