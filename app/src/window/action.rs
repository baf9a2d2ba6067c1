//! What panels and views ask for. They read the document and emit; the shell carries out.

use super::layout::Pane;
use session::{Command, CommandId, SurfaceHit};
use std::path::PathBuf;

/// A wish of a panel or a view.
#[derive(Clone, Debug)]
pub enum Action {
    /// A command of the table.
    Run(CommandId),
    /// Straight to the session.
    Do(Box<Command>),
    /// Opens a file, after asking about unsaved changes.
    Open(PathBuf),
    /// Asks for the picture of an aperture mask, then uses it.
    ChooseMask,
    /// Shows what of the aperture a point sees.
    Inspect(SurfaceHit),
    /// Puts a panel elsewhere.
    Place(Pane, Placing),
    /// A sentence for the user: something cannot be done.
    Complain(String),
}

/// What is done with a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placing {
    /// Over all others, or back.
    Enlarge,
    /// Afloat, or back.
    Float,
    /// Folded away.
    Close,
}

impl From<Command> for Action {
    fn from(command: Command) -> Self {
        Self::Do(Box::new(command))
    }
}

impl From<CommandId> for Action {
    fn from(id: CommandId) -> Self {
        Self::Run(id)
    }
}
