//! The camera parameters of a light field: `parameters.cfg` of the 4D Light Field Benchmark.
//! (Honauer et al., *A Dataset and Evaluation Methodology for Depth Estimation on 4D Light Fields*, 2016.)

use crate::CaptureError;
use crate::files::text::{Lines, number, quoted};
use std::path::Path;

/// The camera parameters of a light field; unknown ones are `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Optics {
    /// Focal length of each view's lens, mm.
    pub focal_length_mm: Option<f64>,
    /// The sensor's longer side, mm.
    pub sensor_size_mm: Option<f64>,
    /// Distance between neighbouring views, mm.
    pub baseline_mm: Option<f64>,
    /// Distance of disparity 0, m.
    pub focus_distance_m: Option<f64>,
    /// The least and the greatest disparity, px.
    pub disparity_range: Option<[f64; 2]>,
    /// Columns and rows of the grid.
    pub grid: Option<[u32; 2]>,
}

impl Optics {
    /// The disparity of a distance along the axis, in pixels of pictures whose longer side is `longer_side` pixels; `None` if parameters are
    /// missing.
    ///
    /// ```text
    /// d = b·f·n/s · (1/z − 1/z₀)
    /// ```
    ///
    /// | symbol | meaning | unit |
    /// | --- | --- | --- |
    /// | b, f, s | baseline, focal length, sensor's longer side | mm |
    /// | n | pixels along it | px |
    /// | z, z₀ | distance, focus distance | mm here, m as arguments |
    pub fn disparity(&self, distance_m: f64, longer_side: u32) -> Option<f64> {
        let (b, f, s) = (self.baseline_mm?, self.focal_length_mm?, self.sensor_size_mm?);
        let per_inverse = b * f * f64::from(longer_side) / s;
        Some(per_inverse * ((1e3 * distance_m).recip() - (1e3 * self.focus_distance_m?).recip()))
    }
}

/// Reads `parameters.cfg`: `key = value`, in sections whose names are ignored.
pub(super) fn read_parameters(file: &Path) -> Result<Optics, CaptureError> {
    let mut optics = Optics::default();
    let (mut low, mut high) = (None, None);
    let mut grid = [None; 2];
    let mut lines = Lines::open(file)?;
    while let Some(line) = lines.next_filled()? {
        let Some((key, text)) = line.split_once(['=', ':']) else { continue };
        let (key, text) = (key.trim(), text.trim());
        let value = || {
            number(text).ok_or_else(|| lines.malformed(format!("{key} is {}, not a number", quoted(text))))
        };
        let positive = || {
            let value = value()?;
            if value > 0.0 {
                Ok(value)
            } else {
                Err(lines.malformed(format!("{key} is {value}, and has to be above 0")))
            }
        };
        let count = || {
            let count =
                text.parse().ok().filter(|count| (1..=super::numbered_grid::MAX_SIDE).contains(count));
            count.ok_or_else(|| lines.malformed(format!("{key} is {}, not a number of views", quoted(text))))
        };
        match key {
            "focal_length_mm" => optics.focal_length_mm = Some(positive()?),
            "sensor_size_mm" => optics.sensor_size_mm = Some(positive()?),
            "baseline_mm" => optics.baseline_mm = Some(positive()?),
            "focus_distance_m" => optics.focus_distance_m = Some(positive()?),
            "disp_min" => low = Some(value()?),
            "disp_max" => high = Some(value()?),
            "num_cams_x" => grid[0] = Some(count()?),
            "num_cams_y" => grid[1] = Some(count()?),
            _ => {}
        }
    }
    optics.disparity_range = low.zip(high).map(|(low, high)| [low, high]).filter(|[low, high]| low <= high);
    optics.grid = grid[0].zip(grid[1]).map(|(columns, rows)| [columns, rows]);
    Ok(optics)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_of_the_benchmark() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("parameters.cfg");
        let text = "[intrinsics]\nfocal_length_mm = 100.0\nsensor_size_mm = 35.0\n[extrinsics]\nnum_cams_x = 9\nnum_cams_y = 9\nbaseline_mm = 11.0\n\
            focus_distance_m = 2.3\n[meta]\nscene = kitchen\ndisp_min = -1.6\ndisp_max = 1.8\n";
        std::fs::write(&file, text).unwrap();
        let optics = read_parameters(&file).unwrap();
        assert_eq!((optics.grid, optics.disparity_range), (Some([9, 9]), Some([-1.6, 1.8])));
        // The focus distance has none; infinity has the file's `offset`, 6.996…
        assert!(optics.disparity(2.3, 512).unwrap().abs() < 1e-12);
        assert!((optics.disparity(f64::INFINITY, 512).unwrap() + 6.9963).abs() < 1e-3);
        for (wrong, message) in [
            ("baseline_mm = 0", "line 1: baseline_mm is 0, and has to be above 0"),
            ("\nnum_cams_x = 1000000", "line 2: num_cams_x is \"1000000\", not a number of views"),
            ("focal_length_mm = x", "line 1: focal_length_mm is \"x\", not a number"),
        ] {
            std::fs::write(&file, wrong).unwrap();
            let text = read_parameters(&file).unwrap_err().to_string();
            assert!(text.contains(message), "{text}");
        }
        assert_eq!(Optics::default().disparity(1.0, 512), None);
    }
}
