"""Estimates of a trained network, by the command `swingbank predict`.

LibTorch stays in the command's own process: loading it takes 0.6 s, and a Python process may hold PyTorch's own copy.
"""
from __future__ import annotations

import json
import os
import pathlib
import re
import subprocess
import tempfile
from typing import Any, Mapping, NamedTuple, Sequence

from . import _native
from .commands import command
from .errors import InputError


class Estimate(NamedTuple):
    """Estimate of one parameter, mean over the records. `rmse`: root mean square error on the network's test rows;
    `scatter`: standard deviation between the records; all in `unit`."""

    name: str
    unit: str
    value: float
    rmse: float
    scatter: float


class Prediction:
    """Estimates of a network by parameter name: `prediction["H"].value`. `content`: the command's JSON."""

    def __init__(self, content: Mapping[str, Any]) -> None:
        self.content = dict(content)
        self.estimates = {
            p["name"]: Estimate(p["name"], p["unit"], p["estimate"], p["spread"], p["scatter"])
            for p in content["parameters"]
        }
        self.warnings = [f"{r['file']} differs from the training data; do not trust its estimate"
                         for r in content["records"] if r["unlike_training"]]

    def __getitem__(self, name: str) -> Estimate:
        return self.estimates[name]

    def __repr__(self) -> str:
        return "<swingbank.Prediction: " + ", ".join(
            f"{e.name} = {e.value:.4g} {e.unit}" for e in self.estimates.values()) + ">"

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><td>{e.name}</td><td>{e.value:.4g}</td><td>{e.rmse:.3g}</td><td>{e.unit}</td></tr>"
                       for e in self.estimates.values())
        notes = "".join(f"<p>{warning}</p>" for warning in self.warnings)
        heading = "".join(f"<th>{name}</th>" for name in ("parameter", "estimate", "RMSE", "unit"))
        return f"<div>{notes}<table><tr>{heading}</tr>{rows}</table></div>"


def _file_of(record: _native.Record | str | os.PathLike[str]) -> str:
    file = record.source if isinstance(record, _native.Record) else os.fspath(record)
    if not file:
        raise InputError([("a record without a file", "records", "swingbank predict reads files",
                           "give the path of the record")])
    return file


def _problems(messages: str) -> list[tuple[str, str, str, str]]:
    """Returns the problems among the command's messages: "<what> at <where> (<why>): <do>"."""
    lines = [line for line in messages.splitlines() if not line.startswith("warning: ")]
    found = [re.fullmatch(r"(.*?) at (.*?) \((.*)\): (.*)", line) for line in lines]
    return [(m[1], m[2], m[3], m[4]) for m in found if m]


def predict(network: str | os.PathLike[str], plant: _native.Plant,
            records: Sequence[_native.Record | str | os.PathLike[str]]) -> Prediction:
    """Estimates the plant's parameters with a trained network (`file.network`, or a folder with one).

    Runs the command `swingbank predict` in a process of its own. Raises InputError with its messages.
    """
    program = command("predict")
    with tempfile.TemporaryDirectory(prefix="swingbank-") as folder:
        model, out = pathlib.Path(folder) / "plant.toml", pathlib.Path(folder) / "estimate.json"
        plant.save(os.fspath(model))
        done = subprocess.run(
            [program, "--network", os.fspath(network), "--model", model, "--out", out, "--records",
             *map(_file_of, records)], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise InputError(_problems(done.stderr) or
                             [("no estimate", "swingbank predict", f"it ended with code {done.returncode}",
                               "run the command in a terminal to see its messages")])
        return Prediction(json.loads(out.read_text()))
