"""A model of MuJoCo as a body that `halfstep.integrate.advance_once` advances."""

import mujoco


class Body:
    """Unknowns are the joints of the model, in its order: m and rad."""

    def __init__(self, model):
        self.model, self.data = model, mujoco.MjData(model)

    @property
    def u(self):
        return self.data.qpos.copy()

    @property
    def v(self):
        return self.data.qvel.copy()

    def acceleration(self, load):
        self.data.qfrc_applied[:] = load
        mujoco.mj_forward(self.model, self.data)
        return self.data.qacc.copy()

    def advance(self, load, dt):
        self.data.qfrc_applied[:] = load
        self.model.opt.timestep = dt
        mujoco.mj_step(self.model, self.data)
