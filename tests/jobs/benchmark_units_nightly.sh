#!/usr/bin/env bash
# Two typical units, a steam unit (GENROU, ESST4B, PSS2B, IEEEG1) and a gas unit (GENROU, REXS, PSS2A, GGOV1), each
# behind its transformer, in twelve events recorded at 30 samples/s. With the right model only noise remains. `calibrate
# --sparse` must name all five wrong values, fit them close to the truth, and name at most two others. If two gains act
# only as a product, it may name either of them.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

networks=$SWINGBANK_SOURCE/configs/networks
raw=$networks/ieee39_dataset_genrou.raw

# the other plants, with SEXS and TGOV1
others() {
  awk '$1 != 32 { print; if ($1 != 39) { print $1 " '\''SEXS'\'' 1 0.1 10 100 0.1 -4 5 /"; print $1 " '\''TGOV1'\'' 1 0.05 0.5 1.1 0 2 6 0 /" } }' \
    "$networks/ieee39_dataset_genrou.dyr"
}
# steam T'do H X'd KR KS1: .dyr records of the steam unit
steam() {
  echo "32 'GENROU' 1 $1 0.07 0.8 0.11 $2 0.3 1.75 1.65 $3 0.58 0.27 0.16 0.08 0.35 /"
  echo "32 'ESST4B' 1 0.01 $4 $4 1 -0.87 0.01 1 0 1 -0.87 0 6.5 0 8.1 0.08 0.09 0 /"
  echo "32 'PSS2B' 1 1 0 3 0 5 1 2 2 0 2 0 2 0.28 1 0.5 0.1 $5 0.15 0.025 0.15 0.025 0.02 0.03 2 -2 2 -2 0.1 -0.1 /"
  echo "32 'IEEEG1' 1 0 0 20 0 0 0.15 0.3 -0.5 1 0 0.3 0.3 0 8 0.4 0 0.5 0.3 0 0 0 0 /"
}
# gas T'do H TE KS1 R: .dyr records of the gas unit
gas() {
  echo "32 'GENROU' 1 $1 0.07 0.8 0.11 $2 0 1.75 1.65 0.36 0.58 0.27 0.16 0.08 0.35 /"
  echo "32 'REXSYS' 1 0.02 400 0 0.1 0.01 0 0 0 0 47 -20 0.05 1 0 0 1 1 0 0 47 -20 0 1 $3 0.05 2 3 0.0001 4 0.001 0 /"
  echo "32 'PSS2A' 1 1 0 3 0 5 1 2 2 0 2 0 2 0.28 1 0.5 0.1 $4 0.25 0.03 0.15 0.03 0.1 -0.1 /"
  echo "32 'GGOV1' 1 1 0 $5 1 0.05 -0.05 10 2 0 1 1 0.15 0.5 1.5 0.2 0.1 0 0 3 2 0.67 1 0 0.1 -0.1 0 0.1 10 0.1 0 0 4 5 99 -99 /"
}
# plant NAME UNIT VALUES...: writes $work/NAME.dyr and .toml of UNIT (steam or gas) with these values
plant() {
  { others; "$2" "${@:3}"; } >"$work/$1.dyr"
  "$swingbank" plant --raw "$raw" --dyr "$work/$1.dyr" --bus 32 --measured-at 10 --out "$work/$1.toml" >/dev/null 2>&1 || fail "$1: no plant"
}
# benchmark UNIT INSTRUMENT "TRUE VALUES" "WRONG VALUES" NAME=TRUE...
benchmark() {
  local unit=$1 code=0
  # shellcheck disable=SC2086 # lists of values
  plant "true" "$unit" $3
  # shellcheck disable=SC2086
  plant owner "$unit" $4
  python3 "$SWINGBANK_SOURCE/tests/jobs/benchmark_units.py" "$swingbank" "$raw" "$work/true.dyr" "$work" "$2" || fail "$unit: no records"
  "$swingbank" compare --model "$work/true.toml" --records "$work"/event*.csv --out "$work/compare" >"$work/said" 2>&1 || code=$?
  ((code == 0 || code == 4)) || fail "$unit: the right model is called unfit: $(grep -m 2 -E '^(Fit|Not|Statist)' "$work/said")"
  python3 - "$work/compare/compare.json" <<'END' || fail "$unit: the residual of the right model exceeds noise"
import json, sys
d = json.load(open(sys.argv[1]))
print(f"the right model: {d['bins_exceeding']} of {d['bins']} bins exceed what noise allows")
sys.exit(d["bins_exceeding"] > 2)
END
  SECONDS=0 code=0
  "$swingbank" calibrate --sparse --model "$work/owner.toml" --records "$work"/event*.csv --out "$work/fewest" >"$work/said" \
    2>"$work/errors" || code=$?
  ((code == 0 || code == 4)) || fail "$unit: exit code $code: $(tail -3 "$work/said" "$work/errors")"
  python3 - "$work/fewest/calibrate.json" "${@:5}" <<'END' || fail "$unit: other values were named than the wrong ones"
import json, sys
wrong = {w["name"]: w["fitted"] for w in json.load(open(sys.argv[1]))["wrong"]}
truth = {name: float(value) for name, value in (a.split("=") for a in sys.argv[2:])}
count = len(wrong)
if "ESST4B.KPM" in wrong and "ESST4B.KPR" in truth:  # KG = 0: only KPM KPR and KPM KIR act; the model has KPR = KIR = 5.5
    gain = wrong.pop("ESST4B.KPM")
    print(f"ESST4B.KPM {gain:.4g} scales KPR and KIR")
    wrong |= {name: gain * wrong.get(name, 5.5) for name in ("ESST4B.KPR", "ESST4B.KIR")}
print(", ".join(f"{n} {v:.4g} (true {truth[n]:g})" if n in truth else f"{n} {v:.4g} (too many)" for n, v in wrong.items()))
near = all(n in wrong and abs(wrong[n] / v - 1) < 0.05 for n, v in truth.items())
sys.exit(not near or count > len(truth) + 2)
END
  echo "ok: $unit, $2: $SECONDS s"
}
benchmark steam sharp "5.7 3.58 0.36 3.8 20" "7.4 4.3 0.30 5.5 12" GENROU.Tdop=5.7 GENROU.H=3.58 GENROU.Xdp=0.36 ESST4B.KPR=3.8 \
  ESST4B.KIR=3.8 PSS2B.KS1=20
benchmark steam meter-f "5.7 3.58 0.36 3.8 20" "7.4 4.3 0.30 5.5 12" GENROU.Tdop=5.7 GENROU.H=3.58 GENROU.Xdp=0.36 ESST4B.KPR=3.8 \
  ESST4B.KIR=3.8 PSS2B.KS1=20
benchmark gas class-m "5.7 4.58 1.2 8 0.04" "7.1 5.4 0.8 12 0.05" GENROU.Tdop=5.7 GENROU.H=4.58 REXS.TE=1.2 PSS2A.KS1=8 GGOV1.R=0.04
