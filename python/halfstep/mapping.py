"""Between a solver's own unknowns and the material points that the fluid sees.

The points are those of `halfstep.particles()`, a lattice. They move with the solver's unknowns, x = x0 + N u, and the
forces on them act on the unknowns as N^T f. So the power is the same on both sides, whatever N is, and so is the total
force, where N reproduces a constant. There is no interpolation between two meshes, and no error of one.
"""

import numpy as np


class Linear:
    """Points x = x0 + N u of displacements u.

    `rest`: x0, N x D. `matrix`: N, one row for each component of each point (point by point, x innermost), one column
    for each unknown; a NumPy array, or any sparse matrix with `@` and `.T`.
    """

    def __init__(self, rest, matrix):
        self.rest, self.matrix = np.asarray(rest, float), matrix
        if matrix.shape[0] != self.rest.size:
            raise ValueError(f"{matrix.shape[0]} rows for {self.rest.size} components of points")

    @classmethod
    def by_component(cls, rest, matrix):
        """From a matrix whose rows are all points' x, then all points' y, as scikit-fem's `Basis.probes` has them."""
        count, dimension = np.shape(rest)
        rows = np.arange(count * dimension).reshape(dimension, count).T.ravel()
        return cls(rest, matrix.tocsr()[rows] if hasattr(matrix, "tocsr") else matrix[rows])

    def positions(self, u):
        """N x D, m."""
        return self.rest + (self.matrix @ u).reshape(self.rest.shape)

    def velocities(self, v):
        """N x D, m/s."""
        return (self.matrix @ v).reshape(self.rest.shape)

    def back(self, forces):
        """Forces on the unknowns, from those on the points (N x D)."""
        return self.matrix.T @ np.asarray(forces, float).ravel()


class Rigid:
    """Points of a rigid body in the plane, whose unknowns are x, y of its centre and its angle: q = [x, y, angle].

    `rest`: the points where the body is as in the scene, N x 2. `centre`: that of the body there.
    """

    def __init__(self, rest, centre):
        self.centre = np.asarray(centre, float)
        self.arms = np.asarray(rest, float) - self.centre
        self.turned = self.arms

    def positions(self, q):
        """N x 2, m. `q`: displacement of the centre (m) and angle (rad, counter-clockwise)."""
        c, s = np.cos(q[2]), np.sin(q[2])
        self.turned = self.arms @ np.array([[c, s], [-s, c]])
        return self.centre + np.asarray(q[:2]) + self.turned

    def velocities(self, v):
        """N x 2, m/s, at the positions that were asked for last. `v`: of the centre (m/s) and of the angle (rad/s)."""
        return np.asarray(v[:2]) + v[2] * np.column_stack([-self.turned[:, 1], self.turned[:, 0]])

    def back(self, forces):
        """Force and moment about the centre, at the positions that were asked for last."""
        x, y = self.turned.T
        return np.array([*forces.sum(axis=0), (x * forces[:, 1] - y * forces[:, 0]).sum()])


class Hinged(Rigid):
    """Points of a rigid body in the plane that turns about a fixed point: its unknown is the angle, q = [angle].

    `rest`: the points where the body is as in the scene, N x 2. `hinge`: the fixed point.
    """

    def __init__(self, rest, hinge):
        super().__init__(rest, hinge)

    def positions(self, q):
        """N x 2, m. `q`: angle (rad, counter-clockwise)."""
        return super().positions([0.0, 0.0, q[0]])

    def velocities(self, v):
        """N x 2, m/s, at the positions that were asked for last. `v`: rad/s."""
        return super().velocities([0.0, 0.0, v[0]])

    def back(self, forces):
        """Moment about the hinge, at the positions that were asked for last."""
        return super().back(forces)[2:]


class MidLine:
    """Points of a slender body in the plane: each a fixed way off the mid-line, along its normal.

    The unknowns are the positions of the mid-line's nodes, M x 2; `nodes` are those at rest. A point belongs to the
    segment that is nearest at rest.
    """

    def __init__(self, rest, nodes):
        rest, self.nodes = np.asarray(rest, float), np.asarray(nodes, float)
        start, along = self.nodes[:-1], np.diff(self.nodes, axis=0)
        share = ((rest[:, None] - start) * along).sum(axis=2) / (along**2).sum(axis=1)
        share = np.clip(share, 0.0, 1.0)
        foot = start + share[:, :, None] * along
        self.segment = ((rest[:, None] - foot) ** 2).sum(axis=2).argmin(axis=1)
        points = np.arange(len(rest))
        self.share = ((rest - start[self.segment]) * along[self.segment]).sum(axis=1)
        self.share /= (along[self.segment] ** 2).sum(axis=1)
        tangent = along[self.segment] / np.linalg.norm(along[self.segment], axis=1)[:, None]
        arm = rest - start[self.segment] - self.share[:, None] * along[self.segment]
        self.offset = tangent[points, 0] * arm[:, 1] - tangent[points, 1] * arm[:, 0]
        self.current = self.nodes

    def positions(self, nodes):
        """N x 2, m."""
        self.current = np.asarray(nodes, float)
        along, length, normal = self._frame()
        return self.current[self.segment] + self.share[:, None] * along + self.offset[:, None] * normal

    def _frame(self):
        along = np.diff(self.current, axis=0)[self.segment]
        length = np.linalg.norm(along, axis=1)[:, None]
        return along, length, np.column_stack([-along[:, 1], along[:, 0]]) / length

    def velocities(self, velocities):
        """N x 2, m/s, at the positions that were asked for last: the exact rate of `positions`."""
        _, length, normal = self._frame()
        rate = np.diff(velocities, axis=0)[self.segment]
        spin = (rate * normal).sum(axis=1)[:, None] / length
        tangent = np.column_stack([normal[:, 1], -normal[:, 0]])
        return velocities[self.segment] + self.share[:, None] * rate - self.offset[:, None] * spin * tangent

    def back(self, forces):
        """Forces on the nodes, M x 2, at the positions that were asked for last: the transpose of `velocities`."""
        _, length, normal = self._frame()
        tangent = np.column_stack([normal[:, 1], -normal[:, 0]])
        couple = -(self.offset * (forces * tangent).sum(axis=1))[:, None] / length * normal
        on_rate = self.share[:, None] * forces + couple
        nodes = np.zeros_like(self.nodes)
        np.add.at(nodes, self.segment, forces - on_rate)
        np.add.at(nodes, self.segment + 1, on_rate)
        return nodes
