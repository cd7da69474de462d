#!/usr/bin/env bash
# swingbank simulate --user-model and --attach: a user-defined model and disturbances in both integrators; errors.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

networks=$SWINGBANK_SOURCE/configs/networks laws=$SWINGBANK_SOURCE/configs/user_models
simulate() {
  "$swingbank" simulate --raw "$networks/ieee14_genrou.raw" --dyr "$networks/ieee14_genrou.dyr" --t-end 5 \
    --fault 5:1:1.1 --plants 2 --channels delta,Efd,Tm "$@"
}
for integrator in reference batch; do
  simulate --integrator $integrator --user-model "$laws/sexs.toml" --attach 2:SEXSLAW:K=50,EMAX=4 \
    --attach 2:FORCEDOSC:amplitude=0.02,frequency=0.7,start=2 --out "$work/law_$integrator.csv" >/dev/null
  simulate --integrator $integrator --attach 2:SEXS:K=50,EMAX=4 \
    --attach 2:FORCEDOSC:amplitude=0.02,frequency=0.7,start=2 --out "$work/compiled_$integrator.csv" >/dev/null
done
simulate --out "$work/plain.csv" >/dev/null
/usr/bin/python3 - "$work" <<'PYTHON'
import csv, sys

def rows(name):
    with open(f"{sys.argv[1]}/{name}.csv") as file:
        return [[float(v) for v in row] for row in list(csv.reader(file))[1:]]

def worst(a, b):
    return max(abs(x - y) for one, other in zip(rows(a), rows(b)) for x, y in zip(one, other))

assert worst("law_batch", "compiled_batch") < 1e-9  # the CSV has 12 significant digits
assert worst("law_reference", "compiled_reference") < 1e-6  # two runs at rtol 1e-8
assert worst("law_batch", "law_reference") < 1e-4  # accuracy of the SIMD integrator ("batch")
assert worst("law_batch", "plain") > 0.1  # exciter and disturbance act
PYTHON

refuses "no file" "cannot read the user-defined model at $work/none.toml" simulate --user-model "$work/none.toml" --out "$work/x.csv"
printf 'name = "L"\ntitle = "t"\nsource = "s"\noutput = "Vs"\naction = "add"\nvalue = "1 + nothing"\n' >"$work/bad.toml"
refuses "an error in a user-defined model" "unknown name nothing in value at $work/bad.toml:6:14" \
  simulate --user-model "$work/bad.toml" --out "$work/x.csv"
refuses "no such plant" "no plant 77" simulate --attach 77:SEXS --out "$work/x.csv"
refuses "no such effect" "unknown effect 'SEXSLAW'" simulate --attach 2:SEXSLAW --out "$work/x.csv"
printf 'name = "L"\ntitle = "t"\nsource = "s"\noutput = "Tm"\naction = "add"\nvalue = "V"\n' >"$work/moves.toml"
refuses "a user-defined model without a steady state" "has no steady state at.*it adds 1.045 pu to Tm" \
  simulate --user-model "$work/moves.toml" --attach 2:L --out "$work/x.csv"
[[ ! -e $work/x.csv ]] || fail "a refused run left a file"
