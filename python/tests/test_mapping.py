"""Mappings keep constants, total force and power."""

import unittest

import numpy as np
from halfstep.mapping import Hinged, Linear, MidLine, Rigid

RANDOM = np.random.default_rng(7)


def rates(mapping, u, v, step=1e-6):
    """Velocities of the points as differences of their positions."""
    return (mapping.positions(u + step * v) - mapping.positions(u - step * v)) / (2 * step)


class Mappings(unittest.TestCase):
    def power_is_kept(self, mapping, u, v):
        points = mapping.positions(u)
        forces = RANDOM.normal(size=points.shape)
        power = (forces * mapping.velocities(v)).sum()
        self.assertAlmostEqual(power, (mapping.back(forces) * v).sum(), delta=1e-12 * np.abs(forces).sum())
        return forces

    def test_linear(self):
        rest = RANDOM.normal(size=(30, 2))
        # Shares of five nodes in each point, which add up to one.
        shares = RANDOM.random((30, 5))
        shares /= shares.sum(axis=1)[:, None]
        mapping = Linear(rest, np.kron(shares, np.eye(2)))
        constant = np.tile([0.3, -0.2], 5)
        self.assertLess(np.abs(mapping.positions(constant) - rest - [0.3, -0.2]).max(), 1e-14)
        forces = self.power_is_kept(mapping, RANDOM.normal(size=10), RANDOM.normal(size=10))
        total = mapping.back(forces).reshape(-1, 2).sum(axis=0)
        self.assertLess(np.abs(total - forces.sum(axis=0)).max(), 1e-12)
        by_component = np.vstack([mapping.matrix[0::2], mapping.matrix[1::2]])
        again = Linear.by_component(rest, by_component)
        self.assertTrue((again.matrix == mapping.matrix).all())
        with self.assertRaises(ValueError):
            Linear(rest, np.eye(3))

    def test_rigid(self):
        rest = RANDOM.normal(size=(20, 2))
        mapping = Rigid(rest, [0.1, 0.4])
        self.assertLess(np.abs(mapping.positions([0, 0, 0]) - rest).max(), 1e-15)
        q, v = np.array([0.2, -0.1, 0.7]), np.array([0.5, 0.3, -2.0])
        forces = self.power_is_kept(mapping, q, v)
        self.assertLess(np.abs(mapping.back(forces)[:2] - forces.sum(axis=0)).max(), 1e-12)
        self.assertLess(np.abs(mapping.velocities(v) - rates(Rigid(rest, [0.1, 0.4]), q, v)).max(), 1e-9)
        # A quarter turn about the centre.
        quarter = Rigid([[1.0, 0.0]], [0.0, 0.0]).positions([0.0, 0.0, np.pi / 2])
        self.assertLess(np.abs(quarter - [[0.0, 1.0]]).max(), 1e-15)

    def test_hinged(self):
        rest = RANDOM.normal(size=(20, 2))
        mapping = Hinged(rest, [0.5, 0.0])
        self.power_is_kept(mapping, np.array([0.4]), np.array([-1.5]))
        self.assertLess(np.abs(mapping.positions([0.0]) - rest).max(), 1e-15)
        # Its lever is the distance to the hinge.
        lever = Hinged([[1.5, 0.0]], [0.5, 0.0])
        lever.positions([0.0])
        self.assertEqual(lever.back(np.array([[7.0, 2.0]])), 2.0)

    def test_mid_line(self):
        nodes = np.column_stack([np.zeros(6), np.linspace(0.0, 1.0, 6)])
        rest = np.array([[x, y] for x in (-0.05, 0.02, 0.05) for y in np.linspace(-0.02, 1.02, 21)])
        mapping = MidLine(rest, nodes)
        self.assertLess(np.abs(mapping.positions(nodes) - rest).max(), 1e-14)
        moved = mapping.positions(nodes + [0.3, -0.2])
        self.assertLess(np.abs(moved - rest - [0.3, -0.2]).max(), 1e-14)
        bent, v = nodes + RANDOM.normal(size=nodes.shape) * 0.02, RANDOM.normal(size=nodes.shape)
        forces = self.power_is_kept(mapping, bent, v)
        self.assertLess(np.abs(mapping.back(forces).sum(axis=0) - forces.sum(axis=0)).max(), 1e-12)
        self.assertLess(np.abs(mapping.velocities(v) - rates(MidLine(rest, nodes), bent, v)).max(), 1e-7)


if __name__ == "__main__":
    unittest.main()
