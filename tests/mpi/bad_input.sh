#!/usr/bin/env bash
# Every refused input gives an error message and a non-zero exit code, and leaves no half-written file.
source "$(dirname "$0")/common.bash"
make=("$generate" "$configs/ieee14_genrou_bus3.toml" --draws 40 --draws-per-shard 20 --progress none)
"${make[@]}" --out "$work/data" >/dev/null 2>&1
whole=$(hash_of "$work/data")

# Two runs in one folder: the second waits and is then refused. Other checks run meanwhile.
two_at_once() {
  exec 9<>"$work/data/.lock"
  flock 9
  expect 1 "dataset in use at" "${make[@]}" --out "$work/data"
}
mkdir "$work/busy"
cp -r "$work/data" "$work/busy"
(work=$work/busy && two_at_once) &
busy=$!

expect 1 "CONFIG (or --again) and --out are needed" "$generate"
expect 1 "--nonsense" "$generate" --nonsense
expect 1 "there is no such file" "$generate" "$work/no.toml" --out "$work/x"
expect 1 "a dataset of another config" "${make[@]}" --seed 2 --out "$work/data"
mkdir "$work/full" && touch "$work/full/letter"
expect 1 "it holds files but no dataset" "${make[@]}" --out "$work/full"
expect 1 "cannot create the folder" "${make[@]}" --out /proc/nowhere
[ "$(hash_of "$work/data")" = "$whole" ] || fail "a refused run changed the data"

# All config problems are reported at once, with lines.
sed -e "s|\.\./networks|$SWINGBANK_SOURCE/configs/networks|" -e 's/^seed = 1/sead = 1/' -e 's/^D = .*/D = [3.0, 0.0]/' -e 's/^t_end = .*/t_end = "15"/' -e 's/^generators = .*/generators = [3]/' "$configs/ieee14_genrou_bus3.toml" >"$work/bad.toml"
expect 1 "unknown key sead at $work/bad.toml:" "$generate" "$work/bad.toml" --out "$work/x"
if ! grep -q "low end lies above" "$work/output" || ! grep -q "must be a number" "$work/output"; then fail "not all problems at once"; fi
[ ! -e "$work/x" ] || fail "a refused config left a folder"
sed -e "s|\.\./networks|$SWINGBANK_SOURCE/configs/networks|" -e 's/^generators = .*/generators = [3, 4]/' -e 's/^except = .*/except = [77]/' "$configs/ieee14_genrou_bus3.toml" >"$work/bad.toml"
expect 1 "generator 4 of vary.generators" "$generate" "$work/bad.toml" --out "$work/x"
grep -q "bus 77 of fault.except" "$work/output" || fail "not all problems at once"

# A full disk, emulated by a limit on the file size.
(trap '' XFSZ; ulimit -f 200; expect 1 "bytes for the file at" "${make[@]}" --out "$work/limit")
[ -z "$(find "$work/limit/shards" -type f)" ] || fail "a half-written shard stayed"
expect 0 "$whole" "${make[@]}" --out "$work/limit"

# A file system without preallocation (error 95, EOPNOTSUPP): the data are written without it and are complete.
expect 0 "$whole" env LD_PRELOAD="$SWINGBANK_BIN/failing_call.so" FAILING_CALL=fallocate FAILING_ERROR=95 FAILING_AT=1 \
  FAILING_UNDER="$work/unreserved" FAILING_LOG="$work/failing" "${make[@]}" --out "$work/unreserved"
grep -q "^failed fallocate" "$work/failing" || fail "no space was preallocated: $(cat "$work/failing")"

# Damaged shards are detected and generated again.
truncate -s 1000 "$work/data/shards/shard-000001.h5"
expect 1 "truncated or changed shard" "$verify" "$work/data"
expect 1 "--repair" "${make[@]}" --out "$work/data"
expect 0 "$whole" "${make[@]}" --repair --out "$work/data"
printf '\x01' | dd of="$work/data/shards/shard-000000.h5" bs=1 seek=100000 conv=notrunc status=none
expect 1 "changed shard at $work/data/shards/shard-000000.h5" "$verify" "$work/data"
expect 0 "$whole" "${make[@]}" --repair --out "$work/data"

# The databank reports its progress.
sed -e "s|\.\./networks|$SWINGBANK_SOURCE/configs/networks|" -e 's/^distance = .*/distance = 1.5/' -e 's/^scale = .*/scale = "scaled"/' "$configs/ieee39_genrou.toml" >"$work/far.toml"
expect 1 "of 3000 samples" "$SWINGBANK_BIN/swingbank-databank" "$work/far.toml" --points 3000
expect 0 "accepted" "$SWINGBANK_BIN/swingbank-databank" "$configs/ieee39_genrou.toml" --points 100 --out "$work/bank.csv"
[ "$(wc -l <"$work/bank.csv")" = 101 ] || fail "bank.csv has not a heading and 100 points"

# Ranks started with different inputs do not mix their data.
expect 1 "ranks with different configs or builds" mpirun --oversubscribe -np 1 "${make[@]}" --out "$work/mixed" : -np 1 "${make[@]}" --seed 2 --out "$work/mixed"
[ ! -e "$work/mixed" ] || fail "mixed ranks left a folder"
wait $busy || fail "two at once on one folder"
