"""Ctrl-C and exceptions of callbacks end a fit; the next call works."""
import os
import signal
import unittest

from case import PLANT, RECORDS

import swingbank


class Interrupt(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plant = swingbank.Plant(PLANT)

    def diagnose(self, progress):
        return self.plant.diagnose(RECORDS, power_only=True, progress=progress)

    def test_signal(self):
        phases = []

        def interrupt(phase, item, done, total):
            phases.append(phase)
            os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            self.diagnose(interrupt)
        self.assertLess(len(set(phases)), 4)  # a whole diagnosis has more phases
        self.assertFalse(self.plant.play(RECORDS[0]).complete)

    def test_exception_of_a_callback(self):
        def fail(phase, item, done, total):
            raise LookupError("enough")

        with self.assertRaisesRegex(LookupError, "enough"):
            self.diagnose(fail)
        with self.assertRaisesRegex(LookupError, "enough"):
            self.plant.calibrate(RECORDS[:1], power_only=True, progress=fail)

    def test_handlers_are_restored(self):
        before = signal.getsignal(signal.SIGINT)
        self.plant.play(RECORDS[0])
        self.assertIs(signal.getsignal(signal.SIGINT), before)
        with self.assertRaises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
            for _ in range(1000):
                pass


if __name__ == "__main__":
    unittest.main()
