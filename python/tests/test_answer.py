"""A wrong answer of the coupler ends the run before anybody uses it, and its message says what is wrong."""

import contextlib
import ctypes
import types
import unittest
from unittest import mock

import numpy as np
from halfstep import Solid, wire
from halfstep.answer import Sent, WrongAnswer, check
from halfstep.link import Environment, Link

COUNT, DT = 3, 0.25
RUN = {"run_id": 7, "protocol": wire.PROTOCOL, "schema": wire.schema()}


class Sample:
    """A message of the transport."""

    def __init__(self, header, record, count):
        self.memory = (ctypes.c_char * header.dtype.itemsize)(), (ctypes.c_char * (record.dtype.itemsize * count))()
        self.user_header_ptr, self.payload_ptr = map(ctypes.addressof, self.memory)
        self.header = types.SimpleNamespace(number_of_elements=count)
        self.head, self.records = header.view(self.user_header_ptr), record.view(self.payload_ptr, count)

    def assume_init(self):
        return self

    def send(self):
        pass


class Coupler:
    """Answers each state as it should; `spoil(header, records)` may make something else of one of the answers."""

    def __init__(self, wrong_at=None, spoil=None, count=COUNT, stop_at=2):
        self.wrong_at, self.spoil, self.count, self.stop_at = wrong_at, spoil, count, stop_at

    def loan_slice_uninit(self, count):
        self.state = Sample(wire.STATE_HEADER, wire.STATE_RECORD, count)
        return self.state

    def receive(self):
        head = self.state.head[0]
        place = int(head["step"]), int(head["stage"])
        is_wrong, stops = place == self.wrong_at, place == (self.stop_at, 0)
        answer = Sample(wire.FORCE_HEADER, wire.FORCE_RECORD, self.count if is_wrong else 0 if stops else COUNT)
        told = RUN | {"count": len(answer.records), "step": head["step"], "stage": head["stage"], "time": head["time"],
                      "order": wire.STOP if stops else wire.GO, "dt": 0.0 if stops else DT}
        for field, value in told.items():
            answer.head[field] = value
        answer.head["next_time"] = answer.head["time"] + answer.head["dt"]
        answer.records["id"] = np.arange(len(answer.records))
        answer.records["stress_force"][:, 0] = 1.0 + np.arange(len(answer.records))
        if is_wrong and self.spoil:
            self.spoil(answer.head[0], answer.records)
        return answer


def environment(**more):
    """Variables of a run."""
    told = {"RUN_ID": 7, "PROTOCOL": wire.PROTOCOL, "SCHEMA": wire.schema(), "NAME": "solid", "CAPACITY": COUNT,
            "PATIENCE_SECONDS": 1}
    return Environment({f"HALFSTEP_{key}": str(value) for key, value in (told | more).items()})


@contextlib.contextmanager
def attach(coupler):
    """Solids that begin meanwhile have this coupler."""

    def connect(link):
        link.inbox = link.outbox = coupler
        link.notifiers = []

    with (mock.patch.object(Link, "_handshake", connect), mock.patch("halfstep.link.Claim"),
          mock.patch("halfstep.solid.atexit")):
        yield


def run(coupler):
    """Forces of all half steps of a solid with this coupler."""
    with attach(coupler):
        solid, forces = Solid(np.zeros((COUNT, 2)), 1.0, 1000.0, environment=environment()), []
        for step in solid:
            forces.append(step.forces)
            step.publish(np.zeros((COUNT, 2)), 0.0)
    return forces


def put(field, value, record=None):
    """Writes a field of the header, or of a record."""

    def spoil(header, records):
        (header if record is None else records[record])[field] = value

    return spoil


def component(field, record, axis, value):
    def spoil(_, records):
        records[field][record, axis] = value

    return spoil


def swap(_, records):
    records["id"][[1, 2]] = 2, 1


# What is wrong with the answer to which state, and what the message says of it.
WRONG = [
    ((0, 0), put("run_id", 8), "run_id is 8, expected 7"),
    ((0, 0), put("protocol", 1), f"protocol is 1, expected {wire.PROTOCOL}"),
    ((0, 0), put("schema", 5), f"schema is 5, expected {wire.schema()}"),
    ((0, 1), put("count", 2), "count is 2, expected 3"),
    ((1, 0), put("step", 2), "step is 2, expected 1"),
    ((1, 0), put("stage", 1), "stage is 1, expected 0"),
    ((1, 1), put("stage", 0), "stage is 0, expected 1"),
    ((1, 0), put("time", np.nextafter(DT, 1.0)), "time is 0.25000000000000006, expected 0.25"),
    ((0, 0), put("time", -0.0), "time is -0.0, expected 0.0"),
    ((0, 0), put("time", np.nan), "time is nan, expected 0.0"),
    ((0, 1), put("dt", 0.125), "dt is 0.125, expected 0.25"),
    ((0, 0), put("dt", np.inf), "dt is inf"),
    ((0, 0), put("dt", np.nan), "dt is nan"),
    ((0, 0), put("dt", 0.0), "dt is 0.0, expected a positive number"),
    ((0, 0), put("dt", -0.25), "dt is -0.25, expected a positive number"),
    ((1, 1), put("next_time", np.nan), "next_time is nan"),
    ((0, 0), put("order", wire.WRITE_FRAME), "order is 2, expected one of go and stop"),
    ((0, 0), put("order", wire.GO | wire.STOP), "order is 9, expected one of go and stop"),
    ((1, 1), put("order", wire.STOP), "stage is 1, expected 0"),
    ((0, 1), put("epoch", 1), "epoch is 1, expected 0"),
    ((0, 0), put("id", 9, record=0), "id is 9, expected 0"),
    ((1, 1), swap, "id is 2, expected 1"),
    ((0, 1), component("stress_force", 2, 0, np.nan), "stress_force is nan for particle 2"),
    ((0, 1), component("cross_viscosity", 1, 1, -np.inf), "cross_viscosity is -inf for particle 1"),
    # In two dimensions nobody uses it.
    ((0, 1), component("stress_force", 0, 2, np.inf), "stress_force is inf for particle 0"),
]


class Answers(unittest.TestCase):
    def refused(self, place, spoil, message, **coupler):
        with self.assertRaises(WrongAnswer) as caught:
            run(Coupler(place, spoil, **coupler))
        step, stage = place
        self.assertEqual(str(caught.exception), f"message of the coupler at step {step}, stage {stage}: {message}")

    def test_right_ones_are_taken(self):
        forces = run(Coupler())
        self.assertEqual(len(forces), 4)
        for force in forces:
            self.assertEqual(force.tolist(), [[1.0, 0.0], [2.0, 0.0], [3.0, 0.0]])

    def test_flags_are_nobodys_business(self):
        self.assertEqual(len(run(Coupler((0, 1), put("flags", 2**32 - 1, record=1)))), 4)

    def test_each_wrong_field_is_told(self):
        for place, spoil, message in WRONG:
            with self.subTest(message):
                self.refused(place, spoil, message)

    def test_as_many_as_were_published(self):
        for count in (0, 2, 4):
            self.refused((0, 1), None, f"count is {count}, expected 3", count=count)

    def test_an_order_to_stop_has_no_forces_and_no_time_step(self):
        for count in (0, 2):
            self.assertEqual(len(run(Coupler((1, 0), put("epoch", 5), count=count, stop_at=1))), 2)

    def test_the_first_wrong_record_is_told(self):
        records = np.zeros(1000, wire.FORCE_RECORD.dtype)
        records["id"] = np.arange(1000)
        sent = Sent(4, 1, 1.0, DT, records["id"].copy())
        header = np.zeros(1, wire.FORCE_HEADER.dtype)[0]
        told = RUN | {"count": 1000, "step": 4, "stage": 1, "time": 1.0, "dt": DT, "next_time": 1.25, "order": wire.GO}
        for field, value in told.items():
            header[field] = value
        check(RUN, sent, header, records)
        for record, axis in ((999, 2), (500, 0), (0, 1)):
            records["cross_viscosity"][record, axis] = np.nan
            with self.assertRaisesRegex(WrongAnswer, f"cross_viscosity is nan for particle {record}$"):
                check(RUN, sent, header, records)


if __name__ == "__main__":
    unittest.main()
