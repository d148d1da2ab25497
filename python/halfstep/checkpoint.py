"""Checkpoints of a solid: an archive of arrays in the folder that the run tells."""

import os

import numpy as np


def read(environment):
    """What the run goes on from; `None` where it starts."""
    folder = environment.get("CHECKPOINT")
    if folder is None:
        return None
    with np.load(os.path.join(folder, f"{environment['NAME']}.hdf")) as archive:
        return dict(archive)


def write(environment, number, arrays):
    """Writes checkpoint `number`. It has its name only when it is whole and on disk."""
    folder = os.path.join(environment["OUT"], "checkpoint-a" if number % 2 else "checkpoint-b")
    path = os.path.join(folder, f"{environment['NAME']}.hdf")
    with open(path + ".tmp", "wb") as file:
        np.savez(file, **arrays)
        file.flush()
        os.fsync(file.fileno())
    os.replace(path + ".tmp", path)
    descriptor = os.open(folder, os.O_RDONLY)
    os.fsync(descriptor)
    os.close(descriptor)
