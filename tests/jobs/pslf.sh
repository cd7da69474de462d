#!/usr/bin/env bash
# A case as PSLF's .epc and .dyd: the same power flow and the same run as from PSS/E's .raw and .dyr, in simulate,
# inventory and plant.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

raw=$SWINGBANK_SOURCE/configs/networks/ieee39_genrou.raw dyr=${SWINGBANK_SOURCE}/configs/networks/ieee39_genrou.dyr
epc=$work/case.epc dyd=$work/case.dyd
/usr/bin/python3 "$SWINGBANK_SOURCE/tests/jobs/raw_to_pslf.py" "$raw" "$dyr" "$epc" "$dyd"

run=(--fault 5:0.2:0.3 --t-end 1 --rate 30 --buses "1,5,39")
"$swingbank" simulate --raw "$raw" --dyr "$dyr" "${run[@]}" --out "$work/psse.csv" >/dev/null
"$swingbank" simulate --epc "$epc" --dyd "$dyd" --frequency-hz 60 "${run[@]}" --out "$work/pslf.csv" >"$work/said" 2>&1 ||
  fail "simulate --epc --dyd: $(cat "$work/said")"
cmp "$work/psse.csv" "$work/pslf.csv" || fail "the runs differ"

"$swingbank" simulate --epc "$epc" --dyd "$dyd" --frequency-hz 60 --t-end 2 --out "$work/still.csv" >"$work/said" 2>&1
grep -q 'maximum change of rotor-angle differences 0.000 deg' "$work/said" || fail "the steady state is not kept: $(cat "$work/said")"

"$swingbank" inventory --epc "$epc" --dyd "$dyd" --frequency-hz 60 | holds -q '^10 units: 10 fully covered' ||
  fail "inventory"
same=(sed '/^#/d; /^origin/d; /^name/d')
"$swingbank" plant --raw "$raw" --dyr "$dyr" --bus 32 2>/dev/null | "${same[@]}" >"$work/psse.toml"
"$swingbank" plant --epc "$epc" --dyd "$dyd" --bus 32 --frequency-hz 60 2>/dev/null | "${same[@]}" >"$work/pslf.toml"
cmp "$work/psse.toml" "$work/pslf.toml" || fail "the plants differ: $(diff "$work/psse.toml" "$work/pslf.toml")"

# The .dyd's base takes precedence, and its records other than machines are named.
sed '/^genrou 32 /s/mva=[^ ]*/mva=900/' "$dyd" >"$work/other.dyd"
echo 'cmpldw 8 "BUS 8" 345 "1 " : #9 1 2 3' >>"$work/other.dyd"
"$swingbank" simulate --epc "$epc" --dyd "$work/other.dyd" --frequency-hz 60 --t-end 0.1 --out "$work/other.csv" >"$work/said" 2>&1
grep -q "'1' at bus 32: 900 MVA, not 843.7" "$work/said" || fail "the base is not named: $(cat "$work/said")"
grep -q '1 cmpldw' "$work/said" || fail "the ignored record is not named: $(cat "$work/said")"
echo 'pidgov 32 "BUS 32" 345 "1 " : #9 1 2 3' >>"$work/other.dyd"
refuses "a model whose columns are not known" "PSLF's model pidgov at .*other.dyd:24" "$swingbank" simulate --epc "$epc" --dyd "$work/other.dyd" --frequency-hz 60 --t-end 0.1 --out "$work/other.csv"
"$swingbank" simulate --epc "$epc" --dyd "$work/other.dyd" --frequency-hz 60 --ignore-model pidgov --t-end 0.1 --out "$work/other.csv" >"$work/said" 2>&1 ||
  fail "--ignore-model: $(cat "$work/said")"
sed 's/^pidgov/oddgov/' "$work/other.dyd" >"$work/odd.dyd"
refuses "an unknown model" "unknown model 'ODDGOV'" "$swingbank" simulate --epc "$epc" --dyd "$work/odd.dyd" --frequency-hz 60 --t-end 0.1 --out "$work/other.csv"
refuses "no frequency" "no frequency at .*case.epc" "$swingbank" simulate --epc "$epc" --dyd "$dyd" --t-end 0.1 --out "$work/other.csv"
sed 's/^bus data  \[39\]/bus data  [40]/' "$epc" >"$work/short.epc"
refuses "a lost record" "39 records in the bus section .*short.epc" "$swingbank" simulate --epc "$work/short.epc" --dyd "$dyd" --frequency-hz 60 --t-end 0.1 --out "$work/other.csv"
