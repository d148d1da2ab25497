//! Suites written once and instantiated for every implementation of a seam.

pub mod link;
pub mod solid;
