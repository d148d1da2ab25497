"""An elastic plate by NGSolve, whose material is one line: `gate.py [LAW]`, for scenes/elastic-gate.toml.

LAW is `st-venant-kirchhoff` (default) or `neo-hooke`. Plane strain, quadrilaterals of order 2, explicit in sub-steps.
"""

import sys

import halfstep
import ngsolve as ng
import numpy as np
import scipy.sparse as sparse
from ngsolve.meshes import MakeStructured2DMesh

scene, points = halfstep.description(), halfstep.particles()
shape, material = scene["shapes"][points.shape[0]], scene["solid"]
box, clamp = shape["geometry"]["box"], shape["clamp"][0]
(x0, y0), (x1, y1) = box["min"][:2], (box["max"][0], clamp["min"][1])  # the part below the clamp
across, along = 2, round(2 * (y1 - y0) / (x1 - x0))

mesh = MakeStructured2DMesh(
    quads=True, nx=across, ny=along, mapping=lambda s, t: (x0 + s * (x1 - x0), y0 + t * (y1 - y0))
)
space = ng.VectorH1(mesh, order=2, dirichlet="top")
u, v = space.TnT()
young, poisson, density = material["youngs_modulus"], material["poissons_ratio"], material["density"]
lame, shear = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
F = ng.Id(2) + ng.Grad(u)
E, J = 0.5 * (F.trans * F - ng.Id(2)), ng.Det(F)
laws = {
    "st-venant-kirchhoff": 0.5 * lame * ng.Trace(E) ** 2 + shear * ng.InnerProduct(E, E),
    "neo-hooke": shear * (ng.Trace(E) - ng.log(J)) + 0.5 * lame * ng.log(J) ** 2,
}
energy = ng.BilinearForm(space, symmetric=True)
energy += ng.Variation(laws[sys.argv[1] if len(sys.argv) > 1 else "st-venant-kirchhoff"].Compile() * ng.dx)
inertia = ng.BilinearForm(density * u * v * ng.dx).Assemble()
inverse = inertia.mat.Inverse(space.FreeDofs(), inverse="sparsecholesky")
weight = ng.LinearForm(density * ng.CF(tuple(scene["gravity"][:2])) * v * ng.dx).Assemble().vec.FV().NumPy()

# N: each shape function at the particles; those in the clamp do not move.
below = points.position[:, 1] < y1
places = mesh(*points.position[below].T)
unit, count = ng.GridFunction(space), points.position.size
N = np.zeros((count, space.ndof))
for k in range(space.ndof):
    unit.vec[:] = 0.0
    unit.vec[k] = 1.0
    N[np.repeat(below, 2), k] = unit(places).ravel()
mapping = halfstep.mapping.Linear(points.position, sparse.csr_matrix(N))


class Plate:
    def __init__(self):
        self.u = self.v = np.zeros(space.ndof)
        self.steps = 1
        self.shown, self.force, self.rate = ng.GridFunction(space), unit.vec.CreateVector(), unit.vec.CreateVector()
        # A consistent mass asks for less than a lumped one.
        self.limit = 0.12 * min((x1 - x0) / across, (y1 - y0) / along) / np.sqrt((lame + 2 * shear) / density)

    def acceleration(self, load):
        self.shown.vec.FV().NumPy()[:] = self.u
        energy.Apply(self.shown.vec, self.force)
        force = self.force.FV().NumPy()
        force[:] = load + weight - force
        self.rate.data = inverse * self.force
        return self.rate.FV().NumPy().copy()

    def advance(self, load, dt):
        self.steps = int(np.ceil(dt / self.limit))
        h, a = dt / self.steps, self.acceleration(load)
        for _ in range(self.steps):
            v = self.v + 0.5 * h * a
            self.u = self.u + h * v
            a = self.acceleration(load)
            self.v = v + 0.5 * h * a


solid = halfstep.Solid(points.position, points.mass, points.density, clamped=points.clamped)
halfstep.integrate.advance_once(solid, mapping, Plate(), sub_steps=lambda plate: plate.steps)
