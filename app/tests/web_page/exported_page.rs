//! Reads what an exported page holds.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::{ImageFormat, RgbImage};
use serde_json::Value;
use std::path::Path;

/// A page that was exported.
pub struct ExportedPage {
    pub html: String,
    /// What its viewer shows.
    pub data: Value,
}

/// A slice.
pub struct Shown {
    pub inverse_distance: f64,
    pub picture: RgbImage,
}

impl ExportedPage {
    pub fn read(file: &Path) -> Self {
        let html = std::fs::read_to_string(file).unwrap();
        let (_, data) = html.rsplit_once("\nshowPage(").unwrap();
        let (data, _) = data.split_once(");\n</script>").unwrap();
        Self { data: serde_json::from_str(data).unwrap(), html }
    }

    /// What is shown first; its picture is in the document.
    pub fn opening(&self) -> Shown {
        let [stack, slice] =
            ["stack", "slice"].map(|name| self.data["opening"][name].as_u64().unwrap() as usize);
        assert_eq!(self.data["stacks"][stack]["slices"][slice], Value::Null);
        self.slice(stack, slice)
    }

    pub fn slice(&self, stack: usize, slice: usize) -> Shown {
        let stack = &self.data["stacks"][stack];
        let poster = self.html.split_once("id=\"poster\" src=\"data:image/webp;base64,").unwrap().1;
        let poster = poster.split_once('"').unwrap().0;
        let webp = STANDARD.decode(stack["slices"][slice].as_str().unwrap_or(poster)).unwrap();
        Shown {
            inverse_distance: stack["inverseDistances"][slice].as_f64().unwrap(),
            picture: image::load_from_memory_with_format(&webp, ImageFormat::WebP).unwrap().to_rgb8(),
        }
    }

    /// The slice nearest to a reciprocal distance.
    pub fn nearest_slice(&self, stack: usize, inverse_distance: f64) -> usize {
        let distances = self.data["stacks"][stack]["inverseDistances"].as_array().unwrap();
        let off = |index: &usize| (distances[*index].as_f64().unwrap() - inverse_distance).abs();
        (0..distances.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()
    }
}

/// The PSNR of two pictures of one size, 8-bit sRGB, dB.
pub fn psnr(a: &RgbImage, b: &RgbImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let squares = a.iter().zip(b.iter()).map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2));
    let mean_square = squares.sum::<f64>() / a.as_raw().len() as f64;
    numerics::psnr(mean_square / 255f64.powi(2))
}
