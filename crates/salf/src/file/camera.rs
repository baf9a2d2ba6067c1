//! Cameras in a `.salf` file.

use super::SalfFileError;
use super::little_endian::{
    FIRST_CAPACITY, bytes, read_f32s, read_f64s, read_text, write_f32s, write_f64s, write_text,
};
use glam::{DMat4, DVec2};
use lens::{Aperture, ApertureMask, ApertureShape, Camera, Character};
use std::io::{self, Read, Write};
use std::sync::Arc;

/// Writes a camera, little endian: width and height (u32); yfov, focus distance, aperture radius, sensor height,
/// shift (2), background (3; NaN if none was chosen), pose (16, by columns), aperture ratio (f64); shape (u8): 0
/// disc, 1 polygon with blades (u32), rotation and roundness (f64), 2 square, 3 mask with width and height (u32),
/// file (text) and a transmission a texel (f32).
///
/// # Errors
/// Errors of `to`.
pub fn write_camera(to: &mut impl Write, camera: &Camera) -> io::Result<()> {
    to.write_all(&camera.width.to_le_bytes())?;
    to.write_all(&camera.height.to_le_bytes())?;
    write_f64s(to, &[camera.yfov, camera.focus_distance, camera.aperture_radius, camera.sensor_height])?;
    write_f64s(to, &camera.shift.to_array())?;
    write_f64s(to, &camera.background.unwrap_or([f64::NAN; 3]))?;
    write_f64s(to, &camera.camera_to_world.to_cols_array())?;
    write_f64s(to, &[camera.aperture.ratio])?;
    match &camera.aperture.shape {
        ApertureShape::Disc => to.write_all(&[0]),
        ApertureShape::Polygon { blades, rotation, roundness } => {
            to.write_all(&[1])?;
            to.write_all(&blades.to_le_bytes())?;
            write_f64s(to, &[*rotation, *roundness])
        }
        ApertureShape::Square => to.write_all(&[2]),
        ApertureShape::Mask(mask) => {
            to.write_all(&[3])?;
            to.write_all(&mask.width.to_le_bytes())?;
            to.write_all(&mask.height.to_le_bytes())?;
            write_text(to, mask.file.as_bytes())?;
            write_f32s(to, &mask.transmission)
        }
    }
}

/// Reads a camera as [`write_camera`] writes it, and checks it.
///
/// # Errors
/// `from` cannot be read or ends too early, or the camera is not valid.
pub fn read_camera(from: &mut impl Read) -> Result<Camera, SalfFileError> {
    let width = u32::from_le_bytes(bytes(from)?);
    let height = u32::from_le_bytes(bytes(from)?);
    let [yfov, focus_distance, aperture_radius, sensor_height] = read_f64s(from)?;
    let shift = DVec2::from_array(read_f64s(from)?);
    let background: [f64; 3] = read_f64s(from)?;
    let camera_to_world = DMat4::from_cols_array(&read_f64s(from)?);
    let [ratio] = read_f64s(from)?;
    let [shape] = bytes(from)?;
    let shape = match shape {
        0 => ApertureShape::Disc,
        1 => {
            let blades = u32::from_le_bytes(bytes(from)?);
            let [rotation, roundness] = read_f64s(from)?;
            ApertureShape::Polygon { blades, rotation, roundness }
        }
        2 => ApertureShape::Square,
        3 => ApertureShape::Mask(Arc::new(read_mask(from)?)),
        other => return Err(SalfFileError::Damaged(format!("aperture shape {other}"))),
    };
    Ok(Camera {
        width,
        height,
        yfov,
        focus_distance,
        aperture_radius,
        sensor_height,
        shift,
        camera_to_world,
        background: (!background.iter().all(|channel| channel.is_nan())).then_some(background),
        aperture: Aperture { shape, ratio },
        // What a lens does beside focusing changes the picture alone.
        character: Character::default(),
    })
}

fn read_mask(from: &mut impl Read) -> Result<ApertureMask, SalfFileError> {
    let width = u32::from_le_bytes(bytes(from)?);
    let height = u32::from_le_bytes(bytes(from)?);
    let file = read_text(from)?;
    if width > Camera::LARGEST_SIDE_PX || height > Camera::LARGEST_SIDE_PX {
        return Err(SalfFileError::Damaged(format!("an aperture mask of {width} × {height}")));
    }
    let texels = width as u64 * height as u64;
    let mut transmission = Vec::with_capacity(texels.min(FIRST_CAPACITY) as usize);
    for _ in 0..texels {
        let [texel] = read_f32s(from)?;
        transmission.push(texel);
    }
    Ok(ApertureMask { width, height, transmission, file })
}
