#!/usr/bin/env bash
# A shard and a header as docs/reference/formats.md describes them, read with h5py.
source "$(dirname "$0")/common.bash"
"$generate" "$configs/ieee14_genrou_bus3.toml" --draws 30 --progress none --out "$work/data" >/dev/null 2>&1
cat >"$work/read.py" <<'PYTHON'
import json

import h5py
import numpy

shard = h5py.File("shards/shard-000000.h5")
records = shard["records"][:]
parameters = dict(zip(shard.attrs["parameter_names"], shard["parameters"][:].T))
speed = records[:, list(shard.attrs["channel_names"]).index("speed"), :]
assert records.shape[1:] == (7, 1800) and 10 < len(records) <= 30 and records.dtype == numpy.float32
assert len(parameters) == 14 and list(parameters)[4] == "H" and parameters["H"].shape == (len(records),)
assert ((parameters["H"] >= 1) & (parameters["H"] <= 10)).all() and parameters["H"].std() > 1
assert (speed[:, 0] == 0).all() and abs(speed).max() > 1e-4  # at rest before the fault, moved by it
assert shard.attrs["format"] == "swingbank-shard-1" and shard.attrs["rate"] == 120.0
assert (shard["fault"][:, 1] == 2.0).all() and (shard["fault"][:, 0] != 3).all()
assert (shard["draws/outcome"][:] == 0).sum() == len(records)
header = json.load(open("dataset.json"))
assert header["frequency"] == 60.0 and header["generators"] == [3] and header["machine_base"] == [60.0]
assert dict(zip(header["held_names"], header["held"][0])) == {"Ra": 0.0}
PYTHON
cd "$work/data" && "$python3" "$work/read.py"
