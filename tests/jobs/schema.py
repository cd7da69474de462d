"""Checks the schemas of configs/schema. Every example that names a schema must conform to it. Schema and program must
refuse each mutation below and name its key.

  schema.py SWINGBANK CONFIGS FILE...    CONFIGS: a copy of configs/, where the mutations are written"""
import csv
import io
import json
import pathlib
import re
import subprocess
import sys
import tomllib

import jsonschema

swingbank, configs, *examples = sys.argv[1:]
configs = pathlib.Path(configs)
schemas = {file.stem: json.loads(file.read_text()) for file in (configs / "schema").glob("*.json")}
validators = {}
for kind, schema in schemas.items():
    jsonschema.Draft7Validator.check_schema(schema)
    validators[kind] = jsonschema.Draft7Validator(schema)

WITHOUT_SCHEMA = {"blind", "user_models"}
used = set()
for example in map(pathlib.Path, examples):
    first = example.read_text().splitlines()[0]
    if example.parent.name in WITHOUT_SCHEMA:
        continue
    assert first.startswith("#:schema "), f"{example} does not begin with #:schema"
    named = (example.parent / first.split()[1]).resolve()
    assert named.is_file(), f"{example}: no {named}"
    for fault in validators[named.stem].iter_errors(tomllib.loads(example.read_text())):
        sys.exit(f"{example}: {'/'.join(map(str, fault.absolute_path))}: {fault.message[:500]}")
    used.add(named.stem)

model, record = configs / "plants/ieee14_bus2.toml", configs / "records/record-example/avr_ev1.csv"
compare = ["compare", "--model", str(model), "--record", str(record), "--out", str(configs / "out")]
BASES = {
    "plant": model,
    "dataset": configs / "datasets/ieee14_genrou_bus3.toml",
    "experiment": configs / "experiments/ieee39_gencls.toml",
    "fleet": configs / "fleet/example.toml",
    "accept": configs / "accept/example.toml",
    "system": configs / "systems/ieee14_fault_at_5.toml",
    "point": configs / "plants/point.toml",
    "benchmark": configs / "benchmark/synchronous.toml",
    "records": record,
}
BASES["point"].write_text(f"""[collector]
r_pu = 0.002
x_pu = 0.05
base_mva = 300.0
[[unit]]
model = "{model.name}"
[[unit]]
model = "other.toml"
share = 0.35
""")
(configs / "plants/other.toml").write_text(model.read_text())
COMMANDS = {
    "plant": ["export", "--model"],
    "dataset": ["databank", "--points", "1"],
    "experiment": ["cross-validate", "--print", "table", "--experiment"],
    "fleet": ["diagnose", "--out", str(configs / "out"), "--fleet"],
    "accept": compare + ["--accept"],
    "system": ["compare", "--out", str(configs / "out"), "--system"],
    "point": compare + ["--point"],
    "benchmark": ["benchmark", "--model", str(model), "--against", str(model), "--out", str(configs / "out"), "--tests"],
    "records": ["compare", "--model", str(model), "--out", str(configs / "out"), "--record"],
}
END = None  # instead of a text to replace: the mutation is appended to the file
# kind: text, replacement, and what the program's message contains
MUTATIONS = {
    "plant": [
        ("Ra = 0.0\n", "Ra = 0.0\ncolour = 1.0\n", "machine.colour"),
        ("Xd = 1.8 ", "# ", "machine.Xd"),
        ("H = 6.54 ", 'H = "6.54" ', "machine.H"),
        ("base_mva = 100.0         # machine", "base_mva = 0.0 # ", "plant.base_mva"),
        ("base_mva = 100.0         # machine", "# ", "plant.base_mva"),
        ('"GENROU"', '"GENROX"', "machine.effect"),
        ('"andes"', '"pslf"', "plant.conventions"),
        ("[machine]", "[converter]", "converter.effect"),
        (END, '[nameplate]\nrecorded = "01.03.2026"\n', "nameplate.recorded"),
        (END, '[nameplate]\nowner = " "\n', "nameplate.owner"),
        (END, '[[exciter]]\neffect = "SEXS"\ndefault_values = true\n', "[[exciter]]"),
        (END, '[exciter]\neffect = "SEXS"\nK = 200.0\n', "exciter.TB"),
        (END, '[exciter]\neffect = "TGOV1"\ndefault_values = true\n', "exciter.effect"),
        (END, '[[limiter]]\neffect = "MAXEX2"\ndefault_values = true\ncolour = 1\n', "colour"),
        (END, '[[event]]\nkind = "open_circuit"\nsize = 1.0\n', "size"),
        (END, '[[event]]\nkind = "vref_step"\ntime = 1.0\n', "size"),
        (END, '[nameplate]\nowner = "x"\ncolour = "y"\n', "nameplate.colour"),
        (END, '[nameplate]\nmva = 0.0\n', "nameplate.mva"),
        (END, '[dispatch]\nP_MW = 1.0\nQ_Mvar = 1.0\n', "dispatch.V_pu"),
        (END, '[grid]\nraw = "../networks/ieee14_genrou.raw"\ndyr = "../networks/ieee14_genrou.dyr"\nbus = 2\n', "machine"),
    ],
    "dataset": [
        ("seed = 1", "sed = 1", "sed"),
        ("seed = 1", "seed = 1.5", "seed"),
        ("seed = 1", "seed = 1\nshard_megabytes = 1.0", "shard size given twice"),
        ("draws = 720000", "draws = 0", "draws"),
        ('"one"', '"two"', "vary.who"),
        ('"GENROU"', '"SEXS"', "vary.model"),
        ("H = [1.0, 10.0]", "H = [1.0, 10.0, 11.0]", "vary.box.H"),
        ("H = [1.0, 10.0]", 'H = "ten"', "vary.box.H"),
        ("H = [1.0, 10.0]", "colour = [1.0, 10.0]", "parameter colour"),
        ('buses = "any"', 'buses = "all"', "fault.buses"),
        ("rate = 120.0", "# ", "record.rate"),
        (END, "[vary.effects.NOSUCH]\nK = [1.0, 2.0]\n", "NOSUCH"),
        (END, "[vary.effects.SEXS]\ncolour = [1.0, 2.0]\n", "colour"),
        (END, "[operating_point]\nvoltage = 1.0\n", "operating_point.voltage"),
    ],
    "experiment": [
        ("title = ", "titel = ", "titel"),
        ("folds = ", "# ", "folds"),
        ('schedule = "cosine"', 'schedule = "sine"', "schedule"),
        ("epochs = ", "epochs = 0 # ", "epochs"),
        ("batch = ", 'batch = "x" # ', "batch"),
        ("patience = ", "# ", "patience"),
    ],
    "fleet": [
        ("[plant.bus2]\nmodel = ", "[plant.bus2]\n# ", "plant.bus2.model"),
        ("power_only = true ", 'power_only = "yes" ', "options.power_only"),
        ("power_only = false", "prior_sd = 5.0", "prior_sd"),
        ("power_only = false", "colour = 1", "colour"),
        ('records = ["../records/record-example/avr_ev*.csv"]', 'records = "avr_ev1.csv"', "plant.bus2.records"),
    ],
    "accept": [
        ('"dtr-test"', '"dtr"', "preset"),
        ('preset = "dtr-test"', "", "P.fault.mxe"),
        ("mxe = 6.0", "mxe = 0.0", "P.post_fault.mxe"),
        ("mxe = 6.0", "colour = 6.0", "P.post_fault.colour"),
        ("error = 20", 'error = "20"', "movement.error"),
        ('source = ', "# ", "source"),
    ],
    "system": [
        ('"andes"', '"pslf"', "system.conventions"),
        ("raw = ", "# ", "system.raw"),
        ("raw = ", "colour = 1\nraw = ", "system.colour"),
        ("base_mva = 100.0", 'base_mva = "100"', "record.base_mva"),
        (END, "[compare]\ntolerance = 1.0\n", "compare.tolerance"),
    ],
    "benchmark": [
        ('kind = "voltage_dip"', 'kind = "voltage_drop"', "kind"),
        ('kind = "voltage_dip"', 'kind = "voltage_dip"\ncolour = 1', "colour"),
        ("event = 1.0", 'event = "1"', "event"),
        ("event = 1.0", "# ", "event"),
        ("rate = ", "rate = 1.0 # ", "operating_point.rate"),
        ("name = ", "# ", "name"),
    ],
    "point": [
        ("r_pu = 0.002", "r_pu = -1.0", "collector.r_pu"),
        ("x_pu = 0.05", "# ", "collector.x_pu"),
        ("share = 0.35", "share = 2.0", "share"),
        ("share = 0.35", "share = 0.35\ncolour = 1", "colour"),
        ('model = "other.toml"', "", "model"),
    ],
    "records": [
        ("t_s,", "x,", "time"),
        (",V_pu,", ",colour,", "V"),
        (",P_pu,", ",colour,", "P"),
    ],
}
assert set(MUTATIONS) == set(schemas), set(MUTATIONS) ^ set(schemas)
assert used == set(schemas) - {"point", "records"}, used


def parsed(kind, text):
    if kind != "records":
        return tomllib.loads(text)
    names, first = list(csv.reader(io.StringIO(text)))[:2]
    return dict(zip(names, map(float, first)))


def mutated(text, old, new):
    if old is END:
        return text + new
    assert old in text, old
    return text.replace(old, new, 1)


def refusal(kind, text):
    """Returns the program's error message for a file that it must refuse."""
    file = BASES[kind].with_name("mutated" + BASES[kind].suffix)
    file.write_text(text)
    ran = subprocess.run([swingbank, *COMMANDS[kind], str(file)], capture_output=True, text=True)
    assert ran.returncode == 1, f"{kind}: exit code {ran.returncode} of\n{text}"
    return ran.stderr


# Additions to a plant file that occur in no example; schema and program accept them.
for text in ('[nameplate]\nowner = "x"\n', '[nameplate]\nmva = 100.0\ntested = "2026-03"\n[nameplate.exciter]\nmodel = "y"\n'):
    whole = BASES["plant"].read_text() + text
    for fault in validators["plant"].iter_errors(tomllib.loads(whole)):
        sys.exit(f"the schema refuses\n{text}{fault.message[:500]}")
    file = BASES["plant"].with_name("accepted.toml")
    file.write_text(whole)
    subprocess.run([swingbank, *COMMANDS["plant"], str(file)], capture_output=True, check=True)

for kind, mutations in MUTATIONS.items():
    base = BASES[kind].read_text()
    assert validators[kind].is_valid(parsed(kind, base)), kind
    for old, new, names in mutations:
        faults = list(validators[kind].iter_errors(parsed(kind, mutated(base, old, new))))
        assert faults, f"{kind}: schema accepts {new}"
        if kind == "records":
            continue
        said = "\n".join(f"{'.'.join(map(str, fault.absolute_path))}: {fault.message}" for fault in faults)
        assert "under any of the given" not in said, f"{kind}: unspecific messages\n{said}"
        assert any(word in said for word in re.findall(r"\w+", names)), f"{kind}: {names} is not in\n{said}"
    # LibTorch takes 0.6 s to load: the program reads all mutations of an experiment at once.
    if kind == "experiment":
        for old, new, names in mutations:
            base = mutated(base, old, new)
        said = refusal(kind, base)
        for old, new, names in mutations:
            assert names in said, f"{kind}: {names} is not in\n{said}"
    else:
        for old, new, names in mutations:
            said = refusal(kind, mutated(base, old, new))
            assert names in said, f"{kind}: {names} is not in\n{said}"
