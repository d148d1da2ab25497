"""A body that is advanced once a step is of second order, and both sides have the same impulses."""

import types
import unittest

import numpy as np
from halfstep.integrate import advance_once

MASS, STIFFNESS = 2.0, 50.0
OTHER_MASS, SPRING, DAMPER = 3.0, 40.0, 1.5
END = 1.0


class Oscillator:
    """A mass on a spring, exact under a constant load: a solver that cannot step back."""

    def __init__(self):
        self.u, self.v, self.impulse = np.array([0.1]), np.array([0.0]), 0.0

    def acceleration(self, load):
        return (load - STIFFNESS * self.u) / MASS

    def advance(self, load, dt):
        self.impulse += float(load[0]) * dt
        omega, rest = np.sqrt(STIFFNESS / MASS), load / STIFFNESS
        c, s, off = np.cos(omega * dt), np.sin(omega * dt), self.u - rest
        self.u, self.v = rest + off * c + self.v / omega * s, self.v * c - off * omega * s


class Implicit(Oscillator):
    """The same without an acceleration to ask for."""

    acceleration = property(doc="hidden")

    def __getattribute__(self, name):
        if name == "acceleration":
            raise AttributeError(name)
        return super().__getattribute__(name)


class One:
    """One point that is the unknown itself."""

    positions = velocities = staticmethod(np.asarray)

    @staticmethod
    def back(forces):
        return np.asarray(forces)


class OtherSide:
    """A mass in place of the fluid, tied to the solid by a spring and a damper, advanced by the midpoint rule."""

    def __init__(self, body, steps):
        self.dt, self.steps, self.body = END / steps, steps, body
        self.y, self.w = 0.0, 0.0
        self.told = (body.u, body.v)

    def __iter__(self):
        for number in range(self.steps):
            y, w = self.y, self.w
            y_now, w_now = y, w
            for stage in (0, 1):
                (x, v) = self.told
                force = SPRING * (y_now - x) + DAMPER * (w_now - v)
                span = self.dt if stage else 0.5 * self.dt
                y_now, w_now = y + span * w_now, w - span * force[0] / OTHER_MASS
                self.told = None
                publish = lambda u, v, **more: setattr(self, "told", (u, v))
                yield types.SimpleNamespace(number=number, stage=stage, dt=self.dt, span=span, forces=force,
                                            publish=publish)
            self.y, self.w = float(y_now), float(w_now)


def state(kind, steps):
    body = kind()
    side = OtherSide(body, steps)
    advance_once(side, One(), body)
    return np.array([body.u[0], body.v[0], side.y, side.w]), body


class Order(unittest.TestCase):
    def test_second_order(self):
        exact = state(Oscillator, 6400)[0]
        for kind in (Oscillator, Implicit):
            coarse, fine = (np.abs(state(kind, steps)[0] - exact).max() for steps in (100, 200))
            self.assertGreater(coarse / fine, 3.6, kind.__name__)
            self.assertLess(coarse / fine, 4.6, kind.__name__)

    def test_the_other_side_has_the_same_impulse(self):
        end, body = state(Oscillator, 100)
        self.assertAlmostEqual(body.impulse, -OTHER_MASS * end[3], delta=1e-12)


if __name__ == "__main__":
    unittest.main()
