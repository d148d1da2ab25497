//! Printing that cannot fail: a run shall not end because nobody reads what it says.

use std::fmt::Arguments;
use std::io::Write;

/// A line to standard output, if it is open.
pub fn tell(line: Arguments<'_>) {
    let _ = writeln!(std::io::stdout().lock(), "{line}");
}

/// A line to standard error, if it is open.
pub fn warn(line: Arguments<'_>) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}
