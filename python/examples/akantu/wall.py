"""A brittle wall by Akantu: `wall.py [ELEMENTS ACROSS]`, for scenes/breaking-wall.toml.

Triangles with six nodes, plane strain, explicit. Where the stress across an edge reaches the strength, a cohesive
element is inserted there: linear softening, the scene's fracture energy (Camacho and Ortiz 1996).
"""

import sys

import akantu as aka
import halfstep
import numpy as np
import scipy.sparse as sparse

scene, points = halfstep.description(), halfstep.particles()
across = int(sys.argv[1]) if len(sys.argv) > 1 else 8
shape, material = scene["shapes"][points.shape[0]], halfstep.material()
box, foot = shape["geometry"]["box"], shape["clamp"][0]["max"][1]
(x0, _), (x1, top), size = box["min"][:2], box["max"][:2], (box["max"][0] - box["min"][0]) / across

# From a row below the clamp's face on: squares as far up as the wall is thick, then rectangles 4 mm high, each cut in
# two. The nodes of an element are three corners and the middles of its sides.
square = foot + x1 - x0
upper = np.linspace(square, top, round((top - square) / max(size, 0.004)) + 1)
levels = np.concatenate([foot + size * np.arange(-1, across), upper])
y = np.sort(np.concatenate([levels, (levels[1:] + levels[:-1]) / 2]))
nodes = np.stack(np.meshgrid(np.linspace(x0, x1, 2 * across + 1), y), axis=2).reshape(-1, 2)
cell = np.arange(len(nodes)).reshape(len(y), -1)
elements = []
for j in range(0, len(y) - 1, 2):
    for i in range(0, 2 * across, 2):
        (a, ab, b), (ad, m, bc), (d, dc, c) = cell[j : j + 3, i : i + 3]
        falls = [a, b, d, ab, m, ad], [b, c, d, bc, dc, m]
        elements += falls if (i + j) // 2 % 2 else ([a, b, c, ab, bc, m], [a, c, d, m, dc, ad])
elements = np.array(elements)
below = nodes[elements, 1].max(axis=1) < foot + 1e-9

young, fracture = material["youngs_modulus"], material["fracture"]
with open(f"{halfstep.folder()}/akantu.dat", "w", encoding="utf-8") as file:
    file.write(f"""model solid_mechanics_model_cohesive [
  material elastic [
    name = bulk, rho = {material["density"]}, E = {young}, nu = {material["poissons_ratio"]}, finite_deformation = true
  ]
  material cohesive_linear [
    name = crack, sigma_c = {fracture["strength"]}, G_c = {fracture["energy"]}, beta = 1
    penalty = {young / size}, max_quad_stress_insertion = true
  ]
]
""".replace(", ", "\n"))
aka.parseInput(file.name)
access = aka.MeshAccessor(mesh := aka.Mesh(2))
access.resizeNodes(len(nodes))
mesh.getNodes()[:] = nodes
mesh.addConnectivityType(aka._triangle_6)
access.resizeConnectivity(len(elements), aka._triangle_6)
mesh.getConnectivity(aka._triangle_6)[:] = elements
access.makeReady()
model = aka.SolidMechanicsModelCohesive(mesh)
model.initFull(aka._explicit_lumped_mass, True)
model.updateAutomaticInsertion()
model.assembleMassLumped()

# Where each particle lies: its triangle, and the triangle's shape functions there. Those in the clamp do not move.
origin, sides = nodes[elements[:, 0]], nodes[elements[:, 1:3]] - nodes[elements[:, :1]]
share = np.einsum("pei,eij->pej", points.position[:, None] - origin, np.linalg.inv(sides))
share = np.concatenate([1 - share.sum(axis=2, keepdims=True), share], axis=2)
home = share.min(axis=2).argmax(axis=1)
l1, l2, l3 = share[np.arange(len(home)), home].T
shares = np.stack([l1 * (2 * l1 - 1), l2 * (2 * l2 - 1), l3 * (2 * l3 - 1), 4 * l1 * l2, 4 * l2 * l3, 4 * l3 * l1])
shares[:, points.position[:, 1] < foot] = 0.0


class Wall:
    """Unknowns are those of the particles: a crack makes new nodes, and N is another one then."""

    def __init__(self):
        self.limit, self.steps = 0.5 * model.getStableTimeStep(), 1
        self.connect()

    def connect(self):
        nodes, held = mesh.getConnectivity(aka._triangle_6), model.getBlockedDOFs()
        held[:] = np.isin(np.arange(len(held)), nodes[below])[:, None]
        row, column = np.repeat(np.arange(len(home)), 6), nodes[home].ravel()
        self.N = sparse.csr_matrix((shares.T.ravel(), (row, column)), (len(home), mesh.getNbNodes()))

    u = property(lambda self: (self.N @ model.getDisplacement()).ravel())
    v = property(lambda self: (self.N @ model.getVelocity()).ravel())

    def advance(self, load, dt):
        self.steps = int(np.ceil(dt / self.limit))
        model.setTimeStep(dt / self.steps)
        for _ in range(self.steps):
            model.getExternalForce()[:] = self.N.T @ load.reshape(-1, 2) + model.getMass() * scene["gravity"][:2]
            model.solveStep("explicit_lumped")
            if model.checkCohesiveStress():
                self.connect()


solid = halfstep.Solid(points.position, points.mass, points.density, clamped=points.clamped)
mapping = halfstep.mapping.Linear(points.position, sparse.identity(points.position.size))
halfstep.integrate.advance_once(solid, mapping, Wall(), sub_steps=lambda wall: wall.steps)
