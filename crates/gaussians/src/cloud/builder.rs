//! Filling a cloud, row by row.

use super::gaussian_cloud::{CloudTraits, GaussianCloud};
use super::harmonics;
use super::left_out::{LeftOut, Reason};
use super::splat::Splat;
use glam::{Quat, Vec3};
use half::f16;
use std::sync::Arc;

/// Opacities that no ray notices: training and viewers drop responses below it.
pub(crate) const OPACITY_THRESHOLD: f32 = 1.0 / 255.0;

/// The range of ln s, s the largest scale of a splat: beyond it s² leaves the range of 32-bit floats.
const MAX_LOG_SCALE: f32 = 80.0;

/// Fills a [`GaussianCloud`]; splats that cannot be drawn are left out and counted.
pub struct CloudBuilder {
    cloud: GaussianCloud,
    coefficients: Vec<f16>,
    rows: u32,
}

impl CloudBuilder {
    /// A builder with room for `count` splats of a degree.
    ///
    /// # Panics
    /// `degree` is above [`harmonics::MAX_DEGREE`].
    pub fn new(degree: u32, count: usize) -> Self {
        assert!(degree <= harmonics::MAX_DEGREE, "degree {degree}");
        Self {
            cloud: GaussianCloud {
                traits: CloudTraits::default(),
                degree,
                means: Vec::with_capacity(count),
                rotations: Vec::with_capacity(count),
                log_scales: Vec::with_capacity(count),
                opacities: Vec::with_capacity(count),
                base_colors: Vec::with_capacity(count),
                coefficients: Arc::default(),
                left_out: LeftOut::default(),
                hidden: Vec::new(),
            },
            coefficients: Vec::with_capacity(3 * harmonics::coefficient_count(degree) * count),
            rows: 0,
        }
    }

    /// The coefficients beyond degree 0 that each splat has, all channels.
    pub fn coefficients_each(&self) -> usize {
        3 * harmonics::coefficient_count(self.cloud.degree)
    }

    /// Adds the next row of the file, with its coefficients beyond degree 0: coefficient by coefficient, red, green and blue of each beside
    /// each other.
    ///
    /// # Panics
    /// The number of coefficients is not that of the degree, or there are 2³² rows.
    pub fn push(&mut self, splat: Splat, coefficients: &[f32]) {
        assert_eq!(coefficients.len(), self.coefficients_each());
        let row = self.rows;
        self.rows = row.checked_add(1).expect("readers refuse files of 2³² splats");
        let cloud = &mut self.cloud;
        match valid(splat, coefficients) {
            Ok(splat) => {
                cloud.means.push(splat.mean);
                cloud.rotations.push(splat.rotation);
                cloud.log_scales.push(splat.log_scale);
                cloud.opacities.push(splat.opacity);
                cloud.base_colors.push(splat.base_color);
                self.coefficients.extend(coefficients.iter().map(|&x| f16::from_f32(x)));
            }
            Err(reason) => cloud.left_out.push(row, reason),
        }
    }

    /// The cloud.
    pub fn finish(self, traits: CloudTraits) -> GaussianCloud {
        GaussianCloud { traits, coefficients: Arc::new(self.coefficients), ..self.cloud }
    }
}

/// A splat with a unit rotation, or why it cannot be drawn.
fn valid(splat: Splat, coefficients: &[f32]) -> Result<Splat, Reason> {
    let require = |ok: bool, reason| if ok { Ok(()) } else { Err(reason) };
    require(splat.mean.is_finite(), Reason::Mean)?;
    let length = splat.rotation.as_dquat().length();
    require(length.is_finite() && length > 0.0, Reason::Rotation)?;
    let largest = splat.log_scale.max_element();
    require(!splat.log_scale.is_nan() && largest.abs() <= MAX_LOG_SCALE, Reason::Scale)?;
    require((0.0..=1.0).contains(&splat.opacity), Reason::Opacity)?;
    // What rounds to infinity in 16 bits is no colour.
    let is_color = |x: f32| f16::from_f32(x).is_finite();
    let base: [f32; 3] = splat.base_color.to_array();
    require(base.iter().chain(coefficients).all(|&x| is_color(x)), Reason::Color)?;
    require(splat.opacity > OPACITY_THRESHOLD, Reason::Transparent)?;
    let rotation = (splat.rotation.as_dquat() / length).as_quat();
    Ok(Splat { rotation: Quat::from_array(rotation.to_array()), log_scale: flat(splat.log_scale), ..splat })
}

/// The scales, those that vanish as −∞.
fn flat(log_scale: Vec3) -> Vec3 {
    Vec3::from_array(log_scale.to_array().map(|s| if s < -MAX_LOG_SCALE { f32::NEG_INFINITY } else { s }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::ColorSpace;

    const GOOD: Splat = Splat {
        mean: Vec3::ONE,
        rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 2.0),
        log_scale: Vec3::new(-3.0, -4.0, f32::NEG_INFINITY),
        opacity: 0.5,
        base_color: Vec3::new(0.1, 0.2, 0.3),
    };

    #[test]
    fn what_cannot_be_drawn_is_left_out_and_counted() {
        let nan = f32::NAN;
        let bad = [
            (Splat { mean: Vec3::new(0.0, nan, 0.0), ..GOOD }, Reason::Mean),
            (Splat { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..GOOD }, Reason::Rotation),
            (Splat { rotation: Quat::from_xyzw(nan, 0.0, 0.0, 1.0), ..GOOD }, Reason::Rotation),
            (Splat { log_scale: Vec3::new(-1.0, nan, -1.0), ..GOOD }, Reason::Scale),
            (Splat { log_scale: Vec3::splat(f32::NEG_INFINITY), ..GOOD }, Reason::Scale),
            (Splat { log_scale: Vec3::new(0.0, 0.0, 100.0), ..GOOD }, Reason::Scale),
            (Splat { opacity: nan, ..GOOD }, Reason::Opacity),
            (Splat { opacity: 1.5, ..GOOD }, Reason::Opacity),
            (Splat { opacity: 0.003, ..GOOD }, Reason::Transparent),
            (Splat { base_color: Vec3::new(1e9, 0.0, 0.0), ..GOOD }, Reason::Color),
        ];
        let mut builder = CloudBuilder::new(1, bad.len() + 2);
        builder.push(GOOD, &[0.25; 9]);
        bad.iter().for_each(|(splat, _)| builder.push(*splat, &[0.0; 9]));
        builder.push(GOOD, &[f32::INFINITY; 9]);
        let cloud = builder.finish(CloudTraits::default());
        assert_eq!((cloud.len(), cloud.file_rows()), (1, bad.len() + 2));
        assert_eq!(cloud.left_out().count(Reason::Color), 2);
        for (splat, reason) in bad {
            assert!(cloud.left_out().count(reason) > 0, "{splat:?}");
        }
        assert_eq!(cloud.splat(0), Splat { rotation: Quat::IDENTITY, ..GOOD });
        assert!(cloud.coefficients(0).iter().all(|x| x.to_f32() == 0.25));
        assert_eq!(cloud.traits().color_space, ColorSpace::Srgb);
    }

    #[test]
    fn hidden_splats_keep_their_number_and_stop_nothing() {
        let mut builder = CloudBuilder::new(0, 3);
        (0..3).for_each(|_| builder.push(GOOD, &[]));
        let shown = builder.finish(CloudTraits::default());
        let mut cloud = shown.clone();
        cloud.hide(vec![false, true, false]);
        assert_eq!((cloud.len(), cloud.hidden_count(), cloud.is_hidden(1)), (3, 1, true));
        assert_eq!([0, 1, 2].map(|index| cloud.splat(index).opacity), [0.5, 0.0, 0.5]);
        let bytes = |cloud: &crate::GaussianCloud| {
            let mut all = Vec::new();
            cloud.each_byte_string(|part| all.extend_from_slice(part));
            all
        };
        assert_ne!(bytes(&cloud), bytes(&shown));
        cloud.hide(vec![false; 3]);
        assert_eq!(cloud, shown);
    }

    #[test]
    fn two_million_splats_of_degree_3_fit() {
        assert!(
            GaussianCloud::bytes_of(3, 2_000_000) < 600_000_000,
            "{}",
            GaussianCloud::bytes_of(3, 2_000_000)
        );
    }
}
