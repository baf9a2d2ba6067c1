//! From stored numbers to a depth map: what the numbers mean.
//!
//! Programs do not agree on which end is near: MiDaS and similar ones write relative *inverse* depth (white is near), Marigold relative
//! depth (black is near), renderers distances. So it is specified by the caller or by a file name with *disparity* or *depth*, or it is an
//! error.

use super::map::{DepthMap, DepthMeaning};
use super::near_end::NearEnd;
use super::stored::{Numbers, Stored};
use crate::CaptureError;
use std::path::Path;

/// The quantity that a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthQuantity {
    /// Distances, or relative depth whose end is given by [`NearEnd`].
    Depth,
    /// Disparities: greater, or white, is nearer.
    Disparity,
}

/// What the caller specifies about a file.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DepthHint {
    /// The quantity that it holds.
    pub quantity: Option<DepthQuantity>,
    /// Which end is near.
    pub near: Option<NearEnd>,
}

/// The quantity that the name of a file denotes.
pub(crate) fn quantity_from_name(file: &Path) -> Option<DepthQuantity> {
    let name = file.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    match () {
        () if name.contains("disp") => Some(DepthQuantity::Disparity),
        () if name.contains("depth") || name.contains("dist") => Some(DepthQuantity::Depth),
        () => None,
    }
}

/// Distances from here on are background: Blender writes 10¹⁰ where there is nothing.
const BACKGROUND: f32 = 1e10;

impl Stored {
    /// Interprets the numbers of `file` as a map, by `hint` or else by the file's name.
    ///
    /// # Errors
    /// Which end of the numbers is near is not known, or the map shows no depth.
    pub fn into_depth_map(self, file: &Path, hint: DepthHint) -> Result<DepthMap, CaptureError> {
        let quantity = hint.quantity.or_else(|| quantity_from_name(file));
        let finite_or_nan = |value: f32| if value.is_finite() { value } else { f32::NAN };
        let Self { width, height, mut values, numbers } = self;
        let meaning = match (hint.near, numbers, quantity) {
            (Some(near), ..) => {
                let [low, high] = match numbers {
                    Numbers::Levels => [0.0, 1.0],
                    Numbers::Floats => finite_range(&values),
                };
                let share = |value: f32| (finite_or_nan(value) - low) / (high - low);
                match near {
                    NearEnd::White => values.iter_mut().for_each(|value| *value = share(*value)),
                    NearEnd::Black => values.iter_mut().for_each(|value| *value = 1.0 - share(*value)),
                    NearEnd::Distances { black, white } => values.iter_mut().for_each(|value| {
                        let share = f64::from(share(*value));
                        *value = ((1.0 - share) / black + share / white).recip() as f32;
                    }),
                }
                match near {
                    NearEnd::Distances { .. } => DepthMeaning::Distance,
                    _ => DepthMeaning::Relative,
                }
            }
            (None, Numbers::Levels, Some(DepthQuantity::Disparity)) => DepthMeaning::Relative,
            (None, Numbers::Levels, _) | (None, Numbers::Floats, None) => {
                return Err(CaptureError::NearUnknown { file: file.into() });
            }
            (None, Numbers::Floats, Some(DepthQuantity::Disparity)) => {
                values.iter_mut().for_each(|value| *value = finite_or_nan(*value));
                DepthMeaning::Disparity
            }
            (None, Numbers::Floats, Some(DepthQuantity::Depth)) => {
                values.iter_mut().for_each(|value| *value = distance(*value));
                DepthMeaning::Distance
            }
        };
        let map = DepthMap { width, height, values, meaning };
        if map.range().is_none() {
            return Err(CaptureError::malformed(
                file,
                "all pixels",
                "none has a value (all are 0, NaN or infinite)",
            ));
        }
        Ok(map)
    }
}

/// A stored distance: infinite where there is nothing, NaN where it is unknown.
fn distance(value: f32) -> f32 {
    match value {
        value if value >= BACKGROUND => f32::INFINITY,
        value if value > 0.0 => value,
        _ => f32::NAN,
    }
}

/// The range of the finite numbers, of some width.
fn finite_range(values: &[f32]) -> [f32; 2] {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let [low, high] = finite
        .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    if high > low && (high - low).is_finite() { [low, high] } else { [low, low + low.abs().max(1.0)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(numbers: Numbers, values: &[f32], name: &str, hint: DepthHint) -> Result<DepthMap, CaptureError> {
        let stored = Stored { width: values.len() as u32, height: 1, values: values.to_vec(), numbers };
        stored.into_depth_map(Path::new(name), hint)
    }

    const LEVELS: [f32; 3] = [0.0, 0.25, 1.0];

    #[test]
    fn nobody_guesses_which_end_is_near() {
        for (numbers, name) in
            [(Numbers::Levels, "a_depth.png"), (Numbers::Levels, "a.png"), (Numbers::Floats, "a.pfm")]
        {
            let error = read(numbers, &LEVELS, name, DepthHint::default()).unwrap_err().to_string();
            assert!(error.contains("does not specify which end is near (pass --near white"), "{error}");
        }
        let near = |near| DepthHint { near: Some(near), ..DepthHint::default() };
        assert_eq!(read(Numbers::Levels, &LEVELS, "a.png", near(NearEnd::White)).unwrap().values, LEVELS);
        assert_eq!(
            read(Numbers::Levels, &LEVELS, "a.png", near(NearEnd::Black)).unwrap().values,
            [1.0, 0.75, 0.0]
        );
        let distances = NearEnd::Distances { black: 0.5, white: f64::INFINITY };
        let map = read(Numbers::Levels, &LEVELS, "a.png", near(distances)).unwrap();
        assert_eq!(
            (map.meaning, &map.values[..]),
            (DepthMeaning::Distance, &[0.5, 2.0 / 3.0, f32::INFINITY][..])
        );
        // MiDaS's floats, which have no scale.
        let map = read(Numbers::Floats, &[100.0, 200.0, 500.0], "a.pfm", near(NearEnd::White)).unwrap();
        assert_eq!((map.meaning, &map.values[..]), (DepthMeaning::Relative, &LEVELS[..]));
    }

    #[test]
    fn names_and_callers_decide_what_floats_are() {
        let values = [f32::NAN, f32::INFINITY, 0.0, -1.0, 2.5, 1e10];
        let depth = read(Numbers::Floats, &values, "x_depth.pfm", DepthHint::default()).unwrap();
        let infinite = |map: &DepthMap| map.values.iter().filter(|value| value.is_infinite()).count();
        let unknown = |map: &DepthMap| map.values.iter().filter(|value| value.is_nan()).count();
        assert_eq!((depth.meaning, infinite(&depth), unknown(&depth)), (DepthMeaning::Distance, 2, 3));
        let disparity = read(Numbers::Floats, &values, "gt_disp_lowres.pfm", DepthHint::default()).unwrap();
        assert_eq!(
            (disparity.meaning, infinite(&disparity), unknown(&disparity)),
            (DepthMeaning::Disparity, 0, 2)
        );
        let hint = DepthHint { quantity: Some(DepthQuantity::Depth), near: None };
        assert_eq!(read(Numbers::Floats, &values, "disp.pfm", hint).unwrap().meaning, DepthMeaning::Distance);
        assert_eq!(
            read(Numbers::Levels, &LEVELS, "disp_rel.png", DepthHint::default()).unwrap().meaning,
            DepthMeaning::Relative
        );
        let nothing = read(Numbers::Floats, &[0.0, f32::NAN], "depth.pfm", DepthHint::default()).unwrap_err();
        assert!(nothing.to_string().contains("none has a value"), "{nothing}");
    }
}
