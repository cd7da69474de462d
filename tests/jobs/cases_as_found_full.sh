#!/usr/bin/env bash
# Unmodified public PSS/E cases, stored next to $SWINGBANK_REFERENCE. Each runs with the options that the messages
# name, lists the modifications on one screen, and stays in steady state without a fault.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
cases_of_others

# holds_still NAME SECONDS RAW DYR [OPTION...]: largest change of any recorded channel below 1e-9
holds_still() {
  local name=$1 seconds=$2 raw=$cases/$3 dyr=$cases/$4 ignore=()
  shift 4
  local run=("$swingbank" simulate --raw "$raw" --dyr "$dyr" "$@" --net-generators --widen-limits --t-end "$seconds"
    --rate 4 --channels 'speed,P,V' --changes "$work/$name.txt" --out "$work/$name.csv")
  # Unsupported models are ignored by the names that the messages give.
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
holds_still fourteen 5 powerfulcases_ieee14/ieee14.raw powerfulcases_ieee14/ieee14_gensal.dyr
holds_still fourteen_p 5 powerfulcases_ieee14/ieee14.raw powerfulcases_ieee14/ieee14_gentpj1.dyr
holds_still new_england 5 griddyn_ieee39/IEEE39.raw griddyn_ieee39/IEEE39.dyr
holds_still gridpack39 5 gridpack_ieee39/IEEE39bus_multiloads_xfmr4_smallX_slackmvachange_v33_single.raw \
  gridpack_ieee39/IEEE39bus_exdc1_gridpack.dyr
holds_still four 5 psid_fourbus/FourBusMulti.raw psid_fourbus/FourBus_multigen.dyr
holds_still steps39 5 steps_ieee39/IEEE39.raw steps_ieee39/IEEE39.dyr
holds_still wecc179 5 griddyn_wecc179/powerflowWECC.raw griddyn_wecc179/dynamicsWECC.dyr --raw-version 30 --frequency-hz 60
holds_still wecc240 5 gridpack_wecc240/240busWECC_2018_PSS_fixedshunt.raw \
  gridpack_wecc240/240busWECC_2018_PSS_mod.dyr --frequency-hz 60 --complete-records zero
holds_still three_hundred 5 gridpack_300bus_cmpld/300bus_v23_no0imp_pslf.raw \
  gridpack_300bus_cmpld/300bus_detail_model_cmpld_combine.dyr --raw-version 23 --frequency-hz 60 --devices file
holds_still two_thousand 5 powerfulcases_activsg2000/ACTIVSg2000.raw powerfulcases_activsg2000/ACTIVSg2000.dyr
holds_still texas 5 gridpack_texas2000/texas2000_hr_4882_mod_33.raw \
  gridpack_texas2000/texas2000_v23_fullsys_noac_wind_mod.dyr --complete-records zero
