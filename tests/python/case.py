"""Example plant and records, and the commands of the build, for the tests of the Python package."""
import json
import os
import pathlib
import subprocess

SOURCE = pathlib.Path(os.environ["SWINGBANK_SOURCE"])
BIN = pathlib.Path(os.environ["SWINGBANK_BIN"])
PLANT = SOURCE / "configs/plants/ieee14_bus2.toml"
RECORDS = [SOURCE / f"configs/records/record-example/avr_ev{k}.csv" for k in (1, 2, 3, 4)]


def run(*words, codes=(0,)):
    """Returns the standard output of a command; `codes`: accepted exit codes."""
    done = subprocess.run([str(BIN / "swingbank"), *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode in codes, (done.returncode, done.stderr)
    return done.stdout


def run_json(*words, codes=(0,)):
    """Returns the JSON that a command prints."""
    return json.loads(run(*words, codes=codes))


def python(text, **environment):
    """Runs Python code in a new process with the package; returns the completed process."""
    return subprocess.run(["/usr/bin/python3", "-c", text], capture_output=True, text=True, check=False,
                          env={**os.environ, **environment})
