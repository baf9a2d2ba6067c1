//! From the numbers of a picture file to linear light.
//!
//! Without an ICC profile numbers are sRGB; floats are linear. A profile of curves and a matrix (Display P3, Adobe
//! RGB and those of cameras) is applied. Profiles made of tables belong to printers and scanners and are rejected.

use crate::texture::linear_from_srgb;
use image::{ColorType, DynamicImage};
use moxcms::{ColorProfile, DataColorSpace, ToneReprCurve};

/// The conversion of a picture's stored colours to linear light.
pub(super) struct LinearConversion {
    /// From a stored number to linear light, for each channel: 256 or 65536 entries.
    curves: [Vec<f32>; 3],
    /// From the profile's primaries to those of sRGB, by rows; `None` if they are the same.
    to_srgb: Option<[[f32; 3]; 3]>,
}

/// What is wrong with a profile, as the continuation of "its ICC profile".
pub(super) struct UnsupportedProfile(pub String);

impl LinearConversion {
    /// The conversion to linear light of a decoded picture with this ICC profile; without one it is sRGB.
    ///
    /// # Errors
    /// The profile cannot be used for this picture.
    pub fn from_profile(profile: Option<&[u8]>, picture: &DynamicImage) -> Result<Self, UnsupportedProfile> {
        let entries = if is_deep(picture.color()) { 1 << 16 } else { 1 << 8 };
        let Some(bytes) = profile else {
            let curve = sample_curve(entries, |value| linear_from_srgb(f64::from(value)));
            return Ok(Self { curves: [curve.clone(), curve.clone(), curve], to_srgb: None });
        };
        let profile = ColorProfile::new_from_slice(bytes)
            .map_err(|error| UnsupportedProfile(format!("is broken: {error}")))?;
        let has_tables = profile.lut_a_to_b_perceptual.is_some() || profile.lut_a_to_b_colorimetric.is_some();
        let curve = |curve: &Option<ToneReprCurve>| {
            let curve = curve.as_ref().ok_or_else(|| UnsupportedProfile("lacks a curve".into()))?;
            let curve = curve.make_linear_evaluator();
            let curve =
                curve.map_err(|error| UnsupportedProfile(format!("has an impossible curve: {error}")))?;
            Ok(sample_curve(entries, |value| curve.evaluate_value(value)))
        };
        match profile.color_space {
            DataColorSpace::Gray => {
                let curve = curve(&profile.gray_trc)?;
                Ok(Self { curves: [curve.clone(), curve.clone(), curve], to_srgb: None })
            }
            DataColorSpace::Rgb if profile.is_matrix_shaper() => {
                let curves =
                    [curve(&profile.red_trc)?, curve(&profile.green_trc)?, curve(&profile.blue_trc)?];
                let matrix = profile.transform_matrix(&ColorProfile::new_srgb()).v;
                Ok(Self { curves, to_srgb: Some(matrix.map(|row| row.map(|entry| entry as f32))) })
            }
            _ if has_tables => Err(UnsupportedProfile("is made of tables".into())),
            _ => Err(UnsupportedProfile("is neither RGB nor grey".into())),
        }
    }

    /// The pixels of that picture, linear, with the primaries of sRGB.
    pub fn to_linear(&self, picture: DynamicImage) -> Vec<[f32; 3]> {
        let [red, green, blue] = &self.curves;
        let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
        let through = |[r, g, b]: [usize; 3]| self.to_srgb([red[r], green[g], blue[b]].map(finite));
        match picture.color() {
            ColorType::Rgb32F | ColorType::Rgba32F => {
                picture.into_rgb32f().pixels().map(|pixel| pixel.0.map(finite)).collect()
            }
            deep if is_deep(deep) => {
                picture.into_rgb16().pixels().map(|pixel| through(pixel.0.map(usize::from))).collect()
            }
            _ => picture.into_rgb8().pixels().map(|pixel| through(pixel.0.map(usize::from))).collect(),
        }
    }

    fn to_srgb(&self, color: [f32; 3]) -> [f32; 3] {
        match &self.to_srgb {
            Some(matrix) => matrix.map(|row| row[0] * color[0] + row[1] * color[1] + row[2] * color[2]),
            None => color,
        }
    }
}

/// Whether the channels have 16 bits.
fn is_deep(color: ColorType) -> bool {
    color.bytes_per_pixel() / color.channel_count() == 2
}

/// Samples a curve at this many positions.
fn sample_curve(entries: usize, curve: impl Fn(f32) -> f32) -> Vec<f32> {
    (0..entries).map(|entry| curve(entry as f32 / (entries - 1) as f32)).collect()
}
