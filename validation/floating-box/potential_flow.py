"""Heave and roll of the floating box by linear potential flow in its tank: `potential_flow.py [SPACING [SCENE]]`.

Laplace's equation by finite elements, the linear free surface, and a box that the water's pressure moves in sway, heave
and roll; z = 0 is the level at rest. Of a box and a water that begin at rest, released 10 mm too high or turned by 10
degrees, it prints when the motion turns round. SCENE `mujoco` is the tank of python/examples/mujoco, in which the box
is released 20 mm too high for the level at the start, 15 mm for that at which it floats. Needs
python/examples/scikit-fem/requirements.txt.
"""

import sys

import numpy as np
import scipy.sparse.linalg as sparse
import skfem

GRAVITY, DENSITY = 9.81, 1000.0
# Of the tank, and of the water as the box floats in it; level and place of the box at the start over those; until, s.
WIDTH, DEPTH, LEVEL, PLACE, END = (
    (0.8, 0.255, -0.005, 0.015, 1.9) if sys.argv[2:] == ["mujoco"] else (1.0, 0.202, -0.002, 0.008, 0.8))
BREADTH, DRAUGHT = 0.2, 0.05
MASS, MOMENT, CENTRE = 10.0, 10.0 * 0.05 / 12.0, 0.0  # its centre of mass is at the level


def mesh(spacing):
    """The water, with even columns and rows on either side of the box's faces."""
    cut = lambda marks: np.unique(np.concatenate([
        np.linspace(a, b, round((b - a) / spacing) + 1) for a, b in zip(marks, marks[1:])]).round(12))
    x = cut([-0.5 * WIDTH, -0.5 * BREADTH, 0.5 * BREADTH, 0.5 * WIDTH])
    whole = skfem.MeshQuad.init_tensor(x, cut([-DEPTH, -DRAUGHT, 0.0]))
    middle = whole.p[:, whole.t].mean(axis=1)
    return whole.remove_elements(np.nonzero((abs(middle[0]) < 0.5 * BREADTH) & (middle[1] > -DRAUGHT))[0])


class Tank:
    def __init__(self, spacing):
        water = mesh(spacing)
        element = skfem.ElementQuad1()
        near = 1e-9
        box = lambda x: (abs(x[0]) < 0.5 * BREADTH + near) & (x[1] > -DRAUGHT - near) & (x[1] < -near)
        surface = skfem.FacetBasis(water, element, facets=water.facets_satisfying(lambda x: x[1] > -near, True))
        body = skfem.FacetBasis(water, element, facets=water.facets_satisfying(box, True))
        self.stiffness = skfem.BilinearForm(lambda u, v, _: u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1]).assemble(
            skfem.Basis(water, element)).tocsc()
        modes = [lambda x, n: n[0], lambda x, n: n[1], lambda x, n: x[0] * n[1] - (x[1] - CENTRE) * n[0]]
        self.modes = np.array([skfem.LinearForm(lambda v, w: v * mode(w.x, w.n)).assemble(body) for mode in modes])
        self.top = surface.get_dofs(surface.find).all()
        rows = skfem.BilinearForm(lambda u, v, _: u * v).assemble(surface).tocsc()
        self.surface = sparse.splu(rows[self.top][:, self.top])
        self.rest = np.setdiff1d(np.arange(self.stiffness.shape[0]), self.top)
        self.inner = sparse.splu(self.stiffness[self.rest][:, self.rest])
        self.to_top = self.stiffness[self.rest][:, self.top]
        # The water's pressure by each acceleration of the box alone: its added masses.
        still = np.zeros(len(self.top))
        added = DENSITY * self.modes @ np.array([self.potential(still, mode) for mode in self.modes]).T
        self.inverse = np.linalg.inv(np.diag([MASS, MASS, MOMENT]) + added)
        roll = DENSITY * GRAVITY * BREADTH**3 / 12.0 - MASS * GRAVITY * (CENTRE + 0.5 * DRAUGHT)
        self.restoring = np.array([0.0, DENSITY * GRAVITY * BREADTH, roll])
        print(f"added mass in heave {added[1, 1]:.2f} kg/m, in roll {added[2, 2]:.5f} kg m")

    def potential(self, top, through_box):
        """Of which the value on the surface and the flux through the box are known."""
        phi = np.zeros(self.stiffness.shape[0])
        phi[self.top] = top
        phi[self.rest] = self.inner.solve(through_box[self.rest] - self.to_top @ top)
        return phi

    def rates(self, state):
        level, top, place, speed = state
        through_box = speed @ self.modes
        flux = (self.stiffness @ self.potential(top, through_box) - through_box)[self.top]
        pressure = self.potential(-GRAVITY * level, 0.0 * through_box)
        force = -self.restoring * place - DENSITY * self.modes @ pressure
        return [self.surface.solve(flux), -GRAVITY * level, speed, self.inverse @ force]

    def swing(self, level, place, end, dt=0.002):
        """Times and places, from rest, by Runge and Kutta's scheme."""
        still = np.zeros(len(self.top))
        state, rows = [still + level, still, np.array(place), np.zeros(3)], []
        go = lambda by, dt: [a + dt * b for a, b in zip(state, by)]
        for k in range(round(end / dt)):
            rows.append([k * dt, *state[2]])
            a = self.rates(state)
            b = self.rates(go(a, 0.5 * dt))
            c = self.rates(go(b, 0.5 * dt))
            d = self.rates(go(c, dt))
            state = go([(p + 2.0 * q + 2.0 * r + s) / 6.0 for p, q, r, s in zip(a, b, c, d)], dt)
        return np.array(rows).T


def turns(time, way):
    """Where the motion turns round, by parabolas."""
    for k in range(1, len(time) - 1):
        before, after = way[k] - way[k - 1], way[k + 1] - way[k]
        if before * after < 0.0:
            part = 0.5 * (before + after) / (before - after)
            yield time[k] + part * (time[1] - time[0]), way[k]


def crossings(time, way):
    """When the motion passes its place, along straight lines."""
    return ", ".join(f"{t - a / (b - a) * (time[1] - time[0]):.4f} s"
                     for t, a, b in zip(time, way, way[1:]) if a * b < 0.0)


tank = Tank(float(sys.argv[1]) if len(sys.argv) > 1 else 0.005)
time, _, heave, _ = tank.swing(LEVEL, [0.0, PLACE, 0.0], END)
print("heave:", ", ".join(f"{1e3 * z:.2f} mm at {t:.4f} s" for t, z in turns(time, heave)))
print("heave: in its place at", crossings(time, heave))
time, _, _, roll = tank.swing(0.0, [0.0, 0.0, np.radians(10.0)], 0.85)
print("roll: upright at", crossings(time, roll), end="; ")
print(", ".join(f"{a:.4f} rad at {t:.4f} s" for t, a in turns(time, roll)))
