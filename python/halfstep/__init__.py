"""A solid of your own in a fluid-structure simulation by halfstep.

    solid = halfstep.Solid(position, mass, density)
    for step in solid:
        ...                                # from step.forces over step.span
        step.publish(position, velocity)

docs/protocol.md of halfstep has the rules, python/examples complete solids.
"""

from . import integrate, mapping
from .solid import Solid, Step, description, folder, material, particles, saved

__all__ = ["Solid", "Step", "description", "folder", "integrate", "mapping", "material", "particles", "saved"]
