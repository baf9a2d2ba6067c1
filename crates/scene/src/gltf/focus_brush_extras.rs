//! Our data in glTF's `extras`, under one key: lenses of cameras, radiance of materials.
//!
//! ```text
//! cameras[i].extras.focus_brush     {"version": 1, the lens in the fields of a camera file: "width", "height", "focus_distance" | "inf",
//!                                    "aperture_radius", "sensor_height", "shift": [x, y], "aperture": {"shape", "blades", …}}
//! materials[i].extras.focus_brush   {"version": 1, "radiance": {"uri": "light.exr", "texCoord": 1}}
//! ```
//!
//! Other programs ignore it. Faulty data is reported as a warning and ignored.

use crate::CameraLens;
use crate::error::Fault;
use crate::gltf::container::json_object::Object;
use crate::gltf::document::Document;
use glam::DVec2;
use lens::{Aperture, ApertureShape, Camera};

/// The key in `extras`.
pub const EXTRAS_KEY: &str = "focus_brush";
/// The version of this data that is read and written.
pub const EXTRAS_VERSION: u64 = 1;

/// Our entry in the extras of an object of the document, if its version is supported.
fn focus_brush_extras<'a>(document: &Document<'_>, holder: &Object<'a>) -> Result<Option<Object<'a>>, Fault> {
    // Extras may be any value; ours are in an object.
    let Some(extras) = holder.get("extras").filter(|extras| extras.is_object()) else { return Ok(None) };
    let extras = Object::new(extras, format!("{}/extras", holder.place))?;
    let Some(own) = extras.object(EXTRAS_KEY)? else { return Ok(None) };
    match own.whole_number("version")? {
        Some(EXTRAS_VERSION) => Ok(Some(own)),
        Some(other) => {
            document.warn(format!("{}/version: {other} is not supported; all of it is left out", own.place));
            Ok(None)
        }
        None => Err(own.malformed("version", "is missing")),
    }
}

/// The value, or a warning and the default.
fn or_warn<T: Default>(document: &Document<'_>, read: Result<T, Fault>) -> T {
    read.unwrap_or_else(|fault| {
        document.warn(format!("{fault}; it is left out"));
        T::default()
    })
}

/// The lens of camera `index`, whose full vertical angle of view is `yfov`.
pub(crate) fn camera_lens(document: &Document<'_>, index: usize, yfov: f64) -> CameraLens {
    let read = || -> Result<CameraLens, Fault> {
        let camera = document.item("cameras", index, "/cameras")?;
        let Some(own) = focus_brush_extras(document, &camera)? else { return Ok(CameraLens::default()) };
        Ok(CameraLens {
            size_px: or_warn(document, size(&own)),
            focus_distance: or_warn(document, focus_distance(&own)),
            aperture_radius: or_warn(document, own.number("aperture_radius")),
            sensor_height: or_warn(document, own.number("sensor_height")),
            shift: or_warn(document, own.numbers::<2>("shift")).map(DVec2::from_array),
            aperture: or_warn(document, aperture(&own)),
        })
    };
    let lens = or_warn(document, read());
    let place = || format!("/cameras/{index}/extras/{EXTRAS_KEY}");
    validated(lens, yfov).unwrap_or_else(|error| {
        document.warn(format!(
            "{}/{}: it must be {}; the lens is left out",
            place(),
            error.field,
            error.must
        ));
        CameraLens::default()
    })
}

/// The lens, if it makes a valid camera.
fn validated(lens: CameraLens, yfov: f64) -> Result<CameraLens, lens::CameraError> {
    lens.apply_to(Camera { yfov, ..Camera::default() }).validate()?;
    Ok(lens)
}

fn size(own: &Object<'_>) -> Result<Option<[u32; 2]>, Fault> {
    let side = |key| own.whole_number(key).map(|side| side.and_then(|side| u32::try_from(side).ok()));
    Ok(side("width")?.zip(side("height")?).map(<[u32; 2]>::from))
}

fn focus_distance(own: &Object<'_>) -> Result<Option<f64>, Fault> {
    match own.get("focus_distance").and_then(|value| value.as_str()) {
        Some("inf") => Ok(Some(f64::INFINITY)),
        _ => own.number("focus_distance"),
    }
}

fn aperture(own: &Object<'_>) -> Result<Option<Aperture>, Fault> {
    /// Number of corners of a polygon if not given.
    const DEFAULT_BLADES: u64 = 6;
    let Some(aperture) = own.object("aperture")? else { return Ok(None) };
    let number = |key: &str, absent: f64| aperture.number(key).map(|number| number.unwrap_or(absent));
    let shape = match aperture.text("shape")?.unwrap_or("disc") {
        "disc" => ApertureShape::Disc,
        "square" => ApertureShape::Square,
        "polygon" => ApertureShape::Polygon {
            blades: aperture.whole_number("blades")?.unwrap_or(DEFAULT_BLADES).min(u64::from(u32::MAX))
                as u32,
            rotation: number("rotation", 0.0)?,
            roundness: number("roundness", 0.0)?,
        },
        other => return Err(aperture.malformed("shape", format!("{other} is not a disc, polygon or square"))),
    };
    Ok(Some(Aperture { shape, ratio: number("ratio", 1.0)? }))
}

/// The picture of the radiance that a material emits, and the n of its TEXCOORD_n.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RadianceInfo<'a> {
    /// The file, inside the scene's folder.
    pub uri: &'a str,
    pub set: u32,
    /// JSON pointer.
    pub place: String,
}

/// The radiance of a material, if it has one.
pub(crate) fn radiance<'a>(
    document: &Document<'_>,
    material: &Object<'a>,
) -> Result<Option<RadianceInfo<'a>>, Fault> {
    let Some(own) = focus_brush_extras(document, material)? else { return Ok(None) };
    let Some(radiance) = own.object("radiance")? else { return Ok(None) };
    let Some(uri) = radiance.text("uri")? else { return Err(radiance.malformed("uri", "is missing")) };
    let set = radiance.whole_number("texCoord")?.unwrap_or(0);
    let set = u32::try_from(set).map_err(|_| radiance.malformed("texCoord", "is too large"))?;
    Ok(Some(RadianceInfo { uri, set, place: radiance.place }))
}
