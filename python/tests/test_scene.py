"""What the scene says of a solid, alone and as one of several."""

import json
import os
import pathlib
import tempfile
import unittest
from unittest import mock

import halfstep
from halfstep import wire

LEFT, RIGHT = ({"name": name, "density": density} for name, density in (("left", 1100.0), ("right", 2700.0)))


class Material(unittest.TestCase):
    def told(self, solid, name):
        """What a program of this name finds in a scene with these solids."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "scene.json"
            path.write_text(json.dumps({"dimension": 2, "solid": solid}), encoding="utf-8")
            run = {"RUN_ID": 7, "PROTOCOL": wire.PROTOCOL, "SCHEMA": wire.schema(), "NAME": name, "SCENE": path}
            variables = {f"HALFSTEP_{key}": str(value) for key, value in run.items()}
            with mock.patch.dict(os.environ, variables):
                return halfstep.material()

    def test_the_only_one(self):
        only = {"name": "solid", "density": 1100.0}
        self.assertEqual(self.told(only, "solid"), only)

    def test_one_of_several(self):
        for own in (LEFT, RIGHT):
            self.assertEqual(self.told([LEFT, RIGHT], own["name"]), own)
        self.assertEqual(self.told([LEFT], "left"), LEFT)


if __name__ == "__main__":
    unittest.main()
