#!/usr/bin/env bash
# A run that is killed or stopped in the middle is resumed and ends with the same hash.
source "$(dirname "$0")/common.bash"
options=("$configs/ieee14_genrou_bus3.toml" --draws 1000 --draws-per-shard 20 --progress none)
"$generate" "${options[@]}" --out "$work/whole" >/dev/null 2>&1
whole=$(hash_of "$work/whole")

# kill -9 of one process.
"$generate" "${options[@]}" --out "$work/killed" >/dev/null 2>&1 &
pid=$!
wait_for_lines "$work/killed" 3
kill -9 $pid
wait $pid 2>/dev/null && fail "a killed process cannot succeed"
made=$(lines "$work/killed")
[ "$made" -lt 50 ] || fail "killed too late to prove anything"
head -c -30 "$work/killed/journal.jsonl" >"$work/cut" && cp "$work/cut" "$work/killed/journal.jsonl" # cuts the last line
expect 0 "dataset $whole" "$generate" "${options[@]}" --out "$work/killed"
[ "$(hash_of "$work/killed")" = "$whole" ] || fail "another hash after kill -9"
diff -r "$work/whole/shards" "$work/killed/shards" || fail "leftovers or other bytes after kill -9"

# A signal: exit code 2, and "submit again" resumes.
"$generate" "${options[@]}" --out "$work/soft" >/dev/null 2>&1 &
pid=$!
wait_for_lines "$work/soft" 2
kill -TERM $pid
code=0
wait $pid || code=$?
[ $code = 2 ] || fail "exit code $code after SIGTERM"
expect 0 "dataset $whole" "$generate" "${options[@]}" --out "$work/soft"
