//! The header of a picture's file, and how it fits the camera that was computed for it.
//!
//! A picture is rotated by its EXIF orientation only if its camera's width and height are then those of the picture, and not those of the
//! stored pixels: programs differ in whether they rotate pictures, and the cameras show which they did.

use crate::files::exif::Exif;
use image::{ImageDecoder, Limits};
use lens::CalibratedLens;
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

/// Reads the size of a picture as it is stored, and its EXIF data.
pub(crate) fn read_header(file: &Path) -> Result<([u32; 2], Exif), String> {
    /// Enough for the EXIF data with its thumbnail and for profiles; if there is more, the whole file is read.
    const HEAD: u64 = 256 << 10;
    let mut bytes = Vec::new();
    let unreadable = |error: std::io::Error| format!("cannot be read: {error}");
    let mut input = File::open(file).map_err(unreadable)?;
    (&mut input).take(HEAD).read_to_end(&mut bytes).map_err(unreadable)?;
    if let Ok(header) = header_of(&bytes) {
        return Ok(header);
    }
    /// No picture within the limits is larger.
    const WHOLE: u64 = 512 << 20;
    input.take(WHOLE).read_to_end(&mut bytes).map_err(unreadable)?;
    header_of(&bytes).map_err(|error| format!("cannot be decoded: {error}").replace('\n', " "))
}

/// The same for the bytes of a picture.
pub(crate) fn header_of_bytes(bytes: &[u8]) -> Result<([u32; 2], Exif), String> {
    header_of(bytes).map_err(|error| format!("cannot be decoded: {error}").replace('\n', " "))
}

fn header_of(bytes: &[u8]) -> Result<([u32; 2], Exif), image::ImageError> {
    let mut decoder = scene::open_picture(Cursor::new(bytes), Limits::no_limits())?;
    let (width, height) = decoder.dimensions();
    let exif = decoder.exif_metadata().ok().flatten();
    Ok(([width, height], exif.map_or_else(Exif::default, |data| Exif::parse(&data))))
}

/// The lens scaled to a picture that is stored in this size, and the orientation to apply for it.
pub(crate) fn fit_lens(
    lens: CalibratedLens,
    stored: [u32; 2],
    exif_orientation: u8,
) -> Result<(CalibratedLens, u8), String> {
    let expected = lens.size_px();
    let [width, height] = stored;
    let turned = [height, width];
    // From 5 on width and height are swapped.
    let may_turn = exif_orientation >= 5;
    let resized = |size| lens.resized(size).map_err(|error| error.to_string());
    match () {
        () if stored == expected => Ok((lens, 1)),
        () if turned == expected && may_turn => Ok((lens, exif_orientation)),
        () if is_scaled(stored, expected) => Ok((resized(stored)?, 1)),
        () if is_scaled(turned, expected) && may_turn => Ok((resized(turned)?, exif_orientation)),
        () => Err(format!(
            "it is {width} × {height} px, its camera is for {} × {} px",
            expected[0], expected[1]
        )),
    }
}

/// Whether a size is another one scaled, up to a pixel of rounding.
fn is_scaled(size: [u32; 2], other: [u32; 2]) -> bool {
    let [width, height, of_width, of_height] = [size[0], size[1], other[0], other[1]].map(f64::from);
    // A pixel more or less on either side.
    (width * of_height - height * of_width).abs() <= of_width.max(of_height).max(width).max(height)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens() -> CalibratedLens {
        CalibratedLens::pinhole([600, 400], 500.0).unwrap()
    }

    #[test]
    fn pictures_are_turned_only_where_the_camera_requires_it() {
        let orientation = |stored, exif| fit_lens(lens(), stored, exif).map(|(_, orientation)| orientation);
        // As it is stored, whatever the EXIF data is: COLMAP since 3.7.
        assert_eq!(orientation([600, 400], 6), Ok(1));
        assert_eq!(orientation([600, 400], 3), Ok(1));
        // The camera is that of the rotated picture.
        assert_eq!(orientation([400, 600], 6), Ok(6));
        assert_eq!(orientation([400, 600], 8), Ok(8));
        // Nothing determines the direction.
        let error = orientation([400, 600], 1).unwrap_err();
        assert_eq!(error, "it is 400 × 600 px, its camera is for 600 × 400 px");
    }

    #[test]
    fn lenses_follow_pictures_that_were_made_smaller() {
        let focal =
            |stored, exif| fit_lens(lens(), stored, exif).map(|(lens, _)| lens.intrinsics().focal_px[0]);
        assert_eq!(focal([300, 200], 1), Ok(250.0));
        assert_eq!(focal([200, 300], 6), Ok(250.0));
        // 1/7 is 85.7 × 57.1.
        assert!(focal([86, 57], 1).is_ok() && focal([85, 57], 1).is_ok());
        assert!(focal([300, 220], 1).is_err());
    }
}
