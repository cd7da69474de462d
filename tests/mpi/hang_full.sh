#!/usr/bin/env bash
# A rank that hangs does not block the others forever.
source "$(dirname "$0")/common.bash"
options=("$configs/ieee14_genrou_bus3.toml" --draws 5000 --draws-per-shard 20 --progress none)
timeout 60 mpirun --oversubscribe -np 2 "$generate" "${options[@]}" --lease-timeout 2 --out "$work/hung" >"$work/log" 2>&1 &
pid=$!
wait_for_lines "$work/hung" 1
mpirun_pid=$(pgrep -P $pid)
kill -STOP "$(pgrep -P "$mpirun_pid" -f "$work/hung" | tail -1)"
code=0
wait $pid || code=$?
if [ "$code" = 0 ] || [ "$code" = 124 ]; then fail "exit code $code of a run with a hung rank"; fi
grep -qE "is overdue at rank|no reply from rank 0" "$work/log" || { cat "$work/log"; fail "the hung rank is not reported"; }
