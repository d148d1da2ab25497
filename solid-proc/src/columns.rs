//! Columns of vectors and tensors.

/// D columns.
pub(crate) type Vectors<const D: usize> = [Vec<f64>; D];
/// Symmetric tensors; a <= b filled.
pub(crate) type Tensors<const D: usize> = [[Vec<f64>; D]; D];

/// `D` columns of `n` zeros.
pub(crate) fn vectors<const D: usize>(n: usize) -> Vectors<D> {
    std::array::from_fn(|_| vec![0.0; n])
}

/// Columns of `n` zeros for a symmetric tensor.
pub(crate) fn tensors<const D: usize>(n: usize) -> Tensors<D> {
    std::array::from_fn(|a| std::array::from_fn(|b| if a <= b { vec![0.0; n] } else { Vec::new() }))
}
