#!/usr/bin/env bash
# A converter plant, from its .dyr through simulate and plant to compare, calibrate and the hypotheses of diagnose.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

networks=$SWINGBANK_SOURCE/configs/networks
raw=$networks/ieee39_genrou.raw
{
  grep -v '^32 ' "$networks/ieee39_genrou.dyr"
  echo "32 'REGCA1' 1 1 0.02 10 0.9 0.4 1.22 1.2 0.8 0.4 -1.3 0.02 0 100 -100 0.7 /"
  echo "32 'REECB1' 1 0 0 1 1 0 -99 99 0.02 -0.02 0.02 2 1.1 -1.1 0 0.05 0.6 -0.6 1.1 0.9 0.1 1 2 20 0.02 99 -99 1 0 1.3 0.02 /"
  echo "32 'REPCA1' 1 0 0 0 '0 ' 0 1 1 0.02 2 1 0 0.05 0.7 0 0 0 0.1 -0.1 0 0 0.6 -0.6 1 0.05 0.25 -0.0006 0.0006 99 -99 1 0 0.1 20 0 /"
} >"$work/case.dyr"

simulate() { "$swingbank" simulate --raw "$raw" --dyr "$work/case.dyr" --plants 32 --channels P,Q,V,theta "$@"; }
simulate --t-end 2 --out "$work/still.csv" >/dev/null
simulate --t-end 6 --rate 240 --fault 12:1:1.1 --out "$work/run.csv" >/dev/null
/usr/bin/python3 - "$work" <<'PYTHON'
import csv, sys
def table(name):
    with open(f"{sys.argv[1]}/{name}.csv") as file:
        rows = list(csv.reader(file))
    return {n: [float(v) for v in c] for n, c in zip(rows[0], zip(*rows[1:]))}
still, run = table("still"), table("run")
for name in ("32.P_pu", "32.Q_pu", "32.V_pu"):
    assert max(still[name]) - min(still[name]) < 1e-9, name
    assert max(run[name]) - min(run[name]) > 0.02, name
PYTHON

"$swingbank" plant --raw "$raw" --dyr "$work/case.dyr" --bus 32 --out "$work/plant.toml" >/dev/null
for section in converter electrical_control plant_control; do
  grep -q "^\[$section\]" "$work/plant.toml" || fail "the plant file has no [$section]"
done
"$swingbank" export --model "$work/plant.toml" | holds -q "^32 'REGCA1' '1' 1 0.02 10 " || fail "export writes another REGCA1"
# The record is per unit on the machine's base. A converter responds within 20 ms, hence 240 samples a second and the
# exact switching times.
sed -i '/^\[record\]/,/^base_mva/s/^base_mva = .*/base_mva = 843.7/' "$work/plant.toml"
compare() { "$swingbank" compare --record "$work/run.csv" --switch 1 --switch 1.1 "$@"; }
compare --model "$work/plant.toml" --out "$work/compared" >"$work/said" ||
  fail "its own run is not explained: $(cat "$work/said")"
sed 's/^Kvi = .*/Kvi = 5.0/; s/^Kqv = .*/Kqv = 0.5/' "$work/plant.toml" >"$work/wrong.toml"
compare --model "$work/wrong.toml" --out "$work/wrong" >"$work/said" &&
  fail "another gain was not noticed"

# Controls that belong to another kind of source are refused.
{
  cat "$work/case.dyr"
  echo "32 'SEXS' 1 0.1 10 50 0.1 -4 5 /"
} >"$work/mixed.dyr"
refuses "an exciter of a converter" "SEXS for generator 32 .*exciter belongs to a synchronous machine" \
  "$swingbank" simulate --raw "$raw" --dyr "$work/mixed.dyr" --out "$work/x.csv"
refuses "a plant control of a machine" "REPCA1 for plant 30 .*plant_control belongs to a converter" \
  "$swingbank" simulate --raw "$raw" --dyr "$work/case.dyr" --attach 30:REPCA1 --out "$work/x.csv"
grep -v REPCA1 "$work/case.dyr" >"$work/without.dyr"
grep -v REECB1 "$work/without.dyr" >"$work/source.dyr"
refuses "a step of a reference that no control reads" "Vref without effect at plant 32 .*the plant has no electrical_control" \
  "$swingbank" simulate --raw "$raw" --dyr "$work/source.dyr" --vref-step 32:1:0.02 --out "$work/x.csv"
simulate --t-end 2 --pref-step 32:1:0.02 --out "$work/step.csv" >/dev/null || fail "a step of a converter's Pref is refused"
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "32.P_pu") p = i } NR == 2 { first = $p } END { exit !($p > first + 0.001) }' \
  "$work/step.csv" || fail "P does not follow a step of Pref"
sed "s/^32 'REGCA1'.*/32 'CSVGN1' 1 20 0 1 0.15 1 0.005 0 2 -1 100 \//" "$work/without.dyr" >"$work/own.dyr"
refuses "a control of a converter that takes no commands" "REECB1 for generator 32 .*CSVGN1 takes no commands" \
  "$swingbank" simulate --raw "$raw" --dyr "$work/own.dyr" --out "$work/x.csv"
refuses "a plant control that measures nowhere" "bus 999, which REPCA1 of plant 32 measures, is not in service at --attach" \
  "$swingbank" simulate --raw "$raw" --dyr "$work/without.dyr" --attach 32:REPCA1:RemoteBus=999 --out "$work/x.csv"

# A source with built-in control (DERA1), and sources behind a reactance: each explains its own run, but not with a
# wrong gain.
explains_itself() { # NAME VALUES, .dyr records on stdin; VALUES: first values of the record NAME
  { grep -v '^32 ' "$networks/ieee39_genrou.dyr"; cat; } >"$work/case.dyr"
  simulate --t-end 6 --rate 240 --fault 12:1:1.1 --out "$work/run.csv" >/dev/null
  "$swingbank" plant --raw "$raw" --dyr "$work/case.dyr" --bus 32 --out "$work/plant.toml" >/dev/null
  "$swingbank" export --model "$work/plant.toml" | holds -q "^32 '$1' '1' $2" || fail "export writes another $1"
  sed -i '/^\[record\]/,/^base_mva/s/^base_mva = .*/base_mva = 843.7/' "$work/plant.toml"
  compare --model "$work/plant.toml" --out "$work/compared" >"$work/said" ||
    fail "$1 does not explain its own run: $(cat "$work/said")"
  sed 's/^Kqv = .*/Kqv = 0.5/' "$work/plant.toml" >"$work/wrong.toml"
  if compare --model "$work/wrong.toml" --out "$work/wrong" >"$work/said"; then fail "another gain beside $1 was not noticed"; fi
}
explains_itself DERA1 '0 1 0 1 1 0 0.02 0.02 ' <<'DYR'
32 'DERA1' 1 0 1 0 1 1 0 0.02 0.02 -0.05 0.05 5 0 0.02 0.02 20 20 -0.0006 0.0006 99 -99 1.1 0 0.5 -0.5 0.02 0.1 10 1.2
0.44 0.49 1.2 1.15 0.16 0.16 0.16 0.16 0.7 56.5 62 0.16 0.16 0.02 99 0.02 0.8 1 -1 /
DYR
explains_itself REGCB1 '0 0 0.02 0.02 100 ' <<'DYR'
32 'REGCB1' 1 0 0 0.02 0.02 100 -100 10 0.01 1.3 /
32 'REECB1' 1 0 0 1 1 0 -99 99 0.02 -0.02 0.02 2 1.1 -1.1 0 0.05 0.6 -0.6 1.1 0.9 0.1 1 2 20 0.02 99 -99 1 0 1.3 0.02 /
DYR
explains_itself REGCC1 '0 0 0.02 0.02 100 ' <<'DYR'
32 'REGCC1' 1 0 0 0.02 0.02 100 -100 10 0.02 1.3 1 100 10 500 10 -10 /
32 'REECB1' 1 0 0 1 1 0 -99 99 0.02 -0.02 0.02 2 1.1 -1.1 0 0.05 0.6 -0.6 1.1 0.9 0.1 1 2 20 0.02 99 -99 1 0 1.3 0.02 /
DYR
