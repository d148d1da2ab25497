"""A rigid box that floats, by MuJoCo: `floating_box.py`, for floating-box.toml.

MuJoCo's body has the plane's three degrees of freedom: two slides and a hinge about z, per metre of depth.
"""

import halfstep
import mujoco
import numpy as np
from body import Body

scene, points = halfstep.description(), halfstep.particles()
box = scene["shapes"][points.shape[0]]["geometry"]["box"]
low, high = np.array(box["min"][:2]), np.array(box["max"][:2])
centre, half = (low + high) / 2, (high - low) / 2

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option gravity="0 {scene['gravity'][1]} 0" integrator="RK4"/>
  <worldbody>
    <body pos="{centre[0]} {centre[1]} 0">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/>
      <joint type="hinge" axis="0 0 1"/>
      <geom type="box" size="{half[0]} {half[1]} 0.5" mass="{points.mass.sum()}"/>
    </body>
  </worldbody>
</mujoco>
""")

solid = halfstep.Solid(points.position, points.mass, points.density)
halfstep.integrate.advance_once(solid, halfstep.mapping.Rigid(points.position, centre), Body(model))
