"""Notebooks of the gallery: each runs from its first to its last cell, in the folder of the example configs."""
import importlib.util
import json
import os
import re
import unittest

import nbclient
import nbformat
from case import BIN, SOURCE

os.environ["PATH"] = f"{BIN}:{os.environ['PATH']}"


class Notebooks(unittest.TestCase):
    def run_notebook(self, name):
        notebook = nbformat.read(SOURCE / "python/notebooks" / name, as_version=4)
        nbclient.NotebookClient(notebook, timeout=900, kernel_name="python3",
                                resources={"metadata": {"path": str(SOURCE)}}).execute()
        return notebook

    def views(self, notebook):
        return [output["data"]["text/html"] for cell in notebook.cells if cell.cell_type == "code"
                for output in cell.outputs if "text/html" in output.get("data", {})]

    def test_play_in(self):
        self.assertIn("<svg", self.views(self.run_notebook("play_in.ipynb"))[0])

    def test_what_is_missing(self):
        notebook = self.run_notebook("what_is_missing.ipynb")
        self.assertIn("SEXS", self.views(notebook)[1])
        before, after = re.search(r"unseen event: ([0-9.]+) -> ([0-9.]+) Mvar", json.dumps(notebook)).groups()
        self.assertLess(float(after), 0.05 * float(before))

    def test_fleet(self):
        self.run_notebook("fleet.ipynb")

    @unittest.skipUnless(importlib.util.find_spec("torch"), "PyTorch is not installed")
    def test_dataset_and_network(self):
        self.run_notebook("dataset_and_network.ipynb")


if __name__ == "__main__":
    unittest.main()
