//! Equirectangular pictures of light from infinity: `.hdr` or `.exr`.

use crate::ProjectError;
use crate::disk::extension;
use crate::pictures::linear_picture::read_picture_mended;
use scene::EnvironmentMap;
use std::path::Path;

/// Infinite radiance counts as the largest half: what is infinite in a file of halves was too bright for them.
const BRIGHTEST: f32 = 65504.0;

/// Reads an equirectangular picture; also returns warnings about pixels that are no radiance.
///
/// # Errors
/// It is not a picture, has another format, or is not about twice as wide as high.
pub(crate) fn read_environment(file: &Path) -> Result<(EnvironmentMap, Vec<String>), ProjectError> {
    if !["hdr", "exr"].contains(&extension(file).as_str()) {
        let cure = "give an equirectangular .hdr or .exr";
        return Err(ProjectError::content(file, "is not an environment", cure));
    }
    let mut faults = Faults::default();
    let picture = read_picture_mended(file, |texel| faults.mend(texel))?;
    let aspect = f64::from(picture.width) / f64::from(picture.height.max(1));
    if !(1.9..=2.1).contains(&aspect) {
        let problem = format!(
            "has {} × {} pixels, an equirectangular picture is twice as wide as high",
            picture.width, picture.height
        );
        return Err(ProjectError::content(file, problem, "give one that shows all directions"));
    }
    // Where the file has other primaries, a colour may lie outside those of Rec. 709, which is no fault.
    let texels = picture.rgb.into_iter().map(|texel| texel.map(|channel| channel.max(0.0))).collect();
    let map = EnvironmentMap {
        name: file.to_string_lossy().into_owned(),
        width: picture.width,
        height: picture.height,
        texels,
    };
    Ok((map, faults.warnings(file)))
}

/// How many texels are no radiance, in any of their channels.
#[derive(Debug, Default)]
struct Faults {
    infinite: u64,
    undefined: u64,
    negative: u64,
}

impl Faults {
    /// Makes a texel a radiance, and counts what was wrong with it.
    fn mend(&mut self, texel: &mut [f32; 3]) {
        let has = |is_fault: fn(f32) -> bool| u64::from(texel.iter().any(|channel| is_fault(*channel)));
        self.infinite += has(|channel| channel == f32::INFINITY);
        self.undefined += has(f32::is_nan);
        self.negative += has(|channel| channel < 0.0);
        for channel in texel {
            *channel = match *channel {
                f32::INFINITY => BRIGHTEST,
                radiance if radiance > 0.0 => radiance,
                _ => 0.0,
            };
        }
    }

    fn warnings(&self, file: &Path) -> Vec<String> {
        let faults = [
            (
                self.infinite,
                "infinite",
                "as 65504, the largest half (a sun is then darker than it was; write the sky in 32-bit floats)",
            ),
            (self.undefined, "not a number", "as 0 (write the sky again)"),
            (self.negative, "negative", "as 0"),
        ];
        let warning = |(count, what, treated): (u64, &str, &str)| {
            let pixels = match count {
                0 => return None,
                1 => "1 pixel is",
                _ => &format!("{count} pixels are"),
            };
            let counts = if count == 1 { "counts" } else { "count" };
            Some(format!("{}: {pixels} {what} and {counts} {treated}", file.display()))
        };
        faults.into_iter().filter_map(warning).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color_space::ColorSpace;
    use crate::openexr::image::{ExrImage, write_exr};
    use crate::openexr::options::ExrOptions;
    use std::fs;

    /// A sky of 4 × 2 texels, written with these options.
    fn sky(texels: [[f32; 3]; 8], form: ExrOptions) -> (EnvironmentMap, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("sky.exr");
        let channel = |c: usize| texels.iter().map(|texel| texel[c]).collect();
        let channels = [("R".into(), channel(0)), ("G".into(), channel(1)), ("B".into(), channel(2))];
        let exr = ExrImage { width: 4, height: 2, channels: channels.into(), ..Default::default() };
        write_exr(&file, exr, form).unwrap();
        read_environment(&file).unwrap()
    }

    #[test]
    fn they_are_read_row_by_row() {
        let texels = std::array::from_fn(|k| [k as f32, 0.5, 1e6]);
        let (map, warnings) = sky(texels, ExrOptions::default());
        assert_eq!((map.width, map.height, map.texels), (4, 2, texels.to_vec()));
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn what_is_no_radiance_is_mended_and_told() {
        let mut texels = [[1.0; 3]; 8];
        texels[1] = [f32::INFINITY, 2.0, f32::INFINITY];
        texels[2] = [f32::NAN, 2.0, f32::INFINITY];
        texels[3] = [-1.0, f32::NEG_INFINITY, 2.0];
        texels[4] = [-0.0, 1e6, 0.0];
        let (map, warnings) = sky(texels, ExrOptions::default());
        assert_eq!(map.texels[1], [65504.0, 2.0, 65504.0]);
        assert_eq!(map.texels[2..5], [[0.0, 2.0, 65504.0], [0.0, 0.0, 2.0], [0.0, 1e6, 0.0]]);
        assert_eq!(map.texels[5..], [[1.0; 3]; 3]);
        assert_eq!(warnings.len(), 3, "{warnings:?}");
        assert!(warnings[0].contains("sky.exr: 2 pixels are infinite and count as 65504"), "{warnings:?}");
        assert!(warnings[1].contains("1 pixel is not a number and counts as 0"), "{warnings:?}");
        assert!(warnings[2].contains("1 pixel is negative and counts as 0"), "{warnings:?}");
    }

    #[test]
    fn an_infinite_sun_of_other_primaries_stays_a_sun() {
        let texels = [[f32::INFINITY; 3]; 8];
        let form = ExrOptions { color_space: Some(ColorSpace::AcesCg), ..ExrOptions::default() };
        let (map, _) = sky(texels, form);
        assert!(map.texels.iter().flatten().all(|channel| (channel / 65504.0 - 1.0).abs() < 1e-3));
    }

    #[test]
    fn radiance_files_of_any_program() {
        let folder = tempfile::tempdir().unwrap();
        let read = |head: &str| {
            let file = folder.path().join("sky.HDR");
            let pixels = (0..8u8).flat_map(|k| [128 + k, 2, 0, 128]);
            fs::write(&file, head.bytes().chain(pixels).collect::<Vec<u8>>()).unwrap();
            read_environment(&file)
        };
        let (expected, _) = read("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n").unwrap();
        assert_eq!(expected.texels[3], [131.0 / 256.0, 2.0 / 256.0, 0.0]);
        let (other, warnings) = read("#?RGBE\r\nEXPOSURE=1\r\n\r\n-Y 2 +X 4\r\n").unwrap();
        assert!(other == expected && warnings.is_empty());
        let (turned, _) = read("#?RGBE\n\n+Y 2 +X 4\n").unwrap();
        assert_eq!(turned.texels, [&expected.texels[4..], &expected.texels[..4]].concat());
        let error = read("#?RGBE\nFORMAT=32-bit_rle_xyze\n\n-Y 2 +X 4\n").unwrap_err().to_string();
        assert!(error.contains("sky.HDR") && error.contains("CIE XYZ"), "{error}");
    }
}
