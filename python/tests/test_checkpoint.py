"""Checkpoints: what a solid saved and published is there again."""

import os
import tempfile
import unittest

import numpy as np
from halfstep import checkpoint
from halfstep.solid import Solid
from test_answer import COUNT, Coupler, attach, environment


def folder_of(number):
    return "checkpoint-a" if number % 2 else "checkpoint-b"


class Checkpoints(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        for number in (1, 2):
            os.mkdir(os.path.join(folder.name, folder_of(number)))

    def environment(self, **more):
        return environment(OUT=self.folder, **more)

    def test_any_name_comes_back(self):
        saved = {"file": 1.5, "u": np.arange(4.0), "step": [1, 2], "allow_pickle": True}
        checkpoint.write(self.environment(), 1, saved, {"step": 7})
        there = self.environment(CHECKPOINT=os.path.join(self.folder, folder_of(1)))
        again, own = checkpoint.read(there)
        self.assertEqual(own.keys(), {"step"})
        self.assertEqual(int(own["step"]), 7)
        self.assertEqual(again.keys(), saved.keys())
        for name, value in saved.items():
            np.testing.assert_array_equal(again[name], value)

    def test_what_is_no_array_is_refused_before_anything_is_written(self):
        for value in (None, {"a": 1}, [[1], [1, 2], None]):
            with self.assertRaises((TypeError, ValueError)):
                checkpoint.write(self.environment(), 1, {"x": value}, {})
        self.assertEqual(os.listdir(os.path.join(self.folder, folder_of(1))), [])

    def test_of_another_language(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "solid.hdf"), "w") as file:
                file.write('{"step":7}')
            with self.assertRaisesRegex(ValueError, "no checkpoint of this package"):
                checkpoint.read({"CHECKPOINT": folder, "NAME": "solid"})

    def test_the_first_message_is_the_last_one(self):
        """What a solid told once and not again counts after the checkpoint as before it."""
        position = np.zeros((COUNT, 2))
        told = self.environment()
        with attach(Coupler()):
            solid = Solid(position, 1.0, 1000.0, environment=told, save=dict)
            for step in solid:
                step.publish(position, 0.0, dt_limit=1e-3, sub_steps=3, stored_energy=2.0, pressure=5.0)
                if solid.stage == 1:
                    checkpoint.write(told, 1, {}, solid._own())
            before = solid._head() | {"pressure": solid.records["pressure"].copy()}
        there = self.environment(CHECKPOINT=os.path.join(self.folder, folder_of(1)))
        with attach(Coupler()):
            again = Solid(position, 1.0, 1000.0, environment=there, save=dict)
        for field in ("dt_limit", "sub_steps", "audit.stored_energy"):
            self.assertEqual(again._head()[field], before[field])
        np.testing.assert_array_equal(again.records["pressure"], before["pressure"])
        with attach(Coupler()), self.assertRaises(SystemExit):
            Solid(position[1:], 1.0, 1000.0, environment=there, save=dict)


if __name__ == "__main__":
    unittest.main()
