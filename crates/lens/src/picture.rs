//! The output of a camera: radiance and coverage per pixel.

/// How the model's sum becomes the displayed picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Exposure {
    /// The model as it is: radiance is conserved, and a uniform wall is not uniform at steps of its paint.
    Conserve,
    /// Radiance over coverage: a white scene stays white.
    #[default]
    Normalise,
}

impl Exposure {
    /// What a pixel's radiance is multiplied by, where it is shown with this gain and has this coverage. What nothing covers is black.
    #[inline(always)]
    pub fn scale(self, gain: f32, coverage: f32) -> f32 {
        match self {
            Self::Conserve => gain,
            Self::Normalise if coverage > 0.0 => gain / coverage,
            Self::Normalise => 0.0,
        }
    }
}

/// The sum of the model over a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width, px.
    pub width: u32,
    /// Height, px.
    pub height: u32,
    /// Linear RGB per pixel, row 0 on top, conserved (not divided by coverage).
    pub radiance: Vec<[f32; 3]>,
    /// The same sum for a scene of radiance 1, over the lens's falloff where it has one: 1 everywhere in a standard picture.
    pub coverage: Vec<f32>,
    /// That of red and blue where the lens focuses colours unlike (see [`Character`](crate::Character)); `coverage` is then green's.
    pub colour_coverage: Option<Vec<[f32; 2]>>,
}

impl Picture {
    /// A black picture with zero coverage, of `width` columns and `height` rows.
    pub fn black(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            width,
            height,
            radiance: vec![[0.0; 3]; pixels],
            coverage: vec![0.0; pixels],
            colour_coverage: None,
        }
    }

    /// The picture averaged over blocks of `side` × `side` pixels; its sides must be multiples of `side`.
    pub fn averaged(&self, side: u32) -> Self {
        assert!(side > 0 && self.width.is_multiple_of(side) && self.height.is_multiple_of(side));
        let mut mean = Self::black(self.width / side, self.height / side);
        let share = 1.0 / (side * side) as f32;
        for (row, (radiance, coverage)) in self
            .radiance
            .chunks(self.width as usize)
            .zip(self.coverage.chunks(self.width as usize))
            .enumerate()
        {
            let first = row / side as usize * mean.width as usize;
            for (column, (rgb, covered)) in radiance.iter().zip(coverage).enumerate() {
                let at = first + column / side as usize;
                (0..3).for_each(|c| mean.radiance[at][c] += share * rgb[c]);
                mean.coverage[at] += share * covered;
            }
        }
        mean.colour_coverage = self.colour_coverage.as_ref().map(|colours| {
            let mut means = vec![[0.0; 2]; mean.coverage.len()];
            for (k, colour) in colours.iter().enumerate() {
                let (row, column) = (k / self.width as usize, k % self.width as usize);
                let at = row / side as usize * mean.width as usize + column / side as usize;
                (0..2).for_each(|c| means[at][c] += share * colour[c]);
            }
            means
        });
        mean
    }

    /// The coverage of red, green and blue of the pixel with this index.
    #[inline]
    pub fn coverage_of_colours(&self, pixel: usize) -> [f32; 3] {
        let green = self.coverage[pixel];
        match &self.colour_coverage {
            Some(colours) => [colours[pixel][0], green, colours[pixel][1]],
            None => [green; 3],
        }
    }

    /// The picture with one coverage for all colours, and the same [`Exposure::Normalise`]: where their coverages differ, red and blue
    /// are scaled by green's over theirs.
    pub fn with_common_coverage(mut self) -> Self {
        if let Some(colours) = self.colour_coverage.take() {
            for ((rgb, green), [red, blue]) in self.radiance.iter_mut().zip(&self.coverage).zip(colours) {
                for (c, own) in [(0, red), (2, blue)] {
                    rgb[c] = if own > 0.0 { rgb[c] * (green / own) } else { 0.0 };
                }
            }
        }
        self
    }

    /// The picture's linear RGB under `exposure`, row by row from the top. [`Exposure::Normalise`] leaves pixels
    /// without coverage black.
    pub fn exposed(&self, exposure: Exposure) -> Vec<[f32; 3]> {
        match exposure {
            Exposure::Conserve => self.radiance.clone(),
            Exposure::Normalise if self.colour_coverage.is_some() => {
                let over = |light: f32, covered: f32| if covered > 0.0 { light / covered } else { 0.0 };
                let pixel = |(k, [r, g, b]): (usize, &[f32; 3])| {
                    let covered = self.coverage_of_colours(k);
                    [over(*r, covered[0]), over(*g, covered[1]), over(*b, covered[2])]
                };
                self.radiance.iter().enumerate().map(pixel).collect()
            }
            Exposure::Normalise => self
                .radiance
                .iter()
                .zip(&self.coverage)
                .map(|(rgb, &coverage)| if coverage > 0.0 { rgb.map(|c| c / coverage) } else { [0.0; 3] })
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_averaged_by_squares() {
        let mut fine = Picture::black(6, 4);
        for (k, (rgb, coverage)) in fine.radiance.iter_mut().zip(&mut fine.coverage).enumerate() {
            (*rgb, *coverage) = ([k as f32, 2.0 * k as f32, 0.0], 1.0);
        }
        let mean = fine.averaged(2);
        assert_eq!((mean.width, mean.height), (3, 2));
        // Of 0, 1, 6 and 7; and of 16, 17, 22 and 23.
        assert_eq!((mean.radiance[0], mean.radiance[5]), ([3.5, 7.0, 0.0], [19.5, 39.0, 0.0]));
        assert!(mean.coverage.iter().all(|&coverage| coverage == 1.0));
        assert!(fine.averaged(1) == fine);
    }

    #[test]
    fn colours_have_their_own_coverage() {
        let pixel = Picture {
            radiance: vec![[1.0, 2.0, 3.0]; 4],
            coverage: vec![2.0; 4],
            colour_coverage: Some(vec![[0.5, 0.0]; 4]),
            ..Picture::black(2, 2)
        };
        let normalised = vec![[2.0, 1.0, 0.0]; 4];
        assert_eq!(pixel.exposed(Exposure::Normalise), normalised);
        assert_eq!(pixel.exposed(Exposure::Conserve), pixel.radiance);
        assert_eq!(pixel.averaged(2).exposed(Exposure::Normalise), normalised[..1]);
        let common = pixel.with_common_coverage();
        assert!(common.colour_coverage.is_none());
        assert_eq!(common.exposed(Exposure::Normalise), normalised);
    }
}
