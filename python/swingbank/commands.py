"""Location of the commands of this installation (swingbank-predict, swingbank-read-hdf5)."""
from __future__ import annotations

import os
import pathlib
import shutil

from .errors import InputError


def _candidates() -> list[pathlib.Path]:
    """Returns the folders that may hold the commands: SWINGBANK_BIN, the build or installation, and the PATH.

    In an installation, bin/swingbank is a link into the folder of the commands."""
    found = []
    if os.environ.get("SWINGBANK_BIN"):
        found.append(pathlib.Path(os.environ["SWINGBANK_BIN"]))
    for parent in pathlib.Path(os.path.abspath(__file__)).parents:
        found.append((parent / "bin" / "swingbank").resolve().parent)
    command = shutil.which("swingbank")
    if command:
        found.append(pathlib.Path(command).resolve().parent)
    return found


def folder() -> pathlib.Path | None:
    """Returns the folder of the commands; None: they are not installed."""
    for candidate in _candidates():
        if (candidate / "swingbank").exists() and (candidate / "swingbank-read-hdf5").exists():
            return candidate
    return None


def command(name: str) -> pathlib.Path:
    """Returns the path of `swingbank-<name>`. Raises InputError if it is not installed."""
    place = folder()
    if place is None or not (place / f"swingbank-{name}").exists():
        raise InputError([(f"swingbank {name}", str(place or "PATH"), "the command is not installed",
                           "install Swingbank's commands, or set SWINGBANK_BIN to their folder")])
    return place / f"swingbank-{name}"
