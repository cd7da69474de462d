#!/usr/bin/python3
"""Prints the smallest distance between two samples of a databank, in the units of the parameters:
python3 read_databank.py bank.h5"""
import sys

import h5py
import numpy

with h5py.File(sys.argv[1]) as bank:
    points = bank["parameters"][:]  # samples x parameters
    names = list(bank.attrs["parameter_names"])
distance = numpy.linalg.norm(points[:, None, :] - points[None, :, :], axis=2)
numpy.fill_diagonal(distance, numpy.inf)
print(f"{len(points)} samples of {', '.join(str(n) for n in names)}; smallest Euclidean distance {distance.min():.4f}")
