"""A flap on a hinge with a spring and a damper, by MuJoCo: `hinged_flap.py STIFFNESS DAMPING`, for hinged-flap.toml.

STIFFNESS in N m/rad, DAMPING in N m s/rad, both per metre of depth. The hinge is the flap's lower left corner.
"""

import sys

import halfstep
import mujoco
import numpy as np
from body import Body

if len(sys.argv) != 3:
    sys.exit("usage: hinged_flap.py STIFFNESS DAMPING, N and N s a radian")
stiffness, damping = float(sys.argv[1]), float(sys.argv[2])
scene, points = halfstep.description(), halfstep.particles()
box = scene["shapes"][points.shape[0]]["geometry"]["box"]
low, high = np.array(box["min"][:2]), np.array(box["max"][:2])
half = (high - low) / 2

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option gravity="0 {scene['gravity'][1]} 0" integrator="RK4"/>
  <worldbody>
    <body pos="{low[0]} {low[1]} 0">
      <joint type="hinge" axis="0 0 1" stiffness="{stiffness}" damping="{damping}"/>
      <geom type="box" pos="{half[0]} {half[1]} 0" size="{half[0]} {half[1]} 0.5" mass="{points.mass.sum()}"/>
    </body>
  </worldbody>
</mujoco>
""")

# The hinge lies in the floor, which does not push the flap.
solid = halfstep.Solid(points.position, points.mass, points.density, own_walls=True)
halfstep.integrate.advance_once(solid, halfstep.mapping.Hinged(points.position, low), Body(model))
