"""A solid of a run, as a loop over half steps."""

import atexit
import os
import sys

import numpy as np

from . import checkpoint, scene, wire
from .link import Environment, Link


class Step:
    """One half step: the forces on the state that was published last, and how far to go from step n with them.

    - `number`: n. `stage` 0: the forces are those at n, and the state at n + 1/2 is to be published. `stage` 1: the
      forces are those at n + 1/2, and the state at n + 1 is to be published. Both go from the state at n.
    - `dt`: length of the whole step, s. `span`: how far this stage goes from n, s: dt / 2, then dt.
    - `time`: time at n, s. `next_time`: time at n + 1, s.
    - `forces`: N x D, N (2D: N/m), the whole action of fluid, other solids and walls. Gravity is the solid's own.
    """

    def __init__(self, solid, header, records):
        self.number, self.stage = int(header["step"]), int(header["stage"])
        self.time, self.dt, self.next_time = (float(header[key]) for key in ("time", "dt", "next_time"))
        self.span = self.dt if self.stage else 0.5 * self.dt
        d = solid.dimension
        acceleration, force = records["cross_viscosity"][:, :d], records["stress_force"][:, :d]
        self.forces = solid.records["mass"][:, None] * acceleration + force
        self._solid = solid

    def publish(self, position, velocity, **more):
        """Takes the state after this half step: N x D, m and m/s; `velocity` may be one for all.

        More, where there is something to say: `stress` (N x 6: xx, yy, zz, xy, yz, xz, Pa) and `pressure` (N, Pa) for
        pictures and probes, `density` (N, kg/m3), `dt_limit` (s), `sub_steps`, `stored_energy` (J).
        """
        self._solid._set(position, velocity, **more)


class Solid:
    """The solid of a run: particles, and a loop over half steps.

    `position`: N x D, m. `mass`: N or one for all, kg (2D: kg/m). `density`: the same, kg/m3. `velocity`: N x D or one
    for all, m/s. `clamped`: mask of particles whose velocity is prescribed. `body`: number of the connected body of
    each, from 0 on. `dt_limit`: largest time step that the solid allows, s. `save`: a function that returns the state
    at n as a dictionary of arrays; with it the run can be interrupted and resumed, and `saved()` has that dictionary
    then. `own_walls`: the solver holds the solid against the scene's walls itself; else walls that the scene lets it
    touch push it in the plane, and `forces` has that, too.
    """

    def __init__(
        self, position, mass, density, *, velocity=0.0, clamped=None, body=None, dt_limit=1e30, save=None,
        own_walls=False, environment=None,
    ):
        self.environment = environment or Environment()
        position = np.asarray(position, float)
        count, self.dimension = position.shape
        if count > self.environment.number("CAPACITY"):
            sys.exit(f"{count} particles, but messages of the run have room for {self.environment['CAPACITY']}")
        self.records = np.zeros(count, wire.STATE_RECORD.dtype)
        self.records["id"] = np.arange(count)
        self.records["mass"], self.records["density"] = mass, density
        flags = np.zeros(count, np.uint32)
        if clamped is not None:
            flags |= np.where(clamped, wire.CLAMPED, 0).astype(np.uint32)
        if body is not None:
            body = np.asarray(body, np.int64)
            if body.min() < 0 or body.max() >= wire.BODIES:
                raise ValueError(f"bodies have the numbers 0 to {wire.BODIES - 1}, not {body.min()} to {body.max()}")
            # 0 would say nothing of its body.
            flags |= (body + 1).astype(np.uint32) << wire.BODY_SHIFT
        self.records["flags"] = flags
        self.header = {"dt_limit": dt_limit, "sub_steps": 1}
        self.save, self.safe = save, 0
        self.abilities = (wire.CHECKPOINTS if save else 0) | (wire.WALLS_AND_CONTACTS if own_walls else 0)
        self._is_due, self._done = True, False
        self.step, self.stage, self.time = 0, 0, 0.0
        _, own = checkpoint.read(self.environment)
        if own is not None:
            self._go_on(own)
        self._set(position, velocity)
        self.link = Link(self.environment)
        self._process = os.getpid()
        atexit.register(self._leave)

    def _own(self):
        """What a checkpoint has of the state that was published, beside what the solid saves."""
        header = {f"header.{field}": value for field, value in self.header.items()}
        return {"step": self.step, "time": self.time, "records": self.records} | header

    def _go_on(self, own):
        self.step, self.time = int(own["step"]), float(own["time"])
        if len(own["records"]) != len(self.records):
            sys.exit(f"{len(self.records)} particles, but the checkpoint has {len(own['records'])}")
        for field in ("deviatoric_stress", "pressure", "density"):
            self.records[field] = own["records"][field]
        self.header |= {key.removeprefix("header."): own[key][()] for key in own if key.startswith("header.")}

    def _set(self, position, velocity, stress=None, pressure=None, density=None, dt_limit=None, sub_steps=None,
             stored_energy=None):
        d, records = self.dimension, self.records
        records["position"][:, :d] = position
        records["velocity"][:, :d] = velocity
        for field, values in (("deviatoric_stress", stress), ("pressure", pressure), ("density", density)):
            if values is not None:
                records[field] = values
        for field, value in (("dt_limit", dt_limit), ("sub_steps", sub_steps), ("audit.stored_energy", stored_energy)):
            if value is not None:
                self.header[field] = value
        self._is_due = True

    def __iter__(self):
        dt = 0.0
        while True:
            self._publish(dt)
            answer, forces = self.link.receive()
            if answer["order"] & wire.WRITE_CHECKPOINT and self.save:
                self.safe = int(answer["checkpoint"])
                checkpoint.write(self.environment, self.safe, self.save(), self._own())
            if answer["order"] & wire.STOP:
                self._last(wire.FINISHED)
                return
            yield Step(self, answer, forces)
            dt = float(answer["dt"])
            if self.stage == 1:
                self.step, self.time, dt = self.step + 1, float(answer["next_time"]), 0.0
            self.stage = 1 - self.stage

    def _publish(self, dt):
        if not self._is_due:
            # The place has moved on to the state that is due.
            step = self.step - (self.stage == 0)
            raise RuntimeError(f"no state was published in step {step}, stage {1 - self.stage}")
        self._is_due = False
        self.link.send(self.records, **self._head(), dt=dt, **self._sums())

    def _head(self):
        place = {"step": self.step, "stage": self.stage, "time": self.time}
        return place | self.header | {"abilities": self.abilities, "checkpoint_safe": self.safe}

    def _sums(self):
        """What run.json tells of the particles: sums at stage 0."""
        records = self.records
        mass, velocity = records["mass"], records["velocity"]
        if self.stage == 1:
            return {}
        return {
            "audit.momentum": mass @ velocity,
            "audit.kinetic_energy": 0.5 * float(mass @ (velocity**2).sum(axis=1)),
            "audit.mass": float(mass.sum()),
            "audit.gap": np.inf,
            "particles": len(records),
        }

    def _last(self, status, **failure):
        self._done = True
        head = self._head() | {"stage": wire.LAST_STAGE if status == wire.FINISHED else self.stage, "status": status}
        if status == wire.FINISHED:
            head |= {"audit.mass": float(self.records["mass"].sum()), "particles": len(self.records)}
        self.link.send(self.records[:0], **head, **failure)
        self.link.close()

    def diverged(self, quantity, value, particle):
        """Ends the run: a quantity of a particle left its bounds. Quantities are those of `wire.QUANTITIES`."""
        place = [pair.split(":")[0] for pair in self.environment["PARTICIPANTS"].split(",")].index(self.link.name)
        told = {"participant": place, "quantity": wire.QUANTITIES[quantity], "particle": particle, "value": value,
                "position": self.records["position"][particle]}
        self._last(wire.DIVERGED, **{f"failure.{key}": value for key, value in told.items()})
        sys.exit(2)

    def _leave(self):
        """At the end of the program: who ends in the middle of a run says so. A fork of it is another process."""
        if not self._done and os.getpid() == self._process:
            self._last(wire.FAILED)


def environment():
    """The variables of the run."""
    return Environment()


def saved():
    """The state that the run goes on from, as `save` gave it; `None` for a run from its start."""
    return checkpoint.read(Environment())[0]


def description():
    """The scene as a dictionary: every default filled in, SI units."""
    return scene.read(Environment())


def material():
    """What the scene says of this solid: the model, density and elastic constants of its section, a dictionary."""
    own = Environment()
    return scene.material(own, scene.read(own))


def particles():
    """The particles that the program itself would give this solid."""
    own = Environment()
    return scene.particles(own, scene.read(own)["dimension"])


def folder():
    """The run's folder."""
    return os.path.abspath(Environment()["OUT"])
