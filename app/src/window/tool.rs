//! What the left button does in the two views.

use focus::{Brush, BrushMode};
use lens::FocusOffset;
use session::{CommandId, DepthRepair};

/// The chosen tool. Not part of the document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Tool {
    /// Strokes that set, add or subtract the chosen focus.
    #[default]
    Brush,
    /// Clicks lay out a curve along which a stroke runs.
    Curve,
    /// Strokes that even out.
    Smooth,
    /// Strokes that make ramps into steps.
    Sharpen,
    /// Strokes that paint the focus of another place.
    Clone,
    /// Strokes that give the ordinary lens back, or take the layer's mask away.
    Reset,
    /// A click fills the object.
    FillObject,
    /// A click fills everything of the material.
    FillMaterial,
    /// A click fills the piece of the atlas.
    FillChart,
    /// A drag draws a gradient.
    Gradient,
    /// Clicks lay the focal plane of the layer through three places.
    FocalPlane,
    /// A click makes the object sharp.
    SharpHere,
    /// A drag copies depth from where it begins.
    DepthSpread,
    /// A drag pulls depth nearer.
    DepthNearer,
    /// A drag pushes depth farther.
    DepthFarther,
    /// A drag evens depth out.
    DepthSmooth,
    /// A line around what may be painted.
    SelectLasso,
    /// A box around what may be painted.
    SelectBox,
    /// A click lets the object be painted.
    SelectObject,
    /// A click lets the material be painted.
    SelectMaterial,
    /// A click lets the piece of the atlas be painted.
    SelectChart,
    /// A click lets be painted what faces alike.
    SelectFacing,
    /// A drag from the nearest to the farthest that may be painted.
    SelectDepth,
    /// A click focuses the lens there.
    FocusHere,
    /// A click lets two eyes look there.
    FixateHere,
    /// Two clicks have the lens go from one to the other.
    RackFocus,
    /// A click takes the focus from there.
    Pick,
    /// A click looks at the aperture from there.
    Inspect,
}

impl Tool {
    /// Those in the tool bar, left to right: families, of which the chosen one is shown, the first otherwise.
    pub const BAR: [&[Tool]; 10] = [
        &[Tool::Brush, Tool::Curve],
        &[Tool::Smooth, Tool::Sharpen],
        &[Tool::Clone],
        &[Tool::Reset],
        &[Tool::FillObject, Tool::FillMaterial, Tool::FillChart, Tool::SharpHere],
        &[Tool::Gradient, Tool::FocalPlane],
        &[Tool::DepthSpread, Tool::DepthNearer, Tool::DepthFarther, Tool::DepthSmooth],
        &[
            Tool::SelectLasso,
            Tool::SelectBox,
            Tool::SelectObject,
            Tool::SelectMaterial,
            Tool::SelectChart,
            Tool::SelectFacing,
            Tool::SelectDepth,
        ],
        &[Tool::FocusHere, Tool::RackFocus, Tool::FixateHere],
        &[Tool::Pick, Tool::Inspect],
    ];

    /// The command that chooses it.
    pub fn command(self) -> CommandId {
        match self {
            Tool::Brush => CommandId::Brush,
            Tool::Curve => CommandId::CurveBrush,
            Tool::Smooth => CommandId::Smooth,
            Tool::Sharpen => CommandId::Sharpen,
            Tool::Clone => CommandId::Clone,
            Tool::Reset => CommandId::Erase,
            Tool::FillObject => CommandId::FillPart,
            Tool::FillMaterial => CommandId::FillMaterial,
            Tool::FillChart => CommandId::FillChart,
            Tool::Gradient => CommandId::Gradient,
            Tool::FocalPlane => CommandId::PlaceFocalPlane,
            Tool::DepthSpread => CommandId::DepthSpread,
            Tool::DepthNearer => CommandId::DepthNearer,
            Tool::DepthFarther => CommandId::DepthFarther,
            Tool::DepthSmooth => CommandId::DepthSmooth,
            Tool::SharpHere => CommandId::SharpHere,
            Tool::SelectLasso => CommandId::SelectLasso,
            Tool::SelectBox => CommandId::SelectBox,
            Tool::SelectObject => CommandId::SelectObject,
            Tool::SelectMaterial => CommandId::SelectMaterial,
            Tool::SelectChart => CommandId::SelectChart,
            Tool::SelectFacing => CommandId::SelectFacing,
            Tool::SelectDepth => CommandId::SelectDepth,
            Tool::FocusHere => CommandId::FocusHere,
            Tool::FixateHere => CommandId::FixateHere,
            Tool::RackFocus => CommandId::RackFocus,
            Tool::Pick => CommandId::Pick,
            Tool::Inspect => CommandId::Inspect,
        }
    }

    /// The tool that a command chooses.
    pub fn for_command(id: CommandId) -> Option<Self> {
        Self::BAR.into_iter().flatten().copied().find(|tool| tool.command() == id)
    }

    /// Its word in the tool bar: the name of its command, but where that is long, or the menu above it says the rest.
    pub fn label(self) -> &'static str {
        match self {
            Tool::Reset => "Reset",
            Tool::FillObject => "Fill",
            Tool::FocalPlane => "Focal plane",
            Tool::DepthNearer => "Nearer",
            Tool::DepthFarther => "Farther",
            Tool::Inspect => "Inspect",
            Tool::FixateHere => "Fixate",
            Tool::SelectObject => "Select object",
            Tool::SelectMaterial => "Select material",
            Tool::SelectChart => "Select chart",
            Tool::SelectFacing => "Select facing",
            Tool::SelectDepth => "Select depth",
            _ => self.command().info().name,
        }
    }

    /// One line for the status line.
    pub fn tip(self) -> &'static str {
        self.command().info().tooltip
    }

    /// Whether it is dragged from one place to another.
    pub fn drags(self) -> bool {
        matches!(self, Tool::Gradient | Tool::SelectLasso | Tool::SelectBox | Tool::SelectDepth)
            || self.depth_repair().is_some()
    }

    /// What it does to depth, if that is what it repairs.
    pub fn depth_repair(self) -> Option<DepthRepair> {
        match self {
            Tool::DepthSpread => Some(DepthRepair::Spread),
            Tool::DepthNearer => Some(DepthRepair::Nearer),
            Tool::DepthFarther => Some(DepthRepair::Farther),
            Tool::DepthSmooth => Some(DepthRepair::Smooth),
            _ => None,
        }
    }

    /// Whether it chooses what may be painted.
    pub fn selects(self) -> bool {
        use Tool::*;
        matches!(
            self,
            SelectLasso
                | SelectBox
                | SelectObject
                | SelectMaterial
                | SelectChart
                | SelectFacing
                | SelectDepth
        )
    }

    /// Whether it paints strokes.
    pub fn paints(self) -> bool {
        matches!(self, Tool::Brush | Tool::Smooth | Tool::Sharpen | Tool::Clone | Tool::Reset)
    }

    /// The focus that it gives to what it is used on, where that is one.
    pub fn paints_focus(self, brush: &Brush) -> Option<FocusOffset> {
        match self {
            Tool::Brush | Tool::Curve => (brush.mode == BrushMode::Set).then_some(brush.target),
            Tool::FillObject | Tool::FillMaterial | Tool::FillChart => Some(brush.target),
            Tool::SharpHere => Some(FocusOffset::SHARP.with_gloss(brush.target.gloss)),
            Tool::Reset => Some(FocusOffset::STANDARD),
            _ => None,
        }
    }

    /// The brush mode of its strokes; `chosen` is the Brush tool's own.
    pub fn mode(self, chosen: BrushMode) -> BrushMode {
        match self {
            Tool::Smooth => BrushMode::Smooth,
            Tool::Sharpen => BrushMode::Sharpen,
            Tool::Clone => BrushMode::Clone,
            Tool::Reset => BrushMode::Reset,
            _ => chosen,
        }
    }
}
