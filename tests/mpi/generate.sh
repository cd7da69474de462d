#!/usr/bin/env bash
# A dataset has the same bytes for 1 and 3 ranks, and for shards written by 1 and 3 ranks; generate_full.sh tries more.
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
make 3 three
make 4 led --writer-ranks 3 --dedicated-master
for d in three led; do
  [ "$(hash_of "$work/$d")" = "$first" ] || fail "$d has another hash"
  diff -r "$work/one/shards" "$work/$d/shards" || fail "$d has other bytes"
done
# Another seed gives another dataset.
make 1 seed --seed 2
[ "$(hash_of "$work/seed")" != "$first" ] || fail "the seed changes nothing"
# Records do not depend on the division into shards: here one shard contains all.
shard=120
make 1 single
"$python3" - "$work" <<'PYTHON'
import glob, sys
import h5py, numpy
def records(folder):
    return numpy.concatenate([h5py.File(f)["records"][:] for f in sorted(glob.glob(f"{sys.argv[1]}/{folder}/shards/*.h5"))])
assert (records("one") == records("single")).all()
PYTHON
# With attached effects and varied parameters, the data are the same for any number of ranks and for a resumed run.
with_exciter=("$configs/ieee39_genrou_sexs.toml" --draws 60 --draws-per-shard 10 --progress none)
"$generate" "${with_exciter[@]}" --out "$work/exciter" >"$work/log" 2>&1 || { cat "$work/log"; fail "an exciter attached"; }
mkdir -p "$work/resumed/shards" # as after a stop half way
head -3 "$work/exciter/journal.jsonl" >"$work/resumed/journal.jsonl"
cp "$work/exciter/dataset.json" "$work/resumed"
cp "$work"/exciter/shards/shard-00000[0-2].h5 "$work/resumed/shards"
ranks 3 "$generate" "${with_exciter[@]}" --writer-ranks 2 --out "$work/resumed" >"$work/log" 2>&1 || { cat "$work/log"; fail "resumed"; }
[ "$(hash_of "$work/exciter")" = "$(hash_of "$work/resumed")" ] || fail "another hash when resumed"
diff -r "$work/exciter/shards" "$work/resumed/shards" || fail "other bytes when resumed"
"$python3" - "$work" <<'PYTHON'
import sys
import h5py
a = h5py.File(f"{sys.argv[1]}/exciter/shards/shard-000000.h5")
names = [n.decode() if isinstance(n, bytes) else n for n in a.attrs["parameter_names"]]
effects = [n.decode() if isinstance(n, bytes) else n for n in a.attrs["parameter_effects"]]
assert names[-2:] == ["SEXS.K", "SEXS.TE"] and effects[-2:] == ["SEXS", "SEXS"] and effects[0] == "GENROU"
gain = a["parameters"][:, -2]
assert ((gain >= 20) & (gain <= 300)).all() and gain.std() > 30, gain
assert a["records"].shape[0] == len(gain)
PYTHON
