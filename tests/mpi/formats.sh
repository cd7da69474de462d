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

# Units and axes, as a viewer and xarray find them; 16-bit records at drawn operating points have further arrays.
axes() { "$python3" "$SWINGBANK_SOURCE/tests/jobs/axes.py" "$@" || fail "axes of $1"; }
of_rows=("records=sample_id,channel,time" "parameters=sample_id,parameter" "generator=sample_id"
  "fault=sample_id,fault_column" "largest_spread=sample_id" "angle_valid=sample_id,time"
  "draws/outcome=draws/sample_id")
for file in shards/shard-000000.h5 dataset.h5; do axes "$file" "${of_rows[@]}"; done
"$generate" "$configs/ieee14_genrou_points.toml" --draws 8 --draws-per-shard 4 --int16 --channels P frequency --progress none \
  --out "$work/int16" >/dev/null 2>&1
for file in shards/shard-000000.h5 dataset.h5; do
  axes "$work/int16/$file" "${of_rows[@]}" record_scale=sample_id,channel,record_scale_column machine_base=sample_id \
    draws/redrawn=draws/sample_id,draws/redrawn_column
done
"$SWINGBANK_BIN/swingbank-databank" "$configs/ieee14_genrou_bus3.toml" --points 50 --out "$work/bank.h5" >/dev/null 2>&1
axes "$work/bank.h5" parameters=point,parameter
