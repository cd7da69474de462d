#!/usr/bin/env bash
# Public PSS/E cases as they are found, read where they lie beside $SWINGBANK_REFERENCE: each runs with the options that
# the messages name, says what was done to it on one screen, and holds still without a fault; or it is refused by name.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

cases=${SWINGBANK_REFERENCE:-$SWINGBANK_SOURCE/../shared/reference}/../cases
if [[ ! -d $cases ]]; then
  echo "skipped: no cases at $cases"
  exit 0
fi

# holds NAME SECONDS RAW DYR [OPTION...]: largest change of any recorded channel below 1e-9
holds() {
  local name=$1 seconds=$2 raw=$cases/$3 dyr=$cases/$4 ignore=()
  shift 4
  local run=("$swingbank" simulate --raw "$raw" --dyr "$dyr" "$@" --net-generators --widen-limits --t-end "$seconds"
    --rate 20 --channels 'speed,P,V' --changes "$work/$name.txt" --out "$work/$name.csv")
  # The models that are not here yet are ignored by the names that the messages give.
  if ! "${run[@]}" >"$work/said" 2>"$work/warned"; then
    mapfile -t ignore < <(sed -nE "s/.*--ignore-model ([A-Z0-9_]+).*/--ignore-model\n\1/p" "$work/warned")
    "${run[@]}" "${ignore[@]}" >"$work/said" 2>"$work/warned" || fail "$name: $(head -5 "$work/warned")"
  fi
  grep -q "^stable at $seconds s" "$work/said" || fail "$name: $(cat "$work/said")"
  python3 - "$work/$name.csv" "$name" <<'END' || fail "$name moves"
import csv, sys
rows = [[float(v) for v in r[1:]] for r in list(csv.reader(open(sys.argv[1])))[1:]]
worst = max(abs(v - first) for row in rows for v, first in zip(row, rows[0]))
print(f"ok: {sys.argv[2]} holds to {worst:.1e}")
sys.exit(worst > 1e-9)
END
  local lines
  lines=$(cat "$work/said" "$work/warned" | wc -l)
  ((lines <= 24)) || fail "$name: more than a screen: $lines lines"
}
# refused WHAT RAW DYR [OPTION...]: faults of the files that nothing here mends, each named
refused() {
  local what=$1 raw=$cases/$2 dyr=$cases/$3
  shift 3
  if "$swingbank" simulate --raw "$raw" --dyr "$dyr" "$@" --net-generators --widen-limits --t-end 0.1 \
    --out "$work/refused.csv" >"$work/said" 2>"$work/warned"; then
    fail "$raw is not refused"
  fi
  grep -qF "$what" "$work/warned" || fail "$raw: $(head -5 "$work/warned")"
  [[ ! -e $work/refused.csv ]] || fail "$raw leaves a file"
}
holds fourteen 2 powerfulcases_ieee14/ieee14.raw powerfulcases_ieee14/ieee14_gensal.dyr
holds fourteen_p 2 powerfulcases_ieee14/ieee14.raw powerfulcases_ieee14/ieee14_gentpj1.dyr
holds new_england 2 griddyn_ieee39/IEEE39.raw griddyn_ieee39/IEEE39.dyr
holds gridpack39 2 gridpack_ieee39/IEEE39bus_multiloads_xfmr4_smallX_slackmvachange_v33_single.raw \
  gridpack_ieee39/IEEE39bus_exdc1_gridpack.dyr
holds four 2 psid_fourbus/FourBusMulti.raw psid_fourbus/FourBus_multigen.dyr
holds two_thousand 0.2 powerfulcases_activsg2000/ACTIVSg2000.raw powerfulcases_activsg2000/ACTIVSg2000.dyr
refused "T'qo = 0.000000 s" griddyn_wecc179/powerflowWECC.raw griddyn_wecc179/dynamicsWECC.dyr --raw-version 30 \
  --frequency-hz 60
refused 'incomplete record' steps_ieee39/IEEE39.raw steps_ieee39/IEEE39.dyr
refused 'they are no solution' gridpack_300bus_cmpld/300bus_v23_no0imp_pslf.raw \
  gridpack_300bus_cmpld/300bus_detail_model_cmpld_combine.dyr --raw-version 23 --frequency-hz 60
