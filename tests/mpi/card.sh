#!/usr/bin/env bash
# A dataset's card (card.json) suffices to generate the dataset again without its original inputs. The list of attempts
# gives the outcome of each run.
source "$(dirname "$0")/common.bash"
mkdir -p "$work/configs/sets" "$work/configs/nets"
networks=$SWINGBANK_SOURCE/configs/networks
for kind in raw dyr; do cp "$networks/ieee39_dataset_gencls.$kind" "$work/configs/nets/grid.$kind"; done
printf '/ a comment in Latin-1: \xfc\n' >>"$work/configs/nets/grid.dyr"
sed -e 's#^raw = .*#raw = "../nets/grid.raw"#' -e "s#^dyr = .*#dyr = '../nets/grid.dyr'#" "$configs/ieee39_gencls.toml" \
  >"$work/configs/sets/mine.toml"
make=("$generate" "$work/configs/sets/mine.toml" --draws 400 --draws-per-shard 10 --seed 5 --channels P speed --rate 60 --int16
  --progress none --out "$work/first")
"${make[@]}" >"$work/log" 2>&1 &
pid=$!
wait_for_lines "$work/first" 2
kill -9 $pid || fail "it ended before it was killed"
wait $pid 2>/dev/null || true
"${make[@]}" >"$work/log" 2>&1 || { cat "$work/log"; fail "the second attempt"; }
first=$(hash_of "$work/first")
"$verify" "$work/first" >"$work/told"
grep -q "2 attempts: 1 killed or still running, 0 failed; 0 shards generated again" "$work/told" || { cat "$work/told"; fail "attempts"; }

cp "$work/first/card.json" "$work/card.json"
rm -r "$work/configs"
mv "$work/first" "$work/kept"
expect 0 "dataset $first" "$generate" --again "$work/card.json" --progress none --out "$work/second"
diff -r "$work/kept/shards" "$work/second/shards" || fail "other bytes"
cmp "$work/kept/dataset.json" "$work/second/dataset.json" || fail "another header"
expect 0 "dataset $first" ranks 2 "$generate" --again "$work/kept" --progress none --out "$work/third"
expect 0 "dataset $first" "$generate" --again "$work/second/card.json" --progress none --out "$work/third" # nothing to do
[ "$(hash_of "$work/third")" = "$first" ] || fail "another hash on two ranks"
ls /tmp/swingbank-card-* >/dev/null 2>&1 && fail "unpacked files are left"

# Readability by other programs.
"$python3" - "$work/kept" <<'PYTHON'
import json, os, sys
import h5py
card = json.load(open(f"{sys.argv[1]}/card.json"))
assert {"software", "compiler", "mpi", "hdf5", "host", "processor", "system"} <= set(card["made_by"]), card["made_by"]
assert all(card["made_by"].values())
events = [json.loads(line) for line in open(f"{sys.argv[1]}/attempts.jsonl") if line.strip()]
assert any(len(e.get("databank", "")) == 16 for e in events), events
os.chdir("/")
whole = h5py.File(f"{sys.argv[1]}/dataset.h5")
shards = sorted(os.listdir(f"{sys.argv[1]}/shards"))
at = 0
for name in shards:
    shard = h5py.File(f"{sys.argv[1]}/shards/{name}")
    n = len(shard["sample_id"])
    for array in ("records", "record_scale", "parameters", "sample_id"):
        assert (whole[array][at:at + n] == shard[array][:]).all(), (name, array)
    at += n
assert at == len(whole["sample_id"]) and list(whole.attrs["channel_names"]) == ["P", "speed"]
PYTHON

# A changed card, and a card from another processor, are refused.
sed 's/"seed": 5/"seed": 6/' "$work/card.json" >"$work/changed.json"
expect 1 "damaged card, or a file that is not a card at $work/changed.json" "$generate" --again "$work/changed.json" --out "$work/x"
expect 1 "CONFIG in addition at --again" "$generate" "$configs/ieee39_gencls.toml" --again "$work/card.json" --out "$work/x"
expect 1 "channel 'X' at --channels" "$generate" "$configs/ieee39_gencls.toml" --channels P X nonsense --out "$work/x"
[ ! -e "$work/x" ] || fail "something was left"
