#!/usr/bin/python3
"""Prints axes, unit and meaning of every array of a shard, dataset.h5, databank or run: python3 show_axes.py FILE.h5"""
import sys

import h5py


def show(name, array):
    if isinstance(array, h5py.Dataset):
        axes = [dimension.keys()[0] if len(dimension) else name for dimension in array.dims]
        sizes = ", ".join(f"{axis}: {size}" for axis, size in zip(axes, array.shape))
        print(f"{name} ({sizes}) [{array.attrs['units']}] {array.attrs['long_name']}")


with h5py.File(sys.argv[1]) as file:
    file.visititems(show)
try:
    import xarray
except ImportError:
    sys.exit()
print(xarray.open_dataset(sys.argv[1], engine="h5netcdf"))
