#!/usr/bin/env bash
# swingbank compare on bad input: one message, exit code 1, no report.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
own_mounts

model=$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml
record=$SWINGBANK_SOURCE/configs/records/record-example/avr_ev1.csv
out=$work/out
mkdir "$out"
compare() { "$swingbank" compare --model "$1" --record "$2" --out "$out"; }
code=0
compare "$model" "$record" >/dev/null || code=$?
[[ $code == 3 ]] || fail "exit code $code: the cases below must fail for their own reason only" # 3: not adequate
[[ -s $out/report.html ]] || fail "no report.html"
find "${out:?}" -mindepth 1 -delete

refuses "no such plant" "$work/none.toml" compare "$work/none.toml" "$record"
refuses "no such record" "$work/none.csv" compare "$model" "$work/none.csv"
refuses "no such plant and record" "$work/none.csv" compare "$work/none.toml" "$work/none.csv"
refuses "plant that is no TOML" 'avr_ev1.csv' compare "$record" "$record"

line=$(grep -n '^H *=' "$model" | cut -d: -f1)
sed "${line}s/^H/Hx/" "$model" >"$work/key.toml"
refuses "unknown key" "key.toml:$line" compare "$work/key.toml" "$record"
sed "${line}d" "$model" >"$work/missing.toml"
refuses "missing parameter" 'missing.toml' compare "$work/missing.toml" "$record"
sed "${line}s/=.*/= \"five\"/" "$model" >"$work/type.toml"
refuses "wrong type" "type.toml:$line" compare "$work/type.toml" "$record"

sed '40,59s/,[^,]*,/,nan,/' "$record" >"$work/nan.csv"
refuses "a third of a second that is no number" 'nan.csv:40' compare "$model" "$work/nan.csv"
head -n 50 "$record" | sed '40s/,[^,]*$//' >"$work/short.csv"
refuses "missing column" 'short.csv:40' compare "$model" "$work/short.csv"
sed '41{h;d};42{G}' "$record" >"$work/order.csv"
refuses "a stretch that ends before it begins" '--from 5 with --until 3' "$swingbank" compare --model "$model" --record "$record" --from 5 --until 3
refuses "time that runs backwards" 'order.csv:42' compare "$model" "$work/order.csv"
leaves_nothing "$out"

disk "$work/full" 64k
out=$work/full
refuses "full disk" "$work/full" compare "$model" "$record"
# A complete playback file may remain, with the list by which the next run removes it. The report and partial files must
# be absent.
left=$(find "$work/full" -type f ! -name 'playback-*.csv' ! -name '.swingbank-compare')
[[ -z $left ]] || fail "left behind: $left"
out=$model/report
refuses "file in place of a folder" "$model" compare "$model" "$record"
