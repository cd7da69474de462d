#!/usr/bin/env bash
# A dataset is the same to the last byte whoever makes it: 1, 2, 3 and 5 ranks, shards written by 1 and 3 ranks.
source "$(dirname "$0")/common.bash"
shard=16
make() { # ranks folder options
  local n=$1 out=$2
  shift 2
  ranks "$n" "$generate" "$configs/ieee39_genrou.toml" --draws 120 --draws-per-shard $shard --progress none --out "$work/$out" "$@" >"$work/log" 2>&1 ||
    { cat "$work/log"; fail "$out"; }
}
make 1 one
first=$(hash_of "$work/one")
[ -n "$first" ] || fail "no hash"
make 2 two
make 3 three
make 5 five
make 3 group --writer-ranks 3
make 4 led --writer-ranks 3 --dedicated-master
make 5 uneven --writer-ranks 3
for d in two three five group led uneven; do
  [ "$(hash_of "$work/$d")" = "$first" ] || fail "$d has another hash"
  diff -r "$work/one/shards" "$work/$d/shards" || fail "$d has other bytes"
done
# Another seed is another dataset.
make 1 seed --seed 2
[ "$(hash_of "$work/seed")" != "$first" ] || fail "the seed changes nothing"
# Which draws share a shard changes no record: here one shard holds all.
shard=120
make 1 single
"$python3" - "$work" <<'PYTHON'
import glob, sys
import h5py, numpy
def records(folder):
    return numpy.concatenate([h5py.File(f)["records"][:] for f in sorted(glob.glob(f"{sys.argv[1]}/{folder}/shards/*.h5"))])
assert (records("one") == records("single")).all()
PYTHON
# All generators varying: ten rows per stable draw.
ranks 2 "$generate" "$configs/ieee39_gencls_all.toml" --draws 20 --draws-per-shard 10 --progress none --out "$work/all" >"$work/log" 2>&1
grep -q '"rows":[1-9][0-9]*0,' "$work/all/journal.jsonl" || fail "rows are no multiple of ten"
