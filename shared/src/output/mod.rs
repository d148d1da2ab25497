//! Output.
pub mod frame;
pub use frame::{Frame, FramePoint};
