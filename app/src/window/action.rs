//! Requests of panels and views. They read the document and emit actions; the shell performs them.

use super::layout::Pane;
use document::SurfaceHit;
use project::Preset;
use session::{Command, CommandId};
use std::path::PathBuf;

/// A request of a panel or a view.
#[derive(Clone, Debug)]
pub enum Action {
    /// Runs a command of the command table.
    Run(CommandId),
    /// Sends a command to the session.
    Apply(Box<Command>),
    /// Opens a file, after the dialog about unsaved changes.
    Open(PathBuf),
    /// Chooses an image as aperture mask.
    ChooseMask,
    /// Chooses an image as environment.
    ChooseEnvironment,
    /// Shows which part of the aperture is visible from a point.
    Inspect(SurfaceHit),
    /// Adds the next point of a rack focus.
    RackPoint(SurfaceHit),
    /// Rearranges a panel.
    Place(Pane, PanelCommand),
    /// Acts on a preset.
    Preset(PresetAction),
    /// Shows an error message: something cannot be done.
    ShowError(String),
}

/// An action on a preset.
#[derive(Clone, Debug)]
pub enum PresetAction {
    /// Applies it to the brush or the camera.
    Use(Box<Preset>),
    /// Renames the user's preset in this file; the string is its current name.
    Rename(PathBuf, String),
    /// Deletes the user's preset in this file.
    Delete(PathBuf),
    /// Writes it to a file that the user chooses.
    Export(Box<Preset>),
}

impl From<PresetAction> for Action {
    fn from(preset_action: PresetAction) -> Self {
        Self::Preset(preset_action)
    }
}

/// An action on a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelCommand {
    /// Shows it over all others, or restores the layout.
    Enlarge,
    /// Makes it float, or docks it again.
    Float,
    /// Hides it.
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
