//! The equations of an implicit step: a symmetric sparse matrix over the free nodes, and its Cholesky factor.

use super::mesh::Mesh;
use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::factorization::CscCholesky;
use nalgebra_sparse::{CooMatrix, CscMatrix};
use std::cmp::Ordering;

/// The equations of the free nodes.
pub(super) struct Equations<const D: usize> {
    /// Of each node the first of its D equations; `None`: it is clamped.
    first: Vec<Option<usize>>,
    /// Number of equations.
    count: usize,
    /// Entries of the matrix that may differ from zero.
    matrix: CscMatrix<f64>,
    /// Where the entries of an element's matrix are added, element by element, row by row.
    places: Vec<Option<usize>>,
    /// Where the entries on the diagonal are.
    diagonal: Vec<usize>,
    factor: Option<CscCholesky<f64>>,
}

impl<const D: usize> Equations<D> {
    /// Of the nodes that are not clamped, numbered along the longest extent so that the matrix has a narrow band.
    pub(super) fn new(mesh: &Mesh<D>, clamped: &[bool]) -> Self {
        let mut first = vec![None; mesh.nodes()];
        let order = in_order(mesh, clamped);
        for (k, node) in order.iter().enumerate() {
            first[*node] = Some(k * D);
        }
        let count = order.len() * D;
        let of_element = |element: usize| -> Vec<Option<usize>> {
            let of_node = |&node: &u32| (0..D).map(move |d| (node as usize, d));
            mesh.of(element).iter().flat_map(of_node).map(|(node, d)| Some(first[node]? + d)).collect()
        };
        let mut pattern = CooMatrix::new(count, count);
        for k in 0..count {
            pattern.push(k, k, 0.0);
        }
        for element in 0..mesh.elements() {
            let all = of_element(element);
            for &i in all.iter().flatten() {
                all.iter().flatten().for_each(|&j| pattern.push(i, j, 0.0));
            }
        }
        let matrix = CscMatrix::from(&pattern);
        let place = |i: usize, j: usize| {
            let (offsets, rows) = (matrix.col_offsets(), matrix.row_indices());
            let found = rows[offsets[j]..offsets[j + 1]].binary_search(&i);
            offsets[j] + found.expect("the pattern has it")
        };
        let mut places = Vec::with_capacity(mesh.elements() * (D << D).pow(2));
        for element in 0..mesh.elements() {
            let all = of_element(element);
            for &i in &all {
                places.extend(all.iter().map(|&j| Some(place(i?, j?))));
            }
        }
        let diagonal = (0..count).map(|k| place(k, k)).collect();
        Self { first, count, matrix, places, diagonal, factor: None }
    }

    /// Number of equations.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Each free node with the first of its equations.
    pub(super) fn free(&self) -> impl Iterator<Item = (usize, usize)> {
        self.first.iter().enumerate().filter_map(|(node, first)| Some((node, (*first)?)))
    }

    /// Entries that are all zero.
    pub(super) fn zeros(&self) -> Vec<f64> {
        vec![0.0; self.matrix.nnz()]
    }

    /// Adds an element's matrix, row by row, to the entries.
    pub(super) fn add_element(&self, entries: &mut [f64], element: usize, of_element: &[f64]) {
        let size = of_element.len();
        for (place, value) in self.places[element * size..][..size].iter().zip(of_element) {
            if let Some(place) = place {
                entries[*place] += value;
            }
        }
    }

    /// Adds to the entries on the diagonal what each node has.
    pub(super) fn add_diagonal(&self, entries: &mut [f64], of_node: impl Fn(usize) -> f64) {
        for (node, first) in self.free() {
            self.diagonal[first..first + D].iter().for_each(|&place| entries[place] += of_node(node));
        }
    }

    /// Factorises the matrix of these entries; `None`: it is not definite.
    pub(super) fn factorise(&mut self, entries: &[f64]) -> Option<()> {
        self.matrix.values_mut().copy_from_slice(entries);
        match &mut self.factor {
            Some(factor) => factor.refactor(entries).ok()?,
            None => self.factor = Some(CscCholesky::factor(&self.matrix).ok()?),
        }
        Some(())
    }

    /// Solves for the corrections.
    pub(super) fn solve(&self, right: &DVector<f64>) -> Option<DMatrix<f64>> {
        Some(self.factor.as_ref()?.solve(right))
    }

    /// The matrix that was factorised last.
    #[cfg(test)]
    pub(super) fn dense(&self) -> DMatrix<f64> {
        DMatrix::from(&self.matrix)
    }
}

/// The free nodes, by their places: along the axis of the longest extent first.
fn in_order<const D: usize>(mesh: &Mesh<D>, clamped: &[bool]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..mesh.nodes()).filter(|&node| !clamped[node]).collect();
    let extent = |d: usize| {
        let along = order.iter().map(|&node| mesh.reference[node][d]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let mut axes: Vec<usize> = (0..D).collect();
    axes.sort_by(|&a, &b| extent(b).total_cmp(&extent(a)));
    order.sort_by(|&a, &b| {
        let by = |d: &usize| mesh.reference[a][*d].total_cmp(&mesh.reference[b][*d]);
        axes.iter().map(by).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    });
    order
}
