"""Dataset: lazy arrays over all shards, with names and units, of records as floats and as 16-bit integers."""
import pathlib
import pickle
import tempfile
import unittest

import h5py
import numpy as np
from case import SOURCE, run

import swingbank

CONFIG = """
raw = "{networks}/ieee39_dataset_gencls.raw"
dyr = "{networks}/ieee39_dataset_gencls.dyr"
convention = "psse"
draws = 12
draws_per_shard = 4
seed = 3
[vary]
who = "one"
generators = [30, 31, 32]
model = "GENCLS"
[vary.box]
H = [2.0, 8.0]  # s
D = [1.0, 4.0]  # pu
[databank]
distance = 0.0
[fault]
buses = "any"
start = 0.5             # s
duration = [0.05, 0.1]  # s
[record]
t_end = 1.0  # s
rate = 60.0  # 1/s
channels = ["P", "Q", "speed"]
{record}
[kernel]
lanes = 0
tolerance = 1e-6
"""


def generate(folder, storage=""):
    config = pathlib.Path(folder) / "tiny.toml"
    config.write_text(CONFIG.format(networks=SOURCE / "configs/networks", record=storage))
    run("generate", config, "--out", pathlib.Path(folder) / "data")
    return pathlib.Path(folder) / "data"


def rows_of_shards(folder):
    """Records of all shards, read shard by shard."""
    parts = []
    for file in sorted((folder / "shards").glob("shard-*.h5")):
        with h5py.File(file) as shard:
            values = shard["records"][:]
            if "record_scale" in shard:
                scale = shard["record_scale"][:].astype(float)
                values = (scale[..., :1] + scale[..., 1:] * values).astype(np.float32)
            parts.append(values)
    return np.concatenate(parts)


class Datasets(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def test_floats(self):
        folder = generate(self.folder.name)
        whole = rows_of_shards(folder)
        with swingbank.Dataset(folder) as data:
            self.assertEqual(data.channels, {"P": "pu", "Q": "pu", "speed": "pu"})
            self.assertEqual(data.parameter_units, {"H": "s", "D": "pu"})
            self.assertEqual(len(data), len(whole))
            self.assertEqual(data.records.shape, whole.shape)
            np.testing.assert_array_equal(data.records[:], whole)
            np.testing.assert_array_equal(data["Q"][2:5], whole[2:5, 1])
            np.testing.assert_array_equal(data["Q"][3], whole[3, 1])
            np.testing.assert_array_equal(data["speed"][:, 10], whole[:, 2, 10])
            np.testing.assert_array_equal(np.asarray(data["P"]), whole[:, 0])
            h = data.parameters["H"]
            self.assertEqual((h.shape, h.unit), ((len(data),), "s"))
            self.assertTrue(((h[:] >= 2) & (h[:] <= 8)).all())
            np.testing.assert_array_equal(data.parameter_matrix[:, 0], h[:])
            self.assertEqual(data.t.shape, (whole.shape[2],))
            self.assertIn("speed", data._repr_html_())
            self.assertLessEqual(set(data.generator[:]), {30, 31, 32})
            copy = pickle.loads(pickle.dumps(data))
            np.testing.assert_array_equal(copy["P"][0], whole[0, 0])
            with self.assertRaises(KeyError):
                data["none"]

    def test_integers(self):
        folder = generate(self.folder.name, 'storage = "int16"')
        whole = rows_of_shards(folder)
        data = swingbank.Dataset(folder)
        self.assertEqual(data.records.dtype, np.float32)
        np.testing.assert_array_equal(data.records[:], whole)
        np.testing.assert_array_equal(data["Q"][1:4], whole[1:4, 1])
        np.testing.assert_array_equal(data["Q"][-1], whole[-1, 1])

    def test_no_dataset(self):
        with self.assertRaises(swingbank.InputError):
            swingbank.Dataset(self.folder.name)

    def test_unfinished_dataset(self):
        folder = generate(self.folder.name)
        (folder / "dataset.h5").unlink()
        with self.assertRaises(swingbank.InputError) as caught:
            swingbank.Dataset(folder)
        self.assertIn("incomplete", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
