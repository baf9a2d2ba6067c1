//! What the user holds, and what a click with it does to what is there.

use super::brush_ring::BrushRing;
use super::tool_settings::ToolSettings;
use super::{Action, Tool};
use focus::{Combine, FillTarget};
use lens::FocusOffset;
use project::SelectionShape;
use session::{Command, FillRegion, Session, SurfaceHit};

/// What the user holds.
#[derive(Clone, Debug)]
pub struct Hand {
    /// The tool.
    pub tool: Tool,
    /// What it is set to.
    pub settings: ToolSettings,
    /// Whether pointer and keys set up the brush now, and do nothing else.
    pub is_busy: bool,
    /// The ring that shows where it paints.
    pub ring: Option<BrushRing>,
    /// Length of the string by which the pointer pulls the brush, points.
    pub string: f32,
}

/// What a click of the tool takes whole.
fn region(tool: Tool, hit: SurfaceHit) -> Option<FillRegion> {
    match tool {
        Tool::FillObject | Tool::SharpHere | Tool::SelectObject => Some(FillRegion::Node(hit)),
        Tool::FillMaterial | Tool::SelectMaterial => Some(FillRegion::Material(hit)),
        Tool::FillChart | Tool::SelectChart => Some(FillRegion::Chart(hit)),
        _ => None,
    }
}

impl Hand {
    /// What a click at `hover` would take whole.
    pub fn targets(&self, session: &Session, hover: Option<SurfaceHit>) -> Vec<FillTarget> {
        let region = hover.and_then(|hit| region(self.tool, hit)).filter(|_| !self.is_busy);
        let targets = |region| session.document().map(|document| document.targets_of(region));
        region.and_then(targets).unwrap_or_default()
    }
}

/// What a tool that is clicked does where it is.
pub fn click(
    tool: Tool,
    hit: SurfaceHit,
    target: FocusOffset,
    facing: SelectionShape,
    combine: Combine,
) -> Option<Action> {
    let command = match tool {
        Tool::Inspect => return Some(Action::Inspect(hit)),
        Tool::SharpHere => Command::Fill(region(tool, hit)?, FocusOffset::SHARP),
        Tool::FillObject | Tool::FillMaterial | Tool::FillChart => Command::Fill(region(tool, hit)?, target),
        Tool::SelectObject | Tool::SelectMaterial | Tool::SelectChart => {
            Command::SelectRegion(region(tool, hit)?, combine)
        }
        Tool::SelectFacing => Command::Select(facing, combine),
        Tool::FocusHere => Command::FocusHere(hit),
        Tool::Pick => Command::Pick(hit),
        _ => return None,
    };
    Some(command.into())
}
