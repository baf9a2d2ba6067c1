//! What can be asked for, and by which name and key.
//!
//! [`Command`] and [`Event`] are the session's two directions; the table names everything that a person can invoke, for menus,
//! palette, keys and help.

mod command;
mod event;
mod key_map;
mod table;

pub use command::Command;
pub use event::Event;
pub use key_map::KeyMap;
pub use table::{COMMANDS, CommandId, CommandInfo, Menu, Shortcut};
