#!/usr/bin/env bash
# swingbank diagnose: output files, exit codes, and one message for each bad input.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

model=$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml
records=$SWINGBANK_SOURCE/configs/records/record-example
one=$work/avr_ev1.csv two=$work/avr_ev2.csv
# Four seconds of every other sample contain the fault and the first swings, and take a fifth of the time of whole
# records.
for record in "$one" "$two"; do
  awk -F, '!/^[0-9]/ || (n++ % 2 == 0 && $1 <= 4)' "$records/$(basename "$record")" >"$record"
done

# the missing exciter is named from two events
status=0
script -qefc "'$swingbank' diagnose --model '$model' --records '$one' '$two' --power-only --threads 1 --out '$work/found' --json \
  >'$work/printed.json'" "$work/terminal" >/dev/null || status=$?
((status == 3)) || fail "exit code $status, expected 3"
# progress on a terminal states the percentage done, or that an optional search phase runs
tr '\r' '\n' <"$work/terminal" | sed 's/\x1b\[K//' | grep -E ' [0-9]+ of [0-9]+' >"$work/progress"
(($(wc -l <"$work/progress") > 20)) || fail "a terminal shows no progress: $(cat "$work/progress")"
! grep -vE '^(note|[0-9]+ % done(, about .* left)?: [a-z]|optional search phase: [a-z])' "$work/progress" >"$work/inner" ||
  fail "progress without a percentage: $(cat "$work/inner")"
sed -n 's/^\([0-9]*\) % done.*/\1/p' "$work/progress" | sort -n -c || fail "the percentage done decreases"
# the remaining time never rises [s], in the lines that state it
python3 - "$work/progress" <<'PYTHON'
import re, sys
last = None
for line in open(sys.argv[1]):
    told = re.search(r"about (?:(\d+) h )?(?:(\d+) min ?)?(?:(\d+) s )?left", line)
    if not told: continue
    h, m, s = (int(x or 0) for x in told.groups())
    left = 3600 * h + 60 * m + s
    assert last is None or left <= last, f"the time left rises from {last} s: {line}"
    last = left
assert last is not None, "no line states the time left"
PYTHON
cmp "$work/printed.json" "$work/found/diagnosis.json" || fail "--json prints something else than it writes"
# the same result with another number of threads, except command, time and duration
status=0
"$swingbank" diagnose --model "$model" --records "$one" "$two" --power-only --threads 2 --quiet --out "$work/again" >/dev/null || status=$?
((status == 3)) || fail "exit code $status with two threads, expected 3"
diff "$work/found/diagnosis.json" "$work/again/diagnosis.json" | grep '^[<>]' |
  grep -vE '"seconds": |"value": "(swingbank diagnose |[0-9-]+ [0-9:]+ UTC")' >"$work/differs" &&
  fail "two threads change the result: $(head -4 "$work/differs")"
fits_schema_of diagnosis "$work/found/diagnosis.json"
grep -q 'SEXS' "$work/found/report.html" || fail "the report does not name the exciter"
python3 - "$work/found/diagnosis.json" <<'PYTHON'
import json, sys
r = json.load(open(sys.argv[1]))
assert r["verdict"] in ("missing", "confusable") and r["effects"][0] == "SEXS", r["sentence"]
shares = {e["name"]: e["probability"] for e in r["probabilities"]}
assert shares["SEXS"] == max(shares.values()), shares
PYTHON

# a signal after the first sentence: the fits made so far are reported, with a separate exit code
"$swingbank" diagnose --model "$model" --records "$one" "$two" --power-only --threads 1 --out "$work/ended" \
  >"$work/ended.txt" 2>"$work/told" &
diagnosing=$!
for ((k = 0; k < 600; ++k)); do
  grep -q 'Preliminary' "$work/told" && break
  sleep 0.1
done
kill -TERM "$diagnosing"
status=0
wait "$diagnosing" || status=$?
((status == 2)) || fail "exit code $status after a signal, expected 2"
grep -qx 'stopping' "$work/told" || fail "the signal is not acknowledged"
grep -q 'Interrupted before a verdict' "$work/ended.txt" || fail "the interruption is not reported"
grep -q '"verdict": "interrupted"' "$work/ended/diagnosis.json" || fail "the JSON does not state the interruption"
fits_schema_of diagnosis "$work/ended/diagnosis.json"
[[ -s $work/ended/report.html ]] || fail "no page after a signal"

out=$work/out
mkdir "$out"
# refused WORDS ARGUMENT...: exit code 1, the words on stderr, nothing written
refused() {
  local words=$1 code=0
  shift
  "$swingbank" diagnose --out "$out/d" "$@" >"$work/text" 2>&1 || code=$?
  ((code == 1)) || fail "exit code $code, expected 1, with $*"
  grep -q -- "$words" "$work/text" || fail "'$words' expected, got: $(head -1 "$work/text")"
  [[ ! -e $out/d ]] || fail "something was written with $*"
}
refused 'records of two events or more' --model "$model" --records "$one"
refused 'no --record has that file name' --model "$model" --records "$one" "$two" --switch avr_ev9.csv=2
refused 'nowhere.csv' --model "$model" --records "$one" "$work/nowhere.csv"
refused 'nowhere.toml' --model "$work/nowhere.toml" --records "$one" "$two"
refused 'two records named' --model "$model" --records "$one" "$one"
head -20 "$one" >"$work/short.csv"
refused 'short.csv' --model "$model" --records "$one" "$work/short.csv"
