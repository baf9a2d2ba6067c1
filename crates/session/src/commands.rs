//! Commands and events, and the table of commands with their names and keys.
//!
//! [`Command`]s go into a session, [`Event`]s come out of it. The table lists everything that a user can invoke, for menus,
//! palette, keys and help.

mod command;
mod event;
mod key_map;
mod table;

pub use command::Command;
pub use event::Event;
pub use key_map::KeyMap;
pub use table::{COMMANDS, CommandId, CommandInfo, Menu, Shortcut};
