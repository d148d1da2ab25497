"""What every answer of the coupler must satisfy before anybody uses it. See docs/protocol.md."""

import math
import struct
from dataclasses import dataclass

import numpy as np

from . import wire

# A solid's particles stay the same ones.
EPOCH = 0


class WrongAnswer(RuntimeError):
    """An answer is not the one that is due: the field, what was expected and what was found."""


@dataclass
class Sent:
    """The state that an answer is for: `time` and `dt` in s, `ids` the numbers of its particles."""

    step: int
    stage: int
    time: float
    dt: float
    ids: np.ndarray

    def __str__(self):
        return f"message of the coupler at step {self.step}, stage {self.stage}"


def check(identity, sent, header, records):
    """Raises `WrongAnswer` where header and records are no answer to the state `sent` of the run `identity`."""
    told = dict(zip(header.dtype.names, header.item()))

    def expect(field, expected, found):
        if found != expected:
            raise _mismatch(sent, field, expected, found)

    for field, own in identity.items():
        expect(field, own, told[field])
    expect("count", len(records), told["count"])
    expect("step", sent.step, told["step"])
    expect("stage", sent.stage, told["stage"])
    # The coupler tells the time step at stage 0 and repeats it at stage 1.
    known = {"time": sent.time} if sent.stage == 0 else {"time": sent.time, "dt": sent.dt}
    for field, own in known.items():
        if _bits(told[field]) != _bits(own):
            raise _mismatch(sent, field, own, told[field])
    for field in ("dt", "next_time"):
        if not math.isfinite(told[field]):
            raise WrongAnswer(f"{sent}: {field} is {told[field]}")
    stops = bool(told["order"] & wire.STOP)
    if stops == bool(told["order"] & wire.GO):
        raise _mismatch(sent, "order", "one of go and stop", told["order"])
    if stops:
        expect("stage", 0, told["stage"])
        return
    if told["dt"] <= 0.0:
        raise _mismatch(sent, "dt", "a positive number", told["dt"])
    expect("epoch", EPOCH, told["epoch"])
    expect("count", len(sent.ids), len(records))
    # All words at once: where flags make the first of a record look infinite, the closer look finds nothing.
    if records["id"].tobytes() != sent.ids.tobytes() or not np.isfinite(records.view("<f8")).all():
        _look_closer(sent, records)


def _look_closer(sent, records):
    """Raises for the first record of which something is wrong."""
    numbers = np.hstack([records["cross_viscosity"], records["stress_force"]])
    wrong = (records["id"] != sent.ids) | ~np.isfinite(numbers).all(axis=1)
    if not wrong.any():
        return
    first = int(wrong.argmax())
    if records["id"][first] != sent.ids[first]:
        raise _mismatch(sent, "id", sent.ids[first], records["id"][first])
    axis = int(np.isfinite(numbers[first]).argmin())
    field = "cross_viscosity" if axis < 3 else "stress_force"
    raise WrongAnswer(f"{sent}: {field} is {numbers[first, axis]} for particle {sent.ids[first]}")


def _mismatch(sent, field, expected, found):
    return WrongAnswer(f"{sent}: {field} is {found}, expected {expected}")


def _bits(number):
    return struct.pack("<d", number)
