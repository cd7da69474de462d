#!/usr/bin/env bash
# A dataset has the same bytes for any number of ranks and of writers per shard. With drawn operating points, this also
# holds for a run that is killed and resumed.
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
make 2 two
make 5 five
make 3 group --writer-ranks 3
make 5 uneven --writer-ranks 3
for d in two five group uneven; do
  [ "$(hash_of "$work/$d")" = "$first" ] || fail "$d has another hash"
  diff -r "$work/one/shards" "$work/$d/shards" || fail "$d has other bytes"
done
# Drawn operating points: the rows are the same for any number of ranks and writers, for a killed and resumed run, and
# for another number of draws per shard.
points=("$configs/ieee39_genrou_points.toml" --draws 60 --progress none)
"$generate" "${points[@]}" --draws-per-shard 15 --out "$work/points" >"$work/log" 2>&1 || { cat "$work/log"; fail "operating points"; }
grep -q '30 operating points; rejected: ' "$work/log" || { cat "$work/log"; fail "redraws are not reported"; }
ranks 3 "$generate" "${points[@]}" --draws-per-shard 15 --writer-ranks 3 --out "$work/points3" >"$work/log" 2>&1 || { cat "$work/log"; fail "operating points of three ranks"; }
"$generate" "${points[@]}" --draws-per-shard 15 --out "$work/killed" >"$work/log" 2>&1 &
pid=$!
wait_for_lines "$work/killed" 1
kill -9 $pid || true # it may have ended
wait $pid 2>/dev/null || true
expect 0 "30 operating points" ranks 3 "$generate" "${points[@]}" --draws-per-shard 15 --out "$work/killed"
for d in points3 killed; do
  [ "$(hash_of "$work/$d")" = "$(hash_of "$work/points")" ] || fail "$d has another hash"
  diff -r "$work/points/shards" "$work/$d/shards" || fail "$d has other bytes"
  diff <(sort "$work/points/journal.jsonl") <(sort "$work/$d/journal.jsonl") || fail "$d counts otherwise"
done
"$generate" "${points[@]}" --draws-per-shard 60 --out "$work/points_one" >"$work/log" 2>&1
"$python3" - "$work" <<'PYTHON'
import glob, json, sys
import h5py, numpy
def all_of(folder, name):
    return numpy.concatenate([h5py.File(f)[name][:] for f in sorted(glob.glob(f"{sys.argv[1]}/{folder}/shards/*.h5"))])
for name in ("records", "machine_base", "draws/redrawn"):
    assert (all_of("points", name) == all_of("points_one", name)).all(), name
base, block, bus = all_of("points", "machine_base"), all_of("points", "sample_id") // 2, all_of("points", "generator")
for b in set(block):
    for g in set(bus):
        assert len(set(base[(block == b) & (bus == g)])) <= 1, (b, g)
assert len(set(base)) > 50
header = json.load(open(f"{sys.argv[1]}/points/dataset.json"))
assert "machine_base" not in header and header["generators"] == list(range(30, 40)), header
PYTHON
# All generators varying: ten rows per stable draw.
ranks 2 "$generate" "$configs/ieee39_gencls_all.toml" --draws 20 --draws-per-shard 10 --progress none --out "$work/all" >"$work/log" 2>&1
grep -q '"rows":[1-9][0-9]*0,' "$work/all/journal.jsonl" || fail "rows are no multiple of ten"
