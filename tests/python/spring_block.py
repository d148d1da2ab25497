"""A rigid block on a spring along x as the solid of a run: `spring_block.py STIFFNESS` (N/m)."""

import itertools
import sys

import halfstep
import numpy as np

stiffness = float(sys.argv[1])
scene = halfstep.description()
box = next(shape["geometry"]["box"] for shape in scene["shapes"] if shape["phase"] == "solid")
dx, dimension, density = scene["resolution"], scene["dimension"], scene["solid"]["density"]

# A particle for each cell of the block, which is rigid: all of them have one displacement.
sides = zip(box["min"], box["max"], range(dimension))
rest = np.array(list(itertools.product(*(np.arange(low + dx / 2, high, dx) for low, high, _ in sides))))
mass = density * dx**dimension
along_x = np.eye(dimension)[0]

saved = halfstep.saved() or {"x": 0.0, "v": 0.0}
x, v = float(saved["x"]), float(saved["v"])  # displacement and velocity at step n
x_now, v_now = x, v  # the same at the stage that was published
solid = halfstep.Solid(
    rest + x * along_x, mass, density, velocity=v * along_x, save=lambda: {"x": x, "v": v}
)
for step in solid:
    load = step.forces[:, 0].sum()
    acceleration = (load - stiffness * x_now) / (mass * len(rest))
    # The midpoint rule: both stages go from n, with the rates of the stage.
    x_now, v_now = x + step.span * v_now, v + step.span * acceleration
    if step.stage == 1:
        x, v = x_now, v_now
    step.publish(rest + x_now * along_x, v_now * along_x)
