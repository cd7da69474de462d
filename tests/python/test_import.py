"""Import of the package: neither MPI nor LibTorch is loaded."""
import subprocess
import unittest

import case

import swingbank

FOREIGN = ("libmpi", "libtorch", "libc10", "libhdf5_openmpi", "libopen-pal")


class Import(unittest.TestCase):
    def test_libraries_of_the_extension(self):
        said = subprocess.run(["ldd", swingbank._native.__file__], capture_output=True, text=True, check=True).stdout
        self.assertNotIn("not found", said)
        for library in FOREIGN:
            self.assertFalse(library in said, library)

    def test_libraries_and_modules_after_a_playback(self):
        text = (f"import sys, swingbank; swingbank.Plant({str(case.PLANT)!r}).play({str(case.RECORDS[0])!r});"
                "print(open('/proc/self/maps').read(), sorted(sys.modules))")
        done = case.python(text)
        self.assertEqual(done.returncode, 0, done.stderr)
        for library in (*FOREIGN, "mpi4py", "'torch'", "h5py"):
            self.assertFalse(library in done.stdout, library)

    def test_exported_symbols(self):
        said = subprocess.run(["nm", "-D", "--defined-only", swingbank._native.__file__], capture_output=True,
                              text=True, check=True).stdout
        names = {line.split()[-1] for line in said.splitlines()}
        operators = {name for name in names if name.startswith(("_Zn", "_Zd"))}  # new and delete
        self.assertEqual(names - operators, {"PyInit__native"})

    def test_version(self):
        self.assertIn(swingbank.__version__, case.run("--version"))


if __name__ == "__main__":
    unittest.main()
