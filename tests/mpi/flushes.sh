#!/usr/bin/env bash
# Data are on the disk before their final name exists: each shard is flushed after its last write and before its
# renaming, its folder after the renaming, and each journal line before the next shard. failing_call.cpp records the
# calls.
source "$(dirname "$0")/common.bash"
trace() { # NAME COMMAND...: records the command's file calls below $work/NAME in $work/NAME.trace
  local name=$1
  shift
  FAILING_ERROR=trace FAILING_UNDER=$work/$name FAILING_LOG=$work/$name.trace LD_PRELOAD=$SWINGBANK_BIN/failing_call.so \
    "$@" --out "$work/$name" --progress none >"$work/log" 2>&1 || { cat "$work/log" >&2; fail "$*"; }
}
cat >"$work/check.py" <<'PYTHON'
import os, sys
unflushed, flushed, named, journal = set(), set(), 0, 0
waiting = None  # folder of a renamed shard, not flushed yet
for line in open(sys.argv[1]):
    kind, _, rest = line.rstrip("\n").partition(" ")
    if kind != "trace": continue
    call, _, path = rest.partition(" ")
    if "write" in call:
        unflushed.add(path)
    elif call == "fsync":
        unflushed.discard(path)
        flushed.add(path)
        if path == waiting: waiting = None
        journal += path.endswith("journal.jsonl")
    elif call == "rename" and "/shards/" in path:
        if path in unflushed or path not in flushed: sys.exit(f"{path} gets its name before it is flushed")
        if waiting: sys.exit(f"{waiting} is not flushed after a shard in it got its name")
        if any(p.endswith("journal.jsonl") for p in unflushed): sys.exit("a line of the journal is not flushed")
        waiting = os.path.dirname(path)
        named += 1
if any(p.endswith("journal.jsonl") for p in unflushed): sys.exit("the journal's last line is not flushed")
if named != int(sys.argv[2]): sys.exit(f"{named} shards got a name, not {sys.argv[2]}")
if journal < named: sys.exit(f"the journal was flushed {journal} times for {named} shards")
PYTHON
check() { "$python3" "$work/check.py" "$1" 10 2>&1; }
trace whole "$generate" "$configs/ieee14_genrou_bus3.toml" --draws 200 --draws-per-shard 20
check "$work/whole.trace" || fail "generate"
trace merged "$SWINGBANK_BIN/swingbank-merge" "$work/whole"
check "$work/merged.trace" || fail "merge"
# The check detects missing flushes.
grep -v 'fsync .*\.part$' "$work/whole.trace" >"$work/no_shard.trace"
check "$work/no_shard.trace" >"$work/said" && fail "a shard that is not flushed is not detected"
grep -q 'before it is flushed' "$work/said" || fail "the message about the shard: $(cat "$work/said")"
grep -v 'fsync .*journal.jsonl$' "$work/whole.trace" >"$work/no_journal.trace"
check "$work/no_journal.trace" >"$work/said" && fail "a journal that is not flushed is not detected"
grep -q 'journal' "$work/said" || fail "the message about the journal: $(cat "$work/said")"
