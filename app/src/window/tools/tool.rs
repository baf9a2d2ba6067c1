//! The tools: what the left button does in the views.

use document::DepthRepair;
use focus::{Brush, BrushMode};
use lens::FocusOffset;
use session::CommandId;

/// A tool. Not part of the document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Tool {
    /// Strokes that set, add or subtract the chosen focus.
    #[default]
    Brush,
    /// Clicks define a curve along which a stroke is painted.
    Curve,
    /// Strokes that smooth the focus.
    Smooth,
    /// Strokes that sharpen transitions of the focus.
    Sharpen,
    /// Strokes that copy the focus from another point.
    Clone,
    /// Strokes that restore the ordinary lens, or erase the layer's mask.
    Reset,
    /// A click fills the object.
    FillObject,
    /// A click fills everything of the material.
    FillMaterial,
    /// A click fills the chart of the atlas.
    FillChart,
    /// A drag draws a gradient.
    Gradient,
    /// Clicks place the layer's focal plane through three points.
    FocalPlane,
    /// A click makes the object sharp.
    SharpHere,
    /// A drag copies depth from its start.
    DepthSpread,
    /// A drag pulls depth nearer.
    DepthNearer,
    /// A drag pushes depth farther.
    DepthFarther,
    /// A drag smooths depth.
    DepthSmooth,
    /// Selects by lasso.
    SelectLasso,
    /// Selects by box.
    SelectBox,
    /// A click selects the object.
    SelectObject,
    /// A click selects the material.
    SelectMaterial,
    /// A click selects the chart.
    SelectChart,
    /// A click selects surfaces with a similar normal.
    SelectFacing,
    /// A drag selects a depth range.
    SelectDepth,
    /// A click selects what touches it and is alike.
    SelectSimilar,
    /// A click focuses the lens on a point.
    FocusHere,
    /// A click sets the point that both eyes fixate.
    FixateHere,
    /// Two clicks animate the focus from one point to the other.
    RackFocus,
    /// A click picks up the focus of a point.
    Pick,
    /// A click inspects the aperture from a point.
    Inspect,
}

impl Tool {
    /// The families of tools in the tool column, top to bottom; the active tool of a family is shown, otherwise
    /// its first.
    pub const FAMILIES: [&[Tool]; 10] = [
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
            Tool::SelectSimilar,
        ],
        &[Tool::FocusHere, Tool::RackFocus, Tool::FixateHere],
        &[Tool::Pick, Tool::Inspect],
    ];

    /// The command that activates it.
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
            Tool::SelectSimilar => CommandId::SelectSimilar,
            Tool::FocusHere => CommandId::FocusHere,
            Tool::FixateHere => CommandId::FixateHere,
            Tool::RackFocus => CommandId::RackFocus,
            Tool::Pick => CommandId::Pick,
            Tool::Inspect => CommandId::Inspect,
        }
    }

    /// The tool that a command activates, if any.
    pub fn for_command(id: CommandId) -> Option<Self> {
        Self::FAMILIES.into_iter().flatten().copied().find(|tool| tool.command() == id)
    }

    /// Its name in the window: the name of its command, or a shorter one.
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
            Tool::SelectSimilar => "Select similar",
            _ => self.command().info().name,
        }
    }

    /// One line for the status line.
    pub fn tip(self) -> &'static str {
        self.command().info().tooltip
    }

    /// Whether it is used by dragging.
    pub fn drags(self) -> bool {
        matches!(self, Tool::Gradient | Tool::SelectLasso | Tool::SelectBox | Tool::SelectDepth)
            || self.depth_repair().is_some()
    }

    /// The depth repair it performs, if any.
    pub fn depth_repair(self) -> Option<DepthRepair> {
        match self {
            Tool::DepthSpread => Some(DepthRepair::Spread),
            Tool::DepthNearer => Some(DepthRepair::Nearer),
            Tool::DepthFarther => Some(DepthRepair::Farther),
            Tool::DepthSmooth => Some(DepthRepair::Smooth),
            _ => None,
        }
    }

    /// Whether it changes the selection.
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
                | SelectSimilar
        )
    }

    /// Whether it paints strokes.
    pub fn paints(self) -> bool {
        matches!(self, Tool::Brush | Tool::Smooth | Tool::Sharpen | Tool::Clone | Tool::Reset)
    }

    /// The focus that it paints, if that is a single value.
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
