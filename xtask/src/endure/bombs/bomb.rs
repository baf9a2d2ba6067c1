//! What a bomb is.

use std::path::Path;

/// A bomb: writes its files and returns the words of a command that opens them.
pub struct Bomb {
    /// Where it is and what it claims.
    pub name: &'static str,
    /// Writes its files.
    pub write: fn(&Path) -> Result<(), String>,
    /// The command.
    pub command: &'static str,
}

/// Shorthand for tables of bombs.
pub const fn bomb(name: &'static str, command: &'static str, write: fn(&Path) -> Result<(), String>) -> Bomb {
    Bomb { name, write, command }
}
