//! What the user holds, and what a click with it does to what is there.

use super::brush_ring::BrushRing;
use super::drag_tool::DragView;
use super::tool_settings::ToolSettings;
use super::{Action, Tool};
use egui::{Pos2, Vec2};
use focus::{CombineMode, FillTarget};
use lens::FocusOffset;
use project::SelectionShape;
use session::{Command, FillRegion, Session, SurfaceHit, view_ray};

/// How far beside the pointer something thin is still hit, points: a nearer ring first.
const PROBE_RADII_POINTS: [f32; 2] = [2.0, 4.0];
/// What goes on for longer than this in the direction in which it was hit is not thin, points.
const THIN_WIDTH_POINTS: f32 = 12.0;
/// Places of a ring that are looked at.
const PROBES_PER_RING: usize = 8;
/// What is hit beside the pointer is nearer than what is beneath it: its share of that distance, at most.
const MAX_DISTANCE_SHARE: f64 = 0.95;

/// What the user holds.
#[derive(Clone, Debug)]
pub struct ActiveTool {
    /// The tool.
    pub tool: Tool,
    /// What it is set to.
    pub settings: ToolSettings,
    /// Whether pointer and keys set up the brush now, and do nothing else.
    pub is_adjusting_brush: bool,
    /// The ring that shows where it paints.
    pub ring: Option<BrushRing>,
    /// Length of the string by which the pointer pulls the brush, points.
    pub stabiliser_points: f32,
}

/// What a click of the tool takes whole; none for tools that do not.
fn fill_region(tool: Tool) -> Option<fn(SurfaceHit) -> FillRegion> {
    match tool {
        Tool::FillObject | Tool::SharpHere | Tool::SelectObject => Some(FillRegion::Node),
        Tool::FillMaterial | Tool::SelectMaterial => Some(FillRegion::Material),
        Tool::FillChart | Tool::SelectChart => Some(FillRegion::Chart),
        _ => None,
    }
}

impl ActiveTool {
    /// What a click at a place of a view acts on: what lies there; for a tool that takes things whole also what is thin, nearer
    /// and passes close by, as the bars of a fence do, which nobody hits exactly.
    pub fn pick(&self, session: &Session, view: &DragView<'_>, at: Pos2) -> Option<SurfaceHit> {
        let pick = |at: Pos2| session.pick(&view_ray(&view.frame, (view.position)(at)));
        let beneath = pick(at);
        let (Some(region), Some(document)) = (fill_region(self.tool), session.document()) else {
            return beneath;
        };
        let whole = |hit: SurfaceHit| document.fill_targets(region(hit));
        let hit_targets = beneath.map(whole);
        let farthest = beneath.map_or(f64::INFINITY, |hit| hit.distance * MAX_DISTANCE_SHARE);
        let directions = || {
            (0..PROBES_PER_RING)
                .map(|k| Vec2::angled(k as f32 / PROBES_PER_RING as f32 * std::f32::consts::TAU))
        };
        let thin_hit = PROBE_RADII_POINTS.into_iter().find_map(|reach| {
            let probe_hits = directions().filter_map(|toward| {
                let hit = pick(at + toward * reach).filter(|hit| hit.distance < farthest)?;
                let targets = Some(whole(hit));
                let continues = pick(at + toward * THIN_WIDTH_POINTS).map(whole) == targets;
                (targets != hit_targets && !continues).then_some(hit)
            });
            probe_hits.min_by(|a, b| a.distance.total_cmp(&b.distance))
        });
        thin_hit.or(beneath)
    }

    /// What a click at `hover` would take whole.
    pub fn targets(&self, session: &Session, hover: Option<SurfaceHit>) -> Vec<FillTarget> {
        let region =
            fill_region(self.tool).filter(|_| !self.is_adjusting_brush).zip(hover).map(|(of, hit)| of(hit));
        let targets = |region| session.document().map(|document| document.fill_targets(region));
        region.and_then(targets).unwrap_or_default()
    }
}

/// What a tool that is clicked does where it is.
pub fn click_action(
    tool: Tool,
    hit: SurfaceHit,
    target: FocusOffset,
    facing: SelectionShape,
    combine: CombineMode,
) -> Option<Action> {
    let command = match tool {
        Tool::Inspect => return Some(Action::Inspect(hit)),
        Tool::RackFocus => return Some(Action::RackPoint(hit)),
        Tool::SharpHere => {
            Command::Fill(fill_region(tool)?(hit), FocusOffset::SHARP.with_gloss(target.gloss))
        }
        Tool::FillObject | Tool::FillMaterial | Tool::FillChart => {
            Command::Fill(fill_region(tool)?(hit), target)
        }
        Tool::SelectObject | Tool::SelectMaterial | Tool::SelectChart => {
            Command::SelectRegion(fill_region(tool)?(hit), combine)
        }
        Tool::SelectFacing => Command::Select(facing, combine),
        Tool::FocusHere => Command::FocusHere(hit),
        Tool::FixateHere => Command::Fixate(Some(hit)),
        Tool::Pick => Command::Pick(hit),
        _ => return None,
    };
    Some(command.into())
}
