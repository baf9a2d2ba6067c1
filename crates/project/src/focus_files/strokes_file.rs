//! Recorded painting as JSON: edits as data, to be replayed.
//!
//! ```text
//! {"format": "focus-brush strokes", "version": 3, "steps": [
//!   {"stroke": {"layer": "Paint", "brush": {…},
//!    "view": {"camera_to_world": [16 numbers, by columns], "yfov": 0.7, "aspect": 1.78},
//!    "points": [[0.5, 0.25, 1.0], …]}},
//!   {"fill": {"layer": "Paint", "targets": [{"node": 3}], "focus": {"t": 1.0, "anchor": 1.0}}},
//!   {"gradient": {"layer": "Paint", "gradient": {…}}},
//!   {"select": {"shape": {"depth": {…}}, "combine": "add"}},
//!   {"spread": {"layer": "Paint", "settings": {"reach": 4096, "softness": 0, "contrast": 0.06}}},
//!   {"layers": {"opacity": [1, 0.5]}}, "reset"]}
//! ```
//!
//! A point is the pen's position in the view it painted in ((0, 0) the upper left corner, (1, 1) the lower right) and
//! its pressure, in [0, 1]. Times are not recorded: dabs follow the path, not the clock. A stroke in the flat atlas
//! has the atlas's hash for a view, `{"atlas": "…"}`. Version 1 held only `"strokes": [{"layer": …}, …]`, version 2
//! no strokes in the atlas, version 3 no symmetry along other than world axes, version 4 no gloss, version 5 nothing that
//! spreads; all are read.

use crate::ProjectError;
use crate::disk::{read_bytes, write_verified};
use focus::{
    Brush, CombineMode, FillTarget, FocusOffsetFields, Gradient, LayerEdit, Likeness, SpreadSettings,
    ViewFrame,
};
use glam::{DVec2, DVec3};
use lens::FocusOffset;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The file's name of its format.
const FORMAT: &str = "focus-brush strokes";

/// The newest version.
const VERSION: u64 = 6;

/// The version that is written if nothing spreads or is selected along the surface.
const WITHOUT_SPREAD: u64 = 5;

/// The version that is written if gloss keeps the lens's focus.
const WITHOUT_GLOSS: u64 = 4;

/// The version that is written if all symmetry is along the world's axes: older programs lose nothing of it.
const ALONG_WORLD_AXES: u64 = 3;

/// One recorded edit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RecordedStep {
    /// A stroke.
    Stroke(RecordedStroke),
    /// A region was filled with one focus.
    Fill(RecordedFill),
    /// A gradient was drawn.
    Gradient(RecordedGradient),
    /// The selection was changed.
    Select(RecordedSelection),
    /// The layers were changed.
    Layers(LayerEdit),
    /// The active layer was masked to the selection.
    Mask,
    /// The strokes of a layer were spread, or are shown again as they were painted.
    Spread(RecordedSpread),
    /// All paint was removed.
    Reset,
}

impl RecordedStep {
    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        let content_bytes = match self {
            Self::Stroke(stroke) => size_of_val(&*stroke.points) + stroke.layer.len(),
            Self::Fill(fill) => size_of_val(&*fill.targets) + fill.layer.len(),
            Self::Gradient(gradient) => gradient.layer.len(),
            Self::Spread(spread) => spread.layer.len(),
            Self::Select(RecordedSelection { shape: SelectionShape::Outline { points, .. }, .. }) => {
                size_of_val(&**points)
            }
            Self::Select(_) | Self::Layers(_) | Self::Mask | Self::Reset => 0,
        };
        size_of::<Self>() + content_bytes
    }

    /// Whether it uses symmetry axes other than the world's.
    fn has_custom_axes(&self) -> bool {
        match self {
            Self::Stroke(stroke) => stroke.brush.has_custom_axes(),
            Self::Gradient(drawn) => !drawn.gradient.symmetry.has_world_axes(),
            _ => false,
        }
    }

    /// Whether it changes gloss.
    fn paints_gloss(&self) -> bool {
        match self {
            Self::Stroke(stroke) => stroke.brush.paints_gloss(),
            Self::Fill(fill) => fill.focus.gloss != 0.0,
            Self::Gradient(drawn) => drawn.gradient.paints_gloss(),
            _ => false,
        }
    }

    /// Whether it needs the surface as a graph: strokes that spread, or a contiguous selection.
    fn follows_surface(&self) -> bool {
        match self {
            Self::Spread(_) => true,
            Self::Select(selection) => {
                matches!(selection.shape, SelectionShape::Similar { .. } | SelectionShape::Refined { .. })
            }
            _ => false,
        }
    }

    /// What is invalid about it, if anything.
    fn problem(&self) -> Option<String> {
        let bad = |what: &str| Some(what.to_string());
        match self {
            Self::Stroke(stroke) => match stroke.brush.problem() {
                Some(problem) => Some(format!("brush: {problem}")),
                None if matches!(&stroke.view, StrokeView::Scene(view) if !view.is_valid()) => {
                    bad("its view is invalid")
                }
                None if !stroke.points.as_flattened().iter().all(|number| number.is_finite()) => {
                    bad("it has points that are not finite")
                }
                None => None,
            },
            Self::Fill(fill) if !fill.focus.is_valid() => bad("its focus cannot be used"),
            Self::Gradient(drawn) if !drawn.gradient.is_valid() => bad("its gradient cannot be drawn"),
            Self::Spread(spread) if !spread.settings.is_none_or(|settings| settings.is_valid()) => {
                bad("its reach, softness or contrast is out of range")
            }
            Self::Select(selection) if !selection.shape.is_valid() => bad("its shape cannot be used"),
            _ => None,
        }
    }
}

/// A recorded stroke.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedStroke {
    /// The name of the layer that it was painted on.
    pub layer: String,
    /// The brush.
    pub brush: Brush,
    /// The view that it was painted in.
    pub view: StrokeView,
    /// x, y and pressure.
    pub points: Vec<[f64; 3]>,
}

/// The view that a stroke was painted in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum StrokeView {
    /// A view of the scene.
    Scene(ViewFrame),
    /// The atlas, laid flat.
    Atlas {
        /// Its hash: the stroke has no meaning on another one.
        atlas: String,
    },
}

impl From<ViewFrame> for StrokeView {
    fn from(view: ViewFrame) -> Self {
        Self::Scene(view)
    }
}

/// A recorded fill.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedFill {
    /// The name of the layer.
    pub layer: String,
    /// What was filled.
    pub targets: Vec<FillTarget>,
    /// The focus.
    #[serde(with = "FocusOffsetFields")]
    pub focus: FocusOffset,
}

/// A recorded gradient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedGradient {
    /// The name of the layer.
    pub layer: String,
    /// The gradient.
    pub gradient: Gradient,
}

/// A recorded spreading of a layer's strokes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedSpread {
    /// The name of the layer.
    pub layer: String,
    /// How they are spread; `None` shows the strokes again as they were painted.
    pub settings: Option<SpreadSettings>,
}

/// A recorded change of the selection.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedSelection {
    /// The set of texels.
    pub shape: SelectionShape,
    /// How it was combined with the selection.
    pub combine: CombineMode,
}

/// A set of texels, by what they belong to or where they lie.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SelectionShape {
    /// Everything: nothing is frozen.
    Everything,
    /// The texels that were not selected.
    Inverse,
    /// Nodes, materials, parts or charts.
    Targets(Vec<FillTarget>),
    /// Texels between two planes perpendicular to an axis.
    Depth {
        /// A point on the plane of depth 0, world.
        origin: DVec3,
        /// Unit axis, world.
        axis: DVec3,
        /// Nearest and farthest depth.
        range: [f64; 2],
    },
    /// Texels that face one way.
    Normal {
        /// Unit normal, world.
        normal: DVec3,
        /// The largest angle from it, degrees.
        degrees: f64,
    },
    /// Texels inside an outline drawn in a view.
    Outline {
        /// The view.
        view: ViewFrame,
        /// Corners, (0, 0) upper left, (1, 1) lower right; closed.
        points: Vec<DVec2>,
        /// Whether hidden surfaces behind are included.
        through: bool,
    },
    /// Texels that touch and are like a clicked one.
    Similar {
        /// The clicked point, world.
        position: DVec3,
        /// What makes them alike.
        likeness: Likeness,
        /// How unlike the clicked one they may be, in [0, 1].
        tolerance: f64,
    },
    /// The texels that were selected, with their outline moved to the nearest edges of the surface.
    Refined {
        /// How far the outline may move, in texels, in [1, 256].
        width: u32,
    },
}

impl SelectionShape {
    /// Whether its numbers are finite and in range, and an outline has at least three points.
    pub fn is_valid(&self) -> bool {
        match self {
            Self::Everything | Self::Inverse | Self::Targets(_) => true,
            Self::Depth { origin, axis, range: [near, far] } => {
                origin.is_finite() && axis.is_finite() && near <= far
            }
            Self::Similar { position, likeness, tolerance } => {
                let is_axis_valid = !matches!(likeness, Likeness::Depth(axis) if !axis.is_finite());
                position.is_finite() && is_axis_valid && (0.0..=1.0).contains(tolerance)
            }
            Self::Refined { width } => (1..=256).contains(width),
            Self::Normal { normal, degrees } => normal.is_finite() && (0.0..=180.0).contains(degrees),
            Self::Outline { view, points, .. } => {
                view.is_valid() && points.len() >= 3 && points.iter().all(|point| point.is_finite())
            }
        }
    }
}

/// The file.
#[derive(Serialize, Deserialize)]
struct StrokesFile {
    format: String,
    version: u64,
    #[serde(default)]
    steps: Vec<RecordedStep>,
    /// Only in version 1.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    strokes: Vec<RecordedStroke>,
}

/// Writes recorded steps of painting as JSON.
///
/// # Errors
/// The file cannot be written.
pub fn write_strokes(file: &Path, steps: &[RecordedStep]) -> Result<(), ProjectError> {
    let any = |of: fn(&RecordedStep) -> bool| steps.iter().any(of);
    let version = match () {
        _ if any(RecordedStep::follows_surface) => VERSION,
        _ if any(RecordedStep::paints_gloss) => WITHOUT_SPREAD,
        _ if any(RecordedStep::has_custom_axes) => WITHOUT_GLOSS,
        _ => ALONG_WORLD_AXES,
    };
    let content = StrokesFile { format: FORMAT.into(), version, steps: steps.to_vec(), strokes: Vec::new() };
    let bytes = serde_json::to_vec(&content).map_err(std::io::Error::other);
    let bytes = bytes.map_err(|source| ProjectError::Write { file: file.to_owned(), source })?;
    write_verified(file, &bytes, |back| match parse(file, back) {
        Ok(read) if read == steps => Ok(()),
        Ok(_) => Err("its content differs".to_string()),
        Err(error) => Err(error.to_string()),
    })
}

/// Reads recorded steps of painting, in order.
///
/// # Errors
/// The file cannot be read, has another form, or has an invalid step.
pub fn read_strokes(file: &Path) -> Result<Vec<RecordedStep>, ProjectError> {
    parse(file, &read_bytes(file)?)
}

fn parse(file: &Path, bytes: &[u8]) -> Result<Vec<RecordedStep>, ProjectError> {
    let error = |problem: String| ProjectError::content(file, problem, "record the strokes again");
    let content: StrokesFile =
        serde_json::from_slice(bytes).map_err(|e| error(format!("is not a valid strokes file: {e}")))?;
    if content.format != FORMAT {
        return Err(error(format!("is not a strokes file but \"{}\"", content.format)));
    }
    if content.version > VERSION {
        let (file, version, newest) = (file.to_owned(), content.version, VERSION);
        return Err(ProjectError::Newer { file, version, newest });
    }
    let old = content.strokes.into_iter().map(RecordedStep::Stroke);
    let steps: Vec<_> = old.chain(content.steps).collect();
    for (index, step) in steps.iter().enumerate() {
        if let Some(problem) = step.problem() {
            return Err(error(format!("step {}: {problem}", index + 1)));
        }
    }
    Ok(steps)
}
