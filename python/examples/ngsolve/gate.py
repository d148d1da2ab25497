"""An elastic plate by NGSolve, whose material is one line: `gate.py [LAW]`, for scenes/elastic-gate.toml, or any other
plate that is a box with a clamp at an end.

LAW is `st-venant-kirchhoff` (default) or `neo-hooke`. Plane strain, quadrilaterals of order 2, explicit in sub-steps.
"""

import sys

import halfstep
import ngsolve as ng
import numpy as np
import scipy.sparse as sparse
from ngsolve.meshes import MakeStructured2DMesh

scene, points = halfstep.description(), halfstep.particles()
shape, material = scene["shapes"][points.shape[0]], halfstep.material()
box, clamp = shape["geometry"]["box"], shape["clamp"][0]
# The mesh covers what the clamp leaves; the side at the clamp does not move.
low, high = np.array([box["min"][:2], box["max"][:2]])
for axis, (least, largest) in enumerate([("left", "right"), ("bottom", "top")]):
    if low[axis] < clamp["max"][axis] < high[axis]:
        low[axis], held = clamp["max"][axis], least
    elif low[axis] < clamp["min"][axis] < high[axis]:
        high[axis], held = clamp["min"][axis], largest
size = (high - low).min() / 2
counts = [int(n) for n in np.round((high - low) / size)]

mesh = MakeStructured2DMesh(
    quads=True, nx=counts[0], ny=counts[1], mapping=lambda s, t: tuple(low + (s, t) * (high - low))
)
space = ng.VectorH1(mesh, order=2, dirichlet=held)
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
gravity = ng.CF(tuple(map(ng.Parameter, scene["gravity"][:2])))
weight = ng.LinearForm(density * gravity * v * ng.dx).Assemble().vec.FV().NumPy()

# N: each shape function at the particles; those in the clamp do not move.
free = ((points.position > low) & (points.position < high)).all(axis=1)
places = mesh(*points.position[free].T)
unit, count = ng.GridFunction(space), points.position.size
N = np.zeros((count, space.ndof))
for k in range(space.ndof):
    unit.vec[:] = 0.0
    unit.vec[k] = 1.0
    N[np.repeat(free, 2), k] = unit(places).ravel()
mapping = halfstep.mapping.Linear(points.position, sparse.csr_matrix(N))


class Plate:
    def __init__(self):
        # As fast as the scene has its particles, by least squares.
        self.u, self.v, move = np.zeros(space.ndof), np.zeros(space.ndof), np.array(space.FreeDofs())
        self.v[move] = np.linalg.lstsq(N[:, move], points.velocity.ravel())[0]
        self.steps = 1
        self.shown, self.force, self.rate = ng.GridFunction(space), unit.vec.CreateVector(), unit.vec.CreateVector()
        # A consistent mass asks for less than a lumped one.
        self.limit = 0.12 * size / np.sqrt((lame + 2 * shear) / density)

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


plate, clamped = Plate(), points.clamped
velocity = mapping.velocities(plate.v)
solid = halfstep.Solid(points.position, points.mass, points.density, velocity=velocity, clamped=clamped)
halfstep.integrate.advance_once(solid, mapping, plate, sub_steps=lambda plate: plate.steps)
