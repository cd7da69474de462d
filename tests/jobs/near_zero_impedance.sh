#!/usr/bin/env bash
# Bus ties, star points and disconnected buses of a small case in swingbank simulate and plant.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

# case_of NAME BRANCH TRANSFORMER...: $work/NAME.raw, four buses and the given branches; bus 4 has the load
case_of() {
  local name=$1 branch=$2
  shift 2
  {
    printf '%s\n' "0, 100.0, 33, 0, 0, 60.0" "a grid" "and a unit"
    printf '%s\n' "1,'GRID',230.0,3,1,1,1,1.02,0.0" "2,'UNIT',20.0,2,1,1,1,1.03,4.0" "3,'HIGH',230.0,1,1,1,1,1.01,1.0" \
      "4,'LOAD',230.0,1,1,1,1,0.99,-3.0" "0 /" "4,'1',1,1,1,150.0,40.0" "0 /" "0 /"
    printf '%s\n' "1,'1',50,0,9999,-9999,1.02,0,1000,0,0.2" "2,'1',100,0,9999,-9999,1.03,0,150,0,0.25" "0 /"
    printf '%s\n' "1,4,'1',0.01,0.10,0.02" "1,3,'1',0.02,0.15,0.04" "$branch" "0 /"
    printf '%s\n' "$@" "0 /"
    for _ in {1..13}; do echo "0 /"; done
    echo Q
  } >"$work/$name.raw"
}
printf '%s\n' "1 'GENCLS' 1 5.0 0.0 /" "2 'GENROU' 1 6.0 0.05 0.8 0.06 4.0 0.0 1.8 1.7 0.3 0.5 0.25 0.15 0.05 0.3 /" \
  "2 'SEXS' 1 0.1 10.0 100.0 0.1 -4.0 5.0 /" >"$work/case.dyr"
simulate() {
  local name=$1
  shift
  "$swingbank" simulate --raw "$work/$name.raw" --dyr "$work/case.dyr" --t-end 3 --rate 60 --out "$work/$name.csv" "$@"
}
# largest A B: the largest difference of two CSV files
largest() {
  paste -d, "$work/$1.csv" "$work/$2.csv" | awk -F, 'NR > 1 { n = NF / 2; for (i = 2; i <= n; i++) { d = $i - $(i + n);
    if (d < 0) d = -d; if (d > most) most = d } } END { print most + 0 }'
}
below() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a < b) }'; }

gsu="2,3,0,'1',1,1,1,0,0,2,'',1"
fault=(--fault 3:1:1.1 --buses '1,2,3,4')
for x in 0.0 1e-9 1e-7 1e-6; do
  case_of "tie$x" "3,4,'1',0.0,$x" "$gsu" 0.003,0.09,100 1.0 1.0
  said=$(simulate "tie$x" "${fault[@]}" 2>&1) || fail "tie of $x: $said"
  grep -q '^stable at 3 s' <<<"$said" || fail "tie of $x: $said"
  case_of "regulator$x" "3,4,'1',0.01,0.08" "$gsu" "0.0,$x,100" 1.05 1.0
  said=$(simulate "regulator$x" "${fault[@]}" 2>&1) || fail "regulator of $x: $said"
  grep -q '^stable at 3 s' <<<"$said" || fail "regulator of $x: $said"
  for kind in tie regulator; do
    below "$(largest "$kind$x" "${kind}0.0")" 1e-5 || fail "$kind of $x: $(largest "$kind$x" "${kind}0.0") from 0"
  done
done

# Three windings: the star point has the internal number 5, which does not occur in the file.
case_of three "3,4,'1',0.01,0.08" "2,3,4,'1',1,1,1,0,0,2,'',1" \
  0.01,0.10,100,0.02,0.20,100,0.03,0.30,100,1.0,0.0 1.0 1.025 1.0
said=$(simulate three "${fault[@]}" 2>&1) || fail "zero star leg: $said"
grep -q '^stable at 3 s' <<<"$said" || fail "zero star leg: $said"
grep -Eq '\b5\b.*pu|bus 5' <<<"$said" && fail "the star point is reported as a bus: $said"
grep -q 'winding at bus 3 of 2-3-4' <<<"$said" || fail "the leg of zero is not named: $said"
head -n 1 "$work/three.csv" | grep -q bus5 && fail "a column of the star point"
simulate three --buses 5 >/dev/null 2>"$work/said" && fail "--buses 5 was accepted"
grep -q 'no bus 5' "$work/said" || fail "--buses 5: $(cat "$work/said")"
simulate three --trip 2:5:1:1 >/dev/null 2>"$work/said" && fail "--trip 2:5:1:1 was accepted"
grep -q 'no bus 5' "$work/said" || fail "--trip 2:5:1:1: $(cat "$work/said")"
# The winding at bus 2 connects only the unit. Each of these trips disconnects the unit, which runs on without load.
for trip in 2:3:1:1 2:3:4:1:1 4:3:2:1:1:1.1; do
  said=$(simulate three --trip "$trip" --integrator batch 2>&1) || fail "--trip $trip: $said"
done
simulate three --trip 2:3:1:1 --channels P >/dev/null 2>&1
p=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "2.P_pu") column = i } NR == 63 { print $column }' "$work/three.csv")
below "${p#-}" 1e-6 || fail "the unit behind its open winding delivers $p pu"

# A disconnected load is shed and reported; the rest of the grid runs on.
case_of radial "3,4,'1',0.01,0.08" "$gsu" 0.003,0.09,100 1.0 1.0
for integrator in reference batch; do
  said=$(simulate radial --trip 1:4:1:1 --trip 3:4:1:1 --integrator $integrator 2>&1) || fail "shed load: $said"
  grep -q 'bus 4 at 1 s: 150.00 MW, 40.00 Mvar' <<<"$said" || fail "shed load is not reported: $said"
  grep -q ' at 3 s' <<<"$said" || fail "shed load: $said"
  cp "$work/radial.csv" "$work/$integrator.csv"
done
below "$(largest reference batch)" 1e-4 || fail "shed load: the batch differs by $(largest reference batch)"
