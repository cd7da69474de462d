"""Type stubs: complete, and clean under mypy's strict rules, in the package and in a program that uses it."""
import pathlib
import subprocess
import tempfile
import unittest

import swingbank

PROGRAM = """
import numpy as np
from numpy.typing import NDArray

import swingbank

plant = swingbank.Plant("plant.toml")
played: swingbank.Playback = plant.play("event.csv", power_only=True)
residual: NDArray[np.float64] = played["Q"].residual
fitted: float = plant.calibrate(["a.csv", "b.csv"], hold_out=["b.csv"]).parameters[0].value
chosen: dict[str, float] = plant.calibrate(["a.csv"], sparse=True).evidence
point = swingbank.Point("point.toml", plant)
events: int = len(point.plant.compare(point.records(["a.csv"], columns={"V": "U1 [kV]"})).events)
names: list[str] = plant.diagnose([swingbank.Record("a.csv", plant), "b.csv"]).effects
rows: int = len(swingbank.Dataset("folder"))
value: float = swingbank.predict("network", plant, ["a.csv"])["H"].value
"""
WRONG = PROGRAM + 'wrong: int = plant.play("event.csv").name\n'


class Types(unittest.TestCase):
    def mypy(self, text):
        package = pathlib.Path(swingbank.__file__).parent
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "program.py"
            program.write_text(text)
            return subprocess.run(
                ["/usr/bin/mypy", "--strict", "--python-executable", "/usr/bin/python3", "--cache-dir",
                 folder + "/cache", str(package), str(program)],
                capture_output=True, text=True, check=False, cwd=folder)

    def test_package_and_program(self):
        done = self.mypy(PROGRAM)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_wrong_program(self):
        done = self.mypy(WRONG)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn('has type "str"', done.stdout)

    def test_stub_of_the_extension(self):
        # pybind11's metaclass, the constructors of results, and names of types that only the stub has
        allowed = "swingbank\\._native\\.[A-Z]\\w+\nswingbank\\._native\\.\\w+\\.__init__\n"
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "allowed").write_text(allowed)
            done = subprocess.run(["/usr/bin/stubtest", "swingbank._native", "--ignore-positional-only", "--allowlist",
                                   "allowed", "--ignore-unused-allowlist"], capture_output=True, text=True, check=False,
                                  cwd=folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_documentation(self):
        for name, item in vars(swingbank._native).items():
            if isinstance(item, type):
                self.assertTrue(item.__doc__, name)
        for method in ("play", "compare", "sensitivities", "calibrate", "add", "diagnose"):
            self.assertIn("record", getattr(swingbank.Plant, method).__doc__)


if __name__ == "__main__":
    unittest.main()
