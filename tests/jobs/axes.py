"""Checks units, meaning and axes of every array of an HDF5 file, by h5py, HDF5's own functions and xarray.

  axes.py FILE ARRAY=SCALE,SCALE... ...    the arrays with axes; all others must be scales"""
import sys

import h5py
import xarray

file, *stated = sys.argv[1:]
axes = {array: scales.split(",") for array, scales in (text.split("=") for text in stated)}
with h5py.File(file) as opened:
    found = {}
    opened.visititems(lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None)
    used = {scale for scales in axes.values() for scale in scales}
    assert set(found) == set(axes) | used, (set(found) ^ (set(axes) | used))
    for name, array in found.items():
        for key in ("units", "long_name"):
            assert isinstance(array.attrs[key], str) and array.attrs[key], (name, key)
        assert h5py.h5ds.is_scale(array.id) == (name in used), name
        if name in used:
            assert array.ndim == 1 and h5py.h5ds.get_scale_name(array.id).decode() == name.rsplit("/", 1)[-1], name
            continue
        assert len(axes[name]) == array.ndim, (name, array.shape)
        for index, scale in enumerate(axes[name]):
            assert h5py.h5ds.get_num_scales(array.id, index) == 1, (name, scale)
            assert h5py.h5ds.is_attached(array.id, found[scale].id, index), (name, scale)
            assert array.dims[index][0] == found[scale] and array.shape[index] == len(found[scale]), (name, scale)
    channels = [text.decode() for text in found["channel"][:]] if "channel" in found else None
    assert channels is None or channels == list(opened.attrs["channel_names"]), channels
for group in sorted({"/" + name.rpartition("/")[0] for name in found}):
    with xarray.open_dataset(file, engine="h5netcdf", group=group) as tables:
        for name, scales in axes.items():
            if "/" + name.rpartition("/")[0] == group:
                names = tuple(scale.rsplit("/", 1)[-1] for scale in scales)
                assert tables[name.rsplit("/", 1)[-1]].dims == names, (name, tables)
        assert group != "/" or "time" not in found or tables["time"].attrs["units"] == "s", tables
