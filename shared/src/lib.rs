//! What two processes of halfstep both need: scenes, particles and neighbours, the pair pass, the wire, output.

pub mod failure;
pub mod link;
pub mod protocol;
pub mod scene;
