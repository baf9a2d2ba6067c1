//! KHR_lights_punctual, and the light of a scene that has none.

use crate::document::Document;
use crate::error::Fault;
use crate::json_object::Object;
use crate::{Light, LightKind};
use glam::{DMat4, DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

const EXTENSION: &str = "KHR_lights_punctual";

/// The light of a node that stands at `world`, if it has one.
pub(crate) fn node_light(
    document: &Document<'_>,
    node: &Object<'_>,
    world: DMat4,
) -> Result<Option<Light>, Fault> {
    let Some(reference) = node.extension(EXTENSION)? else { return Ok(None) };
    let index = reference.required("light", reference.index("light")?)?;
    let place = format!("{}/light", reference.place);
    let lights = document.root().extension(EXTENSION)?.map(|lights| lights.list("lights")).transpose()?;
    let Some(value) = lights.and_then(|lights| lights.get(index)) else {
        return Err(reference.malformed("light", format!("light {index} does not exist")));
    };
    let light = Object::new(value, format!("/extensions/{EXTENSION}/lights/{index}"))?;
    let kind = match light.required("type", light.text("type")?)? {
        "point" => LightKind::Point,
        "directional" => LightKind::Directional,
        "spot" => spot(document, &light)?,
        other => {
            document.warn(format!("{}/type: {other:?} is unknown; the light is left out", light.place));
            return Ok(None);
        }
    };
    let color = light.numbers::<3>("color")?.unwrap_or([1.0; 3]);
    let intensity = light.number("intensity")?.unwrap_or(1.0);
    let range = light.number("range")?.unwrap_or(f64::INFINITY);
    let intensity = Vec3::from_array(color.map(|v| (v * intensity) as f32));
    if !intensity.is_finite() || intensity.min_element() < 0.0 || range <= 0.0 {
        document.warn(format!(
            "{}: its intensity, colour or range is not positive; the light is left out",
            light.place
        ));
        return Ok(None);
    }
    let direction = (-world.z_axis.truncate()).try_normalize();
    let position = world.w_axis.truncate();
    let (Some(direction), true) = (direction.or(Some(DVec3::NEG_Z)), position.is_finite()) else {
        document.warn(format!("{place}: stands nowhere; the light is left out"));
        return Ok(None);
    };
    let name = light.name().or(node.name()).map_or_else(|| format!("light {index}"), String::from);
    Ok(Some(Light { name, kind, intensity, position, direction, range }))
}

fn spot(document: &Document<'_>, light: &Object<'_>) -> Result<LightKind, Fault> {
    let Some(spot) = light.object("spot")? else {
        document.warn(format!("{}/spot: is missing; the default cone is taken", light.place));
        return Ok(LightKind::Spot { inner: 0.0, outer: FRAC_PI_4 });
    };
    let outer = spot.number("outerConeAngle")?.unwrap_or(FRAC_PI_4).clamp(0.0, FRAC_PI_2);
    let inner = spot.number("innerConeAngle")?.unwrap_or(0.0).clamp(0.0, outer);
    Ok(LightKind::Spot { inner, outer })
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
