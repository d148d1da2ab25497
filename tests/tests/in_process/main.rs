//! Solids, fluids and whole runs within the test's own process. One program of them all: the time loop is generic, so
//! each program that steps it compiles it anew.

mod absent_effects;
mod allocation;
mod channel;
mod coincident;
mod divergence;
mod measured;
mod momentum;
mod moving_clamp;
mod moving_stop;
mod moving_walls;
mod polygons;
mod side_friction;
mod solid_models;
