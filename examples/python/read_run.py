#!/usr/bin/python3
"""Prints the range of each channel of one simulated run: python3 read_run.py run.h5"""
import sys

import h5py

with h5py.File(sys.argv[1]) as run:
    time = run["time"][:]
    records = run["records"][:]  # plants x channels x samples
    print(f"{run.attrs['outcome']}: {time[0]:g} to {time[-1]:g} s, {len(time)} samples")
    for plant, of_plant in zip(run.attrs["plant_names"], records):
        for name, unit, values in zip(run.attrs["channel_names"], run.attrs["channel_units"], of_plant):
            print(f"{plant}.{name}: {values.min():.5g} to {values.max():.5g} {unit}")
