//! The error of disparities estimated from a light field, against those that came with it.

use crate::error::DocumentError;
use crate::input::disparity_estimate::estimate_disparity;
use capture::LightField;
use light::DiskCache;
use progress::Progress;
use scene::LoadOptions;

/// The error of estimated disparities, over all pixels with a reference disparity (Honauer et al., ACCV 2016).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisparityError {
    /// The share of pixels with an error of more than 0.07 px per step between views, in [0, 1].
    pub bad_007: f64,
    /// The share of pixels with an error of more than 0.03 px per step, in [0, 1].
    pub bad_003: f64,
    /// The mean squared error, px² per step².
    pub mean_square: f64,
}

/// The error for a light field whose centre view came with disparities; `None` for others. The estimate uses the views alone.
pub(crate) fn disparity_error(
    field: &LightField,
    load: &LoadOptions,
    cache: &DiskCache,
    progress: &dyn Progress,
) -> Result<Option<DisparityError>, DocumentError> {
    let Some(provided) = field.disparity.as_ref().filter(|disparity| disparity.view == field.reference)
    else {
        return Ok(None);
    };
    let estimated = estimate_disparity(field, load, cache, progress)?;
    let [columns, rows] = [provided.map.width, provided.map.height].map(|side| side as usize);
    let [width, height] = field.size.map(|side| side as usize);
    // The pixel of the view at the centre of a pixel of the map.
    let rescale_index =
        |index: usize, from_len: usize, to_len: usize| (2 * index + 1) * to_len / (2 * from_len);
    let estimate_at = |pixel: usize| {
        let (x, y) =
            (rescale_index(pixel % columns, columns, width), rescale_index(pixel / columns, rows, height));
        f64::from(estimated[y * width + x])
    };
    let truth = provided.map.inverse_depth();
    let valid_pixels = truth.iter().enumerate().filter(|(_, truth)| truth.is_finite());
    Ok(summarize_errors(valid_pixels.map(|(pixel, truth)| estimate_at(pixel) - f64::from(*truth))))
}

/// Summarises errors per pixel; `None` without pixels.
fn summarize_errors(errors: impl Iterator<Item = f64>) -> Option<DisparityError> {
    let (mut count, mut bad, mut squares) = (0.0f64, [0.0; 2], 0.0);
    for error in errors {
        count += 1.0;
        bad[0] += f64::from(u8::from(error.abs() > 0.07));
        bad[1] += f64::from(u8::from(error.abs() > 0.03));
        squares += error * error;
    }
    let [bad_007, bad_003] = bad.map(|bad| bad / count);
    (count > 0.0).then_some(DisparityError { bad_007, bad_003, mean_square: squares / count })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_pixels_have_equal_weight() {
        let error = summarize_errors([0.0, -0.05, 0.1, 0.02].into_iter()).expect("there are pixels");
        assert_eq!((error.bad_007, error.bad_003), (0.25, 0.5));
        assert!((error.mean_square - 0.0129 / 4.0).abs() < 1e-12);
        assert_eq!(summarize_errors(std::iter::empty()), None);
    }
}
