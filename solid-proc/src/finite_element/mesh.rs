//! The mesh: each particle's cell is an element, with a node at each of its corners.
//!
//! What the fluid sees stays the lattice of particles: a particle is the middle of its element, where the mean of the
//! nodes' displacements is that of the shape functions, and a force on it goes to the nodes in equal parts. So forces,
//! moments of the undeformed state and power are kept exactly.

use halfstep_scene::geometry::{Cells, SolidPoint};
use halfstep_sph::columns::{Vectors, vectors};

/// Corners of a cell in three dimensions; in two, the first four.
const MOST: usize = 8;

/// How far, in spacings, what is one node may lie apart: rounding of positions only.
const SAME: f64 = 1e-3;

/// Elements and nodes.
#[derive(Clone, Debug)]
pub(super) struct Mesh<const D: usize> {
    corners: Vec<[u32; MOST]>,
    /// Where each node is in the reference configuration, m.
    pub(super) reference: Vec<[f64; D]>,
    /// Elements that share each node.
    sharing: Vec<u32>,
}

impl<const D: usize> Mesh<D> {
    /// Nodes of an element.
    pub(super) const CORNERS: usize = 1 << D;

    /// Of particles with this spacing, m; `body` has a number for each particle's body, and bodies share no nodes.
    pub(super) fn new(points: &[SolidPoint<D>], body: &[u32], spacing: f64) -> Self {
        let mut cells: Cells<(u32, u32, [f64; D]), D> = Cells::new(0.5 * spacing);
        let (mut corners, mut reference) = (Vec::with_capacity(points.len()), Vec::new());
        let mut sharing = Vec::new();
        for (point, &body) in points.iter().zip(body) {
            let mut own = [0; MOST];
            for (corner, node) in own[..Self::CORNERS].iter_mut().enumerate() {
                let at: [f64; D] =
                    std::array::from_fn(|d| point.position[d] + 0.5 * spacing * side(corner, d));
                let near = |other: &[f64; D]| (0..D).all(|d| (at[d] - other[d]).abs() < SAME * spacing);
                let known = cells.around(&at).find(|(_, of, other)| *of == body && near(other));
                *node = match known.map(|(node, ..)| *node) {
                    Some(node) => node,
                    None => {
                        cells.add(&at, (sharing.len() as u32, body, at));
                        sharing.push(0);
                        reference.push(at);
                        sharing.len() as u32 - 1
                    }
                };
                sharing[*node as usize] += 1;
            }
            corners.push(own);
        }
        Self { corners, reference, sharing }
    }

    /// Number of nodes.
    pub(super) fn nodes(&self) -> usize {
        self.sharing.len()
    }

    /// Number of elements.
    pub(super) fn elements(&self) -> usize {
        self.corners.len()
    }

    /// Nodes of an element, corner by corner.
    pub(super) fn of(&self, element: usize) -> &[u32] {
        &self.corners[element][..Self::CORNERS]
    }

    /// Part of a particle's mass that each node has from all its elements, over the mass of one.
    pub(super) fn share(&self, node: usize) -> f64 {
        f64::from(self.sharing[node]) / Self::CORNERS as f64
    }

    /// The mean over an element's nodes.
    pub(super) fn mean(&self, element: usize, of_nodes: &Vectors<D>) -> [f64; D] {
        let nodes = self.of(element);
        std::array::from_fn(|d| {
            nodes.iter().map(|&node| of_nodes[d][node as usize]).sum::<f64>() / Self::CORNERS as f64
        })
    }

    /// Values at nodes from those of particles: the mean over a node's elements, exact where all are equal.
    pub(super) fn spread(&self, of_particles: impl Fn(usize) -> [f64; D]) -> Vectors<D> {
        let (mut at_nodes, mut met) = (vectors(self.nodes()), vec![0.0; self.nodes()]);
        for element in 0..self.corners.len() {
            let value = of_particles(element);
            for &node in self.of(element) {
                let node = node as usize;
                met[node] += 1.0;
                for d in 0..D {
                    at_nodes[d][node] += (value[d] - at_nodes[d][node]) / met[node];
                }
            }
        }
        at_nodes
    }
}

/// On which side of an element's middle a corner lies along an axis: -1 or 1.
pub(super) fn side(corner: usize, axis: usize) -> f64 {
    if corner >> axis & 1 == 1 { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64) -> SolidPoint<2> {
        SolidPoint { position: [x, y], site: [x, y], velocity: [0.0; 2], clamped: false, body: 0, copy: 0 }
    }

    #[test]
    fn two_cells_share_a_side_and_two_bodies_nothing() {
        let points = [point(0.05, 0.05), point(0.15, 0.05)];
        let one = Mesh::new(&points, &[0, 0], 0.1);
        assert_eq!((one.nodes(), one.of(0), one.of(1)), (6, &[0, 1, 2, 3][..], &[1, 4, 3, 5][..]));
        assert_eq!([0, 1, 4].map(|node| one.share(node)), [0.25, 0.5, 0.25]);
        assert_eq!(Mesh::new(&points, &[0, 1], 0.1).nodes(), 8);
        let spread = one.spread(|element| [[1.0, 3.0][element], 7.0]);
        assert_eq!(spread[0], [1.0, 2.0, 1.0, 2.0, 3.0, 3.0]);
        assert_eq!(one.mean(0, &spread), [1.5, 7.0]);
    }
}
