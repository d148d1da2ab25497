"""Draws flaps in waves beside linear theory: python3 wave_flap_plot.py PROBES.CSV FROM PICTURE RUN...

PROBES.CSV and FROM are those of wave_theory.py, 3.4 s for the first whole waves. A RUN is the folder of a run of
wave-flap.toml with wave_flap.py, named for its motor, as wave-flap-5.5-40. Prints each run's mean power and swing.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import wave_theory as theory


def power(damping, stiffness):
    """Mean power by linear theory, W/m."""
    moving = theory.inertia + theory.added
    impedance = theory.hold + stiffness - theory.omega**2 * moving + 1j * theory.omega * (theory.radiation + damping)
    return 0.5 * damping * (theory.omega * theory.force / abs(impedance)) ** 2


begin, end = theory.begin, theory.begin + theory.PERIOD
figure, axes = plt.subplot_mosaic([["angle", "mean"], ["power", "mean"]], figsize=(11, 5), layout="constrained")
dampings = np.geomspace(0.5, 40.0, 200)
axes["mean"].plot(dampings, power(dampings, 0.0), "k", label="linear theory")
axes["mean"].plot(dampings, power(dampings, 40.0), "k--", label="linear theory, 40 N m/rad")

runs = [(*map(float, Path(run).name.split("-")[-2:]), run) for run in sys.argv[4:]]
for damping, stiffness, run in sorted(runs, key=lambda run: (run[1], run[0])):
    time, angle, _, work = np.loadtxt(f"{run}/motor.csv", delimiter=",", skiprows=1).T
    label = f"{damping:g} N m s/rad" + (f", {stiffness:g} N m/rad" if stiffness else "")
    line = axes["angle"].plot(time, np.degrees(angle))[0]
    # Power of a step: its work over its length.
    axes["power"].plot(time[1:], work[1:] / np.diff(time), color=line.get_color())
    whole = (time >= begin) & (time < end)
    mean = work[whole].sum() / theory.PERIOD
    swing = abs(2.0 * np.mean(angle[whole] * np.exp(1j * theory.omega * time[whole])))
    print(f"{label}: {mean:.3f} W/m of {power(damping, stiffness):.3f} W/m, {1e3 * swing:.1f} mrad")
    axes["mean"].plot(damping, mean, "s" if stiffness else "o", color=line.get_color(), label=label)

for name in ("angle", "power"):
    axes[name].axvspan(begin, end, color="0.9")
    axes[name].set_xlim(1.0, 5.2)
axes["power"].sharex(axes["angle"])
axes["angle"].set_ylabel("angle, degrees")
axes["power"].set(xlabel="time, s", ylabel="power of the motor, W/m")
axes["mean"].set(xscale="log", xlabel="damping of the motor, N m s/rad", ylim=(0.0, 0.2))
axes["mean"].set_ylabel(f"mean power, {begin:g} to {end:g} s, W/m")
axes["mean"].legend(loc="lower center")
figure.get_layout_engine().set(w_pad=0.1)
for axis in axes.values():
    axis.grid(color="0.85")
figure.savefig(sys.argv[3], dpi=100)
