//! The coupler: the front door of halfstep.

pub mod supervise;
