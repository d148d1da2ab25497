"""Linear theory of a flap that drives a motor in waves: python3 wave_theory.py PROBES.CSV [FROM].

PROBES.CSV is that of wave-flume.toml, whose gauge stands where the flap would; the waves' amplitude is that of their
period in it from FROM (3.4) s on. A flap on the floor of water of depth d, thin against the waves, in potential flow.
"""

import csv
import sys

import numpy as np

RHO, G, DEPTH, PERIOD = 1000.0, 9.81, 0.2, 0.9  # water and waves of the scene
HEIGHT, THICK, DENSITY = 0.28, 0.02, 500.0  # flap
MODES = 2000

omega = 2.0 * np.pi / PERIOD


def root(f, low, high):
    """Of a function that changes its sign, by bisection."""
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if f(middle) * f(low) > 0.0 else (low, middle)
    return low


k = root(lambda k: G * k * np.tanh(k * DEPTH) - omega**2, 1e-6, 1e3)
group = 0.5 * omega / k * (1.0 + 2.0 * k * DEPTH / np.sinh(2.0 * k * DEPTH))
# Integrals of z cosh(k z) and of its square over the depth, and the same of cos.
lever = DEPTH * np.sinh(k * DEPTH) / k - (np.cosh(k * DEPTH) - 1.0) / k**2
square = 0.5 * DEPTH + np.sinh(2.0 * k * DEPTH) / (4.0 * k)
radiation = 2.0 * RHO * omega / k * lever**2 / square
added = 0.0
for n in range(1, MODES):
    low, high = (n - 0.5) * np.pi / DEPTH + 1e-9, n * np.pi / DEPTH
    kn = root(lambda k: G * k * np.tan(k * DEPTH) + omega**2, low, high)
    lever_n = DEPTH * np.sin(kn * DEPTH) / kn + (np.cos(kn * DEPTH) - 1.0) / kn**2
    square_n = 0.5 * DEPTH + np.sin(2.0 * kn * DEPTH) / (4.0 * kn)
    added += 2.0 * RHO / kn * lever_n**2 / square_n
mass = DENSITY * THICK * HEIGHT
inertia = mass * (HEIGHT**2 / 3.0 + THICK**2 / 12.0)
hold = RHO * THICK * G * DEPTH**2 / 2.0 - mass * G * HEIGHT / 2.0 + RHO * G * THICK**3 / 12.0

begin = float(sys.argv[2]) if len(sys.argv) > 2 else 3.4
with open(sys.argv[1]) as file:
    rows = np.array([[float(row[0]), float(row[1])] for row in list(csv.reader(file))[1:]])
time, level = rows[(rows[:, 0] >= begin) & (rows[:, 0] < begin + PERIOD - 1e-9)].T
level = level - level.mean()
amplitude = abs(2.0 / len(time) * np.sum(level * np.exp(1j * omega * time)))
flux = 0.5 * RHO * G * amplitude**2 * group
force = np.sqrt(2.0 * RHO * G * group * radiation) * amplitude
print(f"B = {radiation:.2f} N m s/rad, A = {added:.4f}, J = {inertia:.4f} kg m, K = {hold:.3f} N m/rad")
print(f"waves of {1e3 * amplitude:.2f} mm carry {flux:.3f} W/m")
for damping, stiffness in [(2.0, 0.0), (5.5, 0.0), (15.0, 0.0), (5.5, 40.0)]:
    impedance = hold + stiffness - omega**2 * (inertia + added) + 1j * omega * (radiation + damping)
    angle = force / abs(impedance)
    print(f"{damping:4.1f} N m s/rad, {stiffness:2.0f} N m/rad: {0.5 * damping * (omega * angle)**2:.3f} W/m, "
          f"{1e3 * angle:.1f} mrad")
