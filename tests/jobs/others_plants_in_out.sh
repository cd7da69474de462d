#!/usr/bin/env bash
# swingbank plant and export: units of public PSS/E cases, extracted and written back.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
cases_of_others

# there_and_back NAME RAW DYR BUS [OPTION...]: extracts a unit, exports it, and extracts it again from the export
there_and_back() {
  local name=$1 raw=$cases/$2 dyr=$cases/$3 bus=$4
  shift 4
  "$swingbank" plant --raw "$raw" --dyr "$dyr" --bus "$bus" "$@" --out "$work/$name.toml" >/dev/null 2>"$work/notes" ||
    fail "$name: $(cat "$work/notes")"
  "$swingbank" export --model "$work/$name.toml" --out "$work/$name.dyr" >/dev/null
  local again=()
  while (($# > 0)); do # the written .dyr has no record to drop or replace
    case $1 in
    --drop | --replace) shift 2 ;;
    *) again+=("$1") && shift ;;
    esac
  done
  "$swingbank" plant --raw "$raw" --dyr "$work/$name.dyr" --bus "$bus" "${again[@]}" 2>/dev/null >"$work/again.toml" ||
    fail "the exported $name cannot be extracted"
  cmp <(grep -v '^ *#\|^standard' "$work/$name.toml") <(grep -v '^ *#\|^standard' "$work/again.toml") || fail "$name: the plant extracted from the export differs"
  echo "ok: $name"
}
there_and_back texas powerfulcases_activsg2000/ACTIVSg2000.raw powerfulcases_activsg2000/ACTIVSg2000.dyr 1048
there_and_back texas_high powerfulcases_activsg2000/ACTIVSg2000.raw powerfulcases_activsg2000/ACTIVSg2000.dyr 1048 --measured-at 1047
grep -q 'base_mva = 390.24 ' "$work/texas_high.toml" || fail "the power base is not the file's"
grep -q '^effect = "STEPUP"' "$work/texas_high.toml" || fail "no transformer"
there_and_back new_england griddyn_ieee39/IEEE39.raw griddyn_ieee39/IEEE39.dyr 31 --drop ESDC1A
there_and_back wecc gridpack_wecc240/240busWECC_2018_PSS_fixedshunt.raw gridpack_wecc240/240busWECC_2018_PSS_mod.dyr 1032 --id C --frequency-hz 60
there_and_back fourteen powerfulcases_ieee14/ieee14.raw powerfulcases_ieee14/ieee14_gensal.dyr 2
