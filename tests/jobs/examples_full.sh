#!/usr/bin/env bash
# examples/cpp is built in an empty folder against an installation, and its programs agree with the commands; the
# scripts of examples/python read one file of each format.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
prefix=$work/prefix build=$(cd "$SWINGBANK_BIN/.." && pwd)
cmake --install "$build" --prefix "$prefix" >"$work/log" 2>&1 || fail "cmake --install: $(tail -n 5 "$work/log")"
leaked=$(grep -rlF -e "$SWINGBANK_SOURCE" -e "$build" "$prefix/lib/cmake" "$prefix/include" || true)
[[ -z $leaked ]] || fail "the installed package names the build or source folder: $leaked"
for program in "$SWINGBANK_SOURCE"/examples/cpp/*.cpp; do
  (($(wc -l <"$program") <= 40)) || fail "$program is too long for an example"
done

# -Werror: the installed headers cause no warning with all warnings enabled.
cp -r "$SWINGBANK_SOURCE/examples/cpp" "$work/cpp"
cmake -S "$work/cpp" -B "$work/examples" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_CXX_FLAGS="-Wall -Wextra -Werror" >"$work/log" 2>&1 || fail "configuring the examples: $(tail -n 5 "$work/log")"
cmake --build "$work/examples" >"$work/log" 2>&1 || fail "building the examples: $(grep -m 5 error "$work/log")"

model=$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml records=$SWINGBANK_SOURCE/configs/records/record-example
record=$records/avr_ev1.csv
cd "$work"
examples/play_record "$model" "$record" >played || fail "play_record"
"$SWINGBANK_BIN/swingbank" compare --model "$model" --records "$record" --out compared --json >compared.json || (($? == 3)) ||
  fail "compare"
/usr/bin/python3 - played compared.json <<'PYTHON'
import json, re, sys

printed = {m[1]: float(m[2]) for m in re.finditer(r"^(\S+) +RMS error +(\S+)", open(sys.argv[1]).read(), re.M)}
event = json.load(open(sys.argv[2]))["events"][0]
whole = {c["name"]: c["whole"]["rms_pu"] for c in event["channels"]}
assert set(printed) == set(whole) and len(printed) >= 2, (printed, whole)
for name in ("P", "Q"):  # on a base of 100 MVA 1 pu is 100 MW
    assert abs(printed[name] / 100 - whole[name]) < 1e-3 * whole[name], (name, printed, whole)
PYTHON

examples/fit_parameters "$model" "$records"/avr_ev[1-4].csv >fitted || fail "fit_parameters"
for start in 'H: 6.5400' 'Xdp: 0.4000'; do
  grep -qF "GENROU.$start -> " fitted || fail "fit_parameters: $(cat fitted)"
done
examples/own_effect "$model" "$record" >added || fail "own_effect"
/usr/bin/python3 -c '
import re, sys
before, after = map(float, re.findall(r" ([0-9.]+) pu", sys.argv[1]))
assert before > 0 and after > 0 and before != after, sys.argv[1]' "$(cat added)" || fail "own_effect: $(cat added)"

# The examples refuse bad input with the messages of the commands.
refuses "no record" "no-record.csv" examples/play_record "$model" no-record.csv
refuses "no dataset" "no-dataset" examples/read_dataset no-dataset

datasets=$SWINGBANK_SOURCE/configs/datasets
"$SWINGBANK_BIN/swingbank" generate "$datasets/ieee14_genrou_bus3.toml" --draws 48 --draws-per-shard 24 --int16 --out data >log 2>&1 ||
  fail "generate: $(tail -n 2 log)"
"$SWINGBANK_BIN/swingbank" databank "$datasets/ieee14_genrou_bus3.toml" --points 100 --out bank.h5 >log 2>&1 || fail "databank"
"$SWINGBANK_BIN/swingbank" simulate --raw "$SWINGBANK_SOURCE/configs/networks/ieee14_genrou.raw" \
  --dyr "$SWINGBANK_SOURCE/configs/networks/ieee14_genrou.dyr" --fault 4:1:1.1 --t-end 3 --out run.h5 >log 2>&1 || fail "simulate"
examples/read_dataset data >dataset || fail "read_dataset"
python() { /usr/bin/python3 "$SWINGBANK_SOURCE/examples/python/$1.py" "${@:2}"; }
python read_dataset data >dataset.py || fail "read_dataset.py"
cmp <(grep -oE 'mean .*|: [0-9]+ records' dataset | sed 's/mean //; s/ = / /') \
  <(grep -oE '[A-Za-z0-9]+: mean .*|: [0-9]+ records' dataset.py | sed 's/: mean / /') || fail "read_dataset and read_dataset.py differ"
python read_databank bank.h5 >databank || fail "read_databank.py"
/usr/bin/python3 -c 'import sys; assert float(sys.argv[1].split()[-1]) >= 0.7, sys.argv[1]' "$(cat databank)" || fail "databank"
# printed LINE SCRIPT FILE
printed() { python "${@:2}" >printed && grep -q "^$1" printed || fail "$2.py does not print '$1'"; }
printed "stable: 0 to 3 s" read_run run.h5
printed 'records (plant: 5, channel: 9, time: 361) \[see channel_units\] records at the plants' show_axes run.h5
printed 'parameters (sample_id: [0-9]*, parameter: 14) \[see parameter_units\]' show_axes data/dataset.h5
printed 'parameters (point: 100, parameter: 14) ' show_axes bank.h5
printed '<xarray.Dataset>' show_axes bank.h5
printed "901 samples at 60.00/s" read_record "$record"
printed "GENROU.H = 6.54" read_plant "$model"
