//! Columns of vectors: one `Vec` a component.

/// `D` columns.
pub type Vectors<const D: usize> = [Vec<f64>; D];

/// `D` columns of `n` zeros.
pub fn vectors<const D: usize>(n: usize) -> Vectors<D> {
    std::array::from_fn(|_| vec![0.0; n])
}

/// Lowest and highest corner of the box around points; zero where there are none.
pub fn bounds<const D: usize>(x: &Vectors<D>) -> ([f64; D], [f64; D]) {
    if x[0].is_empty() {
        return ([0.0; D], [0.0; D]);
    }
    (
        std::array::from_fn(|d| x[d].iter().copied().fold(f64::INFINITY, f64::min)),
        std::array::from_fn(|d| x[d].iter().copied().fold(f64::NEG_INFINITY, f64::max)),
    )
}
