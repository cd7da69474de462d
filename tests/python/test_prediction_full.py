"""Predictions of a trained network: those of `swingbank predict` and of a row of the dataset."""
import pathlib
import subprocess
import tempfile
import unittest

from case import BIN, SOURCE, run, run_json

import swingbank


@unittest.skipUnless((BIN / "swingbank-predict").exists(), "prediction: this build has no LibTorch")
class TrainedNetwork(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = folder = pathlib.Path(cls.temporary.name)
        subprocess.run(["bash", "-euc", 'source "$0"; TINY_DRAWS=100 tiny_experiment "$1"; plant_of_bus_30 "$1/plant.toml" 0.3',
                        SOURCE / "tests/jobs/tiny_experiment.bash", folder], check=True)
        config = folder / "tiny_data.toml"
        config.write_text(config.read_text().replace('"speed"]', '"speed", "V", "theta"]'))
        run("generate", config, "--out", folder / "data")
        run("cross-validate", folder / "data", "--experiment", folder / "tiny.toml", "--fold", "30", "--out", folder / "out")
        cls.network = folder / "out/V-gru-quick-seed1-gen30.network"
        cls.plant = swingbank.Plant(folder / "plant.toml")
        cls.files = cls.write_rows()

    @classmethod
    def write_rows(cls):
        """Writes three rows of the excluded generator as records."""
        files = []
        with swingbank.Dataset(cls.folder / "data") as dataset:
            for row in [int(k) for k in (dataset.generator[:] == 30).nonzero()[0][:3]]:
                columns = [dataset.t, *(dataset[name][row] for name in ("P", "Q", "speed", "V", "theta"))]
                lines = ["t_s,P_pu,Q_pu,speed_pu,V_pu,theta_rad"]
                lines += [",".join(f"{value:.9g}" for value in values) for values in zip(*columns)]
                files.append(cls.folder / f"row-{row}.csv")
                files[-1].write_text("\n".join(lines) + "\n")
        return files

    def test_estimates_of_the_command(self):
        got = swingbank.predict(self.network, self.plant, self.files)
        said = run_json("predict", "--network", self.network, "--model", self.folder / "plant.toml", "--records",
                        *self.files, "--json")
        self.assertEqual(list(got.estimates), ["H", "D"])
        for estimate, row in zip(got.estimates.values(), said["parameters"], strict=True):
            self.assertEqual((estimate.name, estimate.unit, estimate.value, estimate.rmse, estimate.scatter),
                             tuple(row[key] for key in ("name", "unit", "estimate", "spread", "scatter")))
        self.assertEqual((got["H"].unit, len(got.content["records"])), ("s", 3))
        self.assertTrue(0 < got["H"].value < 20 and got["H"].rmse > 0, got)
        self.assertIn("RMSE", got._repr_html_())

    def test_folder_and_record_objects(self):
        records = [swingbank.Record(file, self.plant) for file in self.files[:1]]
        one = swingbank.predict(self.folder / "out", self.plant, records)
        self.assertEqual(one["H"].value, swingbank.predict(self.network, self.plant, self.files[:1])["H"].value)
        columns = {"t_s": records[0].t, **{f"{name}_pu": records[0][name] for name in ("V", "speed")},
                   "theta_rad": records[0]["theta"], "P_MW": records[0]["P"], "Q_Mvar": records[0]["Q"]}
        with self.assertRaisesRegex(swingbank.InputError, "without a file"):
            swingbank.predict(self.network, self.plant, [swingbank.Record.from_columns(columns, self.plant)])


if __name__ == "__main__":
    unittest.main()
