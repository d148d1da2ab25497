"""Solvers that cannot step back, in a scheme that evaluates forces twice a step.

A step has two stages, and a midpoint rule goes to n + 1/2, returns to n, and goes to n + 1. A solver that keeps its
history (plasticity, contact, cracks) or an implicit one is better advanced once. Then:

- at stage 0, a_n = M^-1 (N^T f_n + the solid's own forces at n) is kept, and what is published for n + 1/2 is

      u + v dt/2 + a_n dt^2/8,    v + a_n dt/2;

- at stage 1 the solver is advanced once over dt with the forces of n + 1/2. These are the ones that move the fluid from
  n to n + 1, so the impulses on both sides are equal and opposite.

The result is of second order in dt. Publishing u + v dt/2 and v alone would be of first order.

For a stiff solid a_n is dominated by oscillations that its solver does not resolve. A solid without `acceleration`
gets an estimate from its accepted steps instead: the mean accelerations (v_n - v_(n-1)) / dt, extrapolated.
"""

import numpy as np


class Means:
    """Extrapolates the mean accelerations of accepted steps to the half step that comes."""

    def __init__(self):
        self.last, self.velocity = [], None

    def accept(self, velocity, dt):
        """After a step of length dt (s) that ended with this velocity."""
        velocity = np.array(velocity, float)
        if self.velocity is not None:
            self.last = [((velocity - self.velocity) / dt, dt)] + self.last[:1]
        self.velocity = velocity

    def begin(self, velocity):
        """Before the first step."""
        self.velocity = np.array(velocity, float)

    def acceleration(self, dt):
        """Mean over the half step that comes; dt (s): of its whole step."""
        if not self.last:
            return np.zeros_like(self.velocity)
        newest, newest_dt = self.last[0]
        if len(self.last) == 1:
            return newest
        before, before_dt = self.last[1]
        # Means belong to the middles of their steps, that of the coming half step to a quarter of dt after n.
        slope = (newest - before) / (0.5 * (newest_dt + before_dt))
        return newest + slope * (0.5 * newest_dt + 0.25 * dt)


def advance_once(solid, mapping, body, means=None, **fields):
    """Runs `solid` to its end with a body that is advanced once a step.

    `body.u`, `body.v`: its unknowns and their rates now. `body.advance(load, dt)` goes on by dt (s) under constant
    forces on the unknowns. `body.acceleration(load)`, if it has that: rates of `v` now, its own forces included.
    `means`: a `Means` that `save` keeps (`last`, `velocity`), so that a run that goes on from a checkpoint is the one
    that was interrupted; only for a body without `acceleration`.
    `fields`: functions of the body for more fields of `Step.publish`, `stress` for instance.
    """
    if hasattr(body, "acceleration"):
        means = None
    elif means is None:
        means = Means()
    if means and means.velocity is None:
        means.begin(body.v)
    for step in solid:
        load = mapping.back(step.forces)
        if step.stage == 0:
            a = means.acceleration(step.dt) if means else body.acceleration(load)
            half = 0.5 * step.dt
            u, v = body.u + half * body.v + 0.5 * half**2 * a, body.v + half * a
        else:
            body.advance(load, step.dt)
            u, v = body.u, body.v
            if means:
                means.accept(v, step.dt)
        more = {name: of(body) for name, of in fields.items()}
        step.publish(mapping.positions(u), mapping.velocities(v), **more)
