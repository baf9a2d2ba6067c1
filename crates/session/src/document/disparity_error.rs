//! How far disparities that the views of a light field tell are from those that came with them.

use super::found_disparity::found_disparity;
use crate::error::SessionError;
use capture::LightField;
use progress::Progress;
use scene::LoadOptions;

/// How far found disparities are from given ones, over all pixels that have one (Honauer et al., ACCV 2016).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisparityError {
    /// The share of pixels that are off by more than 0.07 px a step, in [0, 1].
    pub bad_007: f64,
    /// By more than 0.03.
    pub bad_003: f64,
    /// The mean squared error, px² a step².
    pub mean_square: f64,
}

/// Of a light field whose middle view came with disparities; none of others. The views alone are asked.
pub(super) fn disparity_error(
    field: &LightField,
    load: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Option<DisparityError>, SessionError> {
    let Some(given) = field.disparity.as_ref().filter(|given| given.view == field.reference) else {
        return Ok(None);
    };
    let found = found_disparity(field, load, progress)?;
    let [columns, rows] = [given.map.width, given.map.height].map(|side| side as usize);
    let [width, height] = field.size.map(|side| side as usize);
    // The view's pixel at the middle of a pixel of the map.
    let at = |place: usize, of: usize, to: usize| (2 * place + 1) * to / (2 * of);
    let of_pixel = |pixel: usize| {
        let (x, y) = (at(pixel % columns, columns, width), at(pixel / columns, rows, height));
        f64::from(found[y * width + x])
    };
    let truth = given.map.inverse_depth();
    let told = truth.iter().enumerate().filter(|(_, truth)| truth.is_finite());
    Ok(error_of(told.map(|(pixel, truth)| of_pixel(pixel) - f64::from(*truth))))
}

/// None of no pixels.
fn error_of(off: impl Iterator<Item = f64>) -> Option<DisparityError> {
    let (mut count, mut bad, mut squares) = (0.0f64, [0.0; 2], 0.0);
    for off in off {
        count += 1.0;
        bad[0] += f64::from(u8::from(off.abs() > 0.07));
        bad[1] += f64::from(u8::from(off.abs() > 0.03));
        squares += off * off;
    }
    let [bad_007, bad_003] = bad.map(|bad| bad / count);
    (count > 0.0).then_some(DisparityError { bad_007, bad_003, mean_square: squares / count })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_count_alike() {
        let error = error_of([0.0, -0.05, 0.1, 0.02].into_iter()).expect("there are pixels");
        assert_eq!((error.bad_007, error.bad_003), (0.25, 0.5));
        assert!((error.mean_square - 0.0129 / 4.0).abs() < 1e-12);
        assert_eq!(error_of(std::iter::empty()), None);
    }
}
