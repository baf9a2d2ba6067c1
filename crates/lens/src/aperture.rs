//! The aperture's shape: how much light passes at each of its points, how to sample it, how to cut it into rows.
//!
//! Aperture points are given as u in [−1, 1]² (u = U/R), x right and y up as seen from behind the camera.

use crate::CameraError;
use glam::DVec2;
use std::f64::consts::{PI, TAU};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// The aperture: a shape in [−R, R]², possibly squeezed.
#[derive(Clone, Debug, PartialEq)]
pub struct Aperture {
    /// The outline or picture.
    pub shape: ApertureShape,
    /// Anamorphic ratio, > 0: above 1 the shape is this many times as high as wide, below 1 as wide as high.
    pub ratio: f64,
}

/// The outline of the opening.
#[derive(Clone, Debug, PartialEq, Default)]
pub enum ApertureShape {
    /// A disc of radius R.
    #[default]
    Disc,
    /// A regular polygon of circumradius R.
    Polygon {
        /// Corners, ≥ 3.
        blades: u32,
        /// Angle of the first corner from +x, rad, counter-clockwise as seen from behind the camera.
        rotation: f64,
        /// 0 straight edges … 1 the circumscribed disc.
        roundness: f64,
    },
    /// The whole square [−R, R]².
    Square,
    /// Any picture over [−R, R]².
    Mask(Arc<ApertureMask>),
}

/// A picture of an aperture's transmission, row 0 at v = +R.
#[derive(Clone, Debug, PartialEq)]
pub struct ApertureMask {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Transmission of each texel, in [0, 1], row by row from the top.
    pub transmission: Vec<f32>,
    /// The file it came from, as written in the camera file.
    pub file: String,
}

impl Default for Aperture {
    fn default() -> Self {
        Self { shape: ApertureShape::Disc, ratio: 1.0 }
    }
}

impl From<ApertureShape> for Aperture {
    fn from(shape: ApertureShape) -> Self {
        Self { shape, ratio: 1.0 }
    }
}

impl Aperture {
    /// The anamorphic ratios that an aperture may have: beyond them its images are lines.
    pub const RATIOS: RangeInclusive<f64> = 1e-3..=1e3;

    /// Checks that all fields are within their ranges.
    ///
    /// # Errors
    /// The first field that makes the aperture invalid.
    pub fn validate(&self) -> Result<(), CameraError> {
        let error = |field, must| Err(CameraError { field, must });
        if !Self::RATIOS.contains(&self.ratio) {
            return error("aperture ratio", "from 0.001 to 1000");
        }
        match &self.shape {
            ApertureShape::Polygon { blades, rotation, roundness } => {
                if !(3..=64).contains(blades) {
                    return error("aperture blades", "3 to 64");
                }
                if !rotation.is_finite() {
                    return error("aperture rotation", "a finite angle in rad");
                }
                if !(0.0..=1.0).contains(roundness) {
                    return error("aperture roundness", "in [0, 1]");
                }
            }
            ApertureShape::Mask(mask) => {
                let texels = mask.width as usize * mask.height as usize;
                if texels == 0 || mask.transmission.len() != texels {
                    return error("aperture mask", "a picture with at least one texel");
                }
                if !mask.transmission.iter().all(|t| (0.0..=1.0).contains(t)) {
                    return error("aperture mask", "transmissions in [0, 1]");
                }
                if mask.transmission.iter().all(|&t| t == 0.0) {
                    return error("aperture mask", "open somewhere (it is all black)");
                }
            }
            ApertureShape::Disc | ApertureShape::Square => {}
        }
        Ok(())
    }

    /// Share of light that passes at the aperture point `u`, in [0, 1]; coordinates are in units of the aperture
    /// radius R, and nothing passes outside [−1, 1]².
    pub fn transmission(&self, u: DVec2) -> f64 {
        let u = u / self.squeeze();
        if u.abs().max_element() > 1.0 {
            return 0.0;
        }
        match &self.shape {
            ApertureShape::Disc => f64::from(u.length_squared() <= 1.0),
            ApertureShape::Polygon { blades, rotation, roundness } => {
                let inside = u.length() <= polygon_radius(u.y.atan2(u.x) - rotation, *blades, *roundness);
                f64::from(inside)
            }
            ApertureShape::Square => 1.0,
            ApertureShape::Mask(mask) => {
                let column = ((u.x + 1.0) / 2.0 * mask.width as f64) as usize;
                let row = ((1.0 - u.y) / 2.0 * mask.height as f64) as usize;
                let column = column.min(mask.width as usize - 1);
                let row = row.min(mask.height as usize - 1);
                mask.transmission[row * mask.width as usize + column] as f64
            }
        }
    }

    /// The anamorphic squeeze of x and y, each in (0, 1].
    fn squeeze(&self) -> DVec2 {
        DVec2::new((1.0 / self.ratio).min(1.0), self.ratio.min(1.0))
    }

    /// The aperture as `n` rows of runs, for splatting: the transmission of row i of the square between v = −1 + 2i/n
    /// and −1 + 2(i+1)/n. Areas are those of the shape to better than 1e-3.
    pub fn rows(&self, n: usize) -> ApertureRows {
        /// Scan lines per row: the chord of a row is the mean of theirs.
        const SCAN_LINES: usize = 32;
        let mut rows = Vec::with_capacity(n);
        for i in 0..n {
            let v_of = |k: usize| -1.0 + 2.0 * (i as f64 + (k as f64 + 0.5) / SCAN_LINES as f64) / n as f64;
            let runs = match &self.shape {
                ApertureShape::Mask(mask) => self.mask_runs(mask, i, n),
                _ => {
                    let chords: Vec<_> = (0..SCAN_LINES).filter_map(|k| self.chord(v_of(k))).collect();
                    let count = chords.len() as f64;
                    let (start, end) =
                        chords.iter().fold((0.0, 0.0), |(l, r), c| (l + c.0 / count, r + c.1 / count));
                    let share = count / SCAN_LINES as f64;
                    let run = Run { start, end, transmission: share };
                    if end > start { vec![run] } else { vec![] }
                }
            };
            rows.push(ApertureRow { runs });
        }
        ApertureRows { rows }
    }

    /// The chord of a convex shape at height v, if the line meets it.
    fn chord(&self, v: f64) -> Option<(f64, f64)> {
        let squeeze = self.squeeze();
        let v = v / squeeze.y;
        if v.abs() >= 1.0 {
            return None;
        }
        let (start, end) = match &self.shape {
            ApertureShape::Square => (-1.0, 1.0),
            ApertureShape::Disc => {
                let half = (1.0 - v * v).sqrt();
                (-half, half)
            }
            ApertureShape::Polygon { blades, rotation, roundness } => {
                // Star-shaped and convex: walk the outline as a fine polyline and keep the extreme crossings.
                let steps = *blades as usize * if *roundness > 0.0 { 64 } else { 1 };
                let corner = |k: usize| {
                    let angle = TAU * k as f64 / steps as f64;
                    let radius = polygon_radius(angle, *blades, *roundness);
                    DVec2::from_angle(angle + rotation) * radius
                };
                let mut span = (f64::INFINITY, f64::NEG_INFINITY);
                for k in 0..steps {
                    let (a, b) = (corner(k), corner(k + 1));
                    if (a.y > v) != (b.y > v) {
                        let x = a.x + (b.x - a.x) * (v - a.y) / (b.y - a.y);
                        span = (span.0.min(x), span.1.max(x));
                    }
                }
                if span.0 > span.1 {
                    return None;
                }
                span
            }
            ApertureShape::Mask(_) => unreachable!("a mask has runs, not chords"),
        };
        Some((start * squeeze.x, end * squeeze.x))
    }

    /// Row i of n of a mask: the mask's texels averaged over n × n cells, equal neighbours joined.
    fn mask_runs(&self, mask: &ApertureMask, i: usize, n: usize) -> Vec<Run> {
        let squeeze = self.squeeze();
        let v_span = [i, i + 1].map(|k| (-1.0 + 2.0 * k as f64 / n as f64) / squeeze.y);
        let mut runs: Vec<Run> = Vec::new();
        for j in 0..n {
            let [start, end] = [j, j + 1].map(|k| -1.0 + 2.0 * k as f64 / n as f64);
            let mean = mask.mean([start / squeeze.x, end / squeeze.x], v_span);
            if mean == 0.0 {
                continue;
            }
            match runs.last_mut() {
                Some(run) if run.end == start && run.transmission == mean => run.end = end,
                _ => runs.push(Run { start, end, transmission: mean }),
            }
        }
        runs
    }
}

impl ApertureMask {
    /// Mean transmission, in [0, 1], over the box from `u[0]` to `u[1]` and `v[0]` to `v[1]`, in units of the
    /// aperture radius R; 0 outside [−1, 1]².
    pub fn mean(&self, u: [f64; 2], v: [f64; 2]) -> f64 {
        let columns = u.map(|u| (u + 1.0) / 2.0 * self.width as f64);
        let rows = [v[1], v[0]].map(|v| (1.0 - v) / 2.0 * self.height as f64);
        let mut sum = 0.0;
        for (row, height) in overlaps(rows, self.height) {
            for (column, width) in overlaps(columns, self.width) {
                sum += height * width * self.transmission[row * self.width as usize + column] as f64;
            }
        }
        sum / ((columns[1] - columns[0]) * (rows[1] - rows[0]))
    }
}

/// The cells of 0..count that `span` overlaps, with the length of each overlap.
fn overlaps(span: [f64; 2], count: u32) -> impl Iterator<Item = (usize, f64)> {
    let first = span[0].max(0.0) as usize;
    let last = (span[1].min(count as f64).ceil().max(0.0)) as usize;
    (first..last).filter_map(move |k| {
        let length = span[1].min(k as f64 + 1.0) - span[0].max(k as f64);
        (length > 0.0).then_some((k, length))
    })
}

/// The outline of a rounded polygon at `angle` from its first corner.
fn polygon_radius(angle: f64, blades: u32, roundness: f64) -> f64 {
    let wedge = TAU / blades as f64;
    let from_middle = angle.rem_euclid(wedge) - wedge / 2.0;
    let straight = (wedge / 2.0).cos() / from_middle.cos();
    straight + (1.0 - straight) * roundness
}

/// Part of a row: the transmission between u = `start` and `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Left end, in [−1, 1].
    pub start: f64,
    /// Right end, in [−1, 1].
    pub end: f64,
    /// Mean transmission, in (0, 1].
    pub transmission: f64,
}

/// One row of an aperture, left to right.
#[derive(Clone, Debug, PartialEq)]
pub struct ApertureRow {
    /// Disjoint runs in order.
    pub runs: Vec<Run>,
}

/// An aperture cut into rows, from v = −1 up.
#[derive(Clone, Debug, PartialEq)]
pub struct ApertureRows {
    /// Rows of equal height 2/n.
    pub rows: Vec<ApertureRow>,
}

impl ApertureRows {
    /// The open area over [−1, 1]² (4 for the square, π for the disc), weighted by transmission.
    pub fn open_area(&self) -> f64 {
        let height = 2.0 / self.rows.len() as f64;
        let runs = self.rows.iter().flat_map(|row| &row.runs);
        runs.map(|run| (run.end - run.start) * run.transmission * height).sum()
    }
}

/// Warps uniform numbers to aperture points whose density is the transmission.
pub struct ApertureSampler {
    aperture: Aperture,
    /// Cumulative weights: of the angle within a rounded wedge, or of a mask's texels within each row.
    cumulative: Vec<f64>,
    /// Cumulative weights of a mask's rows.
    rows: Vec<f64>,
}

impl ApertureSampler {
    /// Entries of the table of a rounded polygon's wedge.
    const WEDGE_STEPS: usize = 4096;

    /// Prepares to sample `aperture`, which must be valid (see [`Aperture`]).
    pub fn new(aperture: &Aperture) -> Self {
        let mut rows = Vec::new();
        let cumulative = match &aperture.shape {
            ApertureShape::Polygon { blades, roundness, .. } if *roundness > 0.0 => {
                let wedge = TAU / *blades as f64;
                let density = |k: usize| {
                    let angle = wedge * (k as f64 + 0.5) / Self::WEDGE_STEPS as f64;
                    polygon_radius(angle, *blades, *roundness).powi(2)
                };
                running_shares((0..Self::WEDGE_STEPS).map(density))
            }
            ApertureShape::Mask(mask) => {
                let texels = || mask.transmission.chunks_exact(mask.width as usize);
                let light = |row: &[f32]| row.iter().map(|&t| f64::from(t)).sum();
                rows = running_shares(texels().map(light));
                texels().flat_map(|row| running_shares(row.iter().map(|&t| f64::from(t)))).collect()
            }
            _ => Vec::new(),
        };
        Self { aperture: aperture.clone(), cumulative, rows }
    }

    /// The aperture point, in [−1, 1]² (units of the aperture radius R), of two uniform numbers in [0, 1);
    /// distributed as the transmission is.
    pub fn sample(&self, a: f64, b: f64) -> DVec2 {
        let point = match &self.aperture.shape {
            ApertureShape::Disc => disc(a, b),
            ApertureShape::Square => DVec2::new(2.0 * a - 1.0, 2.0 * b - 1.0),
            ApertureShape::Polygon { blades, rotation, roundness } => {
                let n = *blades as f64;
                let wedge = TAU / n;
                let index = (a * n).floor().min(n - 1.0);
                let within = a * n - index;
                let start = rotation + index * wedge;
                if *roundness > 0.0 {
                    let (step, rest) = pick(&self.cumulative, within);
                    let angle = wedge * (step as f64 + rest) / Self::WEDGE_STEPS as f64;
                    let radius = polygon_radius(angle, *blades, *roundness);
                    DVec2::from_angle(start + angle) * radius * b.sqrt()
                } else {
                    let r = within.sqrt();
                    let (p, q) = (DVec2::from_angle(start), DVec2::from_angle(start + wedge));
                    (p * (1.0 - b) + q * b) * r
                }
            }
            ApertureShape::Mask(mask) => {
                // The row first, then the texel in it: points that are evenly spread stay so in both directions.
                let (row, below) = pick(&self.rows, b);
                let width = mask.width as usize;
                let (column, right) = pick(&self.cumulative[row * width..(row + 1) * width], a);
                DVec2::new(
                    2.0 * (column as f64 + right) / mask.width as f64 - 1.0,
                    1.0 - 2.0 * (row as f64 + below) / mask.height as f64,
                )
            }
        };
        point * self.aperture.squeeze()
    }
}

/// The interval of a table of cumulative weights that `a` in [0, 1) falls into, and the position in it.
fn pick(cumulative: &[f64], a: f64) -> (usize, f64) {
    let step = cumulative.partition_point(|&end| end <= a).min(cumulative.len() - 1);
    let start = if step == 0 { 0.0 } else { cumulative[step - 1] };
    let width = cumulative[step] - start;
    (step, if width > 0.0 { ((a - start) / width).clamp(0.0, 1.0) } else { 0.5 })
}

/// Cumulative sums of `shares`, scaled to end at 1; if all are 0 they stay 0.
fn running_shares(shares: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sums: Vec<f64> = shares
        .scan(0.0, |sum, share| {
            *sum += share;
            Some(*sum)
        })
        .collect();
    let total = *sums.last().expect("a table has a step");
    if total > 0.0 {
        sums.iter_mut().for_each(|sum| *sum /= total);
    }
    sums
}

/// The concentric map of the unit square to the unit disc (Shirley and Chiu 1997).
fn disc(a: f64, b: f64) -> DVec2 {
    let (x, y) = (2.0 * a - 1.0, 2.0 * b - 1.0);
    if x == 0.0 && y == 0.0 {
        DVec2::ZERO
    } else if x.abs() > y.abs() {
        DVec2::from_angle(PI / 4.0 * (y / x)) * x
    } else {
        DVec2::from_angle(PI / 2.0 - PI / 4.0 * (x / y)) * y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_that_leave_no_area_are_refused() {
        for ratio in [0.0, 1e-320, 1e-4, 1e4, f64::INFINITY, f64::NAN, -1.0] {
            let aperture = Aperture { ratio, ..Aperture::default() };
            assert_eq!(aperture.validate().unwrap_err().field, "aperture ratio", "{ratio}");
        }
        for ratio in [1e-3, 1.0, 1e3] {
            assert_eq!(Aperture { ratio, ..Aperture::default() }.validate(), Ok(()));
        }
    }

    fn letter() -> ApertureShape {
        #[rustfmt::skip]
        let rows = [
            1.0, 1.0, 1.0, 0.0,
            1.0, 0.0, 0.0, 0.0,
            1.0, 0.5, 0.0, 0.0,
            1.0, 0.0, 0.0, 0.0f32,
        ];
        ApertureShape::Mask(Arc::new(ApertureMask {
            width: 4,
            height: 4,
            transmission: rows.to_vec(),
            file: "f.png".into(),
        }))
    }

    fn shapes() -> Vec<(Aperture, f64)> {
        let polygon = |blades, roundness| ApertureShape::Polygon { blades, rotation: 0.3, roundness };
        let polygon_area = |n: f64| n / 2.0 * (TAU / n).sin();
        vec![
            (ApertureShape::Disc.into(), PI),
            (ApertureShape::Square.into(), 4.0),
            (polygon(5, 0.0).into(), polygon_area(5.0)),
            (polygon(6, 0.0).into(), polygon_area(6.0)),
            (polygon(6, 1.0).into(), PI),
            (letter().into(), 6.5 / 4.0),
            (Aperture { shape: ApertureShape::Disc, ratio: 2.0 }, PI / 2.0),
            (Aperture { shape: ApertureShape::Disc, ratio: 0.5 }, PI / 2.0),
        ]
    }

    #[test]
    fn rows_have_the_area_of_the_shape() {
        for (aperture, area) in shapes() {
            aperture.validate().unwrap();
            for n in [4, 16, 64] {
                let found = aperture.rows(n).open_area();
                assert!((found / area - 1.0).abs() < 2e-3, "{aperture:?} {n}: {found} for {area}");
            }
        }
    }

    /// χ² of samples over an 8 × 8 grid of cells against the transmission's integral over each.
    #[test]
    fn samples_have_the_density_of_the_transmission() {
        const CELLS: usize = 8;
        const SIDE: usize = 512;
        for (aperture, _) in shapes() {
            let sampler = ApertureSampler::new(&aperture);
            let cell_of = |u: DVec2| {
                let index =
                    ((u + 1.0) / 2.0 * CELLS as f64).clamp(DVec2::ZERO, DVec2::splat(CELLS as f64 - 1e-9));
                index.y as usize * CELLS + index.x as usize
            };
            let mut expected = [0.0; CELLS * CELLS];
            for i in 0..SIDE * SIDE {
                let u =
                    DVec2::new((i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0;
                expected[cell_of(u)] += aperture.transmission(u);
            }
            let total: f64 = expected.iter().sum();
            let count = 200_000usize;
            let mut found = [0.0; CELLS * CELLS];
            let mut state = 1u64;
            let mut uniform = || {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 11) as f64 / (1u64 << 53) as f64
            };
            for _ in 0..count {
                let u = sampler.sample(uniform(), uniform());
                assert!(u.abs().max_element() <= 1.0 + 1e-12);
                found[cell_of(u)] += 1.0;
            }
            let mut chi_squared = 0.0;
            let mut cells = 0.0f64;
            for (e, f) in expected.iter().zip(found) {
                let e = e / total * count as f64;
                if e > 50.0 {
                    chi_squared += (f - e).powi(2) / e;
                    cells += 1.0;
                }
            }
            // Mean n, variance 2n: five standard deviations, and the grid's own error of the outline.
            assert!(chi_squared < cells + 5.0 * (2.0 * cells).sqrt() + 20.0, "{aperture:?}: {chi_squared}");
        }
    }

    #[test]
    fn a_mask_is_read_from_the_top() {
        let aperture = Aperture::from(letter());
        assert_eq!(aperture.transmission(DVec2::new(0.4, 0.9)), 1.0, "the F's upper bar");
        assert_eq!(aperture.transmission(DVec2::new(0.4, -0.9)), 0.0);
        let rows = aperture.rows(4);
        assert_eq!(rows.rows[3].runs, vec![Run { start: -1.0, end: 0.5, transmission: 1.0 }]);
        assert_eq!(rows.rows[0].runs, vec![Run { start: -1.0, end: -0.5, transmission: 1.0 }]);
    }

    #[test]
    fn useless_masks_are_refused() {
        let black = ApertureMask { width: 1, height: 1, transmission: vec![0.0], file: String::new() };
        assert!(Aperture::from(ApertureShape::Mask(Arc::new(black))).validate().is_err());
        assert!(Aperture { shape: ApertureShape::Disc, ratio: 0.0 }.validate().is_err());
    }
}
