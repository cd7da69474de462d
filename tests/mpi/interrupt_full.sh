#!/usr/bin/env bash
# A run on several ranks that is killed or stopped in the middle is resumed and ends with the same hash.
source "$(dirname "$0")/common.bash"
options=("$configs/ieee14_genrou_bus3.toml" --draws 1000 --draws-per-shard 20 --progress none)
"$generate" "${options[@]}" --out "$work/whole" >/dev/null 2>&1
whole=$(hash_of "$work/whole")

# kill -9 of one rank of three: mpirun ends the others, the next run continues.
mpirun --oversubscribe -np 3 "$generate" "${options[@]}" --out "$work/rank" >/dev/null 2>&1 &
pid=$!
wait_for_lines "$work/rank" 3
kill -9 "$(pgrep -P $pid -f "$work/rank" | tail -1)"
wait $pid && fail "mpirun cannot succeed without a rank"
expect 0 "dataset $whole" ranks 2 "$generate" "${options[@]}" --out "$work/rank"

# A signal to mpirun: exit code 2, and "submit again" resumes.
mpirun --oversubscribe -np 3 "$generate" "${options[@]}" --out "$work/usr1" >/dev/null 2>&1 &
pid=$!
wait_for_lines "$work/usr1" 2
kill -USR1 $pid
code=0
wait $pid || code=$?
[ $code = 2 ] || fail "exit code $code after SIGUSR1 to mpirun"
expect 0 "dataset $whole" "$generate" "${options[@]}" --out "$work/usr1"
