//! `KHR_gaussian_splatting` of glTF, from attributes that are decoded already (Khronos, release candidate of 2026).
//!
//! Scales are linear, opacities as they are, rotations x y z w; a coefficient of the colour is an attribute of its own.

use super::format::SplatFormat;
use super::reading::Reading;
use super::splat_file::{ReadOptions, SplatFile};
use crate::cloud::harmonics::degree_of;
use crate::cloud::{Axes, CloudTraits, ColorSpace, Splat};
use crate::error::{GaussianError, quoted};
use glam::{Quat, Vec3};
use progress::Progress;
use serde::Deserialize;
use std::path::Path;

/// The decoded attributes of a primitive, each as long as `positions`.
#[derive(Clone, Copy, Debug)]
pub struct GltfAttributes<'a> {
    /// `POSITION`.
    pub positions: &'a [[f32; 3]],
    /// `KHR_gaussian_splatting:ROTATION`, x y z w.
    pub rotations: &'a [[f32; 4]],
    /// `KHR_gaussian_splatting:SCALE`, standard deviations.
    pub scales: &'a [[f32; 3]],
    /// `KHR_gaussian_splatting:OPACITY`, in [0, 1].
    pub opacities: &'a [f32],
    /// `KHR_gaussian_splatting:SH_DEGREE_0_COEF_0`, `SH_DEGREE_1_COEF_0`, … in this order: 1, 4, 9 or 16 of them.
    pub coefficients: &'a [&'a [[f32; 3]]],
}

/// The extension of a primitive.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Extension {
    kernel: String,
    color_space: String,
    projection: Option<String>,
    sorting_method: Option<String>,
}

/// Makes a cloud of the splats of a primitive. `extension` is its object `KHR_gaussian_splatting`, `file` the name in messages. The node's
/// transform is left to [`crate::Placement`].
///
/// # Errors
/// Attributes are of different lengths or not those of a degree, the kernel or the colour space is unknown, no splat can be drawn, the
/// limits are exceeded; or `progress` cancels.
pub fn read_gltf_attributes(
    attributes: &GltfAttributes<'_>,
    extension: &serde_json::Value,
    file: &Path,
    options: &ReadOptions,
    progress: &dyn Progress,
) -> Result<SplatFile, GaussianError> {
    let mut reading = Reading::new(file, options, progress);
    let extension =
        Extension::deserialize(extension).map_err(|e| reading.malformed("KHR_gaussian_splatting", e))?;
    if extension.kernel != "ellipse" {
        let what = format!("its splats have the unknown kernel {}", quoted(&extension.kernel));
        return Err(GaussianError::unsupported(file, what, "export them with the kernel ellipse"));
    }
    let color_space = match extension.color_space.as_str() {
        "srgb_rec709_display" => ColorSpace::Srgb,
        "lin_rec709_display" => ColorSpace::Linear,
        other => {
            let what = format!("its splats have the unknown colour space {}", quoted(other));
            let cure = "export them as srgb_rec709_display or lin_rec709_display";
            return Err(GaussianError::unsupported(file, what, cure));
        }
    };
    let GltfAttributes { positions, rotations, scales, opacities, coefficients } = *attributes;
    let lengths = [rotations.len(), scales.len(), opacities.len()];
    let all_lengths = lengths.into_iter().chain(coefficients.iter().map(|attribute| attribute.len()));
    if let Some(length) = all_lengths.clone().find(|length| *length != positions.len()) {
        let what = format!("an attribute has {length} elements for {} positions", positions.len());
        return Err(reading.malformed("KHR_gaussian_splatting", what));
    }
    let degree = coefficients.len().checked_sub(1).and_then(degree_of);
    let Some((degree, (base, rest))) = degree.zip(coefficients.split_first()) else {
        let what = format!("has {} coefficients, where 1, 4, 9 or 16 belong to a degree", coefficients.len());
        return Err(reading.malformed("KHR_gaussian_splatting", what));
    };
    if extension.projection.as_deref().is_some_and(|projection| projection != "perspective") {
        reading.warn("its splats have an unknown projection", "they are drawn in perspective");
    }
    if extension.sorting_method.as_deref().is_some_and(|method| method != "cameraDistance") {
        reading.warn("its splats have an unknown order", "they are sorted by depth");
    }
    let count = positions.len() as u64;
    let mut builder = reading.builder(degree, count, 0)?;
    let mut values = Vec::new();
    for index in 0..positions.len() {
        reading.at_row(index as u64, count)?;
        values.clear();
        rest.iter().for_each(|attribute| values.extend(attribute[index]));
        let splat = Splat {
            mean: positions[index].into(),
            rotation: Quat::from_array(rotations[index]),
            log_scale: Vec3::from(scales[index]).map(f32::ln),
            opacity: opacities[index],
            base_color: base[index].into(),
        };
        builder.push(splat, &values);
    }
    let traits = CloudTraits { color_space, is_antialiased: false, axes: Axes::RIGHT_UP_BACK };
    reading.finish(builder, traits, SplatFormat::Gltf)
}
