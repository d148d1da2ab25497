"""A block that falls and slides but does not turn, as the solid of a run: `free_block.py [own-walls]`."""

import sys

import halfstep
import numpy as np

gravity, points = np.array(halfstep.description()["gravity"][:2]), halfstep.particles()
saved = halfstep.saved() or {"x": np.zeros(2), "v": points.velocity[0]}
x, v = saved["x"], saved["v"]  # displacement and velocity at step n
x_now, v_now = x, v  # the same at the stage that was published
own_walls = "own-walls" in sys.argv
solid = halfstep.Solid(
    points.position + x, points.mass, points.density, velocity=v, own_walls=own_walls,
    save=lambda: {"x": x, "v": v},
)
for step in solid:
    acceleration = gravity + step.forces.sum(axis=0) / points.mass.sum()
    # The midpoint rule: both stages go from n, with the rates of the stage.
    x_now, v_now = x + step.span * v_now, v + step.span * acceleration
    if step.stage == 1:
        x, v = x_now, v_now
    step.publish(points.position + x_now, v_now)
