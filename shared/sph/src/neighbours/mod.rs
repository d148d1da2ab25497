//! Who interacts with whom: particles sorted into rows, and lists of neighbours for clusters of four.

mod list;
mod rows;

pub use list::{CHUNK_FOURS, ClusterList, Neighbours};
pub use rows::Rows;

/// The number of a slot that only pads a row.
pub const PADDING: u32 = u32::MAX;
