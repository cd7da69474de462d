#!/usr/bin/env bash
<<<<<<< HEAD
# The lines of Python in docs/reference/formats.md read a shard.
=======
# The Python lines of docs/formats.md read a shard.
>>>>>>> 4a9caa8b656077bca57e84fb52af7a5d9cb9f4e8
source "$(dirname "$0")/common.bash"
"$generate" "$configs/ieee14_genrou_bus3.toml" --draws 30 --progress none --out "$work/data" >/dev/null 2>&1
# shellcheck disable=SC2016 # backquotes of Markdown
sed -n '/^```python/,/^```/{/^```/d;p}' "$SWINGBANK_SOURCE/docs/reference/formats.md" >"$work/read.py"
[ "$(wc -l <"$work/read.py")" -ge 5 ] || fail "no lines of Python in docs/reference/formats.md"
cat >>"$work/read.py" <<'PYTHON'
import numpy
assert records.shape[1:] == (7, 1800) and 10 < len(records) <= 30 and records.dtype == numpy.float32
assert len(parameters) == 14 and list(parameters)[4] == "H" and parameters["H"].shape == (len(records),)
assert ((parameters["H"] >= 1) & (parameters["H"] <= 10)).all() and parameters["H"].std() > 1
assert (speed[:, 0] == 0).all() and abs(speed).max() > 1e-4  # at rest before the fault, moved by it
assert shard.attrs["format"] == "swingbank-shard-1" and shard.attrs["rate"] == 120.0
assert (shard["fault"][:, 1] == 2.0).all() and (shard["fault"][:, 0] != 3).all()
assert (shard["draws/outcome"][:] == 0).sum() == len(records)
PYTHON
cat >>"$work/read.py" <<'PYTHON'
import json
header = json.load(open("dataset.json"))
assert header["frequency"] == 60.0 and header["generators"] == [3] and header["machine_base"] == [60.0]
assert dict(zip(header["held_names"], header["held"][0])) == {"Ra": 0.0}
PYTHON
cd "$work/data" && "$python3" "$work/read.py"
