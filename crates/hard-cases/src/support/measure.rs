//! Measurements on pictures.

use lens::Picture;

/// The largest magnitude; NaN if any is NaN.
pub fn worst(magnitudes: impl IntoIterator<Item = f64>) -> f64 {
    magnitudes.into_iter().fold(0.0, |most: f64, value| {
        if most.is_nan() || value.is_nan() { f64::NAN } else { most.max(value.abs()) }
    })
}

/// Number of values of a picture that are NaN, infinite or negative.
pub fn senseless(picture: &Picture) -> f64 {
    let numbers = picture.radiance.iter().flatten().chain(&picture.coverage);
    numbers.filter(|value| !(value.is_finite() && **value >= 0.0)).count() as f64
}

/// The largest difference of any conserved radiance from `value`.
pub fn farthest_from(picture: &Picture, value: f64) -> f64 {
    worst(picture.radiance.iter().flatten().map(|&c| f64::from(c) - value))
}

/// The largest difference between two pictures, in radiance and coverage.
pub fn largest_difference(a: &Picture, b: &Picture) -> f64 {
    let numbers = |p: &Picture| {
        p.radiance.iter().flatten().chain(&p.coverage).map(|&c| f64::from(c)).collect::<Vec<_>>()
    };
    worst(numbers(a).into_iter().zip(numbers(b)).map(|(a, b)| a - b))
}

/// Root mean square difference of the radiances.
pub fn rms_difference(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.radiance.iter().flatten().zip(b.radiance.iter().flatten());
    let squares: f64 = pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (squares / (3.0 * a.radiance.len() as f64)).sqrt()
}

/// The agreement of two pictures whose values are shown up to 1, dB: the peak against the root mean square difference.
pub fn psnr(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let shown = |value: f32| f64::from(value).clamp(0.0, 1.0);
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    let squares: f64 = pairs.map(|(&a, &b)| (shown(a) - shown(b)).powi(2)).sum();
    -10.0 * (squares / (3 * a.len()) as f64).log10()
}

/// Sum of the green channel over all pixels.
pub fn energy(picture: &Picture) -> f64 {
    energies(picture)[1]
}

/// Sums of the channels over all pixels.
pub fn energies(picture: &Picture) -> [f64; 3] {
    [0, 1, 2].map(|c| picture.radiance.iter().map(|rgb| f64::from(rgb[c])).sum())
}
