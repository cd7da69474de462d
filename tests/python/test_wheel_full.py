"""Wheel: built by the target `wheel`, installed in a fresh virtual environment, and used there for a playback."""
import os
import pathlib
import subprocess
import tempfile
import unittest

from case import BIN, PLANT, RECORDS

import swingbank


class Wheel(unittest.TestCase):
    def test_installation(self):
        build = BIN.parent
        subprocess.run(["cmake", "--build", str(build), "--target", "wheel"], check=True, capture_output=True)
        wheels = list((build / "python/wheel").glob("swingbank-*.whl"))
        self.assertEqual(len(wheels), 1)
        text = (f"import swingbank; p = swingbank.Plant({str(PLANT)!r}).play({str(RECORDS[0])!r}); "
                "print(swingbank.__file__, p['Q'].rms)")
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["/usr/bin/python3", "-m", "venv", "--system-site-packages", folder], check=True)
            python = pathlib.Path(folder) / "bin/python"
            install = [python, "-m", "pip", "install", "--no-index", "--no-deps", "--quiet", wheels[0]]
            subprocess.run(install, check=True)
            clean = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "SWINGBANK_BIN")}
            said = subprocess.run([python, "-c", text], check=True, capture_output=True, text=True, env=clean,
                                  cwd=folder)
            where, rms = said.stdout.split()
            self.assertTrue(where.startswith(folder), where)
            self.assertEqual(float(rms), swingbank.Plant(PLANT).play(RECORDS[0])["Q"].rms)
            listed = subprocess.run([python, "-m", "pip", "show", "swingbank"], check=True, capture_output=True,
                                    text=True, env=clean)
            self.assertIn(f"Version: {swingbank.__version__}", listed.stdout)


if __name__ == "__main__":
    unittest.main()
