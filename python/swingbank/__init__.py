"""Swingbank: validation of power-plant models against recorded disturbances.

    plant = swingbank.Plant("plant.toml")
    playback = plant.play("event.csv")      # in a notebook: RMS error of each channel, and curves
    plant.diagnose(["event1.csv", "event2.csv"]).sentence

The module contains the compiled library, without LibTorch and MPI. Arrays are numpy arrays; the docstrings state
shapes and units.
"""
from __future__ import annotations

from . import _native, commands as _commands
from ._native import (
    Addition,
    Calibration,
    Channel,
    Comparison,
    Diagnosis,
    Effect,
    EffectParameter,
    FittedParameter,
    Grid,
    Parameter,
    ParameterSelection,
    Plant,
    Playback,
    Point,
    Record,
    Run,
    Sensitivities,
    effects,
    simulate,
)
from .dataset import Array, Dataset
from .errors import InputError, Problem
from .prediction import Estimate, Prediction, predict

__version__: str = _native.version
__all__ = [
    "Addition", "Array", "Calibration", "Channel", "Comparison", "Dataset", "Diagnosis", "Effect", "EffectParameter",
    "Estimate", "FittedParameter", "Grid", "InputError", "Parameter", "ParameterSelection", "Plant", "Playback",
    "Point", "Prediction", "Problem", "Record", "Run", "Sensitivities", "effects", "predict", "simulate",
]

_folder = _commands.folder()
if _folder is not None:
    _native.set_commands_folder(str(_folder))
