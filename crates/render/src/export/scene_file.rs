//! Writing scenes with their atlas as GLB. A glTF scene is an amended copy of its file; the surface of a capture, which has no glTF file, is
//! written with its direction-independent light as a texture.

use crate::error::RenderError;
use crate::export::shot_extras::write_lens_extras;
use crate::picture::light_of_photographs;
use atlas::{Atlas, UnwrapOptions};
use document::{Input, atlas_error};
use lens::Camera;
use light::{LitScene, Steps};
use project::texture_png;
use rayon::prelude::*;
use scene::{ImageLevel, Scene, srgb_from_linear};
use serde_json::{Map, Value};
use std::path::Path;
use std::sync::Arc;

/// Writes a glTF `scene` as GLB with `atlas` as its second UV set and, if given, the lens of a shot camera in its extras.
///
/// # Errors
/// The path does not end in `.glb`, or an error of [`atlas::write_amended_glb`].
pub fn write_unwrapped(
    path: &Path,
    scene: &Scene,
    atlas: &Atlas,
    shot: Option<&Camera>,
    steps: &dyn Steps,
) -> Result<(), RenderError> {
    check_extension(path)?;
    let amend = |root: &mut Map<String, Value>| {
        if let Some(shot) = shot {
            write_lens_extras(root, scene, shot);
        }
    };
    atlas::write_amended_glb(scene, atlas, path, &amend, &*steps.begin("writing"))
        .map_err(|error| atlas_error(path, error).into())
}

/// Writes a scene as GLB. A glTF scene is written as by [`write_unwrapped`]. The surface of a capture is written as an unlit mesh with the
/// atlas as its first UV set, and its direction-independent light, clipped at white, as its texture.
///
/// # Errors
/// As [`write_unwrapped`], or the light of the photographs cannot be solved.
pub fn write_scene(
    path: &Path,
    lit: &Arc<LitScene>,
    atlas: &Arc<Atlas>,
    shot: &Camera,
    steps: &dyn Steps,
) -> Result<(), RenderError> {
    let scene = lit.scene();
    if !is_captured(scene) {
        return write_unwrapped(path, scene, atlas, Some(shot), steps);
    }
    check_extension(path)?;
    let texture = match light_of_photographs(lit, steps)? {
        Some(light) => {
            let texture = light.texture(atlas);
            let texel = |light: &glam::Vec3| {
                let [r, g, b] = light.to_array().map(|v| eight_bits(srgb_from_linear(v.clamp(0.0, 1.0))));
                [r, g, b, u8::MAX]
            };
            let texels: Vec<[u8; 4]> = texture.pixels.par_iter().map(texel).collect();
            texture_png(texture.size, texels.as_flattened())
        }
        None => picture_png(scene),
    };
    let texture = texture.map_err(RenderError::Internal)?;
    let amend = |root: &mut Map<String, Value>| write_lens_extras(root, scene, shot);
    atlas::write_surface_glb(scene, atlas, &texture, path, &amend, &*steps.begin("writing"))
        .map_err(|error| atlas_error(path, error).into())
}

/// Unwraps the scene of `input` and writes it as by [`write_scene`], with the lens of its camera.
///
/// # Errors
/// There is no atlas, the scene's file cannot be read again, photographs cannot be read, or the file cannot be written.
pub fn export_glb(
    input: &Input,
    path: &Path,
    unwrap: &UnwrapOptions,
    steps: &dyn Steps,
) -> Result<(), RenderError> {
    let atlas = input.atlas(unwrap, steps)?;
    if !is_captured(&input.scene) {
        return write_unwrapped(path, &input.scene, &atlas, Some(&input.camera), steps);
    }
    check_extension(path)?;
    let lit = input.lit_scene()?;
    lit.set_atlas(&atlas);
    write_scene(path, &lit, &atlas, &input.camera, steps)
}

fn check_extension(path: &Path) -> Result<(), RenderError> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb")) {
        return Ok(());
    }
    Err(RenderError::bad_file(path, "unwrapped scenes are written as .glb (choose a name that ends in .glb)"))
}

/// Whether a scene is a capture, which has no glTF file.
fn is_captured(scene: &Scene) -> bool {
    scene.picture.is_some() || !scene.views.is_empty()
}

/// The texture of a surface that was made from a picture. Its atlas is the texture's UV set.
fn picture_png(scene: &Scene) -> Result<Vec<u8>, String> {
    let image =
        scene.images.first().ok_or("a surface from a picture has no texture (a bug in the program)")?;
    let brightest = scene.materials.first().map_or(1.0, |material| material.base_color.x);
    // Clipped at white.
    let encoded = |encoded: f32| {
        let linear = scene::linear_from_srgb(f64::from(encoded)) * brightest;
        eight_bits(srgb_from_linear(linear.clamp(0.0, 1.0)))
    };
    let rgba = |texel: [f32; 4]| {
        let [r, g, b, a] = texel;
        [encoded(r), encoded(g), encoded(b), eight_bits(a)]
    };
    let texels: Vec<[u8; 4]> = match &image.texels {
        ImageLevel::Bits8(all) => {
            all.as_chunks::<4>().0.par_iter().map(|t| rgba(t.map(|v| f32::from(v) / 255.0))).collect()
        }
        ImageLevel::Bits16(all) => {
            all.as_chunks::<4>().0.par_iter().map(|t| rgba(t.map(|v| f32::from(v) / 65535.0))).collect()
        }
        ImageLevel::Float(all) => {
            let encoded = |&[r, g, b, a]: &[f32; 4]| {
                rgba([srgb_from_linear(r), srgb_from_linear(g), srgb_from_linear(b), a])
            };
            all.as_chunks::<4>().0.par_iter().map(encoded).collect()
        }
    };
    texture_png([image.width, image.height], texels.as_flattened())
}

fn eight_bits(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}
