//! Lines on standard error.

use std::io::Write;

/// Writes a line to stderr. The work does not depend on whether it can be written.
pub fn write_line(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
