//! COLMAP's binary files: little endian, counts of 64 bits, names that end with a zero.

use super::camera_model;
use super::records::{Cameras, Image};
use crate::CaptureError;
use crate::files::binary::Binary;
use std::path::Path;

/// Least bytes of a camera (fewest parameters), of a picture (shortest name, no points), and of a point in a picture.
const CAMERA_BYTES: u64 = 4 + 4 + 8 + 8 + 2 * 8;
const IMAGE_BYTES: u64 = 4 + 7 * 8 + 4 + 1 + 8;
const POINT_BYTES: u64 = 8 + 8 + 8;

/// Reads the lenses in `cameras.bin`.
pub(super) fn cameras(file: &Path) -> Result<Cameras, CaptureError> {
    let mut binary = Binary::open(file)?;
    let mut cameras = Cameras::new();
    for _ in 0..binary.count(CAMERA_BYTES, "cameras")? {
        let id = binary.u32("a camera")?;
        let number = binary.u32("a camera")? as i32;
        let Some((model, parameters)) = camera_model::from_number(number) else {
            return Err(binary.malformed(format!("camera {id}: the camera model {number} is not supported")));
        };
        let size = [binary.u64("a camera")?, binary.u64("a camera")?].map(u32::try_from);
        let [Ok(width), Ok(height)] = size else {
            return Err(
                binary.malformed(format!("camera {id}: its width and height are not numbers of pixels"))
            );
        };
        let mut values = Vec::with_capacity(parameters);
        for _ in 0..parameters {
            values.push(binary.f64(&format!("a parameter of camera {id}"))?);
        }
        let lens = camera_model::lens(model, [width, height], &values);
        let lens = lens.map_err(|what| binary.malformed(format!("camera {id}: {what}")))?;
        if cameras.insert(id, lens).is_some() {
            return Err(binary.malformed(format!("camera {id} appears twice")));
        }
    }
    Ok(cameras)
}

/// Reads the pictures in `images.bin`.
pub(super) fn images(file: &Path) -> Result<Vec<Image>, CaptureError> {
    let mut binary = Binary::open(file)?;
    let mut images = Vec::new();
    for _ in 0..binary.count(IMAGE_BYTES, "pictures")? {
        let id = binary.u32("a picture")?;
        let quaternion = binary.f64s(&format!("the rotation of picture {id}"))?;
        let translation = binary.f64s(&format!("the translation of picture {id}"))?;
        let camera = binary.u32(&format!("picture {id}"))?;
        let name = binary.text(&format!("the name of picture {id}"))?;
        let points = binary.count(POINT_BYTES, "points in a picture")?;
        binary.skip(points * POINT_BYTES)?;
        images.push(Image { place: format!("picture {id}"), name, camera, quaternion, translation });
    }
    Ok(images)
}
