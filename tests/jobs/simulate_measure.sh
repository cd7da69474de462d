#!/usr/bin/env bash
# swingbank simulate --measure: instruments between the plants and the record.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

networks=$SWINGBANK_SOURCE/configs/networks
simulate() {
  "$swingbank" simulate --raw "$networks/ieee14_genrou.raw" --dyr "$networks/ieee14_genrou.dyr" --t-end 4 \
    --rate 60 --fault 5:1:1.1 --plants 2 "$@"
}
for integrator in reference batch; do
  simulate --integrator $integrator --out "$work/true_$integrator.csv" --out "$work/true_$integrator.h5" >/dev/null
  simulate --integrator $integrator --measure CTERROR:gain=0.01,phase=0.005 --measure SKEW:skew=0.05 \
    --out "$work/measured_$integrator.csv" >/dev/null
done
simulate --channels P,Efd --measure CTERROR:gain=0.01 --out "$work/one.csv" --out "$work/one.h5" >/dev/null
pmu=(--measure PMUFILTER --measure "NOISE:relative=0.001,angle=0.001" --measure "GAPS:rate=1,length=0.05")
for run in a b; do simulate "${pmu[@]}" --measure-seed 5 --out "$work/pmu_$run.csv" >/dev/null; done
simulate "${pmu[@]}" --measure-seed 6 --out "$work/pmu_c.csv" >/dev/null
cmp -s "$work/pmu_a.csv" "$work/pmu_b.csv" || fail "one seed gave two records"
if cmp -s "$work/pmu_a.csv" "$work/pmu_c.csv"; then fail "two seeds gave one record"; fi
simulate --attach 2:PTERROR:gain=0.02 --out "$work/attached.csv" >/dev/null
/usr/bin/python3 - "$work" <<'PYTHON'
import cmath, csv, sys
import h5py

def table(name):
    with open(f"{sys.argv[1]}/{name}.csv") as file:
        rows = list(csv.reader(file))
    return {name: [float(v) for v in column] for name, column in zip(rows[0], zip(*rows[1:]))}

for integrator in ("reference", "batch"):
    true, seen = table(f"true_{integrator}"), table(f"measured_{integrator}")
    assert "2.f_hz" in seen and "2.f_hz" not in true
    assert seen["t_s"] == true["t_s"]
    # S is rotated by -0.005 rad, scaled by 1.01, and has the current of three samples ago. Each run has an error of
    # 1e-6 per step.
    def phasors(r):
        v = [cmath.rect(m, a) for m, a in zip(r["2.V_pu"], r["2.theta_rad"])]
        return v, [((p + 1j * q) / u).conjugate() for p, q, u in zip(r["2.P_pu"], r["2.Q_pu"], v)]
    (v, i), (vm, im) = phasors(true), phasors(seen)
    late = [i[max(k - 3, 0)] * 1.01 * cmath.exp(0.005j) for k in range(len(i))]
    worst_v = max(abs(a - b) for a, b in zip(v, vm))
    # Samples near the switchings are excluded: there, a sample is one-sided at 60/s, and inside the step at 480/s.
    worst_i = max(abs(a - b) for k, (a, b) in enumerate(zip(late, im)) if abs(k - 63) > 2 and abs(k - 69) > 2)
    assert worst_v < 2e-5, worst_v
    assert worst_i < 1e-4, worst_i
    assert max(true["2.speed_pu"]) > 1e-3 and abs(seen["2.f_hz"][0] - 60) < 1e-6
    # In steady state the frequency of a bus equals that of its machine within a few mHz.
    assert abs(seen["2.f_hz"][-2] - 60 * (1 + seen["2.speed_pu"][-2])) < 0.05

true, one = table("true_reference"), table("one")
assert list(one) == ["t_s", "2.P_pu", "2.Efd_pu", "2.f_hz"]
assert abs(one["2.P_pu"][0] / true["2.P_pu"][0] - 1.01) < 1e-9  # the CSV has 12 digits
with h5py.File(f"{sys.argv[1]}/one.h5") as file:
    assert file["measured_frequency"].shape == (1, 241)
    assert file["measured_frequency"].attrs["units"] in ("Hz", b"Hz")
    assert "CTERROR:gain=0.01" in str(file.attrs["measured"])
with h5py.File(f"{sys.argv[1]}/true_reference.h5") as file:
    assert "measured_frequency" not in file

with open(f"{sys.argv[1]}/pmu_a.csv") as file:
    rows = list(csv.DictReader(file))
missing = [k for k, row in enumerate(rows) if row["2.P_pu"] == ""]
# Expected: about 4 gaps of 3 samples, 12 +- 6 of the 241 samples; 40 are almost 5 standard deviations more.
assert 0 < len(missing) < 40, len(missing)
for k in missing:
    assert all(rows[k][c] == "" for c in ("2.V_pu", "2.theta_rad", "2.P_pu", "2.Q_pu", "2.f_hz"))
    assert rows[k]["2.speed_pu"] != ""  # no instrument measures the rotor
quiet = [float(row["2.V_pu"]) for row in rows[:55] if row["2.V_pu"]]
spread = (sum((v / true["2.V_pu"][0] - 1) ** 2 for v in quiet) / len(quiet)) ** 0.5
assert 0.0006 < spread < 0.0014, spread  # 0.001 within 4 standard errors of 50 samples, 4 / sqrt(2 x 50) = 40 %
attached = table("attached")
assert abs(attached["2.V_pu"][0] / true["2.V_pu"][0] - 1.02) < 1e-9
PYTHON

refuses "no such instrument" "no measurement effect 'SEXS' at --measure SEXS \(the measurement effects are .*CTERROR" \
  simulate --measure SEXS --out "$work/x.csv"
refuses "no such parameter" "CTERROR has gain, phase" simulate --measure CTERROR:gian=1 --out "$work/x.csv"
refuses "a dead instrument" "the current would be zero" simulate --measure CTERROR:gain=-1 --out "$work/x.csv"
refuses "a bolted terminal" "V = 0 pu after 1.+ s at plant 2 \(P and Q do not determine the current there" \
  "$swingbank" simulate --raw "$networks/ieee14_genrou.raw" --dyr "$networks/ieee14_genrou.dyr" --t-end 2 --rate 60 \
  --fault 2:1:1.05 --plants 2 --measure CTERROR:gain=0.1 --out "$work/x.csv"
[[ ! -e $work/x.csv ]] || fail "a refused run left a file"
