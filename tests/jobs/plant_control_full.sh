#!/usr/bin/env bash
# A converter plant behind a cable, with a plant control of the voltage at the point of common coupling, where it is
# recorded. With a point file the model from the case is adequate; it is inadequate if the control is assumed to
# measure at the converter's own bus.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

ends() { for _ in $(seq "$1"); do echo "0 / end"; done; }
{
  printf '0, 100.0, 33, 0, 1, 60.0 / four buses\nconverter plant behind a cable\n\n'
  printf "101,'GRID',138.0,3,1,1,1,1.05,0.0\n102,'POINT',138.0,1,1,1,1,1.0,0.0\n103,'LOAD',138.0,1,1,1,1,1.0,-8.0\n104,'PLANT',138.0,2,1,1,1,1.03,3.0\n"
  ends 1
  printf "103,'1',1,1,1,250.0,30.0,0,0,0,0,1,1,0\n"
  ends 2
  printf "101,'1',153.0,73.0,100,-100,1.05,0,200,0,0.25,0,0,1,1,100,318,0,1,1\n104,'1',80.0,0.0,50,-50,1.03,0,100,0,9999.0,0,0,1,1,100,318,0,1,1\n"
  ends 1
  printf "101,103,'1',0.01,0.12,0.0\n102,103,'1',0.01,0.12,0.0\n102,104,'1',0.002,0.06,0.05\n"
  ends 15
  echo Q
} >"$work/case.raw"
cat >"$work/case.dyr" <<'END_OF_DYR'
101 'GENROU' 1 8.0 0.03 0.4 0.05 6.175 0.05 1.8 1.7 0.3 0.55 0.25 0.2 0.1 0.8 /
104 'REGCA1' 1 0 0.02 10 0.9 0.4 1.22 1.2 0.9 0.5 -1.3 0.2 0 100 -100 0 /
104 'REECB1' 1 0 0 0 0 0 -99 99 0.02 -0.01 0.01 0 1.1 -1.1 0 0 0.6 -0.6 1.05 0.9 0 0.01 10 60 0.02 99 -99 1.2 0 1.11 0.02 /
104 'REPCA1' 1 102 102 103 '1' 0 1 1 0.02 2.0 4.0 0 0.05 0.5 0 0 0.02 0.1 -0.1 0 0 0.6 -0.6 0.5 0.3 0.25
 -0.0004 0.0004 99 -99 1.2 0 0.1 10 10 /
END_OF_DYR
"$swingbank" simulate --raw "$work/case.raw" --dyr "$work/case.dyr" --fault 103:2:2.1:0:0.3 --rate 60 --t-end 12 --plants 104 \
  --channels P,Q --buses 102,104 --out "$work/run.csv" >"$work/said" 2>&1 || fail "simulate: $(cat "$work/said")"
# V and angle of the point, and P and Q into it at the end of the cable; noise of 0.02 % and 0.1 MW
awk -F, 'function noise() { return sqrt(-2 * log(1 - rand())) * cos(6.2831853 * rand()) }
  NR == 1 { srand(1); print "t_s,V_pu,theta_rad,P_MW,Q_Mvar"; next }
  { ar = $4 * cos($5); ai = $4 * sin($5); br = $6 * cos($7); bi = $6 * sin($7)
    r = 0.002; x = 0.06; z = r * r + x * x; dr = br - ar; di = bi - ai
    ir = (dr * r + di * x) / z + 0.025 * ai; ii = (di * r - dr * x) / z - 0.025 * ar
    printf "%.5f,%.7f,%.7f,%.5f,%.5f\n", $1, $4 * (1 + 2e-4 * noise()), $5 + 2e-4 * noise(),
      100 * (ar * ir + ai * ii) + 0.1 * noise(), 100 * (ai * ir - ar * ii) + 0.1 * noise() }' "$work/run.csv" >"$work/event.csv"

"$swingbank" plant --raw "$work/case.raw" --dyr "$work/case.dyr" --bus 104 --out "$work/plant.toml" >"$work/said" 2>&1 ||
  fail "plant: $(cat "$work/said")"
grep -q 'REPCA1 measures at bus 102' "$work/said" "$work/plant.toml" || fail "plant says: $(cat "$work/said")"
printf '[collector]\nr_pu = 0.002\nx_pu = 0.06\nb_pu = 0.05\nbase_mva = 100.0\n[[unit]]\nmodel = "plant.toml"\n' >"$work/point.toml"
compare() { "$swingbank" compare --model "$1" --records "$work/event.csv" --point "$work/point.toml" --out "$2" >"$work/said" 2>&1; }
compare "$work/plant.toml" "$work/right" || fail "the right model: $(cat "$work/said")"
sed -E 's/^(RemoteBus|FromBus|ToBus) = [0-9.]+/\1 = 0/' "$work/plant.toml" >"$work/near.toml"
sed -i 's/plant.toml/near.toml/' "$work/point.toml"
code=0
compare "$work/near.toml" "$work/wrong" || code=$?
((code == 3)) || fail "measured at its own bus: exit code $code, not 3: $(cat "$work/said")"
grep -q '^Fit for purpose: no (1 of .* RMS error of Q after the last switching' "$work/said" ||
  fail "measured at its own bus: more than the movement of Q is wrong: $(cat "$work/said")"
echo "with the point: adequate; at its own bus: $(grep -m1 -i 'not adequate' "$work/said")"
