"""Simulation of a grid: the same samples as `swingbank simulate`."""
import csv
import pathlib
import tempfile
import unittest

import numpy as np
from case import SOURCE, run

import swingbank

NETWORKS = SOURCE / "configs/networks"


class Simulation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.grid = swingbank.Grid(NETWORKS / "ieee14_genrou.raw", NETWORKS / "ieee14_genrou.dyr")
        cls.result = swingbank.simulate(cls.grid, faults=["4:1:1.1"], t_end=2.0, rate=60.0, plants=["2"],
                                     channels=["P", "speed"], buses=[4])

    def test_samples_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "run.csv"
            run("simulate", "--raw", NETWORKS / "ieee14_genrou.raw", "--dyr", NETWORKS / "ieee14_genrou.dyr",
                "--fault", "4:1:1.1", "--t-end", "2", "--rate", "60", "--plants", "2", "--channels", "P,speed",
                "--buses", "4", "--out", file)
            rows = list(csv.reader(file.read_text().splitlines()))
        self.assertEqual(rows[0], ["t_s", "2.P_pu", "2.speed_pu", "bus4.V_pu", "bus4.theta_rad"])
        said = np.array(rows[1:], dtype=float).T
        columns = (self.result.t, self.result["2", "P"], self.result["2", "speed"], self.result.bus_voltage[0],
                   self.result.bus_angle[0])
        for got, column in zip(columns, said):
            np.testing.assert_allclose(got, column, rtol=1e-11, atol=1e-15)

    def test_shapes_and_names(self):
        self.assertEqual(self.result.values.shape, (1, 2, len(self.result.t)))
        np.testing.assert_array_equal(self.result.values[0, 1], self.result["2", "speed"])
        self.assertEqual(self.result.units, {"P": "pu", "speed": "pu"})
        self.assertEqual(self.result.outcome, "stable")
        self.assertIn("2", self.grid.plants)
        self.assertIn("<svg", self.result._repr_html_())
        with self.assertRaises(KeyError):
            self.result["2", "V"]

    def test_problems_are_reported_together(self):
        with self.assertRaises(swingbank.InputError) as caught:
            swingbank.simulate(self.grid, faults=["999:1:1.1"], plants=["none"], channels=["none"], rate=-1.0)
        self.assertEqual(len(caught.exception.problems), 4)
        self.assertIn("faults 999:1:1.1", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
