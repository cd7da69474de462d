#!/usr/bin/env python3
"""Cuts the ANDES records down to what the tests compare: excerpt.py <folder with *.csv and *.json>.

Writes <case>.csv (every 6th sample from 2 s to 5 s, every 24th elsewhere, and the switching times, where a row
contains the values just before) and <case>.json (fault, units' bases, values just after each switching, estimated
error).
"""
import csv
import json
import pathlib
import sys

CHANNELS = ["delta_rad", "omega_pu", "Pe_pu", "Qe_pu", "Vt_pu", "theta_rad", "Ifd_pu"]


def excerpt(path: pathlib.Path, out: pathlib.Path) -> None:
    case = json.loads(path.read_text())
    rate, fault = case["fs"], case["fault"]
    instants = {round(fault[t] * rate) for t in ("t_on", "t_off")}
    units = list(case["machines"])
    # The classical machine has no field current: ANDES repeats E there.
    channels = CHANNELS if case["machine_model"] == "GENROU" else CHANNELS[:-1]
    columns = ["t_s"] + [f"g{u}_{c}" for u in units for c in channels]
    with path.with_suffix(".csv").open() as file, (out / (path.stem + ".csv")).open("w") as to:
        rows = csv.DictReader(file)
        print(",".join(columns), file=to)
        for k, row in enumerate(rows):
            dense = 2 * rate <= k <= 5 * rate
            if k in instants or k % (6 if dense else 24) == 0:
                print(",".join(row[c] for c in columns), file=to)
    kept = {
        "source": case["source"],
        "machine_model": case["machine_model"],
        "rate": rate,
        "fault": fault,
        "right_limits": {t: {u: {c: values["g" + u][c] for c in channels} for u in units}
                         for t, values in case["right_limit_at_events"].items()},
        "estimated_error": case["integration"]["est_max_abs_error"],
    }
    (out / (path.stem + ".json")).write_text(json.dumps(kept, indent=1) + "\n")


if __name__ == "__main__":
    here = pathlib.Path(__file__).parent
    for record in sorted(pathlib.Path(sys.argv[1]).glob("*.json")):
        excerpt(record, here)
