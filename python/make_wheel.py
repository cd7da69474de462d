"""Packs the package of a build folder as a wheel: make_wheel.py PACKAGE VERSION FOLDER.

The wheel contains the extension and the Python sources, but no system libraries: it needs those of
Debian (docs/how-to/python.md).
"""
import pathlib
import shutil
import subprocess
import sys
import sysconfig
import tempfile

METADATA = """Metadata-Version: 2.1
Name: swingbank
Version: {version}
Summary: Validation of power-plant models against recorded disturbances
License: BSD-3-Clause
Requires-Python: >=3.11
Requires-Dist: numpy
Provides-Extra: datasets
Requires-Dist: h5py; extra == 'datasets'
"""
WHEEL = """Wheel-Version: 1.0
Generator: swingbank
Root-Is-Purelib: false
Tag: {tag}
"""


def tag():
    """Returns the tag of this interpreter and platform, "cp311-cp311-linux_x86_64"."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-" + sysconfig.get_platform().replace("-", "_").replace(".", "_")


def main(package, version, folder):
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as work:
        root = pathlib.Path(work) / f"swingbank-{version}"
        shutil.copytree(package, root / "swingbank", ignore=shutil.ignore_patterns("__pycache__"))
        info = root / f"swingbank-{version}.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(METADATA.format(version=version))
        (info / "WHEEL").write_text(WHEEL.format(tag=tag()))
        subprocess.run([sys.executable, "-m", "wheel", "pack", str(root), "--dest-dir", str(folder)], check=True)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3]))
