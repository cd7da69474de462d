#!/usr/bin/python3
"""Reads a dataset folder of `swingbank generate`: python3 read_dataset.py FOLDER"""
import json
import pathlib
import sys

import h5py

folder = pathlib.Path(sys.argv[1])
header = json.loads((folder / "dataset.json").read_text())
for path in sorted(folder.glob("shards/**/shard-*.h5")):
    with h5py.File(path) as shard:
        records = shard["records"][:]  # rows x channels x samples
        if "record_scale" in shard:  # int16 codes: value = offset + step * code
            scale = shard["record_scale"][:].astype(float)  # rows x channels x (offset, step)
            offset, step = scale[:, :, 0, None], scale[:, :, 1, None]
            records = offset + step * records
        print(f"{path.name}: {len(records)} records at {shard.attrs['rate']:g}/s")
        for name, unit, values in zip(header["parameter_names"], header["parameter_units"], shard["parameters"][:].T):
            print(f"  {name}: mean {values.mean():.4f} {unit}")
        for name, unit, values in zip(header["channel_names"], header["channel_units"], records.transpose(1, 0, 2)):
            print(f"  {name}: {values.min():.5g} to {values.max():.5g} {unit}")
