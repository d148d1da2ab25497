"""An elastic plate by finite elements, with scikit-fem: `gate.py [ELEMENTS ACROSS]`, for scenes/elastic-gate.toml, or
any other plate that is a box, alone or one of several solids.

Large rotations, St. Venant-Kirchhoff in plane strain: S = lambda tr(E) I + 2 mu E. Explicit, in sub-steps.
"""

import sys

import halfstep
import numpy as np
import scipy.sparse as sparse
import skfem
from scipy.interpolate import RBFInterpolator

scene, points = halfstep.description(), halfstep.particles()
across = int(sys.argv[1]) if len(sys.argv) > 1 else 2

# The mesh covers the box of the scene's plate; its nodes in the clamp stand still.
shape = scene["shapes"][points.shape[0]]
low, high = np.array(shape["geometry"]["box"]["min"][:2]), np.array(shape["geometry"]["box"]["max"][:2])
size = (high - low) / across
counts = np.maximum(np.round((high - low) / size.min()).astype(int), 1)
mesh = skfem.MeshQuad.init_tensor(*(np.linspace(a, b, n + 1) for a, b, n in zip(low, high, counts)))
basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()), intorder=4)
x, y = basis.doflocs
held = np.zeros(basis.N, bool)
for clamp in shape["clamp"]:
    (x0, y0, _), (x1, y1, _) = clamp["min"], clamp["max"]
    held |= (x > x0 - 1e-9) & (x < x1 + 1e-9) & (y > y0 - 1e-9) & (y < y1 + 1e-9)

# B: gradient of the displacement at the quadrature points, du_i / dX_k in the order (i, k, element, point).
elements, quadrature = basis.dx.shape
rows = np.arange(4 * basis.dx.size)
entries = [basis.basis[j][0].grad.ravel() for j in range(basis.Nbfun)]
columns = [np.broadcast_to(dofs[:, None], (4, elements, quadrature)).ravel() for dofs in basis.element_dofs]
B = sparse.csr_matrix(
    (np.concatenate(entries), (np.tile(rows, basis.Nbfun), np.concatenate(columns))), (len(rows), basis.N)
)
B.eliminate_zeros()
BT = B.T.tocsr()
weights = basis.dx.ravel()
material = halfstep.material()
young, poisson, density = material["youngs_modulus"], material["poissons_ratio"], material["density"]
lame, shear = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
inertia = skfem.BilinearForm(lambda u, v, w: density * (u[0] * v[0] + u[1] * v[1])).assemble(basis)
# Each node has the mass of its row: positive for quadrilaterals of nine nodes.
mass = np.asarray(inertia.sum(axis=1)).ravel()
vertical = np.zeros(basis.N)
vertical[np.concatenate([basis.nodal_dofs[1], basis.facet_dofs[1], basis.interior_dofs[1]])] = 1.0
weight = mass * scene["gravity"][1] * vertical


def internal(u):
    """Forces of the plate on its nodes."""
    F = (B @ u).reshape(2, 2, -1)
    F[0, 0] += 1.0
    F[1, 1] += 1.0
    e_xx = 0.5 * (F[0, 0] ** 2 + F[1, 0] ** 2 - 1.0)
    e_yy = 0.5 * (F[0, 1] ** 2 + F[1, 1] ** 2 - 1.0)
    e_xy = 0.5 * (F[0, 0] * F[0, 1] + F[1, 0] * F[1, 1])
    pressure = lame * (e_xx + e_yy)
    s_xx, s_yy, s_xy = pressure + 2 * shear * e_xx, pressure + 2 * shear * e_yy, 2 * shear * e_xy
    P = [[F[i, 0] * s_xx + F[i, 1] * s_xy, F[i, 0] * s_xy + F[i, 1] * s_yy] for i in (0, 1)]
    return -(BT @ (np.array(P).reshape(4, -1) * weights).ravel())


class Plate:
    def __init__(self, saved):
        start = RBFInterpolator(points.position, points.velocity)(basis.doflocs.T)
        start = np.where(held, 0.0, np.where(vertical > 0.0, start[:, 1], start[:, 0]))
        self.u, self.v = (saved[key] for key in "uv") if saved else (np.zeros(basis.N), start)
        self.steps = 1
        # Less than what the shortest wave on the mesh allows, 0.29 of an element.
        speed = np.sqrt((lame + 2 * shear) / density)
        self.limit = 0.25 * ((high - low) / counts).min() / speed

    def acceleration(self, load):
        return np.where(held, 0.0, (load + weight + internal(self.u)) / mass)

    def advance(self, load, dt):
        self.steps = int(np.ceil(dt / self.limit))
        h, a = dt / self.steps, self.acceleration(load)
        for _ in range(self.steps):
            v = self.v + 0.5 * h * a
            self.u = self.u + h * v
            a = self.acceleration(load)
            self.v = v + 0.5 * h * a


plate = Plate(halfstep.saved())
mapping = halfstep.mapping.Linear.by_component(points.position, basis.probes(points.position.T))
solid = halfstep.Solid(
    mapping.positions(plate.u), points.mass, points.density, velocity=mapping.velocities(plate.v),
    clamped=points.clamped, save=lambda: {"u": plate.u, "v": plate.v},
)
halfstep.integrate.advance_once(solid, mapping, plate, sub_steps=lambda plate: plate.steps)
