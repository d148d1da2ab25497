"""The bytes of the protocol: records and headers, field by field in their order, little-endian, without padding.

Names, units and meanings are those of docs/protocol.md; a dot stands for a structure within another.
"""

import ctypes

import numpy as np

PROTOCOL = 2

_NUMPY = {"u32": "<u4", "u64": "<u8", "f64": "<f8", "f64[3]": "(3,)<f8", "f64[6]": "(6,)<f8"}

# Bits of an answer's `order`.
GO, WRITE_FRAME, WRITE_CHECKPOINT, STOP, SEND_PROBES = 1, 2, 4, 8, 16
# Bits of a state's `abilities`.
CHECKPOINTS, WALLS_AND_CONTACTS = 1, 2
# Values of a state's `status`.
OK, DIVERGED, FAILED, FINISHED = 0, 1, 2, 3
# The `stage` of the last message.
LAST_STAGE = 2
# Bit of a record's `flags`: the velocity is prescribed.
CLAMPED = 1
# Place of a record's body within its `flags`.
BODY_SHIFT = 8
BODIES = (1 << 24) - 1  # most that a record tells apart
# What `failure.quantity` can be.
QUANTITIES = {"density": 1, "speed": 2, "position": 3, "stress": 4, "time step": 5, "energy": 6}


class Layout:
    """A structure of the wire: its NumPy type, and the C type that the transport wants."""

    def __init__(self, name, version, fields):
        self.name = name
        self.fields = [field.strip().split(":") for field in fields.split(",")]
        self.dtype = np.dtype([(field, _NUMPY[kind]) for field, kind in self.fields])
        words = {"_fields_": [("words", ctypes.c_uint64 * (self.dtype.itemsize // 8))]}
        self.ctype = type(name, (ctypes.Structure,), words)
        self.ctype.type_name = staticmethod(lambda: f"halfstep.{name}.{version}")

    def view(self, address, count=1):
        """The structures at an address, as an array. What is received may only be read."""
        return np.frombuffer((self.ctype * count).from_address(address), self.dtype)

    def spelt(self):
        """The structure as the schema number counts it: inner structures in braces."""
        parts, inner = [], None
        for path, kind in self.fields:
            outer, _, field = path.rpartition(".")
            if outer and outer == inner:
                parts[-1] = parts[-1][:-1] + f",{field}:{kind}}}"
            else:
                parts.append(f"{outer}:{{{field}:{kind}}}" if outer else f"{field}:{kind}")
            inner = outer
        return f"{self.name}{{{','.join(parts)}}}"


STATE_RECORD = Layout("StateRecord", 1, """id:u32, flags:u32, position:f64[3], velocity:f64[3], density:f64,
    pressure:f64, mass:f64, deviatoric_stress:f64[6]""")
FORCE_RECORD = Layout("ForceRecord", 1, "id:u32, flags:u32, cross_viscosity:f64[3], stress_force:f64[3]")
STATE_HEADER = Layout("StateHeader", 2, """run_id:u64, schema:u64, protocol:u32, status:u32, step:u64, stage:u32,
    count:u32, epoch:u64, time:f64, dt:f64, dt_limit:f64, displacement:f64, sub_steps:u32, frames_safe:u32,
    abilities:u32, checkpoint_safe:u32, failure.participant:u32, failure.quantity:u32, failure.particle:u32,
    failure.reserved:u32, failure.value:f64, failure.position:f64[3], audit.momentum:f64[3],
    audit.kinetic_energy:f64, audit.mass:f64, audit.density_error:f64, audit.gap:f64, audit.stored_energy:f64,
    state_hash:u64, particles:u64""")
FORCE_HEADER = Layout("ForceHeader", 2, """run_id:u64, schema:u64, protocol:u32, order:u32, step:u64, stage:u32,
    count:u32, epoch:u64, time:f64, dt:f64, next_time:f64, frame:u64, checkpoint:u64""")
PROBE_HEADER = Layout("ProbeHeader", 1, "run_id:u64, schema:u64, protocol:u32, count:u32, step:u64, time:f64")

LAYOUTS = (STATE_RECORD, FORCE_RECORD, STATE_HEADER, FORCE_HEADER, PROBE_HEADER)


def schema():
    """The number that stands for these layouts: FNV-1a (64 bit) of their text."""
    value = 0xCBF29CE484222325
    for byte in ";".join(layout.spelt() for layout in LAYOUTS).encode():
        value = (value ^ byte) * 0x100000001B3 % 2**64
    return value


if __name__ == "__main__":
    # What a test compares with the program's own structures.
    for layout in LAYOUTS:
        print(layout.name, layout.ctype.type_name(), layout.dtype.itemsize)
        for field, kind in layout.fields:
            print(layout.dtype.fields[field][1], field, kind)
    print("protocol", PROTOCOL)
    print("schema", schema())
    numbers = {
        "go": GO, "write frame": WRITE_FRAME, "write checkpoint": WRITE_CHECKPOINT, "stop": STOP,
        "send probes": SEND_PROBES, "checkpoints": CHECKPOINTS, "walls and contacts": WALLS_AND_CONTACTS,
        "ok": OK, "diverged": DIVERGED, "failed": FAILED, "finished": FINISHED, "last stage": LAST_STAGE,
    }
    for name, number in (numbers | QUANTITIES).items():
        print(name, number)
