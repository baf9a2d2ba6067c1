//! KHR_lights_punctual, and the light of a scene that has none.

use crate::document::{Document, named};
use crate::error::Fault;
use crate::{Light, LightKind};
use glam::{DMat4, DVec3, Vec3};
use gltf::khr_lights_punctual::Kind;
use std::f64::consts::{FRAC_PI_2, PI};

const EXTENSION: &str = "KHR_lights_punctual";

/// The light of a node that stands at `world`, if it has one.
pub(crate) fn node_light(
    document: &Document<'_>,
    node: &gltf::Node<'_>,
    world: DMat4,
) -> Result<Option<Light>, Fault> {
    let place = format!("/nodes/{}/extensions", node.index());
    document.sound(&place)?;
    document.sound_below(&format!("{place}/{EXTENSION}"))?;
    let Some(light) = node.light() else { return Ok(None) };
    let index = light.index();
    let place = format!("/extensions/{EXTENSION}/lights/{index}");
    if let Err(fault) = document.sound(&format!("{place}/type")) {
        document.warn(format!("{fault}; the light is left out"));
        return Ok(None);
    }
    document.sound_below(&place)?;
    let kind = match light.kind() {
        Kind::Point => LightKind::Point,
        Kind::Directional => LightKind::Directional,
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            let outer = f64::from(outer_cone_angle).clamp(0.0, FRAC_PI_2);
            LightKind::Spot { inner: f64::from(inner_cone_angle).clamp(0.0, outer), outer }
        }
    };
    let range = light.range().map_or(f64::INFINITY, f64::from);
    let intensity = light.intensity() * Vec3::from_array(light.color());
    if !intensity.is_finite() || intensity.min_element() < 0.0 || range <= 0.0 {
        document
            .warn(format!("{place}: its intensity, colour or range is not positive; the light is left out"));
        return Ok(None);
    }
    let direction = (-world.z_axis.truncate()).try_normalize();
    let position = world.w_axis.truncate();
    let (Some(direction), true) = (direction.or(Some(DVec3::NEG_Z)), position.is_finite()) else {
        document.warn(format!("/nodes/{}: stands nowhere; its light is left out", node.index()));
        return Ok(None);
    };
    let name = named(light.name()).or(named(node.name())).unwrap_or_else(|| format!("light {index}"));
    Ok(Some(Light { name, kind, intensity, position, direction, range }))
}

/// The light of a scene that needs some and has none: a sun from the upper left front, and a sky. A white wall
/// that faces the sun has radiance 1.
pub(crate) fn invented_lights() -> Vec<Light> {
    const SKY: f32 = 0.3;
    let light = |name: &str, kind, intensity| Light {
        name: name.into(),
        kind,
        intensity: Vec3::splat(intensity),
        position: DVec3::ZERO,
        direction: DVec3::new(0.5, -1.0, -0.7).normalize(),
        range: f64::INFINITY,
    };
    vec![
        light("invented sun", LightKind::Directional, (1.0 - SKY) * PI as f32),
        light("invented sky", LightKind::Ambient, SKY),
    ]
}
