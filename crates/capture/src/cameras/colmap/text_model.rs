//! COLMAP's text files.
//!
//! `images.txt` has two lines per picture: the pose, and the points that were detected in it. The second may be empty, and is dropped by
//! programs that remove empty lines; so a line is classified by its content.

use super::camera_model;
use super::records::{Cameras, Image};
use crate::CaptureError;
use crate::files::text::{Lines, count, number, numbers, quoted};
use std::path::Path;

/// Reads the lenses in `cameras.txt`.
pub(super) fn cameras(file: &Path) -> Result<Cameras, CaptureError> {
    let mut lines = Lines::open(file)?;
    let mut cameras = Cameras::new();
    while let Some(line) = lines.next_filled()? {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let [id, model, width, height, parameters @ ..] = &fields[..] else {
            return Err(
                lines.malformed("does not have the id, model, width, height and parameters of a camera")
            );
        };
        let id = count(id).and_then(|id| u32::try_from(id).ok());
        let id = id.ok_or_else(|| lines.malformed(format!("{} is not a camera id", quoted(fields[0]))))?;
        let size = [width, height].map(|side| count(side).and_then(|side| u32::try_from(side).ok()));
        let [Some(width), Some(height)] = size else {
            return Err(
                lines.malformed(format!("camera {id}: its width and height are not numbers of pixels"))
            );
        };
        let mut values = Vec::with_capacity(parameters.len());
        for parameter in parameters {
            let value = number(parameter);
            let what = || format!("camera {id}: its parameter {} is not a number", quoted(parameter));
            values.push(value.ok_or_else(|| lines.malformed(what()))?);
        }
        let lens = camera_model::lens(model, [width, height], &values);
        let lens = lens.map_err(|what| lines.malformed(format!("camera {id}: {what}")))?;
        if cameras.insert(id, lens).is_some() {
            return Err(lines.malformed(format!("camera {id} appears twice")));
        }
    }
    Ok(cameras)
}

/// Reads the pictures in `images.txt`, with notes on irregularities.
pub(super) fn images(file: &Path) -> Result<(Vec<Image>, Vec<String>), CaptureError> {
    let mut lines = Lines::open(file)?;
    let mut images = Vec::new();
    let (mut expects_points, mut without_points) = (false, 0);
    while let Some(line) = lines.next()? {
        if line.starts_with('#') {
            continue;
        }
        if expects_points {
            expects_points = false;
            if line.is_empty() || !is_pose(&line) {
                continue;
            }
            // The line of points was dropped.
            without_points += 1;
        }
        if line.is_empty() {
            continue;
        }
        images.push(image(&lines, &line)?);
        expects_points = true;
    }
    let note = format!(
        "the line of points is missing after {without_points} of {} pictures; COLMAP itself requires one, even if it is empty",
        images.len()
    );
    Ok((images, if without_points > 0 { vec![note] } else { Vec::new() }))
}

/// Whether a line is a picture's pose rather than its points: those are numbers in threes, and nothing else.
fn is_pose(line: &str) -> bool {
    let mut fields = line.split_whitespace();
    let is_head = fields.by_ref().take(9).filter(|field| number(field).is_some()).count() == 9;
    is_head && fields.next().is_some_and(|name| number(name).is_none())
}

/// The picture of a line: IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME; the name may have spaces.
fn image(lines: &Lines, line: &str) -> Result<Image, CaptureError> {
    let (mut fields, mut rest) = (Vec::with_capacity(9), line);
    while fields.len() < 9
        && let Some((field, after)) = rest.split_once(char::is_whitespace)
    {
        fields.push(field);
        rest = after.trim_start();
    }
    let name = rest;
    if fields.len() < 9 || name.is_empty() {
        let what =
            "does not have the id, rotation (4 numbers), translation (3), camera id and name of a picture";
        return Err(lines.malformed(what));
    }
    let wrong = |what: &str| lines.malformed(format!("picture {}: {what}", quoted(name)));
    let quaternion = numbers(&fields[1..5]).ok_or_else(|| wrong("its rotation is not 4 numbers"))?;
    let translation = numbers(&fields[5..8]).ok_or_else(|| wrong("its translation is not 3 numbers"))?;
    let camera = count(fields[8]).and_then(|id| u32::try_from(id).ok());
    let camera = camera.ok_or_else(|| wrong("its camera id is not a number"))?;
    Ok(Image { place: format!("line {}", lines.number), name: name.into(), camera, quaternion, translation })
}
