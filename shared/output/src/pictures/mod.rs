//! The pictures of a run, that of a scene before its run, and the canvas that they are drawn on.

pub mod canvas;
pub mod contact;
#[cfg(test)]
mod fixture;
mod legend;
mod panels;
pub mod plot;
mod stamp;
pub mod start;
mod strokes;
#[cfg(test)]
mod tests;
pub mod timeline;
pub mod units;
mod view;

pub use contact::draw_contact;
pub use plot::draw_plot;
pub use start::draw_start;
pub use timeline::draw_timeline;
