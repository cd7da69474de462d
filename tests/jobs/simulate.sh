#!/usr/bin/env bash
# swingbank simulate: its output as CSV and as HDF5, by both integrators.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

networks=$SWINGBANK_SOURCE/configs/networks
simulate() { "$swingbank" simulate --raw "$networks/ieee14_genrou.raw" --dyr "$networks/ieee14_genrou.dyr" --t-end 4 "$@"; }

summary=$(simulate --fault 5:1:1.1:0.001:0.01 --trip 1:2:1:1.1:1.5 --plants 2,8 --channels delta,P,V --buses 5,9 \
  --out "$work/run.csv" --out "$work/run.h5")
grep -qE '^stable at 4 s, maximum change of rotor-angle differences [0-9.]+ deg, [0-9]+ steps, [0-9.]+ s wall time$' <<<"$summary" ||
  fail "summary: $summary"
header='t_s,2.delta_rad,2.P_pu,2.V_pu,8.delta_rad,8.P_pu,8.V_pu,bus5.V_pu,bus5.theta_rad,bus9.V_pu,bus9.theta_rad'
[[ $(head -n 1 "$work/run.csv") == "$header" ]] || fail "header: $(head -n 1 "$work/run.csv")"
(($(wc -l <"$work/run.csv") == 1 + 4 * 120 + 1)) || fail "rows: $(wc -l <"$work/run.csv")"
simulate --fault 5:1:1.1 --integrator batch --out "$work/batch.h5" >/dev/null
simulate --fault 5:1:1.1 --out "$work/reference.h5" >/dev/null

# Debian's own python3, for which python3-h5py is installed.
/usr/bin/python3 - "$work" <<'PYTHON'
import csv, sys
import h5py, numpy as np

folder = sys.argv[1]
with open(folder + "/run.csv") as file:
    rows = np.array([[float(v) for v in row] for row in list(csv.reader(file))[1:]])
with h5py.File(folder + "/run.h5") as run:
    assert list(run.attrs["plant_names"]) == ["2", "8"] and list(run.attrs["plant_base_mva"]) == [100, 50]
    assert list(run.attrs["channel_names"]) == ["delta", "P", "V"]
    assert list(run.attrs["channel_units"]) == ["rad", "pu", "pu"]
    assert run["time"].attrs["units"] == "s" and run["bus_angle"].attrs["units"] == "rad"
    assert run.attrs["outcome"] == "stable" and run.attrs["faults"] == "5:1:1.1:0.001:0.01"
    assert list(run["bus_number"]) == [5, 9]
    buses = np.stack([run["bus_voltage"][:], run["bus_angle"][:]], axis=1).reshape(4, -1)
    both = np.concatenate([run["time"][:][None], run["records"][:].reshape(6, -1), buses])
# The CSV has 12 significant digits of values up to 10.
assert np.abs(both.T - rows).max() < 1e-10
before, during = 120, 126  # samples at 1 s, just before the fault, and in the middle of the fault
assert rows[before, 7] > 0.95 and rows[during, 7] < 0.2
assert abs(rows[0, 2] - 0.4) < 1e-9  # 40 MW on 100 MVA
with h5py.File(folder + "/batch.h5") as batch, h5py.File(folder + "/reference.h5") as reference:
    assert batch.attrs["integrator"] == "batch" and reference.attrs["integrator"] == "reference"
    difference = np.abs(batch["records"][:] - reference["records"][:]).max()
    assert difference < 1e-4, difference  # the promised accuracy of the SIMD batch
PYTHON

/usr/bin/python3 "$SWINGBANK_SOURCE/tests/jobs/axes.py" "$work/run.h5" records=plant,channel,time \
  bus_voltage=bus_number,time bus_angle=bus_number,time || fail "axes of run.h5"

# Unbalanced faults by hand: two machines at no load and 1 pu (X'' = 0.2 and 0.3 pu), a line of 0.1 pu between
# them, a fault at the second. Z1 = Z2 = (0.2 + 0.1) parallel to 0.3 = j0.15 pu, Z0 = j0.05 pu. The positive
# sequence sees Z2 + Z0 = 0.2 (line to ground), Z2 = 0.15 (two-phase), Z2 parallel to Z0 = 0.0375 pu (two-phase
# to ground), and V = Zf/(Z1 + Zf) just after the fault: 4/7, 1/2, 1/5 pu.
{
  printf '%s\n' "0, 100.0, 33, 0, 0, 60.0" "two machines" "at no load"
  printf '%s\n' "1,'A',20.0,3,1,1,1,1.0,0.0" "2,'B',20.0,2,1,1,1,1.0,0.0" "0 /" "0 /" "0 /"
  printf '%s\n' "1,'1',0,0,99,-99,1.0,0,100,0,0.2" "2,'1',0,0,99,-99,1.0,0,100,0,0.3" "0 /"
  printf '%s\n' "1,2,'1',0.0,0.1" "0 /"
  for _ in {1..14}; do echo "0 /"; done
  echo Q
} >"$work/pair.raw"
printf '%s\n' "1 'GENCLS' 1 5.0 0.0 /" "2 'GENCLS' 1 5.0 0.0 /" >"$work/pair.dyr"
# at_fault VOLTAGE OPTIONS...: V of bus 2 just after the fault
at_fault() {
  local expected=$1 found
  shift
  "$swingbank" simulate --raw "$work/pair.raw" --dyr "$work/pair.dyr" --t-end 0.5 --rate 100 --fault 2:0.1:0.2 \
    --after-switching --channels V --buses 2 --out "$work/pair.csv" "$@" >/dev/null
  found=$(awk -F, '$1 == 0.1 { print $4 }' "$work/pair.csv")
  awk -v a="$found" -v b="$expected" 'BEGIN { d = a - b; exit !(a != "" && d * d < 1e-18) }' || # CSV: 12 digits
    fail "V = $found pu instead of $expected pu with $*"
}
at_fault 0.571428571429 --fault-type slg --z0 0:0.05
at_fault 0.5 --fault-type ll
at_fault 0.2 --fault-type llg --z0 0:0.05
at_fault 0 --fault-type 3ph
