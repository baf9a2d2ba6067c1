//! VisualSFM's N-View Match files.
//!
//! ```text
//! NVM_V3
//! CAMERAS
//! name f qw qx qy qz cx cy cz r 0         each camera: rotation from the world to the camera, its centre
//! ```
//!
//! The camera's axes are computer vision's (y down, z forward); pixels are counted from the picture's middle; r undistorts what was
//! measured ([`lens::Projection::MeasuredRadial`]). Of several models the one with the most pictures counts. Points are not read.

use crate::CaptureError;
use crate::cameras::pose::from_center;
use crate::cameras::shot::{Focal, Shot, ShotLens, Shots};
use crate::files::text::{Lines, count, numbers, quoted};
use lens::{Distortion, Projection};
use std::path::Path;

/// Reads the pictures of a file.
pub(crate) fn read(file: &Path) -> Result<Shots, CaptureError> {
    let mut lines = Lines::open(file)?;
    let head = lines.next_filled()?.unwrap_or_default();
    if !head.starts_with("NVM_V3") {
        return Err(lines.malformed(format!("is {} instead of NVM_V3", quoted(&head))));
    }
    let mut best = Shots::default();
    let mut models = 0;
    // Each model: number of cameras, the cameras, number of points, the points.
    while let Some(line) = lines.next_filled()? {
        // What follows the models refers to PLY files.
        let Some(cameras) = count(&line).filter(|&cameras| cameras > 0) else { break };
        let mut shots = Shots::default();
        for _ in 0..cameras {
            let line = lines
                .next_filled()?
                .ok_or_else(|| lines.malformed(format!("the file ends within {cameras} cameras")))?;
            shots.shots.push(shot(&lines, &line)?);
        }
        models += 1;
        if shots.shots.len() > best.shots.len() {
            best = shots;
        }
        let Some(points) = lines.next_filled()? else { break };
        let points = count(&points).ok_or_else(|| lines.malformed("is not the number of points"))?;
        for _ in 0..points {
            if lines.next_filled()?.is_none() {
                break;
            }
        }
    }
    if models > 1 {
        best.notes.push(format!("has {models} models; the one with the most pictures is read"));
    }
    Ok(best)
}

/// The camera of a line. Names may have spaces, or quotes in place of them.
fn shot(lines: &Lines, line: &str) -> Result<Shot, CaptureError> {
    let mut fields: Vec<&str> = line.rsplitn(11, char::is_whitespace).collect();
    let name = if fields.len() == 11 { fields.pop().unwrap_or_default().trim() } else { "" };
    fields.reverse();
    let Some([focal, w, x, y, z, cx, cy, cz, r, _]) = numbers::<10>(&fields).filter(|_| !name.is_empty())
    else {
        return Err(lines.malformed(
            "does not have the name, focal length, rotation (4 numbers), centre (3), distortion and 0 of a camera",
        ));
    };
    let name = name.replace('"', " ");
    let Some(camera_to_world) = from_center([w, x, y, z], [cx, cy, cz]) else {
        return Err(
            lines.malformed(format!("picture {}: its rotation is not a unit quaternion", quoted(&name)))
        );
    };
    let (focal, projection) = (Focal::Pixels([focal; 2]), Projection::MeasuredRadial { r });
    let lens =
        ShotLens::OfAnySize { focal, principal_px: [None; 2], projection, distortion: Distortion::default() };
    Ok(Shot { name, place: format!("line {}", lines.number), lens, camera_to_world, mask: None })
}
