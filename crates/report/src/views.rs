//! What the views of a light field tell: how far found depth is from the one that came with them, and what they would be by themselves.

use crate::photographs::SparseLightField;
use serde::{Deserialize, Serialize};
use session::{DisparityError, Input, SessionError, Steps};

/// What was measured of a light field's views.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Views {
    /// How many there are.
    pub count: usize,
    /// How far disparities that they tell are from those that came with them, if some did.
    pub disparity: Option<Disparity>,
    /// As a sparse light field.
    pub sparse: Option<SparseLightField>,
}

/// How far found disparities are from given ones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Disparity {
    /// The share of pixels that are off by more than 0.07 px a step, in [0, 1].
    pub bad_007: f64,
    /// By more than 0.03.
    pub bad_003: f64,
    /// The mean squared error, px² a step².
    pub mean_square: f64,
}

impl Views {
    /// Of an opened light field; none of anything else.
    pub fn measure(input: &Input, name: &str, steps: &dyn Steps) -> Result<Option<Self>, SessionError> {
        let views = &input.scene.excluded_views;
        if input.scene.picture.is_none() || views.len() < 2 {
            return Ok(None);
        }
        let bar = steps.begin(&format!("{name}: disparities"));
        let error = input.disparity_error(&*bar)?;
        let disparity = error.map(|DisparityError { bad_007, bad_003, mean_square }| Disparity {
            bad_007,
            bad_003,
            mean_square,
        });
        Ok(Some(Self {
            count: views.len(),
            disparity,
            sparse: SparseLightField::from_views(&input.scene, views),
        }))
    }
}
