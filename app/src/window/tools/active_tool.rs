//! The active tool with its settings, and what a click with it does.

use super::brush_ring::BrushRing;
use super::drag_tool::DragView;
use super::tool_settings::ToolSettings;
use crate::window::{Action, Tool};
use document::{FillRegion, SurfaceHit, view_ray};
use egui::{Pos2, Vec2};
use focus::{CombineMode, FillTarget};
use lens::FocusOffset;
use project::SelectionShape;
use session::{Command, Session};

/// Radii around the pointer within which thin objects are still hit, points; the smaller one first.
const PROBE_RADII_POINTS: [f32; 2] = [2.0, 4.0];
/// An object that extends farther than this in the probed direction is not thin, points.
const THIN_WIDTH_POINTS: f32 = 12.0;
/// Number of probes on each ring.
const PROBES_PER_RING: usize = 8;
/// A thin object must be nearer than the surface under the pointer by at least this factor.
const MAX_DISTANCE_SHARE: f64 = 0.95;

/// The active tool.
#[derive(Clone, Debug)]
pub struct ActiveTool {
    /// The tool.
    pub tool: Tool,
    /// The settings of the tools.
    pub settings: ToolSettings,
    /// Whether pointer and keys currently adjust the brush.
    pub is_adjusting_brush: bool,
    /// The brush ring, if the tool shows one.
    pub ring: Option<BrushRing>,
    /// Length of the stabiliser's string, by which the pointer pulls the brush, points.
    pub stabiliser_points: f32,
}

/// The region that a click with the tool affects as a whole; `None` for other tools.
fn fill_region(tool: Tool) -> Option<fn(SurfaceHit) -> FillRegion> {
    match tool {
        Tool::FillObject | Tool::SharpHere | Tool::SelectObject => Some(FillRegion::Node),
        Tool::FillMaterial | Tool::SelectMaterial => Some(FillRegion::Material),
        Tool::FillChart | Tool::SelectChart => Some(FillRegion::Chart),
        _ => None,
    }
}

impl ActiveTool {
    /// The surface point that a click acts on. For tools that affect whole regions this includes thin nearer
    /// objects close to the pointer, such as the bars of a fence, which are hard to hit exactly.
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

    /// The regions that a click at `hover` would affect.
    pub fn targets(&self, session: &Session, hover: Option<SurfaceHit>) -> Vec<FillTarget> {
        let region =
            fill_region(self.tool).filter(|_| !self.is_adjusting_brush).zip(hover).map(|(of, hit)| of(hit));
        let targets = |region| session.document().map(|document| document.fill_targets(region));
        region.and_then(targets).unwrap_or_default()
    }
}

/// The action of a click with the tool; `None` for tools that are not clicked.
pub fn click_action(
    tool: Tool,
    hit: SurfaceHit,
    target: FocusOffset,
    [facing, similar]: [SelectionShape; 2],
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
        Tool::SelectSimilar => Command::Select(similar, combine),
        Tool::FocusHere => Command::FocusHere(hit),
        Tool::FixateHere => Command::Fixate(Some(hit)),
        Tool::Pick => Command::Pick(hit),
        _ => return None,
    };
    Some(command.into())
}
