"""A rigid block on a spring along x as the solid of a run, or one of several: `spring_block.py STIFFNESS` (N/m)."""

import itertools
import os
import sys

import halfstep
import numpy as np

stiffness = float(sys.argv[1])
scene = halfstep.description()
solids = scene["solid"] if isinstance(scene["solid"], list) else [scene["solid"]]
number = next((k for k, solid in enumerate(solids) if solid.get("name") == os.environ["HALFSTEP_NAME"]), 0)
own = (shape for shape in scene["shapes"] if shape["phase"] == "solid" and (shape.get("solid") or 0) == number)
box = next(own)["geometry"]["box"]
dx, dimension, density = scene["resolution"], scene["dimension"], solids[number]["density"]

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
