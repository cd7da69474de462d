"""Prints the outcome of each report of the gallery, one line a case, from the JSON files in the current folder."""
import json
import pathlib


def read(file):
    return json.loads(pathlib.Path(file).read_text())


def named(case):
    d = read(f"{case}/diagnosis/diagnosis.json")
    wrong = d["wrong_parameters"]
    if not d["effects"]:
        return f"nothing missing, {len(wrong['wrong'] if isinstance(wrong, dict) else wrong)} values wrong"
    first = d["probabilities"][0]
    return f"{first['name']} missing ({100 * first['probability']:.0f} %)"


def error(case, result, record, channel):
    """Returns the RMS error of a channel before and after the change, in a held-out event."""
    before, after = [e for e in read(f"{case}/{result}")["errors"] if (e["record"], e["channel"]) == (record, channel)]
    return (f"RMS error of {channel} in the held-out event {before['rms']:.3g} -> {after['rms']:.3g} {after['unit']} "
            f"(noise {after['noise']:.3g} {after['unit']})")


print(f"missing exciter: {named('exciter')}; {error('exciter', 'added/add.json', 'avr_ev4.csv', 'Q')}")
print(f"missing governor: {named('governor')}; {error('governor', 'added/add.json', 'event4.csv', 'P')}")
values = "; ".join(f"{w['name']} {w['model']:.3g} -> {w['fitted']:.3g} {w['unit']}"
                   for w in read("values/calibrated/calibrate.json")["wrong"])
print(f"wrong values: {named('values')}; {values}; {error('values', 'calibrated/calibrate.json', 'event4.csv', 'Q')}")
