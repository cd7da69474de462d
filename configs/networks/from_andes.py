#!/usr/bin/env python3
"""Writes the networks of this folder from the JSON files that accompany the ANDES reference records.

usage: from_andes.py FOLDER_WITH_JSON [OUTPUT_FOLDER]

Decimals are exact: the doubles that read_raw returns equal those of the JSON to the last bit.
"""
import json
import sys
from decimal import Decimal, getcontext
from pathlib import Path

getcontext().prec = 40
PI = Decimal("3.141592653589793238462643383279502884197")
# Machine bases of the dataset files [MVA]; see README.md.
DATASET_MVA = {
    "ieee39": {30: 1000, 31: 700, 32: 800, 33: 800, 34: 600, 35: 800, 36: 700, 37: 700, 38: 1000, 39: 10000},
    "ieee14": {1: 615, 2: 60, 3: 60, 6: 25, 8: 25},
}
# .dyr columns, with the names that the JSON gives them.
COLUMNS = {
    "GENCLS": ["H", "D"],
    "GENROU": ["Td10", "Td20", "Tq10", "Tq20", "H", "D", "xd", "xq", "xd1", "xq1", "xd2", "xl", "S10", "S12"],
}
SOURCE_REACTANCE = {"GENCLS": "xd1", "GENROU": "xd2"}
EMPTY_SECTIONS = ["area", "two-terminal dc line", "VSC dc line", "impedance correction", "multi-terminal dc line",
                  "multi-section line", "zone", "inter-area transfer", "owner", "FACTS device", "switched shunt",
                  "GNE device", "induction machine"]


def exact(value, factor=1):
    """Returns the shortest decimal of value * factor that, divided by factor, gives the same double."""
    scaled = Decimal(repr(value)) * factor
    for digits in range(1, 30):
        text = Decimal(f"{scaled:.{digits - 1}e}")
        if float(text / factor) == value:
            break
    if text == 0:
        return "0"
    return f"{text:f}" if abs(text) > Decimal("1e-6") else f"{text:g}"


def raw(case, model, bases, titles):
    """Returns the text of the .raw file, version 33."""
    net, rows = case["network"], []
    mva = net["base_mva"]

    def row(*fields):
        rows.append(", ".join(str(f) for f in fields))

    def end(section):
        rows.append(f"0 / end of {section} data")

    row(0, exact(mva), 33, 0, 0, exact(net["freq"]))
    rows.extend(titles)
    generators = {g["bus"]: g for g in net["gen_pf"]}
    for b in net["bus"]:
        g = generators.get(b["id"])
        kind = 1 if g is None else 3 if g["slack"] else 2
        row(b["id"], f"'BUS {b['id']}'", exact(b["Vn_kV"]), kind, 1, 1, 1, exact(b["vm_pu"]),
            exact(b["va_rad"], 180 / PI), 1.1, 0.9, 1.1, 0.9)
    end("bus")
    for load in net["load"]:
        row(load["bus"], "'1'", 1, 1, 1, exact(load["p_pu"], int(mva)), exact(load["q_pu"], int(mva)), 0, 0, 0, 0, 1, 1, 0)
    end("load")
    for s in net["shunt"]:
        row(s["bus"], "'1'", 1, exact(s["g"], int(mva)), exact(s["b"], int(mva)))
    end("fixed shunt")
    voltage = {b["id"]: b["vm_pu"] for b in net["bus"]}
    for bus in sorted(generators):
        g, p = generators[bus], case["machines"][str(bus)]["params_machine_base"]
        row(bus, "'1'", exact(g["p_pu"], int(mva)), exact(g["q_pu"], int(mva)), 9999, -9999, exact(voltage[bus]), 0,
            exact(bases[bus]), exact(p["ra"]), exact(p[SOURCE_REACTANCE[model]]), 0, 0, 1, 1, 100, 9999, -9999, 1, 1)
    end("generator")
    is_transformer = [b["tap"] != 1.0 or b["phi_rad"] != 0.0 for b in net["branch"]]
    for b, transformer in zip(net["branch"], is_transformer):
        if not transformer:
            row(b["f"], b["t"], "'1'", exact(b["r"]), exact(b["x"]), exact(b["b"]), 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 1, 1)
    end("branch")
    for b, transformer in zip(net["branch"], is_transformer):
        if transformer:
            assert b["b"] == 0.0, "a .raw has no field for the charging of a transformer"
            row(b["f"], b["t"], 0, "'1'", 1, 1, 1, 0, 0, 2, "''", 1, 1, 1)
            row(exact(b["r"]), exact(b["x"]), exact(mva))
            row(exact(b["tap"]), 0, exact(b["phi_rad"], 180 / PI), 0, 0, 0, 0, 0, 1.1, 0.9, 1.1, 0.9, 33, 0, 0, 0, 0)
            row(1, 0)
    end("transformer")
    for section in EMPTY_SECTIONS:
        end(section)
    return "\n".join(rows) + "\nQ\n"


def dyr(case, model):
    """Returns the text of the .dyr file."""
    lines = []
    for bus in sorted(case["machines"], key=int):
        p = case["machines"][bus]["params_machine_base"]
        lines.append(f"{bus} '{model}' '1' " + " ".join(exact(p[c]) for c in COLUMNS[model]) + " /")
    return "\n".join(lines) + "\n"


def main():
    source = Path(sys.argv[1])
    out = Path(sys.argv[2]) if len(sys.argv) > 2 else Path(__file__).parent
    for stem in ("ieee39_gencls", "ieee39_genrou", "ieee14_genrou"):
        case = json.loads((source / f"{stem}_ev1.json").read_text())
        grid, kind = stem.split("_")
        model = case["machine_model"]
        own = {int(bus): m["mbase_mva"] for bus, m in case["machines"].items()}
        origin = f"{case['network_file']}; solution and {model} parameters as in the ANDES 1.10.1 reference run"
        for name, bases, note in ((stem, own, "machine bases of that run"),
                                  (f"{grid}_dataset_{kind}", DATASET_MVA[grid], "machine bases of the dataset")):
            titles = [f"IEEE {grid[4:]} bus, all {model}, {note}", f"From {origin}"]
            (out / f"{name}.raw").write_text(raw(case, model, bases, titles))
            (out / f"{name}.dyr").write_text(dyr(case, model))


if __name__ == "__main__":
    main()
