//! What the left button does in the two views.

use focus::BrushMode;
use session::CommandId;

/// The chosen tool. Not part of the document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Tool {
    /// Strokes that set, add or subtract the chosen focus.
    #[default]
    Brush,
    /// Strokes that even out.
    Smooth,
    /// Strokes that make ramps into steps.
    Sharpen,
    /// Strokes that give the ordinary lens back, or take the layer's mask away.
    Reset,
    /// A click fills the object.
    FillObject,
    /// A click fills everything of the material.
    FillMaterial,
    /// A click fills the piece of the atlas.
    FillChart,
    /// A click focuses the lens there.
    FocusHere,
    /// A click takes the focus from there.
    Pick,
}

impl Tool {
    /// Those in the tool bar, left to right.
    pub const BAR: [Tool; 6] =
        [Tool::Brush, Tool::Smooth, Tool::Reset, Tool::FillObject, Tool::FocusHere, Tool::Pick];

    /// The command that chooses it.
    pub fn command(self) -> CommandId {
        match self {
            Tool::Brush => CommandId::Brush,
            Tool::Smooth => CommandId::Smooth,
            Tool::Sharpen => CommandId::Sharpen,
            Tool::Reset => CommandId::Erase,
            Tool::FillObject => CommandId::FillPart,
            Tool::FillMaterial => CommandId::FillMaterial,
            Tool::FillChart => CommandId::FillChart,
            Tool::FocusHere => CommandId::FocusHere,
            Tool::Pick => CommandId::Pick,
        }
    }

    /// Its word in the tool bar.
    pub fn label(self) -> &'static str {
        match self {
            Tool::Brush => "Brush",
            Tool::Smooth => "Smooth",
            Tool::Sharpen => "Sharpen",
            Tool::Reset => "Reset",
            Tool::FillObject => "Fill",
            Tool::FillMaterial => "Fill material",
            Tool::FillChart => "Fill chart",
            Tool::FocusHere => "Focus here",
            Tool::Pick => "Pick",
        }
    }

    /// Whether it paints strokes; else a click does it.
    pub fn paints(self) -> bool {
        matches!(self, Tool::Brush | Tool::Smooth | Tool::Sharpen | Tool::Reset)
    }

    /// The brush mode of its strokes; `chosen` is the Brush tool's own.
    pub fn mode(self, chosen: BrushMode) -> BrushMode {
        match self {
            Tool::Smooth => BrushMode::Smooth,
            Tool::Sharpen => BrushMode::Sharpen,
            Tool::Reset => BrushMode::Reset,
            _ => chosen,
        }
    }

    /// One line for the status line.
    pub fn tip(self) -> &'static str {
        match self {
            Tool::Brush => {
                "Drag in either view to paint the chosen focus. Shift+click draws a straight line, Esc takes a stroke back."
            }
            Tool::Smooth => "Drag in either view to even out the focus.",
            Tool::Sharpen => "Drag in either view to turn soft changes of focus into hard ones.",
            Tool::Reset => "Drag in either view to give the ordinary lens back.",
            Tool::FillObject => "Click an object in either view to give it the chosen focus.",
            Tool::FillMaterial => "Click a material in either view to give it the chosen focus.",
            Tool::FillChart => "Click a chart in either view to give it the chosen focus.",
            Tool::FocusHere => "Click in either view to focus the lens there.",
            Tool::Pick => "Click in either view to take the focus from there.",
        }
    }
}
