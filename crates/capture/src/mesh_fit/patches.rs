//! Patches of one photograph, carried to another one through the surface.

use super::distance_map::DistanceMap;
use super::grey_picture::GreyPicture;
use glam::DVec2;
use scene::View;

/// A photograph with what it shows of the surface.
pub(super) type Prepared<'a> = (&'a View, &'a DistanceMap, &'a GreyPicture);

/// How many pixels of a patch there are on each side of its middle.
const RADIUS: usize = 4;
/// How far beside its place a patch is compared, too, px, in eight directions each: as far as a pose may be off, and so far that little is
/// alike.
const ASIDE: [f64; 2] = [3.0, 8.0];
/// The share of patches that agree by chance.
pub(super) const BY_CHANCE: f64 = 1.0 / 17.0;
/// Most patches of a pair.
const MAX_PATCHES: usize = 250;

/// The result of comparing patches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tally {
    pub patches: u32,
    /// Those that look more like the place where the surface carries them than like those beside it.
    pub agreeing: u32,
}

impl std::iter::Sum for Tally {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |sum, one| Self {
            patches: sum.patches + one.patches,
            agreeing: sum.agreeing + one.agreeing,
        })
    }
}

/// Compares patches of one photograph with another one.
pub(super) fn compare(from: Prepared<'_>, to: Prepared<'_>) -> Tally {
    let map = from.1;
    let is_centre = |[x, y]: &[usize; 2]| {
        (RADIUS..map.width.saturating_sub(RADIUS)).contains(x)
            && (RADIUS..map.height.saturating_sub(RADIUS)).contains(y)
    };
    let centres = map.hits().filter(is_centre).count();
    // On a grid: every n-th pixel of every n-th row.
    let step = ((centres as f64 / MAX_PATCHES as f64).sqrt().round() as usize).max(2);
    let on_grid = map.hits().filter(|[x, y]| x % step == 0 && y % step == 0).filter(is_centre);
    let agreements = on_grid.filter_map(|centre| agrees(centre, from, to));
    agreements.map(|agrees| Tally { patches: 1, agreeing: u32::from(agrees) }).sum()
}

/// Where photographs have a pattern: on the surface and beside it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Patterns {
    /// Patches on the surface, and those of them with a pattern.
    pub on_surface: [u32; 2],
    pub beside: [u32; 2],
}

impl Patterns {
    /// Whether the photographs have a pattern, and the surface is where they have none.
    pub fn is_surface_elsewhere(&self) -> bool {
        /// Fewer patches are hardly a surface.
        const FEW: u32 = 40;
        let ([on, on_patterned], [beside, beside_patterned]) = (self.on_surface, self.beside);
        let is_patterned = f64::from(beside_patterned) > 0.3 * f64::from(beside) && beside_patterned > FEW;
        is_patterned && f64::from(on_patterned) < 0.1 * f64::from(on.max(FEW))
    }
}

impl std::iter::Sum for Patterns {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        let plus = |[a, b]: [u32; 2], [c, d]: [u32; 2]| [a + c, b + d];
        all.fold(Self::default(), |sum, one| Self {
            on_surface: plus(sum.on_surface, one.on_surface),
            beside: plus(sum.beside, one.beside),
        })
    }
}

/// Counts the patches of a photograph that have a pattern.
pub(super) fn patterns(map: &DistanceMap, picture: &GreyPicture) -> Patterns {
    let mut patterns = Patterns::default();
    let places = |side: usize| (RADIUS..side.saturating_sub(RADIUS)).step_by(2 * RADIUS);
    for (y, x) in places(map.height).flat_map(|y| places(map.width).map(move |x| (y, x))) {
        let pixels = (y - RADIUS..=y + RADIUS)
            .flat_map(|row| (x - RADIUS..=x + RADIUS).map(move |column| (column, row)));
        let values: Vec<f64> = pixels.map(|(column, row)| picture.pixel(column, row)).collect();
        let counts = if map.at(x, y).is_some() { &mut patterns.on_surface } else { &mut patterns.beside };
        counts[0] += 1;
        counts[1] += u32::from(has_pattern(&values));
    }
    patterns
}

/// Whether the patch around a pixel looks most like the place where it is carried; `None` if it has no pattern, or is not visible there.
fn agrees([x, y]: [usize; 2], (view, map, picture): Prepared<'_>, to: Prepared<'_>) -> Option<bool> {
    /// The share of a patch that has to be visible in both photographs.
    const LEAST_VISIBLE: f64 = 0.8;
    const SIDE: usize = 2 * RADIUS + 1;
    let mut own = Vec::with_capacity(SIDE * SIDE);
    let mut places = Vec::with_capacity(SIDE * SIDE);
    for (row, column) in
        (y - RADIUS..=y + RADIUS).flat_map(|row| (x - RADIUS..=x + RADIUS).map(move |column| (row, column)))
    {
        let place = map.point(view, column, row).and_then(|point| to.1.visible_at(to.0, point));
        if let Some(place) = place {
            own.push(picture.pixel(column, row));
            places.push(place);
        }
    }
    if (own.len() as f64) < LEAST_VISIBLE * (SIDE * SIDE) as f64 || !has_pattern(&own) {
        return None;
    }
    let correlation = |aside: DVec2| {
        let other: Vec<f64> = places.iter().map(|place| to.2.sample(*place + aside)).collect();
        correlation(&own, &other)
    };
    let here = correlation(DVec2::ZERO);
    let directions = (0..8).map(|k| DVec2::from_angle(std::f64::consts::FRAC_PI_4 * f64::from(k)));
    let beside = directions.flat_map(|direction| ASIDE.map(|aside| correlation(direction * aside)));
    let beside = beside.fold(0.0, f64::max);
    Some(here > beside)
}

/// Whether the shades of grey vary by more than noise.
fn has_pattern(values: &[f64]) -> bool {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    deviation > 0.01 && deviation > 0.03 * mean
}

/// The correlation of two lists of equal length, −1 to 1; 0 if one of them does not vary.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len() as f64;
    let [mean_a, mean_b] = [a, b].map(|values| values.iter().sum::<f64>() / count);
    let (mut product, mut square_a, mut square_b) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        (product, square_a, square_b) = (product + a * b, square_a + a * a, square_b + b * b);
    }
    let scale = (square_a * square_b).sqrt();
    if scale > 1e-12 { product / scale } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlations() {
        let values = [1.0, 4.0, 2.0, 8.0];
        assert!((correlation(&values, &values.map(|value| 3.0 - 0.1 * value)) + 1.0).abs() < 1e-12);
        assert!((correlation(&values, &values.map(|value| 7.0 * value)) - 1.0).abs() < 1e-12);
        assert_eq!(correlation(&values, &[5.0; 4]), 0.0);
        let elsewhere = Patterns { on_surface: [300, 9], beside: [900, 600] };
        assert!(elsewhere.is_surface_elsewhere());
        assert!(Patterns { on_surface: [3, 3], ..elsewhere }.is_surface_elsewhere(), "hardly to be seen");
        assert!(!Patterns { on_surface: [300, 200], ..elsewhere }.is_surface_elsewhere());
        assert!(!Patterns { beside: [900, 100], ..elsewhere }.is_surface_elsewhere(), "all is blank");
        assert!(has_pattern(&values) && !has_pattern(&[0.7, 0.7001, 0.6999, 0.7]));
    }
}
