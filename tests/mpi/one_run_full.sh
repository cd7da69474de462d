#!/usr/bin/env bash
# A dataset never has two runs at once, and a refused or killed start does not block a valid one.
source "$(dirname "$0")/common.bash"
make=("$generate" "$configs/ieee14_genrou_bus3.toml" --draws 1000 --draws-per-shard 20 --progress none)
"${make[@]}" --out "$work/whole" >/dev/null 2>&1
whole=$(hash_of "$work/whole")

# The lock comes before any read or write: if another run has the folder, nothing appears in it.
mkdir "$work/held"
(
  exec 9>"$work/held/.lock"
  echo "process 12 on elsewhere" >&9
  flock 9
  "${make[@]}" --repair --out "$work/held" >"$work/repair" 2>&1 9>&- &
  expect 1 "dataset in use at $work/held (locked by process 12 on elsewhere)" "${make[@]}" --out "$work/held"
  wait $! && fail "a repair went on in a locked folder"
  grep -q "dataset in use" "$work/repair" || fail "the repair did not report that the dataset is in use: $(cat "$work/repair")"
)
[ "$(ls -A "$work/held")" = .lock ] || fail "a refused run wrote $(ls -A "$work/held")"
expect 0 "dataset $whole" "${make[@]}" --out "$work/held"

# A run concurrent with a repair, which replaces the journal. One more run completes the result.
cp -r "$work/whole" "$work/repaired"
for shard in "$work"/repaired/shards/*; do printf '\x01' | dd of="$shard" bs=1 seek=100000 conv=notrunc status=none; done
"${make[@]}" --repair --out "$work/repaired" >"$work/first" 2>&1 &
first=$!
second=0
"${make[@]}" --repair --out "$work/repaired" >"$work/second" 2>&1 || second=$?
wait $first || second=1$second # either may be first
[ "$second" = 0 ] || grep -q "locked by" "$work/first" "$work/second" || { cat "$work/first" "$work/second"; fail "beside a repair: $second"; }
[ "$(hash_of "$work/repaired")" = "$whole" ] || fail "beside a repair: another hash"
[ "$(lines "$work/repaired")" = 50 ] || fail "beside a repair: $(lines "$work/repaired") lines for 50 shards"

# Many concurrent starts with two seeds: one config gets the folder, and the others report the reason.
starts=()
for i in 1 2 3 4 5 6; do
  "${make[@]}" --seed $((i % 2 + 1)) --out "$work/many" >"$work/start$i" 2>&1 &
  starts+=($!)
done
done=0
for i in 1 2 3 4 5 6; do
  if wait "${starts[i - 1]}"; then
    done=$((done + 1))
  else
    grep -qE "dataset in use|a dataset of another config" "$work/start$i" || { cat "$work/start$i"; fail "a wrong reason"; }
  fi
done
[ $done -ge 1 ] && [ $done -le 3 ] || fail "$done of six starts succeeded, three of each seed"
[ -n "$(hash_of "$work/many")" ] || fail "the data of many starts"

# Killed before dataset.json exists: the leftovers are recognised as such.
mkdir -p "$work/early/shards"
echo '{"format": "swingb' >"$work/early/.dataset.json.part"
touch "$work/early/.lock"
expect 0 "dataset $whole" "${make[@]}" --out "$work/early"
[ ! -e "$work/early/.dataset.json.part" ] || fail "a half-written header stayed"
for ((i = 0; i < 12; ++i)); do # killed at any moment of its start
  "${make[@]}" --out "$work/killed" >/dev/null 2>&1 &
  pid=$!
  sleep "0.0$((i * 8 / 10))$((i * 8 % 10))"
  kill -9 $pid
  wait $pid 2>/dev/null || true
done
expect 0 "dataset $whole" "${make[@]}" --out "$work/killed"

# Only files that generate itself writes count as leftovers, also where the folder is a symbolic link.
mv "$work/early/shards" "$work/elsewhere"
ln -s ../elsewhere "$work/early/shards"
touch "$work/elsewhere/thesis.part" "$work/elsewhere/.shard-000000.h5.part"
expect 0 "dataset $whole" "${make[@]}" --out "$work/early"
[ -e "$work/elsewhere/thesis.part" ] || fail "a file of somebody else was removed"
[ ! -e "$work/elsewhere/.shard-000000.h5.part" ] || fail "a leftover stayed"

# A refused run leaves nothing that blocks a valid one.
sed "s|\.\./networks|$SWINGBANK_SOURCE/configs/networks|" "$configs/ieee14_genrou_bus3.toml" >"$work/"$'b\xff.toml'
expect 1 "a name that is not UTF-8" "$generate" "$work/"$'b\xff.toml' --progress none --out "$work/refused"
[ ! -e "$work/refused" ] || fail "a refused start left $(ls -A "$work/refused")"
mkdir "$work/foreign" && touch "$work/foreign/letter"
expect 1 "it holds files but no dataset" "${make[@]}" --out "$work/foreign"
[ "$(ls -A "$work/foreign")" = letter ] || fail "a refused start left $(ls -A "$work/foreign")"
mkdir -p "$work/others/shards" && touch "$work/others/shards/letter"
expect 1 "it holds files but no dataset" "${make[@]}" --out "$work/others"
