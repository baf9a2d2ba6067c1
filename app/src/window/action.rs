//! What panels and views ask for. They read the document and emit; the shell carries out.

use super::layout::Pane;
use project::Preset;
use session::{Command, CommandId, SurfaceHit};
use std::path::PathBuf;

/// A wish of a panel or a view.
#[derive(Clone, Debug)]
pub enum Action {
    /// A command of the table.
    Run(CommandId),
    /// Straight to the session.
    Apply(Box<Command>),
    /// Opens a file, after asking about unsaved changes.
    Open(PathBuf),
    /// Asks for the picture of an aperture mask, then uses it.
    ChooseMask,
    /// Asks for an environment's picture, then uses it.
    ChooseEnvironment,
    /// Shows what of the aperture a point sees.
    Inspect(SurfaceHit),
    /// The next point of a rack focus.
    RackPoint(SurfaceHit),
    /// Puts a panel elsewhere.
    Place(Pane, PanelCommand),
    /// Something with a preset.
    Preset(PresetAction),
    /// A sentence for the user: something cannot be done.
    ShowError(String),
}

/// What is done with a preset.
#[derive(Clone, Debug)]
pub enum PresetAction {
    /// Brush or camera become as it says.
    Use(Box<Preset>),
    /// The user's own preset of a file, with its name, gets another name.
    Rename(PathBuf, String),
    /// The user's own preset of a file goes.
    Delete(PathBuf),
    /// It is written to a file that is asked for.
    Export(Box<Preset>),
}

impl From<PresetAction> for Action {
    fn from(preset_action: PresetAction) -> Self {
        Self::Preset(preset_action)
    }
}

/// What is done with a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelCommand {
    /// Over all others, or back.
    Enlarge,
    /// Afloat, or back.
    Float,
    /// Folded away.
    Close,
}

impl From<Command> for Action {
    fn from(command: Command) -> Self {
        Self::Apply(Box::new(command))
    }
}

impl From<CommandId> for Action {
    fn from(id: CommandId) -> Self {
        Self::Run(id)
    }
}
