//! Measurements of the views of a light field: error of the estimated disparities, and the views as a sparse
//! light field.

use super::left_out_photographs::SparseLightField;
use document::{DisparityError, Input};
use light::Steps;
use serde::{Deserialize, Serialize};
use session::SessionError;

/// Measurements of the views of a light field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Views {
    /// Number of views.
    pub count: usize,
    /// Error of the estimated disparities, if ground truth was supplied.
    pub disparity: Option<Disparity>,
    /// The views as a sparse light field.
    pub sparse: Option<SparseLightField>,
}

/// Error of estimated disparities.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Disparity {
    /// Share of pixels with an error above 0.07 px per step, in [0, 1].
    pub bad_007: f64,
    /// Share of pixels with an error above 0.03 px per step, in [0, 1].
    pub bad_003: f64,
    /// Mean squared error, px² per step².
    pub mean_square: f64,
}

impl Views {
    /// Measures an opened light field; `None` for other inputs.
    ///
    /// # Errors
    /// The views cannot be read or the work is cancelled.
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
