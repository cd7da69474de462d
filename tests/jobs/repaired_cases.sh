#!/usr/bin/env bash
# A network file with errors that are repaired on request, and models with inactive blocks, in swingbank simulate.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

# case_of NAME LOAD BRANCH: $work/NAME.raw, four buses and the given load and branch
case_of() {
  {
    printf '%s\n' "0, 100.0, 33, 0, 0, 60.0" "a grid" "and a unit"
    printf '%s\n' "1,'GRID',230.0,3,1,1,1,1.02,0.0" "2,'UNIT',20.0,2,1,1,1,1.03,4.0" "3,'HIGH',230.0,1,1,1,1,1.01,1.0"
    printf '%s\n' "4,'LOAD',230.0,1,1,1,1,0.99,-3.0" "0 /" "4,'1',1,1,1,150.0,40.0 ! peak" ${2:+"$2"} "0 /" "0 /"
    printf '%s\n' "1,'1',50,0,9999,-9999,1.02,0,1000,0,0.2" "2,'1',100,0,9999,-9999,1.03,0,150,0,0.25" "0 /"
    printf '%s\n' "1,4,'1',0.01,0.10,0.02" "1,3,'1',0.02,0.15,0.04" "3,4,'1',0.01,0.08,0.03" ${3:+"$3"} "0 /"
    printf '%s\n' "2,3,0,'1',1,1,1,0,0,2,'',1" 0.003,0.09,100 1.0 1.0 "0 /"
    for _ in {1..13}; do echo "0 /"; done
    echo Q
  } >"$work/$1.raw"
}
machines=("1 'GENCLS' 1 5.0 0.0 /" "2 'GENROU' 1 6.0 0.05 0.8 0.06 4.0 0.0 1.8 1.7 0.3 0.5 0.25 0.15 0.05 0.3 /")
printf '%s\n' "${machines[@]}" "2 'SEXS' 1 0.1 10.0 100.0 0.1 -4.0 5.0 /" >"$work/case.dyr"
# simulate NAME [OPTION...]
simulate() {
  local name=$1
  shift
  "$swingbank" simulate --raw "$work/$name.raw" --dyr "$work/case.dyr" --fault 3:1:1.1 --t-end 3 --rate 60 --buses 1,2,3,4 \
    --out "$work/run.csv" "$@"
}

case_of whole '' ''
simulate whole >/dev/null 2>&1
cp "$work/run.csv" "$work/whole.csv"
case_of named '' "1,4,'2',0.01,0.10,0.02"
simulate named >/dev/null 2>&1
cp "$work/run.csv" "$work/named.csv"

case_of twice '' "1,4,'1',0.01,0.10,0.02"
refuses "repeated branch" "branch 1-4 circuit '1' appears twice at .*twice.raw:[0-9]+ .*--repeated voltages" simulate twice
simulate twice --repeated keep | holds -q "kept under a new id (--repeated keep): branch 1-4 circuit '1' .*as 'R1'" || fail "the kept branch is not named"
cmp -s "$work/run.csv" "$work/named.csv" || fail "the run differs from that with the branch under its own id"
simulate twice --repeated voltages | holds -q "is ignored, because the file's voltages contradict it" || fail "the branch that contradicts the voltages is not ignored"
cmp -s "$work/run.csv" "$work/whole.csv" || fail "the branch that contradicts the voltages is in the run"

case_of dangling "77,'1',1,1,1,5.0,1.0" "4,77,'1',0.01,0.1"
refuses "missing bus" 'bus 77 is not in the bus section at .*leave the equipment out with --drop-refused' simulate dangling
simulate dangling --drop-refused | holds -q 'load record at bus 77 .*; branch record at bus 77' || fail "dangling equipment is not named"
cmp -s "$work/run.csv" "$work/whole.csv" || fail "dangling equipment changes the run"

sed 3d "$work/whole.raw" >"$work/title.raw"
refuses "missing title line" 'line 3 looks like a bus record at .*title.raw:3' simulate title

# A feedback with zero gain needs no time constant; with a gain it does.
printf '%s\n' "${machines[@]}" "2 'EXST1' 1 0.01 0.1 -0.1 1.0 10.0 200.0 0.0 6.0 -5.0 0.05 0.0 0.0 /" >"$work/case.dyr"
simulate whole | holds -q '^stable at 3 s' || fail "EXST1 without feedback and regulator lag does not run"
sed -i "s/0.05 0.0 0.0/0.05 0.03 0.0/; s/200.0 0.0 6.0/200.0 0.02 6.0/" "$work/case.dyr"
refuses "feedback without a time constant" 'TF = 0 s .*KF = 0, which switches the block off' simulate whole
