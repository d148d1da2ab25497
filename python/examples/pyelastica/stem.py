"""A flexible stem by PyElastica, a Cosserat rod: `stem.py [ELEMENTS]`, for stem.toml.

The rod is round, the stem a sheet of thickness t. A rod of radius t / sqrt(3) whose material is denser and stiffer by
3 / (pi t) has the sheet's mass, tension and bending stiffness for each metre of depth.
"""

import sys

import elastica as ea
import halfstep
import numpy as np

scene, points = halfstep.description(), halfstep.particles()
count = int(sys.argv[1]) if len(sys.argv) > 1 else 16
shape, material = scene["shapes"][points.shape[0]], halfstep.material()
low, high = np.array(shape["geometry"]["box"]["min"]), np.array(shape["geometry"]["box"]["max"])
foot, thickness = shape["clamp"][0]["max"][1], high[0] - low[0]
# The first element is held: the stem's clamped end is its middle, where its direction is.
size = (high[1] - foot) / (count - 0.5)
start, length = np.array([(low[0] + high[0]) / 2, foot - size / 2, 0.0]), count * size
factor = 3.0 / (np.pi * thickness)
density, young = factor * material["density"], factor * material["youngs_modulus"]

rod = ea.CosseratRod.straight_rod(
    count, start, np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), length, thickness / np.sqrt(3.0), density,
    youngs_modulus=young, shear_modulus=young / (2.0 * (1.0 + material["poissons_ratio"])),
)


class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing):
    pass


class Load(ea.NoForces):
    """What acts on the nodes: they forget it after each step."""

    on_nodes = np.zeros((count + 1, 2))

    def apply_forces(self, system, time=0.0):
        system.external_forces[:2] += Load.on_nodes.T


simulator, stepper = Simulator(), ea.PositionVerlet()
simulator.append(rod)
simulator.constrain(rod).using(ea.FixedConstraint, constrained_position_idx=(0, 1), constrained_director_idx=(0,))
simulator.add_forcing_to(rod).using(Load)
simulator.finalize()
weight, free = rod.mass[:, None] * scene["gravity"][:2], np.arange(count + 1)[:, None] > 1


class Stem:
    def __init__(self):
        # A fifth of the time that sound takes through an element.
        self.limit = 0.2 * size * np.sqrt(density / young)
        self.steps, self.time = 1, 0.0

    u = property(lambda self: rod.position_collection[:2].T.copy())
    v = property(lambda self: rod.velocity_collection[:2].T.copy())

    def acceleration(self, load):
        force = load + weight + rod.internal_forces[:2].T
        return np.where(free, force / rod.mass[:, None], 0.0)

    def advance(self, load, dt):
        self.steps = int(np.ceil(dt / self.limit))
        Load.on_nodes = load + weight
        for _ in range(self.steps):
            self.time = stepper.step(simulator, self.time, dt / self.steps)


solid = halfstep.Solid(points.position, points.mass, points.density, clamped=points.clamped)
mapping, stem = halfstep.mapping.MidLine(points.position, rod.position_collection[:2].T.copy()), Stem()
halfstep.integrate.advance_once(solid, mapping, stem, sub_steps=lambda stem: stem.steps)
