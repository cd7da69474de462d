#!/usr/bin/env bash
# swingbank inventory, plant and export: a unit extracted from its case and written back as PSS/E and PSLF records
# (public cases: others_plants_in_out.sh).
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

networks=$SWINGBANK_SOURCE/configs/networks
raw=$networks/ieee39_genrou.raw dyr=$networks/ieee39_genrou.dyr

# Extracted, exported, extracted again: the same file.
"$swingbank" plant --raw "$raw" --dyr "$dyr" --bus 32 --out "$work/plant.toml" >"$work/said"
grep -q "^wrote $work/plant.toml" "$work/said" || fail "plant says: $(cat "$work/said")"
"$swingbank" export --model "$work/plant.toml" --out "$work/plant.dyr" >/dev/null
"$swingbank" plant --raw "$raw" --dyr "$work/plant.dyr" --bus 32 >"$work/again.toml" 2>/dev/null
cmp <(grep -v '^#' "$work/plant.toml") <(grep -v '^#' "$work/again.toml") || fail "the plant extracted from the export differs"
"$swingbank" plant --raw "$raw" --dyr "$dyr" --bus 32 2>/dev/null | cmp - "$work/plant.toml" || fail "--out writes something else than is printed"
cmp <("$swingbank" export --model "$work/plant.toml") "$work/plant.dyr" || fail "export --out writes something else than is printed"
"$swingbank" export --model "$work/plant.toml" --bus 7 --id B | holds -q "^7 'GENROU' 'B' " || fail "export --bus --id"

# A case without nominal voltages (1 kV at every bus) gives no voltage base, which is reported.
sed "s/', 345, /', 1, /" "$raw" >"$work/per_unit.raw"
"$swingbank" plant --raw "$work/per_unit.raw" --dyr "$dyr" --bus 32 >"$work/per_unit.toml" 2>"$work/notes"
grep -q '^base_kv' "$work/per_unit.toml" && fail "1 kV is taken for a nominal voltage"
grep -q 'no nominal voltage (BASKV = 1 kV): for records in kV write base_kv' "$work/notes" || fail "the missing nominal voltage is not reported: $(cat "$work/notes")"
grep -q '^# base_kv =  # nominal line-to-line voltage' "$work/per_unit.toml" || fail "the file does not ask for base_kv"
! grep -q 'BASKV' "$work/per_unit.toml" || fail "the file keeps a note that is wrong once base_kv is filled in"
for k in 1 2; do
  { echo t_s,V_kV,theta_deg,P_MW,Q_Mvar && seq 0 0.02 10 | sed 's/$/,345,0,600,100/'; } >"$work/kv$k.csv"
done
status=0
"$swingbank" compare --model "$work/per_unit.toml" --records "$work"/kv[12].csv --out "$work/no" 2>"$work/words" >&2 || status=$?
((status == 1)) || fail "compare without base_kv: exit code $status"
[[ $(grep -c 'add base_kv under \[record\]' "$work/words") == 1 ]] || fail "the missing base_kv is not named exactly once: $(cat "$work/words")"
grep -q 'kv1.csv.*kv2.csv' "$work/words" || fail "the missing base_kv is not named for both records"

# Exported to PSLF and read back: the same plant, with controls; Ra and mva of the .dyd take precedence.
{
  cat "$work/plant.toml"
  "$swingbank" effects --toml SEXS TGOV1
} >"$work/controlled.toml"
"$swingbank" export --model "$work/controlled.toml" --format dyd --bus-name NORTH --kv 20 >"$work/plant.dyd"
grep -qE '^genrou +32 "NORTH +" 20 "1 " : #9 mva=[0-9.]+ "tpdo" ' "$work/plant.dyd" || fail "export --dyd: $(cat "$work/plant.dyd")"
"$swingbank" plant --raw "$raw" --dyd "$work/plant.dyd" --bus 32 >"$work/again.toml" 2>"$work/notes" || fail "plant --dyd: $(cat "$work/notes")"
values() { sed 's/ *#.*//; /^$/d; /^origin/d; /^base_kv/d; /^name/d' "$1" | sort; } # blocks in whatever order
cmp <(values "$work/controlled.toml") <(values "$work/again.toml") || fail "the plant extracted from the PSLF export differs"
sed 's/"ra" [^ ]*/"ra" 0.004/; s/mva=[^ ]*/mva=450/' "$work/plant.dyd" >"$work/other.dyd"
"$swingbank" plant --raw "$raw" --dyd "$work/other.dyd" --bus 32 2>"$work/notes" | holds -qE '^Ra = 0.004 ' || fail "the Ra of the .dyd is not used"
grep -q '450 MVA' "$work/notes" || fail "the base of the .dyd is not reported: $(cat "$work/notes")"
sed 's/"xcomp" [^ ]*/"xcomp" -0.05/' "$work/plant.dyd" >"$work/other.dyd"
refuses "a compensated machine" "xcomp = -0.05 of genrou .*other.dyd" "$swingbank" plant --raw "$raw" --dyd "$work/other.dyd" --bus 32
refuses "neither" "no dynamic models" "$swingbank" plant --raw "$raw" --bus 32
sed '/^base_kv/d' "$work/controlled.toml" >"$work/no_kv.toml"
refuses "no kV" "no nominal voltage" "$swingbank" export --model "$work/no_kv.toml" --format dyd

# Unknown records of other units are ignored; those of the unit are named with their line, and dropped or replaced.
{
  cat "$dyr"
  echo "30 'STRANGE' 1 1 2 3 /"
  echo "32 'ESAC9Z' 1 1 2 3 /"
} >"$work/more.dyr"
line=$(wc -l <"$work/more.dyr")
refuses "its own unknown model" "unknown model 'ESAC9Z' .*more.dyr:$line .*--drop ESAC9Z" \
  "$swingbank" plant --raw "$raw" --dyr "$work/more.dyr" --bus 32
grep -q STRANGE "$work/stderr" && fail "another unit's model was named"
"$swingbank" plant --raw "$raw" --dyr "$work/more.dyr" --bus 32 --drop ESAC9Z >"$work/dropped.toml" 2>"$work/notes"
grep -q "ESAC9Z of line $line ignored" "$work/notes" || fail "the dropped record is not reported: $(cat "$work/notes")"
"$swingbank" plant --raw "$raw" --dyr "$work/more.dyr" --bus 32 --replace ESAC9Z=SEXS >"$work/replaced.toml" 2>"$work/notes"
grep -q 'default_values = true' "$work/replaced.toml" || fail "a replacement by a model with other parameters has no default values"
refuses "no such bus" "no bus 4711" "$swingbank" plant --raw "$raw" --dyr "$dyr" --bus 4711
refuses "no unit there" "no generator at bus 16" "$swingbank" plant --raw "$raw" --dyr "$dyr" --bus 16
sed '/^bus = 2/d' "$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml" >"$work/no_bus.toml"
refuses "no bus number" "no bus number" "$swingbank" export --model "$work/no_bus.toml"
misused "no bus" "bus" "$swingbank" plant --raw "$raw" --dyr "$dyr"

# The message has one line for each model, not for each record.
for bus in 31 33 34; do echo "$bus 'STRANGE' 1 1 2 3 /"; done >>"$work/more.dyr"
refuses "grouped" "unknown model 'STRANGE' of '1' at bus 30 and 3 more" "$swingbank" simulate --raw "$raw" --dyr "$work/more.dyr" --out "$work/x.csv"
(($(grep -c STRANGE "$work/stderr") == 1)) || fail "the records are not grouped: $(cat "$work/stderr")"
"$swingbank" inventory --raw "$raw" --dyr "$work/more.dyr" >"$work/inventory"
grep -q '^10 units: 5 fully covered (50.0 %), 5 partly' "$work/inventory" || fail "inventory says: $(head -1 "$work/inventory")"
grep -qE "^STRANGE +4 +4 +[0-9]+  no$" "$work/inventory" || fail "inventory: $(cat "$work/inventory")"
# A .raw header without a frequency: `inventory` does not need it, `plant` does.
sed '1s/, 60$/,/' "$raw" >"$work/silent.raw"
"$swingbank" inventory --raw "$work/silent.raw" --dyr "$work/more.dyr" | holds -q '^10 units: 5 fully covered' || fail "inventory without a frequency"
refuses "no frequency" 'give it with --frequency-hz' "$swingbank" plant --raw "$work/silent.raw" --dyr "$work/more.dyr" --bus 32
"$swingbank" inventory --raw "$raw" --dyr "$work/more.dyr" --units | holds -qE '^ +32 1 .*not covered: ESAC9Z' || fail "inventory --units"
"$swingbank" inventory --raw "$raw" --dyr "$work/more.dyr" --json | python3 -c "
import json, sys
j = json.load(sys.stdin)
assert (j['units'], j['covered']) == (10, 5)
assert [m['not_covered'] for m in j['models'] if m['name'] == 'STRANGE'] == [4]" || fail "inventory --json"

# Several names with commas; exchanged files; a truncated file; records that are too short.
"$swingbank" simulate --raw "$raw" --dyr "$work/more.dyr" --ignore-model STRANGE,ESAC9Z --t-end 0.1 --out "$work/x.csv" >/dev/null 2>&1 ||
  fail "--ignore-model with commas"
"$swingbank" plant --raw "$raw" --dyr "$work/more.dyr" --bus 32 --drop ESAC9Z,STRANGE >/dev/null 2>"$work/notes" || fail "--drop with commas"
for command in "simulate --out $work/x.csv" "plant --bus 32" inventory; do
  # shellcheck disable=SC2086
  refuses "exchanged" "exchange --raw and --dyr" "$swingbank" $command --raw "$dyr" --dyr "$raw"
  (($(wc -l <"$work/stderr") == 1)) || fail "$command: more than one sentence: $(cat "$work/stderr")"
done
head -c $(($(wc -c <"$dyr") * 2 / 3)) "$dyr" >"$work/cut.dyr"
refuses "cut off" "may be truncated" "$swingbank" simulate --raw "$raw" --dyr "$work/cut.dyr" --out "$work/x.csv"
{
  cat "$dyr"
  echo "32 'SEXS' 1 0.1 10 100 0.1 -500 /"
} >"$work/short.dyr"
refuses "a short record" "SEXS with 5 parameters .*--complete-records" "$swingbank" plant --raw "$raw" --dyr "$work/short.dyr" --bus 32
"$swingbank" plant --raw "$raw" --dyr "$work/short.dyr" --bus 32 --complete-records zero >"$work/short.toml" 2>"$work/notes"
grep -q 'has 5 of 6 values: EMAX = 0 ' "$work/notes" || fail "the value is not named: $(cat "$work/notes")"
grep -q "short.dyr:$(wc -l <"$work/short.dyr"): EMIN = -500 pu (usual range of SEXS: " "$work/notes" || fail "an unusual value: $(cat "$work/notes")"

# Blocks printed by `effects --toml` can be pasted into a plant file.
{
  sed '/^\[machine\]/,$d' "$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml"
  "$swingbank" effects --toml GENROU IEEET1
} >"$work/pasted.toml"
"$swingbank" export --model "$work/pasted.toml" --bus 2 | holds -q "^2 'IEEET1' '1' " || fail "the plant file with the pasted blocks is not exported"
refuses "a block of nothing" "--toml prints the block of one effect" "$swingbank" effects --toml
