//! The wire of a co-simulation: records and headers, what they mean, and the particles of an instant for output.
//!
//! ```
//! use halfstep_wire::half_step::HalfStep;
//!
//! // A step has two stages: from n to n + 1/2, and from n to n + 1.
//! let [first, second] = HalfStep::begin(7, 0.5).lasting(0.1).both();
//! assert_eq!((first.span(), second.span()), (0.05, 0.1));
//! assert_eq!((first.before(), second.before(), second.after()), (0.5, 0.55, 0.6));
//! ```

pub mod checkpoint;
pub mod failure;
pub mod frame;
pub mod half_step;
mod name;
pub mod order;
pub mod protocol;
pub mod state;

pub use name::{BadName, Name};

/// A vector of the scene's dimension as the three components of the wire and of files.
pub fn wide<const D: usize>(v: [f64; D]) -> [f64; 3] {
    std::array::from_fn(|d| if d < D { v[d] } else { 0.0 })
}

/// Of three components those of the scene's dimension.
pub fn narrow<const D: usize>(v: [f64; 3]) -> [f64; D] {
    std::array::from_fn(|d| v[d])
}

/// Place of component (a, b), a <= b, in a record's stress: xx, yy, zz, xy, yz, xz.
pub fn wire_component(a: usize, b: usize) -> usize {
    match (a, b) {
        (0, 1) => 3,
        (1, 2) => 4,
        (0, 2) => 5,
        _ => a,
    }
}
