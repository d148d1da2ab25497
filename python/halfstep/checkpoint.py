"""Checkpoints of a solid: an archive of arrays in the folder that the run tells."""

import os

import numpy as np

# Prefix of the names that the solid saves; names of the package have none.
SAVED = "saved."


def read(environment):
    """What the run goes on from, the solid's own and the package's; `None` twice where it starts."""
    folder = environment.get("CHECKPOINT")
    if folder is None:
        return None, None
    path = os.path.join(folder, f"{environment['NAME']}.hdf")
    with open(path, "rb") as file:
        # Clients in other languages write other files; those of NumPy are archives.
        if file.read(2) != b"PK":
            raise ValueError(f"{path}: no checkpoint of this package, but of a program in another language")
    with np.load(path) as archive:
        own = {name: archive[name] for name in archive.files if not name.startswith(SAVED)}
        return {name.removeprefix(SAVED): archive[name] for name in archive.files if name not in own}, own


def write(environment, number, saved, own):
    """Writes checkpoint `number` with two dictionaries of arrays: what the solid saved, and what is the package's own.

    It has its name only when it is whole and on disk.
    """
    arrays = {SAVED + name: np.asarray(value) for name, value in saved.items()}
    for name, array in arrays.items():
        if array.dtype.hasobject:
            raise TypeError(f"save() gave {name.removeprefix(SAVED)!r}, which is no array of numbers")
    folder = os.path.join(environment["OUT"], "checkpoint-a" if number % 2 else "checkpoint-b")
    path = os.path.join(folder, f"{environment['NAME']}.hdf")
    with open(path + ".tmp", "wb") as file:
        np.savez(file, **arrays, **own)
        file.flush()
        os.fsync(file.fileno())
    os.replace(path + ".tmp", path)
    descriptor = os.open(folder, os.O_RDONLY)
    os.fsync(descriptor)
    os.close(descriptor)
