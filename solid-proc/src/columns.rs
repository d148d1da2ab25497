//! Columns of vectors and tensors.

pub(crate) use halfstep_sph::columns::{Vectors, vectors};

/// Symmetric tensors; a <= b filled.
pub(crate) type Tensors<const D: usize> = [[Vec<f64>; D]; D];

/// Columns of `n` zeros for a symmetric tensor.
pub(crate) fn tensors<const D: usize>(n: usize) -> Tensors<D> {
    std::array::from_fn(|a| std::array::from_fn(|b| if a <= b { vec![0.0; n] } else { Vec::new() }))
}
