"""Playback: the same figures as `swingbank compare`, arrays, and the notebook view."""
import csv
import math
import pathlib
import tempfile
import threading
import unittest

import numpy as np
from case import PLANT, RECORDS, run_json

import swingbank


class Playback(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plant = swingbank.Plant(PLANT)
        cls.record = swingbank.Record(RECORDS[0], cls.plant)
        cls.played = cls.plant.play(cls.record)

    def test_figures_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            said = run_json("compare", "--model", PLANT, "--records", *RECORDS[:2], "--out", folder + "/out", "--json",
                            codes=(3,))
        got = self.plant.compare(RECORDS[:2])
        for key in ("events", "adequacy", "fitness", "verdict"):
            self.assertEqual(got.to_dict()[key], said[key], key)
        self.assertEqual(got.complete, said["statistically_complete"])
        self.assertEqual(got.fit_for_purpose, said["fitness"]["fit_for_purpose"])
        for event, of_command in zip(got.events, said["events"]):
            for channel, row in zip(event.channels, of_command["channels"]):
                self.assertEqual(channel.name, row["name"])
                self.assertTrue(math.isclose(channel.rms, row["whole"]["rms_pu"] * row["units_in_pu"], rel_tol=1e-12))
                self.assertTrue(math.isclose(channel.noise, row["noise_pu"] * row["units_in_pu"], rel_tol=1e-12))

    def test_play_equals_compare(self):
        for one, other in zip(self.played.channels, self.plant.compare([self.record]).events[0].channels):
            np.testing.assert_array_equal(one.modelled, other.modelled)

    def test_arrays(self):
        self.assertEqual([c.name for c in self.played.channels], ["P", "Q", "speed", "Efd", "Ifd"])
        q = self.played["Q"]
        self.assertEqual(q.unit, "Mvar")
        self.assertEqual(q.modelled.shape, self.played.t.shape)
        np.testing.assert_allclose(q.residual, q.modelled - q.measured, atol=1e-12)
        np.testing.assert_array_equal(q.measured, self.record["Q"])
        self.assertAlmostEqual(self.played.switching_times[0], 2.0, delta=0.05)
        with self.assertRaises(KeyError):
            self.played["none"]

    def test_power_only(self):
        played = self.plant.play(self.record, power_only=True)
        self.assertEqual([c.name for c in played.channels], ["P", "Q"])

    def test_power_as_input(self):
        with self.assertRaisesRegex(swingbank.InputError, "no terminal voltage"):  # during the fault
            self.plant.play(self.record, input="pq")
        with self.assertRaisesRegex(swingbank.InputError, "current"):
            self.plant.play(self.record, input="current")

    def test_record_of_arrays(self):
        lines = [line for line in RECORDS[0].read_text().splitlines() if not line.startswith("#")]
        rows = list(csv.reader(lines))
        columns = {name: np.array([float(row[k]) for row in rows[1:]]) for k, name in enumerate(rows[0])}
        record = swingbank.Record.from_columns(columns, self.plant, name=self.record.name)
        np.testing.assert_array_equal(record.t, self.record.t)
        for channel in self.record.units:
            np.testing.assert_array_equal(record[channel], self.record[channel])
        played = self.plant.play(record)
        np.testing.assert_array_equal(played["Q"].modelled, self.played["Q"].modelled)

    def test_problems_of_arrays(self):
        t = np.arange(100) / 60
        with self.assertRaises(swingbank.InputError) as caught:
            swingbank.Record.from_columns({"t_s": t, "V_pu": np.full(100, np.nan), "P_MW": t}, self.plant)
        self.assertGreaterEqual(len(caught.exception.problems), 1)

    def test_notebook_view(self):
        self.assertIn("<svg", self.record._repr_html_())
        self.assertIn("GENROU.H", self.plant._repr_html_())
        html = self.played._repr_html_()
        self.assertIn("<svg", html)
        self.assertIn("Mvar", html)
        self.assertFalse(self.played.complete)
        self.assertIn("▲", html)  # the exciter is missing: more than noise
        self.assertIn("<svg", self.plant.compare(RECORDS[:1])._repr_html_())

    def test_sensitivities(self):
        s = self.plant.sensitivities(self.record, ["GENROU.H", "GENROU.Xdp"], power_only=True)
        self.assertEqual(s.parameters, ["GENROU.H", "GENROU.Xdp"])
        self.assertEqual(s.values.shape, (2, 2, len(s.t)))
        h = self.plant["GENROU.H"]
        low, high = (self.plant.with_values({"GENROU.H": h * factor}).play(self.record, power_only=True)
                     for factor in (0.999, 1.001))
        quotient = (high["P"].modelled - low["P"].modelled) / (0.002 * h)
        scale = np.abs(quotient).max()
        self.assertLess(np.median(np.abs(s.values[0, 0] - quotient)), 0.02 * scale)

    def test_other_threads_run_during_a_playback(self):
        worker = threading.Thread(target=lambda: self.plant.compare(RECORDS))
        worker.start()
        counted = 0
        while worker.is_alive():
            counted += 1
        self.assertGreater(counted, 1000)

    def test_path_like_arguments(self):
        self.assertEqual(self.plant.play(str(RECORDS[0])).name, self.plant.play(pathlib.Path(RECORDS[0])).name)


if __name__ == "__main__":
    unittest.main()
