//! A primitive of Gaussian splats: `KHR_gaussian_splatting` (Khronos, release candidate of April 2026).

use crate::error::{Fault, Stop};
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::Accessor;
use gaussians::{GaussianError, GltfAttributes, ReadOptions, SplatFile, read_gltf_attributes};
use gltf::mesh::Mode;
use progress::Progress;
use std::path::Path;

/// The extension's name, and the prefix of its attributes.
pub(crate) const EXTENSION: &str = "KHR_gaussian_splatting";

/// Coefficients of a colour, the number of which its attributes have: degree by degree.
const DEGREES: u32 = 4;

/// Whether a primitive at `place` (JSON pointer) is one of splats.
pub(crate) fn is_splats(document: &Document<'_>, file: &gltf::Primitive<'_>, place: &str) -> bool {
    document.root_value().pointer(&format!("{place}/extensions/{EXTENSION}")).is_some()
        && document.check_at(&format!("{place}/mode")).is_ok()
        && file.mode() == Mode::Points
}

/// Reads the splats of a primitive at `place`.
///
/// # Errors
/// An attribute is missing or faulty, kernel or colour space are unknown, no splat can be drawn, or the budget is exhausted; or `progress` cancels.
pub(crate) fn read_splats(
    document: &Document<'_>,
    file: &Path,
    place: &str,
    progress: &dyn Progress,
) -> Result<SplatFile, Stop> {
    let attributes = Attributes { document, place: format!("{place}/attributes") };
    let own = |name: &str| format!("{EXTENSION}:{name}");
    let positions = attributes.vectors::<3>("POSITION")?;
    let rotations = attributes.vectors::<4>(&own("ROTATION"))?;
    let scales = attributes.vectors::<3>(&own("SCALE"))?;
    let opacities = attributes.vectors::<1>(&own("OPACITY"))?;
    let mut coefficients = vec![attributes.vectors::<3>(&own("SH_DEGREE_0_COEF_0"))?];
    let of_degree = |degree: u32| (0..=2 * degree).map(move |k| own(&format!("SH_DEGREE_{degree}_COEF_{k}")));
    for degree in (1..DEGREES).take_while(|degree| of_degree(*degree).any(|name| attributes.has(&name))) {
        for name in of_degree(degree) {
            coefficients.push(attributes.vectors::<3>(&name)?);
        }
    }
    let count = positions.len();
    let lengths = [rotations.len(), scales.len(), opacities.len()];
    let all_lengths = lengths.into_iter().chain(coefficients.iter().map(Vec::len));
    if let Some(length) = all_lengths.into_iter().find(|length| *length != count) {
        let what = format!("an attribute has {length} elements for {count} positions");
        return Err(Fault::Malformed { place: attributes.place, what }.into());
    }
    let coefficients: Vec<&[[f32; 3]]> = coefficients.iter().map(Vec::as_slice).collect();
    let attributes = GltfAttributes {
        positions: &positions,
        rotations: &rotations,
        scales: &scales,
        opacities: opacities.as_flattened(),
        coefficients: &coefficients,
    };
    let extension = document.root_value().pointer(&format!("{place}/extensions/{EXTENSION}"));
    let extension = extension.unwrap_or(&serde_json::Value::Null);
    let options = ReadOptions { max_memory: document.budget.memory_left() };
    let read = read_gltf_attributes(&attributes, extension, file, &options, progress);
    let read = read.map_err(|error| match error {
        GaussianError::Cancelled(_) => Stop::Cancelled,
        GaussianError::TooBig { what, .. } => Fault::TooBig { what }.into(),
        GaussianError::NoSplats { what, .. } | GaussianError::Unsupported { what, .. } => {
            Fault::Malformed { place: place.into(), what }.into()
        }
        GaussianError::Malformed { what, .. } => {
            Fault::Malformed { place: format!("{place}/extensions/{EXTENSION}"), what }.into()
        }
        other => Fault::Malformed { place: place.into(), what: other.to_string() }.into(),
    })?;
    document.budget.take_memory(read.cloud.bytes(), place)?;
    Ok(read)
}

/// The attributes of a primitive.
struct Attributes<'a> {
    document: &'a Document<'a>,
    place: String,
}

impl Attributes<'_> {
    fn has(&self, name: &str) -> bool {
        self.document.index_at(&format!("{}/{name}", self.place)).is_some()
    }

    /// All elements of a required attribute, normalised if its accessor is. They are let go of when the cloud is made.
    fn vectors<const N: usize>(&self, name: &str) -> Result<Vec<[f32; N]>, Fault> {
        let Self { document, .. } = self;
        let place = format!("{}/{name}", self.place);
        document.check_at(&place)?;
        let Some(index) = document.index_at(&place) else {
            let what = "is missing, which every splat needs".into();
            return Err(Fault::Malformed { place, what });
        };
        let accessor = Accessor::open(document, index, &place)?.expect_components(&[N], name)?;
        document.budget.take_work((N * accessor.count) as u64, &place)?;
        let bytes = size_of::<[f32; N]>() as u64 * accessor.count as u64;
        document.budget.take_memory(bytes, &place)?;
        let values = (0..accessor.count).map(|element| accessor.floats(element)).collect();
        document.budget.release_memory(bytes);
        Ok(values)
    }
}
