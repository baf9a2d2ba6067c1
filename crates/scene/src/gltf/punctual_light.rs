//! KHR_lights_punctual.

use crate::error::Fault;
use crate::gltf::document::{Document, nonempty_name};
use crate::{Light, LightKind};
use glam::{DMat4, DVec3, Vec3};
use gltf::khr_lights_punctual::Kind;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

const EXTENSION: &str = "KHR_lights_punctual";

/// The light of a node with the transform `world`, if it has one.
pub(crate) fn node_light(
    document: &Document<'_>,
    node: &gltf::Node<'_>,
    world: DMat4,
) -> Result<Option<Light>, Fault> {
    let place = format!("/nodes/{}/extensions", node.index());
    document.check_at(&place)?;
    document.check_below(&format!("{place}/{EXTENSION}"))?;
    let Some(light) = node.light() else { return Ok(None) };
    let index = light.index();
    let place = format!("/extensions/{EXTENSION}/lights/{index}");
    if let Err(fault) = document.check_at(&format!("{place}/type")) {
        document.warn(format!("{fault}; the light is left out"));
        return Ok(None);
    }
    for key in ["color", "intensity"] {
        document.check_below(&format!("{place}/{key}"))?;
    }
    let kind = match light.kind() {
        Kind::Point => LightKind::Point,
        Kind::Directional => LightKind::Directional,
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            spot_cone(document, &format!("{place}/spot"), inner_cone_angle.into(), outer_cone_angle.into())
        }
    };
    let range = match kind {
        // Directional light has no range, whatever the file declares.
        LightKind::Directional => f64::INFINITY,
        _ => light_range(document, &format!("{place}/range"), light.range()),
    };
    let intensity = light.intensity() * Vec3::from_array(light.color());
    if !intensity.is_finite() {
        document.warn(format!("{place}: its intensity or colour is not finite; the light is left out"));
        return Ok(None);
    }
    if intensity.min_element() < 0.0 {
        document.warn(format!("{place}: its intensity or colour is negative, which counts as 0"));
    }
    let intensity = intensity.max(Vec3::ZERO);
    let direction = (-world.z_axis.truncate()).try_normalize();
    let position = world.w_axis.truncate();
    let (Some(direction), true) = (direction.or(Some(DVec3::NEG_Z)), position.is_finite()) else {
        document.warn(format!("/nodes/{}: has no finite position; its light is left out", node.index()));
        return Ok(None);
    };
    let name = nonempty_name(light.name())
        .or(nonempty_name(node.name()))
        .unwrap_or_else(|| format!("light {index}"));
    Ok(Some(Light { name, kind, intensity, position, direction, range }))
}

/// The range of a light. Exporters write 0 for an unlimited light; an invalid range counts as unlimited, since a
/// light that goes out is hardly intended.
fn light_range(document: &Document<'_>, place: &str, range: Option<f32>) -> f64 {
    if let Err(fault) = document.check_at(place) {
        document.warn(format!("{fault}; the light reaches any distance"));
    }
    match range {
        Some(range) if range <= 0.0 => {
            document.warn(format!("{place}: {range} is not a valid range; the light reaches any distance"));
            f64::INFINITY
        }
        range => range.map_or(f64::INFINITY, f64::from),
    }
}

/// A spot light's cone with valid angles, 0 ≤ inner ≤ outer ≤ π/2. Equal angles make a sharp edge; an outer angle of
/// 0 or less, which would let no light out, is replaced by glTF's default.
fn spot_cone(document: &Document<'_>, place: &str, inner: f64, outer: f64) -> LightKind {
    for place in [place, &format!("{place}/innerConeAngle"), &format!("{place}/outerConeAngle")] {
        if let Err(fault) = document.check_at(place) {
            document.warn(format!("{fault}; the default is used"));
        }
    }
    let repaired = if outer > 0.0 { outer.min(FRAC_PI_2) } else { FRAC_PI_4 };
    // Half of the decimal forms of π/2 are rounded up.
    if (repaired - outer).abs() > 1e-6 {
        document.warn(format!(
            "{place}/outerConeAngle: {outer:.6} is not a valid half angle of a cone; {repaired:.6} is used"
        ));
    }
    LightKind::Spot { inner: inner.clamp(0.0, repaired), outer: repaired }
}
