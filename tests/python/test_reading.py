"""Records from named columns, and of one of several units behind a measuring point: the figures of the commands."""
import csv
import math
import pathlib
import tempfile
import unittest

import numpy as np
from case import PLANT, RECORDS, run_json

import swingbank

EXCITER = """
[exciter]
effect = "SEXS"
TAoverTB = 0.1
TB = 10.0
K = 100.0
TE = 0.05
EMIN = -4.0
EMAX = 5.0
"""


def rewrite(record, file, heading, change=lambda row: row):
    """Writes the first six seconds of a record with another heading and changed rows."""
    with open(record, newline="") as lines, open(file, "w", newline="") as out:
        rows = csv.reader(lines)
        next(rows)
        writer = csv.writer(out)
        writer.writerow(heading)
        writer.writerows(change(row) for row in rows if float(row[0]) <= 6)


class Columns(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.file = pathlib.Path(self.folder.name) / "relay.csv"
        self.plant = swingbank.Plant(PLANT)

    def test_named_columns(self):
        rewrite(RECORDS[0], self.file, ["stamp", "U1", "angle", "x", "power", "reactive", "c7", "c8", "c9"])
        columns = {"t": "stamp [s]", "V": "U1 [pu]", "theta": "#3 [rad]", "P": "power [pu]", "Q": "reactive [pu]"}
        record = swingbank.Record(self.file, self.plant, columns=columns)
        whole = swingbank.Record(RECORDS[0], self.plant)
        self.assertEqual(sorted(record.units), ["P", "Q", "V", "theta"])
        for channel in record.units:
            np.testing.assert_array_equal(record[channel], whole[channel][:len(record)], channel)
        with self.assertRaisesRegex(swingbank.InputError, "reverse the signs"):  # the check of the record sees it
            swingbank.Record(self.file, self.plant, columns={**columns, "P": "-power [pu]", "Q": "-reactive [pu]"})
        with self.assertRaises(swingbank.InputError):
            swingbank.Record(self.file, self.plant)  # no name is recognised

    def test_wrong_columns_are_reported(self):
        rewrite(RECORDS[0], self.file, ["t_s", "V_pu", "theta_rad", "f_pu", "P_pu", "Q_pu", "c7", "c8", "c9"])
        for columns, word in (({"V": "nowhere [kV]"}, "nowhere"), ({"colour": "V_pu"}, "colour")):
            with self.assertRaisesRegex(swingbank.InputError, word):
                swingbank.Record(self.file, self.plant, columns=columns)


class PointOfTwoUnits(unittest.TestCase):
    """Two equal units share a terminal; the record there has twice the power of one."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        folder = pathlib.Path(cls.temporary.name)
        cls.model, cls.point, cls.both = folder / "whole.toml", folder / "point.toml", folder / "both.csv"
        cls.model.write_text(PLANT.read_text() + EXCITER)
        (folder / "other.toml").write_text(cls.model.read_text())
        cls.point.write_text('[[unit]]\nmodel = "whole.toml"\n[[unit]]\nmodel = "other.toml"\nshare = 0.5\n')
        rewrite(RECORDS[0], cls.both, ["t_s", "V_pu", "theta_rad", "P_pu", "Q_pu"],
                lambda row: [*row[:3], *(2 * float(value) for value in row[4:6])])
        cls.plant = swingbank.Plant(cls.model)

    def test_record_of_the_tested_unit(self):
        point = swingbank.Point(self.point, self.plant)
        self.assertEqual(point.others, ["IEEE 14, bus 2"])
        (record,) = point.records([self.both])
        alone = swingbank.Record(RECORDS[0], self.plant)
        noise = self.plant.play(alone)["P"].noise  # noise of the doubled record minus that of a simulated response without noise
        self.assertLess(np.std(record["P"] - alone["P"][:len(record)]), 2 * noise)
        self.assertGreater(np.std(alone["P"]), 5 * noise)

    def test_figures_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            said = run_json("compare", "--model", self.model, "--records", self.both, "--point", self.point, "--out",
                            folder + "/out", "--json", codes=(0, 3, 4, 5))
        point = swingbank.Point(self.point, self.plant)
        got = point.plant.compare(point.records([self.both]))
        for channel, row in zip(got.events[0].channels, said["events"][0]["channels"], strict=True):
            # the separation fits the switching times, which amplifies the last digits (here to 1e-10)
            self.assertTrue(math.isclose(channel.rms, row["whole"]["rms_pu"] * row["units_in_pu"], rel_tol=1e-7))
        self.assertLess(got.events[0]["P"].ratio, 1.5)
        doubled = self.plant.compare(self.both, power_only=True)  # all power taken for that of one unit
        self.assertGreater(doubled.events[0]["P"].ratio, 4)

    def test_columns_of_the_point(self):
        named = self.both.with_name("named.csv")
        rewrite(self.both, named, ["stamp", "U1", "angle", "power", "reactive"])
        point = swingbank.Point(self.point, self.plant)
        (record,) = point.records([named], columns={"t": "stamp [s]", "V": "U1 [pu]", "theta": "angle [rad]",
                                                    "P": "power [pu]", "Q": "reactive [pu]"})
        np.testing.assert_array_equal(record["P"], point.records([self.both])[0]["P"])

    def test_faults_of_the_point_file(self):
        wrong = self.point.with_name("wrong.toml")
        wrong.write_text('colour = 3\n[[unit]]\nmodel = "whole.toml"\n[[unit]]\nmodel = "nowhere.toml"\nshare = 0.5\n')
        with self.assertRaises(swingbank.InputError) as caught:
            swingbank.Point(wrong, self.plant)
        self.assertGreaterEqual(len(caught.exception.problems), 2)


if __name__ == "__main__":
    unittest.main()
