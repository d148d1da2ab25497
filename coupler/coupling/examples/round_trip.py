"""A solid that computes nothing, for the example `round_trip`: `round_trip.py RECORDS`."""

import sys

import halfstep
import numpy as np

position = np.zeros((int(sys.argv[1]), 2))
position[:, 0] = np.arange(len(position))
for step in halfstep.Solid(position, 1.0, 1000.0, dt_limit=1.0):
    step.publish(position, 0.0)
