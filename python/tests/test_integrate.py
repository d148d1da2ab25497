"""A body that is advanced once a step is of second order, and both sides have the same impulses."""

import types
import unittest

import numpy as np
from halfstep.integrate import Means, advance_once

MASS, STIFFNESS = 2.0, 50.0
OTHER_MASS, SPRING, DAMPER = 3.0, 40.0, 1.5
END = 1.0
# Lengths of steps over their mean, in turn.
EQUAL, ALTERNATING = (1.0,), (0.8, 1.2)


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


class AtRest(Means):
    """Of accelerations nothing is known: u + v dt/2 and v alone are published."""

    def acceleration(self, dt):
        return np.zeros(1)


class One:
    """One point that is the unknown itself."""

    positions = velocities = staticmethod(np.asarray)

    @staticmethod
    def back(forces):
        return np.asarray(forces)


class OtherSide:
    """A mass in place of the fluid, tied to the solid by a spring and a damper, advanced by the midpoint rule."""

    def __init__(self, body, steps, lengths):
        self.steps = END / steps * np.resize(lengths, steps)
        self.y, self.w = 0.0, 0.0
        self.told = (body.u, body.v)

    def __iter__(self):
        for number, dt in enumerate(self.steps):
            y, w = self.y, self.w
            y_now, w_now = y, w
            for stage in (0, 1):
                (x, v) = self.told
                force = SPRING * (y_now - x) + DAMPER * (w_now - v)
                span = dt if stage else 0.5 * dt
                y_now, w_now = y + span * w_now, w - span * force[0] / OTHER_MASS
                self.told = None
                publish = lambda u, v, **more: setattr(self, "told", (u, v))
                yield types.SimpleNamespace(number=number, stage=stage, dt=dt, span=span, forces=force,
                                            publish=publish)
            self.y, self.w = float(y_now), float(w_now)


def state(kind, steps, lengths=EQUAL, means=None):
    body = kind()
    side = OtherSide(body, steps, lengths)
    advance_once(side, One(), body, means)
    return np.array([body.u[0], body.v[0], side.y, side.w]), body


class Order(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.exact = state(Oscillator, 6400)[0]

    def ratio(self, kind, lengths, means=lambda: None):
        """How much smaller the error gets with twice the steps."""
        coarse, fine = (np.abs(state(kind, n, lengths, means())[0] - self.exact).max() for n in (100, 200))
        return coarse / fine

    def test_second_order(self):
        for kind in (Oscillator, Implicit):
            for lengths in (EQUAL, ALTERNATING):
                with self.subTest(f"{kind.__name__}, {lengths}"):
                    ratio = self.ratio(kind, lengths)
                    self.assertGreater(ratio, 3.6)
                    self.assertLess(ratio, 4.6)

    def test_without_an_acceleration_it_is_the_first(self):
        for lengths in (EQUAL, ALTERNATING):
            ratio = self.ratio(Implicit, lengths, AtRest)
            self.assertGreater(ratio, 1.8)
            self.assertLess(ratio, 2.2)

    def test_means_of_unequal_steps_by_hand(self):
        # v = 3 t^2 - 2 t: the acceleration is 6 t - 2, its mean over a half step that in its middle.
        means, time = Means(), 0.0
        means.begin([0.0])
        for dt in (0.5, 0.25, 0.75):
            time += dt
            means.accept([3.0 * time**2 - 2.0 * time], dt)
            if len(means.last) == 2:
                for following in (0.125, 1.0):
                    middle = time + 0.25 * following
                    self.assertAlmostEqual(means.acceleration(following)[0], 6.0 * middle - 2.0, delta=1e-14)

    def test_the_other_side_has_the_same_impulse(self):
        end, body = state(Oscillator, 100)
        self.assertAlmostEqual(body.impulse, -OTHER_MASS * end[3], delta=1e-12)


if __name__ == "__main__":
    unittest.main()
