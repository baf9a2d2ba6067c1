//! The first surface of each pixel, from the samples that its chief ray sees.

use salf::{Salf, Visibility};

/// The first surface of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstSurface {
    /// 1/z, above 0.
    pub inverse_depth: f32,
    /// A sample of it.
    pub sample: u32,
}

/// The first surface of each pixel, row by row from the top: of those that the aperture's centre sees, the one in the middle by weight, from
/// the nearest on. `None` where there is no surface.
pub struct FirstSurfaces {
    size: [u32; 2],
    surfaces: Vec<Option<FirstSurface>>,
}

/// A sample that the aperture's centre sees.
struct Seen {
    pixel: u32,
    surface: FirstSurface,
    weight: f32,
}

impl FirstSurfaces {
    pub fn new(salf: &Salf) -> Self {
        let size = [salf.camera.width, salf.camera.height];
        let mut seen: Vec<Seen> = salf
            .samples
            .runs()
            .flat_map(|run| {
                run.indices.clone().zip(run.iter()).filter_map(|(index, sample)| {
                    let [x, y] = [sample.center.x, sample.center.y];
                    let is_in_frame = x >= 0.0 && y >= 0.0 && x < size[0] as f32 && y < size[1] as f32;
                    let is_surface =
                        sample.surface.is_some() && sample.inverse_depth > 0.0 && !sample.is_carried;
                    let weight = sample.weight * centre_share(&sample.visibility);
                    (is_in_frame && is_surface && weight > 0.0).then(|| Seen {
                        pixel: y as u32 * size[0] + x as u32,
                        surface: FirstSurface { inverse_depth: sample.inverse_depth, sample: index },
                        weight,
                    })
                })
            })
            .collect();
        seen.sort_unstable_by(|a, b| {
            let by_depth = || b.surface.inverse_depth.total_cmp(&a.surface.inverse_depth);
            a.pixel.cmp(&b.pixel).then_with(by_depth).then(a.surface.sample.cmp(&b.surface.sample))
        });
        let mut surfaces = vec![None; size[0] as usize * size[1] as usize];
        for of_pixel in seen.chunk_by(|a, b| a.pixel == b.pixel) {
            let half = of_pixel.iter().map(|seen| seen.weight).sum::<f32>() / 2.0;
            let mut before = 0.0;
            let middle = of_pixel.iter().find(|seen| {
                before += seen.weight;
                before >= half
            });
            surfaces[of_pixel[0].pixel as usize] = middle.or(of_pixel.last()).map(|seen| seen.surface);
        }
        Self { size, surfaces }
    }

    /// The first surface at a place of the picture, from 0 at the upper left to 1; `None` beside it and where there is none.
    pub fn at(&self, x: f64, y: f64) -> Option<FirstSurface> {
        let [column, row] =
            [(x, self.size[0]), (y, self.size[1])].map(|(share, side)| (share * f64::from(side)).floor());
        let is_in_frame =
            column >= 0.0 && row >= 0.0 && column < f64::from(self.size[0]) && row < f64::from(self.size[1]);
        is_in_frame.then(|| self.surfaces[row as usize * self.size[0] as usize + column as usize])?
    }

    /// All of them, row by row from the top.
    pub fn iter(&self) -> impl Iterator<Item = &Option<FirstSurface>> {
        self.surfaces.iter()
    }

    /// The reciprocal distances of the farthest and the nearest; where something is missing, it is infinitely far. `None` without any surface.
    pub fn range(&self) -> Option<[f64; 2]> {
        let of =
            |surface: &Option<FirstSurface>| surface.map_or(0.0, |surface| f64::from(surface.inverse_depth));
        let nearest = self.surfaces.iter().map(of).reduce(f64::max).filter(|nearest| *nearest > 0.0)?;
        Some([self.surfaces.iter().map(of).fold(nearest, f64::min), nearest])
    }
}

/// How much of the middle of the aperture is seen, in [0, 1]: of the four cells around its centre.
fn centre_share(visibility: &Visibility) -> f32 {
    let Visibility::Cells { words } = visibility else { return 1.0 };
    let middle = Visibility::side_of(words) / 2;
    let cells = |row: usize| (Visibility::row(words, row) >> (middle - 1) & 3).count_ones();
    (cells(middle - 1) + cells(middle)) as f32 / 4.0
}
