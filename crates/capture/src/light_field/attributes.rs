//! `attributes.dat` and `depth.bin` of the older light fields of HCI.
//!
//! ```text
//! d = dH·f/z − shift        where f = 0 the file holds d itself
//! ```
//!
//! | symbol | `attributes.dat` | unit |
//! | --- | --- | --- |
//! | z | `depth.bin`, little-endian floats, row by row | that of f·dH |
//! | dH, f, shift | `dH`, `focalLength`, `shift` | px per view at distance f, –, px |
//!
//! (Wanner, Meister and Goldluecke, *Datasets and Benchmarks for Densely Sampled 4D Light Fields*, 2013.)

use crate::CaptureError;
use crate::depth_map::{DepthMap, DepthMeaning, raw_floats};
use crate::files::text::{Lines, number, quoted};
use scene::LoadOptions;
use std::path::Path;

/// The content of `attributes.dat`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Attributes {
    /// Columns and rows of each picture.
    pub size: Option<[u32; 2]>,
    pub base: f64,
    pub shift: f64,
    pub focal_length: f64,
    /// The least and the greatest disparity, px.
    pub range: Option<[f64; 2]>,
}

/// Reads `attributes.dat`: a number, then its name as a comment.
pub(super) fn read_attributes(file: &Path) -> Result<Attributes, CaptureError> {
    let mut lines = Lines::open(file)?;
    let mut attributes = Attributes::default();
    let (mut size, mut range) = ([None; 2], [None; 2]);
    while let Some(line) = lines.next_filled()? {
        let Some((text, name)) = line.split_once("//") else { continue };
        let (text, name) = (text.trim(), name.trim());
        let name = name.split(|c: char| c.is_whitespace() || c == '=').next().unwrap_or_default();
        let value = || {
            number(text).ok_or_else(|| lines.malformed(format!("{name} is {}, not a number", quoted(text))))
        };
        let side = || {
            let side = text.parse().ok().filter(|side| (1..=32768).contains(side));
            side.ok_or_else(|| lines.malformed(format!("{name} is {}, not a width or height", quoted(text))))
        };
        match name {
            "xRes" => size[0] = Some(side()?),
            "yRes" => size[1] = Some(side()?),
            "dH" => attributes.base = value()?,
            "shift" => attributes.shift = value()?,
            "focalLength" => attributes.focal_length = value()?,
            "min_disp" => range[0] = Some(value()?),
            "max_disp" => range[1] = Some(value()?),
            _ => {}
        }
    }
    attributes.size = size[0].zip(size[1]).map(|(width, height)| [width, height]);
    attributes.range = range[0].zip(range[1]).map(|(low, high)| [low, high]);
    Ok(attributes)
}

impl Attributes {
    /// The disparity map in `depth.bin`, for pictures of `size` if `attributes.dat` does not specify one.
    ///
    /// # Errors
    /// The file cannot be read, is of another size, or exceeds the limits of `options`.
    pub fn disparity(
        &self,
        file: &Path,
        size: [u32; 2],
        options: &LoadOptions,
    ) -> Result<DepthMap, CaptureError> {
        let [width, height] = self.size.unwrap_or(size);
        let pixels = u64::from(width) * u64::from(height);
        let limit = options.max_texels.min(options.max_memory / 16);
        if pixels > limit {
            let what = format!("has {width} × {height} px, more than the limit of {limit} px");
            return Err(CaptureError::TooBig { file: file.into(), what });
        }
        let mut values = raw_floats(file, [width, height], options.max_memory / 2)?;
        let finite_or_nan = |value: f32| if value.is_finite() { value } else { f32::NAN };
        for value in &mut values {
            *value = finite_or_nan(match self.focal_length {
                0.0 => *value,
                focal if *value > 0.0 => (self.base * focal / f64::from(*value) - self.shift) as f32,
                _ => f32::NAN,
            });
        }
        let map = DepthMap { width, height, values, meaning: DepthMeaning::Disparity };
        match map.range() {
            Some(_) => Ok(map),
            None => Err(CaptureError::malformed(
                file,
                "all pixels",
                "none has a value (all are 0, NaN or infinite)",
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_and_disparities() {
        let folder = tempfile::tempdir().unwrap();
        let [file, bin] = ["attributes.dat", "depth.bin"].map(|name| folder.path().join(name));
        let write = |text: &str| std::fs::write(&file, text).unwrap();
        write(
            "2 //xRes\n1 //yRes\n6.144000e+002 //dH\n288 //shift\n9.375000 //focalLength => a comment\n-10 //min_disp\n16 //max_disp\n",
        );
        let attributes = read_attributes(&file).unwrap();
        assert_eq!((attributes.size, attributes.range), (Some([2, 1]), Some([-10.0, 16.0])));
        std::fs::write(&bin, [20.0f32, 0.0].map(f32::to_le_bytes).concat()).unwrap();
        let map = attributes.disparity(&bin, [9, 9], &LoadOptions::default()).unwrap();
        assert!(
            map.values[0].abs() < 1e-4 && map.values[1].is_nan(),
            "614.4 · 9.375 / 20 = 288: {:?}",
            map.values
        );
        write("0 //focalLength\n");
        let map = read_attributes(&file).unwrap().disparity(&bin, [2, 1], &LoadOptions::default()).unwrap();
        assert_eq!(map.values, [20.0, 0.0]);
        let text = attributes.disparity(&file, [2, 1], &LoadOptions::default()).unwrap_err().to_string();
        assert!(text.contains("2 × 1 px take 8 bytes"), "{text}");
        write("\n0 //xRes\n");
        assert!(
            read_attributes(&file).unwrap_err().to_string().contains("line 2: xRes is \"0\", not a width")
        );
    }
}
