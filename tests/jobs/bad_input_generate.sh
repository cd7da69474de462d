#!/usr/bin/env bash
# swingbank databank and generate on bad input, full disks and damaged datasets: one message, exit code 1, no data
# lost.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
own_mounts

tiny_experiment "$work"
config=$work/tiny_data.toml data=$work/data
make_data() { "$swingbank" generate "$1" --out "$2" "${@:3}"; }
whole() { "$swingbank" verify "$1" | holds -q 'every shard agrees with its journal'; }

refuses "no such config" "$work/none.toml" make_data "$work/none.toml" "$data"
refuses "no such config" "$work/none.toml" "$swingbank" databank "$work/none.toml"
misused "unknown option" 'nonsense' make_data "$config" "$data" --nonsense 3
misused "no number of draws" 'draws' make_data "$config" "$data" --draws many
misused "too few draws" '“-1” is not a number above 0' make_data "$config" "$data" --draws=-1

# edit NAME SED-SCRIPT: writes a config with one error
edit() { sed "$2" "$config" >"$work/$1.toml"; }
edit key 's/^duration/duraton/'
refuses "unknown key" 'key.toml:[0-9]+' make_data "$work/key.toml" "$data"
edit type 's/^rate = .*/rate = "fast"/'
refuses "wrong type" 'type.toml:[0-9]+' make_data "$work/type.toml" "$data"
edit box 's/^H = .*/H = [2.0, 80.0]/'
refuses "box beyond what is possible" 'box.toml:[0-9]+' make_data "$work/box.toml" "$data"
edit bus 's/^generators = .*/generators = [30, 31, 4711]/'
refuses "generator that is not there" 'bus.toml' make_data "$work/bus.toml" "$data"
edit nan 's/^start = .*/start = nan/'
refuses "not a number" 'nan.toml:[0-9]+' make_data "$work/nan.toml" "$data"
edit broken 's/^\[fault\]/[fault/'
refuses "no TOML" 'broken.toml:[0-9]+' make_data "$work/broken.toml" "$data"
edit network 's/^raw = .*/raw = "none.raw"/'
refuses "no such network" 'none.raw' make_data "$work/network.toml" "$data"
[[ ! -e $data ]] || fail "a refused config left $data"

# No machine stays in synchronism through a fault of two seconds. The dataset then has no rows, which is an error.
edit unstable 's/^buses = .*/buses = [16]/; s/^duration = .*/duration = [2.0, 2.1]/; s/^draws = .*/draws = 20/'
refuses "dataset without rows" 'a dataset without rows at .*unstable_data .*stable' make_data "$work/unstable.toml" "$work/unstable_data"

make_data "$config" "$data" >/dev/null 2>&1
whole "$data" || fail "the dataset that the cases below break is broken itself"
edit other 's/^seed = .*/seed = 4/'
refuses "folder of another config" "$data" make_data "$work/other.toml" "$data"
whole "$data" || fail "a refused config changed the dataset"

cp -r "$data" "$work/cut"
truncate -s 5000 "$work/cut/shards/shard-000003.h5"
refuses "truncated shard" 'shard-000003.h5' "$swingbank" verify "$work/cut"
make_data "$config" "$work/cut" --repair >/dev/null 2>&1
whole "$work/cut" || fail "--repair did not mend the shard"
make_data "$work/other.toml" "$work/data4" >/dev/null 2>&1
cp "$work/data4/shards/shard-000002.h5" "$work/cut/shards/"
refuses "shard of another config" 'shard-000002.h5' "$swingbank" verify "$work/cut"
rm "$work/cut/shards/shard-000002.h5"
refuses "shard that is gone" 'shard-000002.h5' "$swingbank" verify "$work/cut"

# A full disk ends the run. Finished shards stay, no partial file remains, and with free space the run continues.
disk "$work/small" 750k
refuses "full disk" "$work/small" make_data "$config" "$work/small/data"
finished=$(wc -l <"$work/small/data/journal.jsonl")
((finished > 0 && finished < 20)) || fail "the disk was to fill up half-way, but $finished of 20 shards are there"
[[ $(find "$work/small/data/shards" -name 'shard-??????.h5' | wc -l) == "$finished" ]] || fail "a shard that is not in the journal"
mount -o remount,size=20m "$work/small"
make_data "$config" "$work/small/data" >/dev/null 2>&1
whole "$work/small/data" || fail "the run did not continue after the full disk"
diff <(cut -d, -f1-5 "$data/journal.jsonl" | sort) <(cut -d, -f1-5 "$work/small/data/journal.jsonl" | sort) ||
  fail "the dataset differs from that of a run without a full disk"

mount -o remount,ro "$work/small"
refuses "read-only disk" "$work/small" make_data "$config" "$work/small/more"
refuses "file in place of a folder" "$config" make_data "$config" "$config/data"

# After SIGKILL, all shards in the journal are complete, and the next run generates the other shards.
"$swingbank" generate "$config" --draws 100000 --out "$work/killed" >/dev/null 2>&1 &
killed=$!
for ((i = 0; i < 300; i++)); do
  [[ $(grep -c . "$work/killed/journal.jsonl" 2>/dev/null) -ge 3 ]] && break
  sleep 0.1
done
kill -KILL "$killed"
wait "$killed" 2>/dev/null || true
status=0
"$swingbank" verify "$work/killed" >"$work/verify" 2>&1 || status=$?
((status == 2)) || fail "an unfinished but sound dataset: exit code $status, $(cat "$work/verify")"
echo "ok: killed: $(grep -c . "$work/killed/journal.jsonl") shards kept"
