//! What two processes of halfstep both need: scenes, particles and neighbours, the pair pass, the wire, output.

pub mod failure;
pub mod geometry;
pub mod interface;
pub mod kernel;
pub mod lane;
pub mod neighbours;
pub mod output;
pub mod pair;
pub mod protocol;
pub mod role;
pub mod scene;
pub mod state_equation;
