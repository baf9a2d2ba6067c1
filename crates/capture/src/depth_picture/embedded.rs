//! The content of a JPEG besides its picture: a depth map, perhaps the picture before it was blurred, perhaps a focal
//! length.

use super::depth_range::DepthRange;
use crate::depth_map::{DepthMap, DepthMeaning, levels_of};
use scene::LoadOptions;

/// A depth map embedded in a picture's file.
pub(super) struct Embedded {
    pub map: DepthMap,
    /// Distances of black and of white, m, if they are specified.
    pub near_far: Option<[f64; 2]>,
    /// The bytes of the sharp picture, if the displayed one has been blurred.
    pub original: Option<Vec<u8>>,
    /// Focal length over the width of the picture.
    pub focal_share: Option<f64>,
    /// Sentences about irregularities, without the file.
    pub notes: Vec<String>,
}

impl Embedded {
    /// Decodes a picture of levels and interprets it with a range. Without a range levels are relative, black is
    /// near.
    ///
    /// # Errors
    /// Why it cannot be decoded, as text.
    pub fn decode(bytes: &[u8], range: Option<DepthRange>, options: &LoadOptions) -> Result<Self, String> {
        let stored = levels_of(bytes, options).map_err(|why| format!("its depth map {why}"))?;
        let (mut values, mut notes) = (stored.values, Vec::new());
        let meaning = match range {
            Some(range) => {
                values.iter_mut().for_each(|level| *level = range.distance(f64::from(*level)) as f32);
                DepthMeaning::Distance
            }
            None => {
                values.iter_mut().for_each(|level| *level = 1.0 - *level);
                notes.push(
                    "has no range for its depth map, which is treated as relative, with black near".into(),
                );
                DepthMeaning::Relative
            }
        };
        let map = DepthMap { width: stored.width, height: stored.height, values, meaning };
        let near_far = range.map(|range| [range.near, range.far]);
        Ok(Self { map, near_far, original: None, focal_share: None, notes })
    }
}
