//! EXT_lights_image_based: the environment embedded in a file, as a world.
//!
//! The extension stores a cube of images, blurred increasingly for rougher surfaces, and coefficients of the
//! irradiance, for renderers that cannot integrate light. Here light is integrated: the first, sharpest cube is the
//! environment, the rest is not read.
//!
//! The faces come in the order +X, −X, +Y, −Y, +Z, −Z. Each image is that of the usual cube map mirrored left to
//! right, as the extension specifies: it is the view from the centre along the axis (see the table at [`CubeMap`]).
//! Its colours are sRGB-encoded; an alpha channel is the D of RGBD, by which the decoded colours are divided.
//! <https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/EXT_lights_image_based>

use crate::error::Fault;
use crate::gltf::container::json_object::Object;
use crate::gltf::document::{Document, nonempty_name};
use crate::gltf::geometry::hierarchy::shown_scene;
use crate::world::CubeMap;
use crate::{Environment, Image, ImageLevel, World};
use glam::DQuat;
use serde_json::Value;
use std::sync::Arc;

const EXTENSION: &str = "EXT_lights_image_based";

/// Bytes per texel of radiance.
const TEXEL_BYTES: u64 = 12;

/// The world embedded in the file for the shown scene, if any.
pub(crate) fn read_embedded_world(document: &Document<'_>) -> Result<Option<World>, Fault> {
    let Some(scene) = shown_scene(document) else { return Ok(None) };
    let Some(reference) = document.item("scenes", scene, "/scene")?.extension(EXTENSION)? else {
        return Ok(None);
    };
    let Some(index) = reference.index("light")? else {
        return Err(reference.malformed("light", "is missing"));
    };
    let lights = match document.root_object().extension(EXTENSION)? {
        Some(extension) => extension.objects("lights")?,
        None => Vec::new(),
    };
    let Some(light) = lights.get(index) else {
        return Err(reference.malformed("light", format!("refers to lights[{index}], which does not exist")));
    };
    let name = nonempty_name(light.text("name")?).unwrap_or_else(|| format!("{index}"));
    let rotation = rotation(light)?;
    let cube = read_cube_map(document, light, intensity(light)?)?;
    warn_about_flaws(document, light, cube.side);
    let [texels, lookups] = CubeMap::conversion_cost(cube.side);
    document.budget.take_memory(TEXEL_BYTES * texels, &light.place)?;
    document.budget.take_work(lookups, &light.place)?;
    let map = cube.to_equirectangular(format!("image-based light {name}"), rotation);
    document.budget.release_memory(TEXEL_BYTES * 6 * u64::from(cube.side).pow(2));
    Ok(Some(World { environment: Environment::Map(Arc::new(map)), ..World::uniform(glam::Vec3::ZERO) }))
}

/// The rotation of the cube.
fn rotation(light: &Object<'_>) -> Result<DQuat, Fault> {
    let Some(numbers) = light.numbers::<4>("rotation")? else { return Ok(DQuat::IDENTITY) };
    let rotation = DQuat::from_array(numbers);
    match rotation.length() {
        length if length > 0.0 && length.is_finite() => Ok(rotation / length),
        _ => Err(light.malformed("rotation", format!("{numbers:?} is not a rotation"))),
    }
}

/// The factor of its radiance.
fn intensity(light: &Object<'_>) -> Result<f32, Fault> {
    let intensity = light.number("intensity")?.unwrap_or(1.0);
    // A colour divided by its alpha is at most this many times the intensity.
    const BRIGHTEST: f32 = u16::MAX as f32;
    let is_usable = intensity >= 0.0 && (intensity as f32 * BRIGHTEST).is_finite();
    is_usable.then_some(intensity as f32).ok_or_else(|| {
        light.malformed("intensity", format!("{intensity} is negative or more than can be computed with"))
    })
}

/// The sharpest cube.
fn read_cube_map(document: &Document<'_>, light: &Object<'_>, intensity: f32) -> Result<CubeMap, Fault> {
    let key = "specularImages/0";
    let faces = light.list("specularImages")?.first();
    let Some(faces) = faces else { return Err(light.malformed("specularImages", "is missing or empty")) };
    let indices = image_indices(faces).ok_or_else(|| light.malformed(key, "is not an array of 6 images"))?;
    if indices.len() != 6 {
        return Err(light.malformed(key, format!("has {} faces, a cube has 6", indices.len())));
    }
    let mut cube = CubeMap { side: 0, faces: Default::default() };
    for (face, &index) in indices.iter().enumerate() {
        let image = document.decode_image(index, &format!("{}/{key}/{face}", light.place))?;
        let wrong = |what: String| Fault::Malformed { place: format!("/images/{index}"), what };
        let (width, height) = (image.width, image.height);
        if width != height {
            return Err(wrong(format!("has {width} × {height} texels, the faces of a cube are square")));
        }
        if face > 0 && width != cube.side {
            let side = cube.side;
            return Err(wrong(format!("has {width} × {height} texels, another face {side} × {side}")));
        }
        cube.side = width;
        let texels = u64::from(width).pow(2);
        document.budget.take_memory(TEXEL_BYTES * texels, &light.place)?;
        cube.faces[face] = image_radiance(&image, intensity).map_err(wrong)?;
        let bytes = match &image.texels {
            ImageLevel::Bits8(_) => 4,
            ImageLevel::Bits16(_) => 8,
            ImageLevel::Float(_) => 16,
        };
        document.budget.release_memory(bytes * texels);
    }
    Ok(cube)
}

/// Indices of images.
fn image_indices(list: &Value) -> Option<Vec<usize>> {
    let index =
        |value: &Value| usize::try_from(crate::gltf::container::json_object::as_whole_number(value)?).ok();
    list.as_array()?.iter().map(index).collect()
}

/// The radiance of an image's texels, times `intensity`; or what is wrong with one.
fn image_radiance(image: &Image, intensity: f32) -> Result<Vec<[f32; 3]>, String> {
    let places = (0..image.height).flat_map(|y| (0..image.width).map(move |x| (x, y)));
    let light = |(x, y)| {
        let texel = image.texel(x, y, true);
        if texel.w == 0.0 {
            return Err(format!(
                "has an opacity of 0 in column {x} of row {y}, by which its light would be divided (RGBD)"
            ));
        }
        Ok((texel.truncate() / texel.w * intensity).to_array())
    };
    places.map(light).collect()
}

/// Warns about defects in the rest, which is not used here.
fn warn_about_flaws(document: &Document<'_>, light: &Object<'_>, side: u32) {
    let warn = |key: &str, what: String| document.warn(format!("{}/{key}: {what}", light.place));
    if !side.is_power_of_two() {
        warn(
            "specularImages/0",
            format!("its faces have {side} texels per side, which is not a power of two"),
        );
    }
    match light.whole_number("specularImageSize") {
        Ok(Some(declared)) if declared == u64::from(side) => {}
        Ok(Some(declared)) => {
            warn("specularImageSize", format!("is {declared}, but the first faces have {side}"))
        }
        _ => warn("specularImageSize", "is missing or not a whole number".into()),
    }
    let rows = light.list("irradianceCoefficients").unwrap_or_default();
    let is_color = |row: &Value| {
        row.as_array().is_some_and(|numbers| numbers.len() == 3 && numbers.iter().all(Value::is_number))
    };
    if rows.len() != 9 || !rows.iter().all(is_color) {
        warn("irradianceCoefficients", "is not an array of 9 arrays of 3 numbers".into());
    }
    for (mip, faces) in light.list("specularImages").unwrap_or_default().iter().enumerate().skip(1) {
        let exist = |list: Vec<usize>| list.len() == 6 && list.iter().all(|&i| i < document.len("images"));
        if !image_indices(faces).is_some_and(exist) {
            warn(&format!("specularImages/{mip}"), "is not an array of 6 images that exist".into());
        }
    }
}
