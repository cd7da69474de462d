#!/usr/bin/env bash
# swingbank benchmark: the reference is the record of a simulation (as CSV and as PSCAD output) or another model. The
# errors are computed independently; limits, exit codes and bad input are tested.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

networks=$SWINGBANK_SOURCE/configs/networks
raw=$networks/ieee14_genrou.raw
dyr=$networks/ieee14_genrou.dyr
cd "$work"
simulate() {
  "$swingbank" simulate --raw "$raw" --dyr "$dyr" --attach 2:SEXS --plants 2 --channels P,Q,V,theta --rate 200 "$@" >/dev/null
}
simulate --t-end 5 --fault 4:1:1.15 --out dip.csv
simulate --t-end 8 --vref-step 2:1:0.03 --out vref.csv
"$swingbank" plant --raw "$raw" --dyr "$dyr" --bus 2 --out bare.toml >/dev/null
{ cat bare.toml; echo; "$swingbank" effects SEXS --toml; } >right.toml
mva=$(sed -n '/^\[plant\]/,/^\[/s/^base_mva *= *\([0-9.]*\).*/\1/p' right.toml)
sed -i "/^\[record\]/,/^base_mva/s/^base_mva = .*/base_mva = $mva/" right.toml # simulate's P and Q: machine base
awk '$1 == "H" {$3 = 1.2 * $3} {print}' right.toml >wrong.toml
cmp -s right.toml wrong.toml && fail "no inertia was changed"
cat >tests.toml <<'TOML'
name = "two tests"
[operating_point]
P = 0.4
Q = 0.1
V = 1.0
rate = 200
[[test]]
name = "dip"
kind = "voltage_dip"
event = 1.0
end = 1.15
size = -0.4
pre = [0.5, 1.0]
post = [1.15, 4.5]
[[test]]
name = "vref"
kind = "v_reference_step"
event = 1.0
size = 0.03
post = [1.0, 7.5]
TOML
benchmark() { "$swingbank" benchmark --tests tests.toml "$@"; }

# the same model: it passes narrow limits
cat >narrow.toml <<'TOML'
name = "narrow"
source = "a test"
preset = "dtr-simulation"
[P.post_fault]
mxe = 0.5
me = 0.5
mae = 0.5
[Q.post_fault]
mxe = 0.5
me = 0.5
mae = 0.5
TOML
benchmark --model right.toml --records dip.csv vref.csv --accept narrow.toml --out same >said || fail "the right model against its own record: $(cat said)"
grep -q '^2 of 2 tests are within the limits narrow' said || fail "no verdict: $(cat said)"

# another inertia: the errors equal those computed here from the samples, exit code 3
code=0
benchmark --model wrong.toml --records dip.csv vref.csv --accept narrow.toml --out other --json >printed.json || code=$?
((code == 3)) || fail "exit code $code of a wrong model"
cmp printed.json other/benchmark.json || fail "--json prints something else than it writes"
for file in report.html benchmark.csv curves-dip.csv curves-vref.csv; do [[ -s other/$file ]] || fail "no $file"; done
/usr/bin/python3 - "$mva" <<'PYTHON'
import csv, json, sys
def table(name):
    with open(name) as file:
        rows = list(csv.reader(file))
    return {n: [float(v) for v in c] for n, c in zip(rows[0], zip(*rows[1:]))}
report = json.load(open("other/benchmark.json"))
assert report["format"] == "swingbank-benchmark-1" and report["passes"] is False
assert report["model"]["mva"] == float(sys.argv[1]) and report["limits"]["name"] == "narrow"
recorded, curves = table("dip.csv"), table("other/curves-dip.csv")
for name in "P", "Q":  # within the windows, the reference equals the record
    at = {round(t, 6): v for t, v in zip(recorded["t_s"], recorded[f"2.{name}_pu"])}
    for t, v in zip(curves["t_s"], curves[f"{name}_reference_pu"]):
        assert abs(at[round(t, 6)] - v) < 1e-8, (name, t)
# With a simulated reference, the windows exclude the first 20 ms of the fault and the first 60 ms after it.
window = {"pre": (0.5, 1.0), "during": (1.02, 1.15), "post": (1.21, 4.5)}
test = report["tests"][0]
assert test["name"] == "dip" and len(test["errors"]) == 6
for row in test["errors"]:
    low, high = window[row["window"]]
    first = row["window"] == "pre"
    errors = [100 * (m - r) for t, r, m in zip(curves["t_s"], curves[row["channel"] + "_reference_pu"],
                                                curves[row["channel"] + "_model_pu"])
              if (t > low + 1e-6 or first) and low - 1e-6 < t < high + 1e-6]
    own = {"mxe": max(map(abs, errors)), "me": sum(errors) / len(errors), "mae": sum(map(abs, errors)) / len(errors)}
    assert len(errors) == row["samples"], row
    for key, value in own.items():
        assert abs(value - row["percent"][key]) < 1e-4, (row, own)
        assert abs(value / 100 - row["pu"][key]) < 1e-6, (row, own)
assert any(row["passes"] is False for row in test["errors"])
rows = list(csv.DictReader(open("other/benchmark.csv")))
assert len(rows) == sum(len(t["errors"]) for t in report["tests"])
assert abs(float(rows[2]["mxe_percent"]) - test["errors"][2]["percent"]["mxe"]) < 1e-6

# the record as PSCAD output: 11 channels, of which V and P are in the first file and the others in the second
names = ["V", "P"] + [f"other_{k}" for k in range(8)] + ["theta", "Q"]
units = {"V": "pu", "P": "pu", "theta": "rad", "Q": "pu"}
with open("dip.inf", "w") as file:
    for k, name in enumerate(names, 1):
        file.write(f'PGB({k}) Output Desc="{name}" Group="Main" Max=2.0 Min=-2.0 Units="{units.get(name, "")}"\n')
for part in 1, 2:
    with open(f"dip_{part:02}.out", "w") as file:
        file.write("EMT model of the plant\n")
        for k, t in enumerate(recorded["t_s"]):
            values = [t] + [recorded[f"2.{n}_{units[n]}"][k] if n in units else 0.0 for n in names[10 * part - 10:10 * part]]
            file.write("".join(f" {v:22.14E}" for v in values) + "\n")
PYTHON
code=0
benchmark --model wrong.toml --records dip_02.out vref.csv --accept narrow.toml --out pscad --quiet >/dev/null || code=$?
((code == 3)) || fail "exit code $code with PSCAD output"
diff <(cut -d, -f1-10 other/benchmark.csv) <(cut -d, -f1-10 pscad/benchmark.csv) || fail "PSCAD output gives other errors"
grep -q 'dip_01.out' pscad/benchmark.json || fail "the provenance names no .out"

# another model as reference: the same input to both, recorded or generated
benchmark --model right.toml --against right.toml --records dip.csv vref.csv --accept narrow.toml --out self >said ||
  fail "a model against itself: $(cat said)"
code=0
benchmark --model wrong.toml --against right.toml --accept narrow.toml --out against --json >against.json || code=$?
((code == 3)) || fail "exit code $code against another model"
/usr/bin/python3 - <<'PYTHON'
import csv, json
report = json.load(open("against.json"))
assert report["reference"] != "EMT records" and report["tests"][0]["record"] == ""
curves = list(csv.DictReader(open("against/curves-dip.csv")))
V = {float(r["t_s"]): float(r["V_pu"]) for r in curves}
assert min(V.values()) == 0.6 and V[1.0] == 1.0 and V[4.5] == 1.0  # an ideal source
moved = [abs(float(r["P_reference_pu"]) - 0.4) for r in curves]
assert moved[0] < 1e-9 and max(moved) > 0.1
PYTHON
"$swingbank" benchmark --model right.toml --against right.toml --tests "$SWINGBANK_SOURCE/configs/benchmark/synchronous.toml" \
  --out standard >said 2>&1 && fail "a plant without a governor passes the test of the power reference"
grep -q "test 'p_reference_step'.*no control with that reference" said || fail "not refused: $(cat said)"

# a converter: the shipped set, with its active and reactive current
{
  grep -v '^32 ' "$networks/ieee39_genrou.dyr"
  echo "32 'REGCA1' 1 1 0.02 10 0.9 0.4 1.22 1.2 0.8 0.4 -1.3 0.02 0 100 -100 0.7 /"
  echo "32 'REECB1' 1 0 0 1 1 0 -99 99 0.02 -0.02 0.02 2 1.1 -1.1 0 0.05 0.6 -0.6 1.1 0.9 0.1 1 2 20 0.02 99 -99 1 0 1.3 0.02 /"
  echo "32 'REPCA1' 1 0 0 0 '0 ' 0 0 1 0.02 2 1 0 0.05 0.7 0 0 0 0.1 -0.1 0 0 0.6 -0.6 1 0.05 0.25 -0.0006 0.0006 99 -99 1 0 0.1 20 0 /"
} >case.dyr
"$swingbank" plant --raw "$networks/ieee39_genrou.raw" --dyr case.dyr --bus 32 --out converter.toml >/dev/null 2>&1
sed 's/^Kqv = .*/Kqv = 1.5/' converter.toml >other_gain.toml
code=0
"$swingbank" benchmark --model other_gain.toml --against converter.toml --out currents --quiet --json \
  --tests "$SWINGBANK_SOURCE/configs/benchmark/converter.toml" >currents.json || code=$?
((code == 3)) || fail "exit code $code of another gain of the converter"
/usr/bin/python3 - <<'PYTHON'
import csv, json
report = json.load(open("currents.json"))
assert len(report["tests"]) == 12
base = 100 / report["model"]["mva"]  # P and Q of the curves are per unit on the records' base of 100 MVA
for r in csv.DictReader(open("currents/curves-voltage_dip_050.csv")):
    for current, power in (("Ip", "P"), ("Iq", "Q")):
        for of in "reference", "model":
            own = float(r[f"{power}_{of}_pu"]) * base / float(r["V_pu"])
            assert abs(own - float(r[f"{current}_{of}_pu"])) < 1e-6, r
for row in report["tests"][1]["errors"]:
    assert (row["limits_percent"] is None) == (row["channel"] in ("Ip", "Iq"))
step = next(t for t in report["tests"] if t["name"] == "q_reference_step")
moved = [float(r["Q_reference_pu"]) * base for r in csv.DictReader(open("currents/curves-q_reference_step.csv"))]
assert abs(moved[0] - 0.1) < 1e-6 and abs(moved[-1] - 0.2) < 5e-3, (moved[0], moved[-1])
assert step["passes"] is True
PYTHON

# the same plants behind the impedance of a grid: the terminal voltage depends on the model
code=0
"$swingbank" benchmark --model other_gain.toml --against converter.toml --out weak --quiet --json \
  --tests "$SWINGBANK_SOURCE/configs/benchmark/weak_grid.toml" >weak.json || code=$?
/usr/bin/python3 - $code <<'PYTHON'
import json, sys
report = json.load(open("weak.json"))
assert int(sys.argv[1]) == (0 if report["passes"] else 3), (sys.argv, report["sentence"])
for test in report["tests"]:
    assert test["scr"] > 0 and test["x_over_r"] == 10
    errors = {r["channel"]: r["percent"]["mxe"] for r in test["errors"] if r["window"] == "post"}
    assert list(errors) == ["P", "Q", "V", "Ip", "Iq"], (test["name"], errors)
    # Kqv acts only where the voltage leaves its deadband, thus in the dips
    assert (errors["V"] > 1e-3) == (test["kind"] == "voltage_dip"), (test["name"], errors)
PYTHON
code=0
"$swingbank" benchmark --model converter.toml --tests "$SWINGBANK_SOURCE/configs/benchmark/weak_grid.toml" --out none \
  2>said || code=$?
((code == 1)) || fail "exit code $code of a weak grid without record and reference"
grep -q "no record for test 'scr_10_to_5'" said || fail "not refused: $(cat said)"

# bad input: every problem at once, and no file
out=none
refused() { "$swingbank" benchmark --out "$out" "$@"; }
refuses "no tests file" 'none.toml' refused --model right.toml --tests none.toml --records dip.csv
refuses "a test without a record" "no record for test 'vref' at tests.toml:15" refused --model right.toml --tests tests.toml --records dip.csv
refuses "a record that no test uses" 'right.csv at --records' refused --model right.toml --tests tests.toml --records dip.csv vref.csv right.csv
sed 's/kind = "voltage_dip"/kind = "voltage_dips"/; s/^size = 0.03/sise = 0.03/' tests.toml >bad.toml
refuses "an unknown kind" 'bad.toml:9' refused --model right.toml --tests bad.toml --records dip.csv vref.csv
grep -q 'sise' "$work/stderr" || fail "the unknown key is not reported with it"
sed 's/4.5\]/45.0]/; s/7.5\]/75.0]/' tests.toml >long.toml
refuses "a window after the record" "window post of test 'dip'" refused --model right.toml --tests long.toml --records dip.csv vref.csv
grep -q "window post of test 'vref'" "$work/stderr" || fail "the second window is not reported with it"
# The results satisfy their schema; changed content does not.
for result in same other against currents; do fits_schema_of benchmark $result/benchmark.json; done
sed 's/"passed": [0-9]*/"passed": -1/' other/benchmark.json >altered.json
(fits_schema_of benchmark altered.json) 2>/dev/null && fail "the schema accepts a negative number of tests"

mkdir cut
sed "100s/,[^,]*\$//" dip.csv >cut/dip.csv
refuses "a line without a value" 'dip.csv:100' refused --model right.toml --tests tests.toml --records cut/dip.csv vref.csv
refuses "no limits of that name" 'no limits' refused --model right.toml --tests tests.toml --records dip.csv vref.csv --accept dtr
[[ ! -e $out ]] || fail "bad input leaves $out"
