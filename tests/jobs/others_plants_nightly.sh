#!/usr/bin/env bash
# Plants of public PSS/E cases with their original values. One control at a time is removed from the model; the records
# are three simulated faults with noise. The diagnosis's set of 95 % probability must contain the removed control, or
# the effect of which it is a variant. SWINGBANK_PLANTS=REGEX selects plants. At most one may be missed: bus 31 of
# griddyn_ieee39 is at its exciter's limit.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
cases_of_others

# as_records FAULT... : $work/event<k>.csv of the unit $plant, as from a PMU: noise of 0.02 % on V, of 0.1 % of the
# unit's MVA on P and Q, of 0.01 degrees on the angle
as_records() {
  local k=0 fault
  for fault in "$@"; do
    k=$((k + 1))
    "$swingbank" simulate --raw "$raw" --dyr "$dyr" --widen-limits --fault "$fault" --rate 60 --t-end 10 --plants "$plant" \
      --channels P,Q --buses "$bus" --out "$work/run.csv" >/dev/null 2>"$work/errors" || fail "simulate: $(tail -3 "$work/errors")"
    awk -F, -v seed="$k" -v mva="$mva" '
      function noise() { return sqrt(-2 * log(1 - rand())) * cos(6.2831853 * rand()) }
      NR == 1 { srand(seed); print "t_s,V_pu,theta_rad,P_pu,Q_pu"; next }
      { printf "%.5f,%.7f,%.7f,%.7f,%.7f\n", $1, $4 * (1 + 2e-4 * noise()), $5 + 1.75e-4 * noise(),
          ($2 + 1e-3 * noise()) * mva / 100, ($3 + 1e-3 * noise()) * mva / 100 }' "$work/run.csv" >"$work/event$k.csv"
  done
}
tried=0 missed=()
# missing CASE RAW DYR BUS ID TAKEN EXPECTED FAULT...: diagnoses the unit without control TAKEN; the set must have
# EXPECTED
missing() {
  local name="$1 bus $4 $5 without $6" expected=$7 code=0 columns
  raw=$cases/$1/$2 dyr=$cases/$1/$3 bus=$4 plant=$4
  [[ $5 == 1 ]] || plant=$4:$5
  [[ $name =~ ${SWINGBANK_PLANTS:-.} ]] || return 0
  "$swingbank" plant --raw "$raw" --dyr "$dyr" --bus "$bus" --id "$5" --drop "$6" --out "$work/plant.toml" \
    >/dev/null 2>"$work/errors" || fail "$name: $(tail -3 "$work/errors")"
  mva=$(sed -nE 's/^base_mva = ([0-9.]+) .*machine base.*/\1/p' "$work/plant.toml")
  shift 7
  as_records "$@"
  SECONDS=0
  "$swingbank" diagnose --model "$work/plant.toml" --records "$work"/event*.csv --out "$work/found" >"$work/said" \
    2>"$work/errors" || code=$?
  ((code == 3 || code == 4)) || fail "$name: exit code $code: $(tail -5 "$work/said" "$work/errors")"
  columns=$(python3 - "$work/found/diagnosis.json" "$expected" <<'END'
import json, sys
d = json.load(open(sys.argv[1]))
inside = [p for p in d["probabilities"] if p["in_set"]]
print("found " if any(p["name"] == sys.argv[2] for p in inside) else "MISSED", end=" ")
print(", ".join(f"{p['name']} {100 * p['probability']:.0f} %" for p in inside))
END
  )
  tried=$((tried + 1))
  [[ $columns == found* ]] || missed+=("$name")
  echo "$name ($expected): $columns, $SECONDS s"
}
m39=(14:2:2.1 4:2:2.15 21:2:2.1)
for bus in 31 33 36 38; do missing griddyn_ieee39 IEEE39.raw IEEE39.dyr "$bus" 1 ESDC1A IEEET1 "${m39[@]}"; done
for bus in 32 36; do missing griddyn_ieee39 IEEE39.raw IEEE39.dyr "$bus" 1 TGOV1 TGOV1 "${m39[@]}"; done
for bus in 32 38; do
  for pair in "EXDC1 IEEET1" "WSIEG1 IEEEG1"; do
    missing gridpack_ieee39 IEEE39bus_multiloads_xfmr4_smallX_slackmvachange_v33_single.raw IEEE39bus_exdc1_gridpack.dyr \
      "$bus" 1 "${pair% *}" "${pair#* }" "${m39[@]}"
  done
done
for bus in 2 8; do
  for control in SEXS TGOV1; do
    missing powerfulcases_ieee14 ieee14.raw ieee14_gensal.dyr "$bus" 1 "$control" "$control" 4:2:2.1 9:2:2.15 5:2:2.1
  done
done
((tried > 0)) || fail "no plant like $SWINGBANK_PLANTS"
echo "$((tried - ${#missed[@]})) of $tried found"
((${#missed[@]} <= 1)) || fail "missed: ${missed[*]}"
