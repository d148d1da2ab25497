"""docs/protocol.md has the functions of the package, and what the package checks."""

import inspect
import pathlib
import re
import types
import unittest

import halfstep
import numpy as np
from halfstep import scene, wire
from test_answer import WRONG

PAGE = (pathlib.Path(__file__).parents[2] / "docs" / "protocol.md").read_text(encoding="utf-8").splitlines()


def table(beginning):
    """Rows of the first table behind a line that begins so; `code` of their first two cells."""
    first = next(k for k, line in enumerate(PAGE) if line.startswith(beginning))
    first += next(k for k, line in enumerate(PAGE[first:]) if line.startswith("|"))
    rows = PAGE[first : next(k for k, line in enumerate(PAGE) if k > first and not line.startswith("|"))]
    return [[re.findall(r"`([^`]+)`", cell) for cell in row.split("|")[1:3]] for row in rows[2:]]


def public(thing):
    return {name for name in dir(thing) if not name.startswith("_")}


def parameters(function):
    return set(inspect.signature(function).parameters) - {"self", "environment"}


class Functions(unittest.TestCase):
    def setUp(self):
        self.rows = table("## In Python")
        self.names = [name for code, _ in self.rows for name in code]

    def of(self, owner):
        """What the table has of `owner`, without arguments."""
        return {name.split(".")[1].split("(")[0] for name in self.names if name.startswith(owner + ".")}

    def arguments(self, call):
        """Arguments of a call of the table, and the names that stand behind it."""
        code, more = next(row for row in self.rows if row[0][0].startswith(call + "("))
        return set(re.findall(r"\w+", code[0].split("(")[1])) | set(more)

    def test_the_package(self):
        # A `Step` comes from the loop.
        self.assertEqual(self.of("halfstep"), set(halfstep.__all__) - {"Step"})
        self.assertTrue(set(halfstep.__all__) <= public(halfstep))

    def test_a_solid(self):
        self.assertEqual(self.of("solid"), public(halfstep.Solid))
        self.assertEqual(self.arguments("halfstep.Solid"), parameters(halfstep.Solid.__init__))
        self.assertEqual(self.arguments("solid.diverged"), parameters(halfstep.Solid.diverged))
        by_keyword = {name.split("=")[0] for name in self.names if "=" in name}
        self.assertEqual(by_keyword, {"own_walls", "save"})
        self.assertTrue(by_keyword <= parameters(halfstep.Solid.__init__))

    def test_a_step(self):
        solid = types.SimpleNamespace(dimension=2, records={"mass": np.ones(1)})
        records = np.zeros(1, wire.FORCE_RECORD.dtype)
        step = halfstep.Step(solid, np.zeros(1, wire.FORCE_HEADER.dtype)[0], records)
        self.assertEqual(self.of("step"), public(step))
        self.assertEqual(self.arguments("step.publish"), parameters(halfstep.Solid._set))

    def test_particles(self):
        told = next(more for code, more in self.rows if code == ["halfstep.particles()"])
        fields = set(scene.Particles.__dataclass_fields__)
        self.assertEqual({name.split("(")[0] for name in told}, fields | public(scene.Particles))


class Checks(unittest.TestCase):
    def test_answers(self):
        told = {name for code, _ in table("| of an answer") for name in code}
        tried = {message.split()[0] for _, _, message in WRONG}
        # "all numbers of all records"
        self.assertEqual(tried, told | {"cross_viscosity", "stress_force"})


if __name__ == "__main__":
    unittest.main()
