#!/usr/bin/python3
"""Loads a trained network of kind cnn into PyTorch and estimates the parameters of a record:
python3 load_network.py run.network record.npy. The record is an array of channels x samples from t = 0, in the units
of the dataset."""
import json
import sys

import numpy
import torch
from torch.nn import functional as nn


def read(path):
    """Returns header and arrays of a network file (train/run/README.md)."""
    data, at = open(path, "rb").read(), len(b"swingbank-network-1\n")

    def take(count, kind):
        nonlocal at
        at += count * numpy.dtype(kind).itemsize
        return numpy.frombuffer(data, kind, count, at - count * numpy.dtype(kind).itemsize)

    header = json.loads(take(int(take(1, "<u8")[0]), "u1").tobytes())
    arrays = [torch.tensor(take(int(take(1, "<u8")[0]), "<f4")) for _ in range(int(take(1, "<u8")[0]))]
    return header, arrays


def same(x, weight, bias):
    """Returns a convolution with as many samples as x; weight: taps x inputs x outputs."""
    taps = weight.shape[0]
    return nn.relu(nn.conv1d(nn.pad(x, ((taps - 1) // 2, taps // 2)), weight.permute(2, 1, 0), bias))


def estimate(path, record):
    """Returns the estimated parameters by name."""
    h, (mean, deviation, w1, b1, w2, b2, *dense) = read(path)
    assert h["kind"] == "cnn" and h["features"]["pca_components"] == 0 and h["input"]["form"] == "deviation", h["input"]
    cut = h["input"]
    series = torch.tensor(record - record[:, :1])[:, cut["first"]:][:, :cut["step"] * cut["samples"]:cut["step"]]
    x = ((series - mean[:, None]) / deviation[:, None])[None]
    taps = cut["samples"] // 4
    x = nn.max_pool1d(same(x, w1.reshape(taps, -1, 256), b1), 4)
    x = nn.max_pool1d(same(x, w2.reshape(taps, 256, 512), b2), 2)
    x = x.permute(0, 2, 1).flatten(1)
    for weight, bias in zip(dense[::2], dense[1::2]):
        x = nn.relu(x @ weight.reshape(-1, len(bias)) + bias)
    return {p["name"]: min(max(y * p["scale"] + p["origin"], p["low"]), p["high"])
            for p, y in zip(h["parameters"], x[0].tolist())}


if __name__ == "__main__":
    print(json.dumps(estimate(sys.argv[1], numpy.load(sys.argv[2]).astype("float32"))))
