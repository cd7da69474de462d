"""Plant: parameters, changed copies, files, and errors with all their problems."""
import pathlib
import pickle
import tempfile
import unittest

from case import BIN, PLANT, RECORDS, SOURCE, run_json

import swingbank


class PlantModel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plant = swingbank.Plant(PLANT)

    def test_parameters(self):
        h = self.plant.parameters["GENROU.H"]
        self.assertEqual((h.name, h.unit), ("GENROU.H", "s"))
        self.assertEqual(h.value, self.plant["GENROU.H"])
        self.assertLess(h.low, h.high)
        self.assertEqual(self.plant.effects[0], "GENROU")

    def test_changed_copy(self):
        changed = self.plant.with_values({"GENROU.H": 5.25})
        self.assertEqual(changed["GENROU.H"], 5.25)
        self.assertNotEqual(self.plant["GENROU.H"], 5.25)

    def test_unknown_parameters_are_reported_together(self):
        with self.assertRaises(swingbank.InputError) as caught:
            self.plant.with_values({"GENROU.no": 1.0, "SEXS.K": 2.0})
        self.assertEqual(len(caught.exception.problems), 2)
        problem = caught.exception.problems[0]
        for part in (problem.what, problem.where, problem.why, problem.do):
            self.assertTrue(part)
        self.assertIn(problem.do, str(caught.exception))
        self.assertIsInstance(caught.exception, ValueError)

    def test_value_that_the_equations_do_not_allow(self):
        with self.assertRaises(swingbank.InputError):
            self.plant.with_values({"GENROU.H": -1.0})

    def test_every_problem_of_a_file(self):
        text = PLANT.read_text().replace("mva", "mvva").replace("H =", "HH =")
        with self.assertRaises(swingbank.InputError) as caught:
            swingbank.Plant.from_text(text, "wrong.toml")
        self.assertGreater(len(caught.exception.problems), 1)
        self.assertTrue(any("wrong.toml:" in p.where for p in caught.exception.problems))
        copy = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual(copy.problems, caught.exception.problems)

    def test_text_and_file(self):
        again = swingbank.Plant.from_text(self.plant.text())
        self.assertEqual({k: p.value for k, p in again.parameters.items()},
                         {k: p.value for k, p in self.plant.parameters.items()})
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "plant.toml"
            self.plant.save(file)
            self.assertEqual(swingbank.Plant(file).text(), self.plant.text())

    def test_unit_of_a_case(self):
        networks = SOURCE / "configs/networks"
        plant = swingbank.Plant.from_case(networks / "ieee14_genrou.raw", networks / "ieee14_genrou.dyr", 2)
        self.assertEqual(plant.effects[0], "GENROU")
        self.assertIn("'GENROU'", plant.dyr())

    def test_bad_record(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "bad.csv"
            file.write_text("t_s,V_pu\n0,1\n")
            with self.assertRaises(swingbank.InputError) as caught:
                swingbank.Record(file, self.plant)
        self.assertTrue(all(p.do for p in caught.exception.problems))

    def test_two_records_of_one_name(self):
        with self.assertRaises(swingbank.InputError):
            self.plant.compare([RECORDS[0], RECORDS[0]])
        record = swingbank.Record(RECORDS[0], self.plant)
        with self.assertRaises(swingbank.InputError):
            self.plant.compare([record, record])
        with self.assertRaises(swingbank.InputError):
            self.plant.compare([])


class Prediction(unittest.TestCase):
    @unittest.skipUnless((BIN / "swingbank-predict").exists(), "this build has no LibTorch")
    def test_message_of_the_command(self):
        with self.assertRaises(swingbank.InputError) as caught:
            swingbank.predict("none.network", swingbank.Plant(PLANT), [RECORDS[0]])
        self.assertEqual([p.what for p in caught.exception.problems], ["cannot read the network file"])


class Effects(unittest.TestCase):
    def test_list_of_the_command(self):
        said = run_json("effects", "--json")
        got = swingbank.effects()
        self.assertEqual([e.name for e in got], [e["name"] for e in said])
        sexs = next(e for e in got if e.name == "SEXS")
        row = next(e for e in said if e["name"] == "SEXS")
        self.assertEqual([(p.name, p.unit, p.low, p.high) for p in sexs.parameters],
                         [(p["name"], p["unit"], p["low"], p["high"]) for p in row["parameters"]])
        self.assertEqual([s[0] for s in sexs.states], [s["name"] for s in row["states"]])

    def test_user_defined_model(self):
        files = sorted((SOURCE / "configs/user_models").glob("*.toml"))
        self.assertEqual(len(swingbank.effects(files[:1])), len(swingbank.effects()) + 1)


if __name__ == "__main__":
    unittest.main()
