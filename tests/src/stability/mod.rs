//! Hard cases that must stay numerically stable, as data: `tests/stability/*.toml`.
//!
//! Every case is run through the real program as it is, where all its criteria must hold, and once more with its remedy
//! taken away, where the criterion that it names must fail: a criterion that cannot fail says nothing. A case that
//! holds without the remedy, too, says so (`holds = true`), and that is asserted as well.

mod case;
mod courant;
mod criteria;
mod runner;
mod table;

pub use case::{Case, Family, families};
pub use courant::{Room, courant_table, room};
pub use criteria::{Criterion, Measured, evaluate};
pub use runner::{Row, check};
pub use table::{replace_between_markers, table};
