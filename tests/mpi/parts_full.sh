#!/usr/bin/env bash
# A dataset made in concurrent parts without a launcher, with one part killed and resumed, equals that of one run.
source "$(dirname "$0")/common.bash"
make=("$generate" "$configs/ieee14_genrou_bus3.toml" --draws 1200 --draws-per-shard 20 --progress none)
"${make[@]}" --out "$work/whole" >/dev/null 2>&1
whole=$(hash_of "$work/whole")
"$SWINGBANK_BIN/swingbank-databank" "$configs/ieee14_genrou_bus3.toml" --points 1200 --out "$work/bank.h5" >/dev/null

parts=()
for k in 1 2 3; do
  "${make[@]}" --databank "$work/bank.h5" --part $k/3 --out "$work/parts" >"$work/part$k" 2>&1 &
  parts+=($!)
done
for _ in $(seq 3000); do
  if [ -s "$work/parts/journal-2-of-3.jsonl" ]; then break; fi
  sleep 0.01
done
kill -9 "${parts[1]}" || fail "part 2 ended before it was killed"
for k in 0 2; do wait "${parts[k]}" || { cat "$work/part$((k + 1))"; fail "part $((k + 1))"; }; done
wait "${parts[1]}" 2>/dev/null || true
code=0
"$verify" "$work/parts" >"$work/log" 2>&1 || code=$?
[ $code = 2 ] || { cat "$work/log"; fail "exit code $code of verify before all parts are made"; }
expect 0 "dataset $whole" "${make[@]}" --part 2/3 --out "$work/parts"
diff -r "$work/whole/shards" "$work/parts/shards" || fail "other bytes in parts"
[ "$(hash_of "$work/parts")" = "$whole" ] || fail "another hash in parts"
expect 0 "dataset $whole" "${make[@]}" --out "$work/parts" # nothing remains to be done

# Another division, the same part twice, or a simultaneous whole run: refused.
expect 1 "-of-3.jsonl, which divides the dataset differently" "${make[@]}" --part 2/4 --out "$work/parts"
expect 1 "it is not of the form k/n" "${make[@]}" --part 4/3 --out "$work/x"
expect 1 "it is not of the form k/n" "${make[@]}" --part 2 --out "$work/x"
[ ! -e "$work/x" ] || fail "a refused part left a folder"
mkdir "$work/foreign" && touch "$work/foreign/letter"
expect 1 "it holds files but no dataset" "${make[@]}" --part 1/2 --out "$work/foreign"
[ "$(ls -A "$work/foreign")" = letter ] || fail "a refused part left $(ls -A "$work/foreign")"
(
  exec 9>>"$work/parts/.lock-2-of-3"
  flock 9
  expect 1 "part 2 of 3 in use at" "${make[@]}" --part 2/3 --out "$work/parts"
)
(
  exec 9>>"$work/parts/.lock"
  flock -s 9
  expect 1 "dataset in use at" "${make[@]}" --out "$work/parts"
  expect 0 "dataset $whole" "${make[@]}" --part 1/3 --out "$work/parts"
)

# A databank of another config, one with too few points, and a changed one are refused.
expect 1 "a databank of another config at $work/bank.h5" "${make[@]}" --seed 2 --databank "$work/bank.h5" --out "$work/y"
"$SWINGBANK_BIN/swingbank-databank" "$configs/ieee14_genrou_bus3.toml" --points 10 --out "$work/few.h5" >/dev/null
expect 1 "too few databank samples at $work/few.h5 (it has 10" "${make[@]}" --databank "$work/few.h5" --out "$work/z"
"$python3" -c "import h5py, sys; h5py.File(sys.argv[1], 'r+')['parameters'][0, 4] += 0.125" "$work/bank.h5"
expect 1 "changed databank at $work/bank.h5" "${make[@]}" --databank "$work/bank.h5" --out "$work/z"

# Damaged and repeated journal lines: refused, and repaired by --repair.
{ echo garbage; head -1 "$work/whole/journal.jsonl"; sed -n '2s/"rows":/&1/p' "$work/whole/journal.jsonl"; } >"$work/more"
cat "$work/more" >>"$work/whole/journal.jsonl"
expect 1 "damaged journal line at $work/whole/journal.jsonl:61" "${make[@]}" --out "$work/whole"
grep -q "damaged journal line at $work/whole/journal.jsonl:63" "$work/output" || { cat "$work/output"; fail "the changed line is not reported"; }
grep -q ":62" "$work/output" && fail "a repeated line is reported as damage"
expect 0 "dataset $whole" "${make[@]}" --repair --out "$work/whole"
[ "$(lines "$work/whole")" = 60 ] || fail "$(lines "$work/whole") lines after a repair"
diff -r "$work/whole/shards" "$work/parts/shards" || fail "other bytes after a repair"

# A finished read-only dataset is complete; an unfinished one reports the missing parts.
chmod -R a+rX "$work"
chmod a-w "$work/whole" "$work/whole/shards" "$work/whole/journal.jsonl" "$work/whole/.lock"
as_reader=()
if ((EUID == 0)); then as_reader=(setpriv --reuid=65534 --regid=65534 --clear-groups); fi
if "${as_reader[@]}" test -x "$generate"; then
  expect 0 "dataset $whole" "${as_reader[@]}" "${make[@]}" --out "$work/whole"
  rm "$work/whole/shards/shard-000003.h5"
  expect 1 "missing shard at $work/whole/shards/shard-000003.h5" "${as_reader[@]}" "${make[@]}" --out "$work/whole"
else
  echo "the programs are not readable by others: archives are not tried"
fi
chmod u+w "$work/whole"
