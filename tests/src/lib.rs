//! Suites that every implementation of a seam must pass, and what they need.

pub mod conformance;
