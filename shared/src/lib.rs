//! What two processes of halfstep both need: scenes, particles and neighbours, the pair pass, the wire, output.

pub mod artificial_viscosity;
pub mod bounds;
pub mod columns;
pub mod extrapolation;
pub mod failure;
pub mod geometry;
pub mod interface;
pub mod kernel;
pub mod lane;
pub mod latency;
pub mod link;
pub mod lockstep;
pub mod neighbours;
pub mod output;
pub mod pair;
pub mod protocol;
pub mod role;
pub mod scene;
pub mod state_equation;
pub mod tensor;

/// A vector of the scene's dimension as the three components of the wire and of files.
pub fn wide<const D: usize>(v: [f64; D]) -> [f64; 3] {
    std::array::from_fn(|d| if d < D { v[d] } else { 0.0 })
}
