"""A flap in waves and its motor, by MuJoCo: `wave_flap.py DAMPING STIFFNESS`, for wave-flap.toml.

The motor brakes with DAMPING (N m s/rad) and holds with STIFFNESS (N m/rad), both per metre of depth: what it brakes is
the power that the waves give. `motor.csv` in the run's folder has it. The hinge is the middle of the flap's foot.
"""

import sys

import halfstep
import mujoco
import numpy as np
from body import Body

if len(sys.argv) != 3:
    sys.exit("usage: wave_flap.py DAMPING STIFFNESS, N s and N a radian")
damping, stiffness = float(sys.argv[1]), float(sys.argv[2])
scene, points = halfstep.description(), halfstep.particles()
box = scene["shapes"][points.shape[0]]["geometry"]["box"]
low, high = np.array(box["min"][:2]), np.array(box["max"][:2])
half, hinge = (high - low) / 2, np.array([(low[0] + high[0]) / 2, low[1]])

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option gravity="0 {scene['gravity'][1]} 0" integrator="RK4"/>
  <worldbody>
    <body pos="{hinge[0]} {hinge[1]} 0">
      <joint name="hinge" type="hinge" axis="0 0 1"/>
      <geom type="box" pos="0 {half[1]} 0" size="{half[0]} {half[1]} 0.5" mass="{points.mass.sum()}"/>
    </body>
  </worldbody>
  <actuator>
    <motor joint="hinge"/>
  </actuator>
</mujoco>
""")


class Flap(Body):
    def control(self):
        self.data.ctrl[0] = -damping * self.v[0] - stiffness * self.u[0]

    def acceleration(self, load):
        self.control()
        return super().acceleration(load)

    def advance(self, load, dt):
        self.control()
        before = self.u[0]
        super().advance(load, dt)
        work = -self.data.ctrl[0] * (self.u[0] - before)
        print(f"{self.data.time},{self.u[0]},{self.data.ctrl[0]},{work}", file=table)


# The hinge lies in the floor, which does not push the flap.
solid = halfstep.Solid(points.position, points.mass, points.density, own_walls=True)
with open(f"{halfstep.folder()}/motor.csv", "w", encoding="utf-8") as table:
    print("time [s],angle [rad],moment [N],work [J]", file=table)
    halfstep.integrate.advance_once(solid, halfstep.mapping.Hinged(points.position, hinge), Flap(model))
