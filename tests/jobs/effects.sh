#!/usr/bin/env bash
# swingbank effects: the list, one effect, its JSON, files of user-defined models, and unknown names.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

"$swingbank" effects >"$work/list.txt"
"$swingbank" effects --json >"$work/list.json"
"$swingbank" effects SEXS genrou >"$work/two.txt"
"$swingbank" effects --json SEXS GAPS >"$work/two.json"
law=$SWINGBANK_SOURCE/configs/user_models/torque_voltage_dip.toml
"$swingbank" effects --user-model "$law" DIPTORQUE >"$work/law.txt"
"$swingbank" effects --user-model "$law" >"$work/user_models.txt"

/usr/bin/python3 - "$work" "$SWINGBANK_SOURCE" <<'PYTHON'
import json, pathlib, re, sys

work, source = map(pathlib.Path, sys.argv[1:])
lines = (work / "list.txt").read_text().splitlines()
listed = {}
for line in lines:
    if line.startswith("  "):
        listed[line.split()[0]] = slot
    else:
        slot = line.split(":")[0]
everything = json.loads((work / "list.json").read_text())
assert listed == {e["name"]: e["slot"] for e in everything}
# Every header is listed, under its slot, and nothing else.
headers = {}
for header in (source / "sim/effects").glob("*.hpp"):
    text = header.read_text()
    name = re.search(r'name = "(\w+)"', text).group(1)
    slot = re.search(r"slot = Slot::(\w+)", text)  # none: the effect has the slot of its base effect
    headers[name] = slot.group(1) if slot else listed.get(name)
assert headers == listed, headers.keys() ^ listed.keys()
for e in everything:
    assert e["title"] and e["source"] and e["description"].strip(), e["name"]
    for p in e["parameters"]:
        assert p["low"] <= p["default"] <= p["high"] and p["unit"] and p["meaning"], (e["name"], p)
        assert p["default_from"] and p["bounds_from"], (e["name"], p)
        end = re.search("(max|min)$", p["name"], re.I)  # limit of a signal, unless the unit is that of a rate or a time
        level = p["unit"] != "s" and not p["unit"].endswith("/s")
        assert not end or not level or p["limit"] == {"max": "upper", "min": "lower"}[end.group().lower()], (e["name"], p)

sexs, gaps = json.loads((work / "two.json").read_text())
assert sexs["dyr"] == {"name": "SEXS", "columns": ["TAoverTB", "TB", "K", "TE", "EMIN", "EMAX"]}
gain = next(p for p in sexs["parameters"] if p["name"] == "K")
assert gain["default"] == 100 and gain["null_value"] is None
assert gain["default_from"] == "CIM: ExcSEXS" and gain["bounds_from"].startswith("own choice: ")
assert "dyr" not in gaps and gaps["parameters"][0]["null_value"] == 0

two = (work / "two.txt").read_text()
assert "SEXS: simplified excitation system" in two and "GENROU: round-rotor machine" in two
assert "TE dEfd/dt = K y - Efd" in two  # the equations
assert re.search(r"^  K +K +pu +100 +0\.5 +2000 +- +1 2 +gain$", two, re.M), two
assert ".dyr: BUS 'SEXS' ID TA/TB TB K TE EMIN EMAX /" in two
assert re.search(r"^   1  CIM: ExcSEXS$", two, re.M) and "  CIM: IEC and ENTSO-E, " in two
assert "source: " in two and re.search(r"^  Efd +pu +field voltage$", two, re.M)

law = (work / "law.txt").read_text()
assert "DIPTORQUE: torque lost in a voltage dip" in law and "recovery" in law
assert "configs/user_models/torque_voltage_dip.toml" in law  # the source of the values is the file
assert "DIPTORQUE" in (work / "user_models.txt").read_text() and "DIPTORQUE" not in listed
PYTHON

refuses "a name mistyped" "unknown effect 'GENRUO' at NAME \(the nearest names are GENROU" "$swingbank" effects GENRUO
"$swingbank" effects GENRUO SEXX 2>"$work/both.txt" && fail "unknown names were accepted"
(($(wc -l <"$work/both.txt") == 2)) || fail "not every unknown name was reported: $(cat "$work/both.txt")"
"$swingbank" effects REGCA1 | holds -q '^slot: converter' || fail "REGCA1 is no converter"
refuses "a name cut short" "unknown effect 'regcb' at NAME \(the nearest names are REGC" "$swingbank" effects regcb
refuses "a wind turbine" "unknown effect 'WT3G1' at NAME \(this model of inverters, wind or storage is not supported yet\)" "$swingbank" effects WT3G1
"$swingbank" compare --help | grep -F "{false}" && fail "a flag shows how it is stored"

printf "%s\n" "1 'SEXS' 1 0.1 10 100 0.1 0 5 /" "1 'EXDC1' 1 0 40 0.1 0 0 1 -1 0.1 0.5 0.05 0.7 0 2.8 0.08 3.7 0.33 /" \
  "1 'NOSUCH' 1 1 2 /" "2 'SEXS' 1 0.1 /" >"$work/some.dyr"
"$swingbank" effects --coverage "$work/some.dyr" >"$work/coverage.txt"
grep -qF "4 records of 3 models in 1 file: 2 covered (50.0 %)" "$work/coverage.txt" || fail "the count: $(cat "$work/coverage.txt")"
grep -qE "^EXDC1 +1 +1 +1 +exciter IEEEX1$" "$work/coverage.txt" || fail "EXDC1: $(cat "$work/coverage.txt")"
"$swingbank" effects --coverage "$work/some.dyr" --json >"$work/coverage.json"
python3 - "$work/coverage.json" <<'PYTHON'
import json, sys
c = json.load(open(sys.argv[1]))
assert (c["files"], c["records"], c["covered"], c["percent"]) == (1, 4, 2, 50), c
sexs = next(m for m in c["models"] if m["name"] == "SEXS")
assert sexs["refused"] == 1 and "SEXS with 1 parameter" in sexs["fault"], sexs
PYTHON
refuses "no .dyr file" "none.dyr" "$swingbank" effects --coverage "$work/none.dyr"
refuses "no file" "cannot read the user-defined model" "$swingbank" effects --user-model "$work/none.toml"
misused "unknown option" nonsense "$swingbank" effects --nonsense
