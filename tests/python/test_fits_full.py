"""Calibration, addition and diagnosis: the results of the commands."""
import math
import pathlib
import tempfile
import unittest

import numpy as np
from case import PLANT, RECORDS, run_json

import swingbank

# A fit amplifies the last digits of its sums, which differ between two processes
# (docs/decisions/62-memory-alignment.md).
RELATIVE = 2e-3


class Fits(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plant = swingbank.Plant(PLANT)

    def command(self, *words):
        with tempfile.TemporaryDirectory() as folder:
            return run_json(*words, "--model", PLANT, "--records", *RECORDS, "--power-only", "--json", "--out",
                            pathlib.Path(folder) / "out", codes=(0, 3, 4, 5))

    def assert_same_parameters(self, got, said):
        self.assertEqual([p.name for p in got.parameters], [f"{p['effect']}.{p['name']}" for p in said["parameters"]])
        for one, other in zip(got.parameters, said["parameters"]):
            self.assertTrue(abs(one.value - other["value"]) < 0.05 * one.error + 1e-12, (one, other["value"]))

    def assert_close(self, got, said):
        self.assertTrue(math.isclose(got, said, rel_tol=RELATIVE), (got, said))

    def test_calibration(self):
        said = self.command("calibrate", "--hold-out", "avr_ev4.csv")
        phases = set()
        got = self.plant.calibrate(RECORDS, hold_out=["avr_ev4.csv"], power_only=True,
                                   progress=lambda phase, *_: phases.add(phase))
        self.assert_same_parameters(got, said)
        self.assertEqual(got.to_dict()["verdict"], said["verdict"])
        self.assert_close(got.after, said["reduced_chi2_after"])
        self.assertFalse(got.adequate)
        self.assertIn("fit of the parameters", phases)
        self.assertEqual(got.correlation.shape, (len(got.parameters),) * 2)
        np.testing.assert_allclose(np.diag(got.correlation), 1.0)
        self.assertEqual(got.plant[got.parameters[0].name], got.parameters[0].value)
        self.assertIn(got.parameters[0].name, got._repr_html_())

    def test_sparse_parameter_selection(self):
        true = self.plant.add("SEXS", RECORDS, power_only=True).plant
        wrong = true.with_values({"SEXS.K": 0.5 * true["SEXS.K"]})
        with tempfile.TemporaryDirectory() as folder:
            wrong.save(pathlib.Path(folder) / "wrong.toml")
            said = run_json("calibrate", "--sparse", "--model", pathlib.Path(folder) / "wrong.toml", "--records",
                            *RECORDS, "--power-only", "--json", "--out", pathlib.Path(folder) / "out", codes=(0, 5))
        got = wrong.calibrate(RECORDS, power_only=True, sparse=True)
        self.assertEqual([p.name for p in got.parameters], ["SEXS.K"])
        self.assertEqual([p["name"] for p in got.to_dict()["wrong"]], [p["name"] for p in said["wrong"]])
        self.assertTrue(got.adequate)
        self.assert_close(got.after, said["chi2_per_value"]["these_changed"])
        self.assert_close(got.evidence["SEXS.K"], said["wrong"][0]["evidence_chi2"])
        self.assertLess(got.after, got.before)
        self.assertGreater(got.evidence["SEXS.K"], 10)
        self.assertEqual(list(got.tied), ["SEXS.K"])
        k = got.parameters[0]
        self.assertTrue(k.low < true["SEXS.K"] < k.high, k)
        self.assertEqual(got.plant["SEXS.K"], k.value)
        self.assertEqual(got.plant["GENROU.H"], wrong["GENROU.H"])
        self.assertIn("SEXS.K", got._repr_html_())

    def test_addition(self):
        said = self.command("add", "SEXS", "--hold-out", "avr_ev4.csv")
        got = self.plant.add("SEXS", RECORDS, hold_out=["avr_ev4.csv"], power_only=True)
        self.assert_same_parameters(got, said)
        self.assert_close(got.evidence, said["evidence"])
        self.assertTrue(got.accepted and got.adequate)
        k = next(p for p in got.parameters if p.name == "SEXS.K")
        self.assertTrue(k.low < 100 < k.high)  # the hidden exciter's value
        self.assertTrue(got.plant.compare(RECORDS, power_only=True).complete)
        self.assertIn("SEXS", got._repr_html_())
        with self.assertRaises(swingbank.InputError):
            self.plant.add("NONE", RECORDS)

    def test_diagnosis(self):
        said = self.command("diagnose")
        phases, sentences = set(), []
        got = self.plant.diagnose(RECORDS, power_only=True, progress=lambda phase, *_: phases.add(phase),
                                  preliminary=sentences.append)
        for key in ("verdict", "side", "effects", "equivalent"):
            self.assertEqual(got.to_dict()[key], said[key], key)
        self.assert_close(got.to_dict()["before"]["normalised_rms"], said["before"]["normalised_rms"])
        self.assertEqual((got.effects[0], got.side), ("SEXS", "excitation"))
        self.assertGreater(len(phases), 4)
        self.assertTrue(sentences)
        self.assertEqual(got.hypotheses[0]["name"], "SEXS")
        self.assertTrue(got.hypotheses[0]["accepted"])
        self.assertAlmostEqual(sum(got.probabilities.values()), 1.0, places=6)
        t, value = got.field["avr_ev1.csv"]
        self.assertEqual(t.shape, value.shape)
        self.assertIn("<html", got.to_html())
        self.assertIn("SEXS", got._repr_html_())


if __name__ == "__main__":
    unittest.main()
