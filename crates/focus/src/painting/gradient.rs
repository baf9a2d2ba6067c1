//! Gradients: a focus that changes evenly along a line, over everything that may be painted.

use crate::focus_map::to_numbers;
use crate::painting::brush::FocusOffsetFields;
use crate::painting::stroke_painter::paint_over;
use crate::{Canvas, ChangedTexels, Channels, FocusError, FocusMap, Selection, Symmetry, ViewFrame};
use glam::{DVec2, DVec3};
use lens::FocusOffset;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How a gradient spreads from its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GradientShape {
    /// Constant across the line.
    #[default]
    Linear,
    /// Constant at one distance from the line's start.
    Radial,
}

/// Where a gradient's line lies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GradientLine {
    /// Between two points of the world.
    World([DVec3; 2]),
    /// Between two positions of a view ((0, 0) upper left, (1, 1) lower right).
    View(ViewFrame, [DVec2; 2]),
}

/// A gradient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gradient {
    /// How it spreads.
    pub shape: GradientShape,
    /// The line's start and end.
    pub line: GradientLine,
    /// The focus at the line's start and before it.
    #[serde(with = "FocusOffsetFields")]
    pub from: FocusOffset,
    /// The focus at the line's end and beyond it; `None` fades into the existing values.
    #[serde(with = "optional")]
    pub to: Option<FocusOffset>,
    /// Repeated at the images of this symmetry.
    #[serde(default)]
    pub symmetry: Symmetry,
}

/// [t, anchor], [t, anchor, gloss] or null.
mod optional {
    use lens::FocusOffset;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes a focus as [t, anchor], or [t, anchor, gloss] where carried light obeys it; its absence as null.
    ///
    /// # Errors
    /// Errors of `to`.
    pub fn serialize<S: Serializer>(value: &Option<FocusOffset>, to: S) -> Result<S::Ok, S::Error> {
        let numbers = |FocusOffset { t, anchor, gloss }| match gloss {
            0.0 => vec![t, anchor],
            gloss => vec![t, anchor, gloss],
        };
        value.map(numbers).serialize(to)
    }

    /// Reads a focus of two or three numbers, or null.
    ///
    /// # Errors
    /// The form is another.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<FocusOffset>, D::Error> {
        let Some(numbers) = Option::<Vec<f64>>::deserialize(from)? else { return Ok(None) };
        match numbers[..] {
            [t, anchor] => Ok(Some(FocusOffset::new(t, anchor))),
            [t, anchor, gloss] => Ok(Some(FocusOffset { t, anchor, gloss })),
            _ => Err(D::Error::invalid_length(numbers.len(), &"t, anchor and perhaps gloss")),
        }
    }
}

impl Gradient {
    /// Whether it can be drawn: its ends are finite and apart, its focus and symmetry are valid.
    pub fn is_valid(&self) -> bool {
        let line = match self.line {
            GradientLine::World(ends) => ends.iter().all(|end| end.is_finite()) && ends[0] != ends[1],
            GradientLine::View(view, ends) => {
                view.is_valid() && ends.iter().all(|end| end.is_finite()) && ends[0] != ends[1]
            }
        };
        line && self.symmetry.is_valid() && self.from.is_valid() && self.to.is_none_or(|to| to.is_valid())
    }

    /// Whether it changes gloss, which older versions of the program do not support.
    pub fn paints_gloss(&self) -> bool {
        self.from.gloss != 0.0 || self.to.is_some_and(|to| to.gloss != 0.0)
    }

    /// How far along the gradient a world point lies, clamped to [0, 1]: 0 at its start, 1 at its end; of several
    /// images the one nearest to the start counts. Points behind the eye of the gradient's view count as its end.
    pub fn position_along(&self, point: DVec3) -> f64 {
        let images = self.symmetry.images();
        images.iter().map(|image| self.position_along_image(image.original(point))).fold(1.0, f64::min)
    }

    fn position_along_image(&self, point: DVec3) -> f64 {
        let (away, whole) = match self.line {
            GradientLine::World([a, b]) => (point - a, b - a),
            GradientLine::View(view, [a, b]) => {
                let Some(at) = view.position(point) else { return 1.0 };
                let square = DVec2::new(view.aspect, 1.0);
                (((at - a) * square).extend(0.0), ((b - a) * square).extend(0.0))
            }
        };
        let along = match self.shape {
            GradientShape::Linear => away.dot(whole) / whole.length_squared(),
            GradientShape::Radial => away.length() / whole.length(),
        };
        along.clamp(0.0, 1.0)
    }
}

/// Draws a gradient over everything selected (`None`: everything). Returns the changed texels.
///
/// # Errors
/// [`FocusError::BadValue`] if the gradient is invalid, [`FocusError::SizesDiffer`] if map and canvas differ in size.
pub fn draw_gradient(
    map: &mut FocusMap,
    canvas: &Canvas,
    gradient: &Gradient,
    channels: Channels,
    selection: Option<&Selection>,
) -> Result<ChangedTexels, FocusError> {
    if !gradient.is_valid() {
        return Err(FocusError::BadValue { entry: "gradient".to_string() });
    }
    if map.size() != canvas.size() {
        return Err(FocusError::SizesDiffer { map: map.size(), canvas: canvas.size() });
    }
    let positions: Vec<f64> =
        canvas.par_texels().map(|texel| gradient.position_along(texel.position)).collect();
    let from = to_numbers(gradient.from);
    let mut changed = Vec::new();
    for (index, position) in positions.into_iter().enumerate() {
        if !selection.is_none_or(|selection| selection.contains(index)) {
            continue;
        }
        let value = match gradient.to {
            None => paint_over(canvas.value(map, index), from, (1.0 - position) as f32),
            Some(to) => {
                let mix = |a: f64, b: f64| if position >= 1.0 { b } else { a + (b - a) * position };
                let from = gradient.from;
                let [t, anchor, gloss] = to_numbers(FocusOffset {
                    t: mix(from.t, to.t),
                    anchor: mix(from.anchor, to.anchor),
                    gloss: mix(from.gloss, to.gloss),
                });
                [t, anchor, gloss, 1.0]
            }
        };
        canvas.write_channels(map, index, value, channels.write_flags(), &mut changed);
    }
    Ok(ChangedTexels::new(changed))
}
