#!/usr/bin/env bash
# swingbank simulate on bad input: one message, exit code 1, no output.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
own_mounts

networks=$SWINGBANK_SOURCE/configs/networks
raw=$networks/ieee39_genrou.raw dyr=$networks/ieee39_genrou.dyr out=$work/out
mkdir "$out"
# simulate RAW DYR [OPTION...]
simulate() {
  local raw_file=$1 dyr_file=$2
  shift 2
  "$swingbank" simulate --raw "$raw_file" --dyr "$dyr_file" --out "$out/run.csv" --out "$out/run.h5" --t-end 3 "$@"
}
simulate "$raw" "$dyr" --fault 16:1:1.1 >/dev/null # succeeds, so each case below fails for its own reason only
rm "$out"/run.*

refuses "no such .raw" "$work/none.raw" simulate "$work/none.raw" "$dyr"
refuses "bus that is not there" '--fault 999' simulate "$raw" "$dyr" --fault 999:2:2.1
refuses "fault that ends before it starts" 'bus 16' simulate "$raw" "$dyr" --fault 16:2:1
misused "unknown option" 'nonsense' simulate "$raw" "$dyr" --nonsense 3

sed '3d' "$dyr" >"$work/missing.dyr"
refuses "generator without a model" 'bus 32 at .*missing.dyr' simulate "$raw" "$work/missing.dyr"
sed "4s/GENROU/GENFOO/" "$dyr" >"$work/unknown.dyr"
refuses "unknown model" 'unknown.dyr:4' simulate "$raw" "$work/unknown.dyr"
refuses "the way out of an unknown model" '--ignore-model GENFOO' simulate "$raw" "$work/unknown.dyr"
refuses "mapping to other parameters" 'GENCLS with 14 parameters' simulate "$raw" "$work/unknown.dyr" --map-model GENFOO=GENCLS
refuses "mapping without a model" "'GENFOO' at --map-model" simulate "$raw" "$work/unknown.dyr" --map-model GENFOO
refuses "ignored model that is not there" 'no model GENBAR' simulate "$raw" "$work/unknown.dyr" --ignore-model GENBAR
simulate "$raw" "$work/unknown.dyr" --map-model GENFOO=GENROU >/dev/null
sed '4s/^/30 "EXTRA" 1 1 2 3 \/\n/' "$dyr" >"$work/extra.dyr"
simulate "$raw" "$work/extra.dyr" --ignore-model extra | grep 'ignored (--ignore-model): EXTRA on line 4' >/dev/null
rm "$out"/run.*
refuses "frequency that contradicts the .raw" 'BASFRQ = 60 Hz' simulate "$raw" "$dyr" --frequency-hz 50
echo "mpc.version = '2';" >"$work/case.m"
refuses "MATPOWER case without a frequency" 'frequency-hz' simulate "$work/case.m" "$dyr"
refuses "MATPOWER case that is cut off" 'no branch at .*case.m' simulate "$work/case.m" "$dyr" --frequency-hz 60
sed '2s/1.8 1.7 0.4 /1.8 1.7 0.1 /' "$dyr" >"$work/reactances.dyr" # X'd below X''d and Xl
refuses "inconsistent reactances" 'reactances.dyr:2' simulate "$raw" "$work/reactances.dyr"
sed '5s/0.6 /abc /' "$dyr" >"$work/words.dyr"
refuses "word for a number" 'words.dyr:5' simulate "$raw" "$work/words.dyr"
sed '6s/7.3 /nan /' "$dyr" >"$work/nan.dyr"
refuses "not a number" 'nan.dyr:6' simulate "$raw" "$work/nan.dyr"

# Buses 20 and 34 are connected by transformer 19-20 alone (four lines of the file).
sed '/^ *19, 20, 0, /,+3d' "$raw" >"$work/part.raw"
"$swingbank" simulate --raw "$work/part.raw" --dyr "$dyr" --out "$work/part.csv" >"$work/said" 2>&1 || fail "an island of its own is refused"
grep -q 'islands without a slack bus get one at their largest generator: bus 34 of buses 20, 34' "$work/said" ||
  fail "an island without a slack bus is not reported: $(cat "$work/said")"
awk -F", *" -v OFS=", " '/end of bus/ {loads = 1} /end of load/ {loads = 0} loads && NF > 8 {$6 = $6 * 20} {print}' \
  "$raw" >"$work/heavy.raw"
refuses "power flow that diverges" 'heavy.raw' simulate "$work/heavy.raw" "$dyr"
head -c 3000 "$raw" >"$work/short.raw"
refuses "truncated .raw" 'short.raw' simulate "$work/short.raw" "$dyr"
refuses "run that fails at its start" 'the run failed at 0 s .*nothing was written' simulate "$raw" "$dyr" --tolerance 1e-16
leaves_nothing "$out"

disk "$work/full" 32k
refuses "full disk" "$work/full/run.csv" "$swingbank" simulate --raw "$raw" --dyr "$dyr" --out "$work/full/run.csv"
leaves_nothing "$work/full"
refuses "full disk, HDF5" "$work/full/run.h5" "$swingbank" simulate --raw "$raw" --dyr "$dyr" --out "$work/full/run.h5"
leaves_nothing "$work/full"
mount -o remount,ro "$work/full"
refuses "read-only disk" "$work/full/run.csv" "$swingbank" simulate --raw "$raw" --dyr "$dyr" --out "$work/full/run.csv"
refuses "file in place of a folder" "$raw/run.csv" "$swingbank" simulate --raw "$raw" --dyr "$dyr" --out "$raw/run.csv"
