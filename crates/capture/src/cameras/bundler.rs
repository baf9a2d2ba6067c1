//! Bundler's `bundle.out` and the list of pictures next to it.
//!
//! ```text
//! # Bundle file v0.3
//! CAMERAS POINTS
//! f k1 k2                         each camera; f = 0: none was found
//! R                               3 rows, from the world to the camera
//! t
//! ```
//!
//! The camera's axes are glTF's (x right, y up, looks down −z); pixels are counted from the picture's middle. Points are not read.

use crate::CaptureError;
use crate::cameras::pose::{Axes, from_camera_to_world};
use crate::cameras::shot::{Focal, Shot, ShotLens, Shots};
use crate::files::text::{Lines, count, numbers};
use glam::{DMat3, DMat4, DVec3};
use lens::{Distortion, Projection};
use std::path::Path;

/// Reads the pictures of `bundle`, whose names are the lines of `list`.
pub(crate) fn read(bundle: &Path, list: &Path) -> Result<Shots, CaptureError> {
    let names = names(list)?;
    let mut lines = Lines::open(bundle)?;
    let head = lines.next_filled()?.unwrap_or_default();
    let cameras = head.split_whitespace().next().and_then(count);
    let cameras = cameras.ok_or_else(|| lines.malformed("is not the number of cameras and points"))?;
    if cameras != names.len() as u64 {
        let list = list.file_name().unwrap_or_default().to_string_lossy();
        return Err(
            lines.malformed(format!("declares {cameras} cameras, but {list} has {} pictures", names.len()))
        );
    }
    let mut shots = Shots::default();
    for name in names {
        let [focal, k1, k2] = row(&mut lines, &name, "f, k1, k2")?;
        let place = format!("line {}", lines.number);
        let rows = [row(&mut lines, &name, "R")?, row(&mut lines, &name, "R")?, row(&mut lines, &name, "R")?];
        let translation = DVec3::from(row(&mut lines, &name, "t")?);
        if focal == 0.0 {
            shots.without_camera.push(name);
            continue;
        }
        let from_camera = DMat3::from_cols_array_2d(&rows);
        let camera_to_world = DMat4::from_mat3_translation(from_camera, from_camera * -translation);
        let Some(camera_to_world) = from_camera_to_world(camera_to_world, Axes::Gltf) else {
            return Err(lines.malformed(format!("picture {name:?}: its R is not a rotation")));
        };
        let focal = Focal::Pixels([focal; 2]);
        let (projection, distortion) = (Projection::Perspective, Distortion::radial(&[k1, k2]));
        let lens = ShotLens::OfAnySize { focal, principal_px: [None; 2], projection, distortion };
        shots.shots.push(Shot { name, place, lens, camera_to_world, mask: None });
    }
    Ok(shots)
}

/// Three numbers of a camera.
fn row(lines: &mut Lines, name: &str, what: &str) -> Result<[f64; 3], CaptureError> {
    let line = lines.next_filled()?.unwrap_or_default();
    let fields: Vec<&str> = line.split_whitespace().collect();
    numbers(&fields)
        .ok_or_else(|| lines.malformed(format!("picture {name:?}: does not have the 3 numbers of {what}")))
}

/// The names in a list of pictures: lines that may end with a 0 and a focal length.
fn names(list: &Path) -> Result<Vec<String>, CaptureError> {
    let mut lines = Lines::open(list)?;
    let mut names = Vec::new();
    while let Some(line) = lines.next_filled()? {
        let fields: Vec<&str> = line.rsplitn(3, char::is_whitespace).collect();
        let name = match fields[..] {
            [focal, "0", name] if crate::files::text::number(focal).is_some() => name.trim_end(),
            _ => &line,
        };
        names.push(name.to_owned());
    }
    Ok(names)
}
