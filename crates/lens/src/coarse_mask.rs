//! Downsampling large aperture pictures.

use crate::{Aperture, ApertureMask, ApertureShape};
use std::borrow::Cow;
use std::sync::Arc;

impl Aperture {
    /// The aperture with a mask of at most `side` × `side` texels, each the mean of the texels that it replaces;
    /// unchanged if it is no larger. The light that passes any whole texel of it is unchanged.
    pub fn coarsened(&self, side: u32) -> Cow<'_, Self> {
        match &self.shape {
            ApertureShape::Mask(mask) if mask.width > side || mask.height > side => {
                let shape = ApertureShape::Mask(Arc::new(mask.coarsened(side)));
                Cow::Owned(Self { shape, ratio: self.ratio })
            }
            _ => Cow::Borrowed(self),
        }
    }
}

impl ApertureMask {
    fn coarsened(&self, side: u32) -> Self {
        let [width, height] = [self.width, self.height].map(|texels| texels.min(side).max(1));
        let edge = |k: u32, count: u32| 2.0 * f64::from(k) / f64::from(count) - 1.0;
        let texel = |k: u32| {
            let (row, column) = (k / width, k % width);
            let u = [column, column + 1].map(|k| edge(k, width));
            let v = [row + 1, row].map(|k| -edge(k, height));
            self.mean(u, v) as f32
        };
        let transmission = (0..width * height).map(texel).collect();
        Self { width, height, transmission, file: self.file.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarser_mask_passes_the_same_light_in_the_same_rows() {
        // Brighter toward the upper right, and not of a size that divides.
        let (width, height) = (90, 70);
        let texel = |k: u32| (k % width) as f32 / width as f32 * (1.0 - (k / width) as f32 / height as f32);
        let transmission = (0..width * height).map(texel).collect();
        let mask = ApertureMask { width, height, transmission, file: "ramp".into() };
        let aperture = Aperture::from(ApertureShape::Mask(Arc::new(mask)));
        let coarse = aperture.coarsened(32);
        let area_of = |aperture: &Aperture, row: usize| {
            let rows = aperture.rows(8);
            rows.rows[row].runs.iter().map(|run| (run.end - run.start) * run.transmission).sum::<f64>()
        };
        for row in 0..8 {
            assert!((area_of(&aperture, row) - area_of(&coarse, row)).abs() < 1e-6, "row {row}");
        }
        assert!(matches!(aperture.coarsened(90), Cow::Borrowed(_)));
        assert!(matches!(&coarse.shape, ApertureShape::Mask(mask) if (mask.width, mask.height) == (32, 32)));
    }
}
