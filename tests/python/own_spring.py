"""A rigid block on a spring along x, whichever solid of the scene it is: `own_spring.py STIFFNESS [FROM [PAUSE]]`.

From the step FROM on it is silent for PAUSE seconds (by default for good) before each state.
"""

import sys
import time

import halfstep
import numpy as np

stiffness, points = float(sys.argv[1]), halfstep.particles()
silent_from = int(sys.argv[2]) if len(sys.argv) > 2 else None
pause = float(sys.argv[3]) if len(sys.argv) > 3 else 1000.0
mass, along_x = points.mass.sum(), np.array([1.0, 0.0])
x = v = x_now = v_now = 0.0  # displacement and velocity at step n, and at the stage that was published
solid = halfstep.Solid(points.position, points.mass, points.density, own_walls=True)
for step in solid:
    if silent_from is not None and step.number >= silent_from:
        time.sleep(pause)
    acceleration = (step.forces[:, 0].sum() - stiffness * x_now) / mass
    # The midpoint rule: both stages go from n, with the rates of the stage.
    x_now, v_now = x + step.span * v_now, v + step.span * acceleration
    if step.stage == 1:
        x, v = x_now, v_now
    step.publish(points.position + x_now * along_x, v_now * along_x)
