"""What the scene says: its JSON, and where it has particles."""

import json
from dataclasses import dataclass

import numpy as np


def read(environment):
    """The scene with every default filled in, SI units."""
    with open(environment["SCENE"], encoding="utf-8") as file:
        return json.load(file)


def material(environment, scene):
    """What the scene says of the solid of this name: its `[solid]`, or the one of its `[[solid]]`."""
    told = scene["solid"]
    sections = told if isinstance(told, list) else [told]
    return next(section for section in sections if section["name"] == environment["NAME"])


@dataclass
class Particles:
    """The particles that the program itself would give this solid, in the order of their numbers.

    `position` m, N x D; `velocity` m/s, N x D; `mass` kg (2D: kg/m) and `density` kg/m3, N; `clamped`, N: the velocity
    is prescribed; `body` and `shape`, N: number of the connected body, and place in the scene's list of shapes.
    """

    position: np.ndarray
    velocity: np.ndarray
    mass: np.ndarray
    density: np.ndarray
    clamped: np.ndarray
    body: np.ndarray
    shape: np.ndarray

    @property
    def volume(self):
        """Of each, m3 (2D: m2)."""
        return self.mass / self.density

    def of(self, chosen):
        """Some of them: a mask or numbers."""
        return Particles(*(getattr(self, name)[chosen] for name in self.__dataclass_fields__))


def particles(environment, dimension):
    """Reads the file that the launcher wrote."""
    table = np.loadtxt(environment["PARTICLES"], delimiter=",", skiprows=1, ndmin=2)
    columns = table.T
    return Particles(
        position=table[:, 0:dimension].copy(),
        velocity=table[:, 3 : 3 + dimension].copy(),
        mass=columns[6].copy(),
        density=columns[7].copy(),
        clamped=columns[8] != 0,
        body=columns[9].astype(int),
        shape=columns[10].astype(int),
    )
