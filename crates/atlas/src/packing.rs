//! Packing charts into one atlas.
//!
//! A skyline packer over outlines: the atlas stores for every column how far down it is filled; a chart goes where
//! its lower outline, column by column, comes to rest highest up. Charts are placed in order of size, in up to four
//! quarter turns. Every chart carries half of the gutter around it. The density that fills the target side is found
//! by packing a few times.

mod boxed_chart;
mod chart_outline;
pub(crate) mod overlap;
mod skyline;
pub(crate) mod unpacked_chart;

use crate::AtlasError;
use crate::options::{Density, MAX_SIDE, MIN_GUTTER};
use boxed_chart::BoxedChart;
use chart_outline::ChartOutline;
use glam::{DVec2, Vec2};
use progress::Progress;
use rayon::prelude::*;
use skyline::Skyline;
use unpacked_chart::UnpackedChart;

/// Sides that [`Density::Auto`] chooses from: for a simple scene and for one of many triangles.
const AUTO_SIDES: [f64; 2] = [1024.0, 2048.0];

/// Texels per triangle that `Auto` aims for between those sides.
const AUTO_TEXELS_PER_TRIANGLE: f64 = 100.0;

/// Number of packings tried to find the best density. Each halves the error; the first is within about 10 %.
const TRIALS: usize = 6;

/// A layout that fills this fraction of its side is accepted.
const TARGET_FILL: f64 = 0.95;

/// The packed charts.
pub(crate) struct PackedCharts {
    pub width: u32,
    pub height: u32,
    pub density: f64,
    /// For each chart its triangles' corners in texels.
    pub corners: Vec<Vec<[Vec2; 3]>>,
    pub notes: Vec<String>,
}

/// The place of a chart: atlas column and row of its grown outline, and its quarter turns.
#[derive(Clone, Copy, Default)]
struct ChartPlacement {
    x: u32,
    y: u32,
    turns: u32,
}

struct Layout {
    width: u32,
    height: u32,
    density: f64,
    places: Vec<ChartPlacement>,
}

/// Packs the charts.
pub(crate) fn pack(
    charts: &[UnpackedChart],
    density: Density,
    gutter: u32,
    progress: &dyn Progress,
) -> Result<PackedCharts, AtlasError> {
    let boxed: Vec<BoxedChart> = charts.par_iter().map(BoxedChart::new).collect();
    let mut notes = Vec::new();
    let mut packer = Packer { boxed: &boxed, margin: gutter.max(MIN_GUTTER).div_ceil(2), progress };
    let layout = loop {
        match packer.layout(density, charts, &mut notes)? {
            Some(layout) => break layout,
            None if packer.margin > MIN_GUTTER / 2 => {
                packer.margin = MIN_GUTTER / 2;
                notes.push(format!(
                    "{} separate pieces of surface: the gutter is {MIN_GUTTER} texels instead of {gutter}",
                    charts.len()
                ));
            }
            None => return Err(AtlasError::TooManyCharts { charts: charts.len(), side: MAX_SIDE }),
        }
    };
    let margin = f64::from(packer.margin);
    let size = DVec2::new(layout.width.into(), layout.height.into()).as_vec2();
    let corners = boxed.par_iter().zip(&layout.places).map(|(chart, place)| {
        let origin = DVec2::new(f64::from(place.x) + margin, f64::from(place.y) + margin);
        let put = |corners: [DVec2; 3]| corners.map(|c| (origin + c).as_vec2().clamp(Vec2::ZERO, size));
        chart.rotated(layout.density, place.turns).map(put).collect()
    });
    let corners = corners.collect();
    Ok(PackedCharts { width: layout.width, height: layout.height, density: layout.density, corners, notes })
}

struct Packer<'a> {
    boxed: &'a [BoxedChart],
    /// Half of the gutter, which surrounds every chart.
    margin: u32,
    progress: &'a dyn Progress,
}

impl Packer<'_> {
    /// The layout of the requested density; `None` if the charts do not fit even at one texel each.
    fn layout(
        &self,
        density: Density,
        charts: &[UnpackedChart],
        notes: &mut Vec<String>,
    ) -> Result<Option<Layout>, AtlasError> {
        let side = match density {
            Density::Auto => self.auto_side(charts),
            Density::Side(side) => side.clamp(1, MAX_SIDE),
            Density::TexelsPerUnit(density) if density > 0.0 && density.is_finite() => {
                let width = self.texels_at(density).sqrt().ceil().clamp(1.0, MAX_SIDE.into()) as u32;
                let widest = self.boxed.iter().map(|b| (b.size.x * b.scale(density)).ceil());
                let widest = widest.fold(0.0, f64::max) + f64::from(2 * self.margin);
                if widest <= MAX_SIDE.into()
                    && let Some(layout) = self.try_density(density, width.max(widest as u32), MAX_SIDE)?
                {
                    return Ok(Some(layout));
                }
                let fitted = self.fit_square(MAX_SIDE)?;
                if let Some(layout) = &fitted {
                    notes.push(format!(
                        "{density} texels per unit would exceed {MAX_SIDE}×{MAX_SIDE} texels: {:.3} were used",
                        layout.density
                    ));
                }
                return Ok(fitted);
            }
            Density::TexelsPerUnit(density) => {
                notes.push(format!(
                    "{density} texels per unit is not a valid density: an automatic one was used"
                ));
                self.auto_side(charts)
            }
        };
        if let Some(layout) = self.fit_square(side)? {
            return Ok(Some(layout));
        }
        let fitted = if side < MAX_SIDE { self.fit_square(MAX_SIDE)? } else { None };
        if let Some(layout) = &fitted {
            notes.push(format!(
                "{} separate pieces of surface do not fit {side}×{side} texels: the atlas is {}×{}",
                charts.len(),
                layout.width,
                layout.height
            ));
        }
        Ok(fitted)
    }

    fn auto_side(&self, charts: &[UnpackedChart]) -> u32 {
        let triangles: usize = charts.iter().map(|c| c.triangles.len()).sum();
        let target_side =
            (triangles as f64 * AUTO_TEXELS_PER_TRIANGLE).sqrt().clamp(AUTO_SIDES[0], AUTO_SIDES[1]);
        // Charts of two texels with their gutters should not take more than half of it.
        let chart = f64::from(2 * self.margin + 2).powi(2);
        let needed = (2.0 * chart * charts.len() as f64).sqrt();
        (target_side.max(needed).ceil() as u32).next_multiple_of(64).min(MAX_SIDE)
    }

    /// Estimated number of texels that the charts take at a density, gutters and gaps included.
    fn texels_at(&self, density: f64) -> f64 {
        let margin = f64::from(2 * self.margin);
        let padded = |b: &BoxedChart| (b.size * b.scale(density)).ceil() + DVec2::splat(margin);
        1.1 * self.boxed.iter().map(|b| padded(b).element_product()).sum::<f64>()
    }

    /// The densest layout found for a square of this side.
    fn fit_square(&self, side: u32) -> Result<Option<Layout>, AtlasError> {
        let longest = self.boxed.iter().map(|b| b.size.x).fold(0.0, f64::max);
        // Between one chart as wide as the side, and all charts shrunk to a texel.
        let mut fits = if longest > 0.0 { 0.5 / longest } else { 1.0 };
        let mut fails = if longest > 0.0 { f64::from(side) / longest } else { 1.0 };
        let area = f64::from(side).powi(2);
        let (mut low, mut high) = (fits, fails);
        for _ in 0..40 {
            let middle = (low * high).sqrt();
            if self.texels_at(middle) <= area { low = middle } else { high = middle }
        }
        let mut density = low;
        let mut best: Option<Layout> = None;
        for _ in 0..TRIALS {
            match self.try_density(density, side, side)? {
                Some(layout) => {
                    let fill = f64::from(layout.height) / f64::from(side);
                    fits = density;
                    best = Some(layout);
                    if fill >= TARGET_FILL {
                        break;
                    }
                    let grown = density * fill.recip().sqrt() * 0.995;
                    density = if grown < fails { grown } else { (fits * fails).sqrt() };
                }
                None => {
                    fails = density;
                    let shrunk = density * 0.92;
                    density = if best.is_none() && shrunk > fits { shrunk } else { (fits * fails).sqrt() };
                }
            }
            if fails / fits < 1.01 {
                break;
            }
        }
        match best {
            Some(layout) => Ok(Some(layout)),
            None => self.try_density(if longest > 0.0 { 0.5 / longest } else { 1.0 }, side, side),
        }
    }

    /// The layout at a density in an atlas of at most `width` columns, if it has at most `max_height` rows.
    fn try_density(&self, density: f64, width: u32, max_height: u32) -> Result<Option<Layout>, AtlasError> {
        self.progress.check()?;
        // More turns pack more tightly but take longer; with very many charts the small ones fill the gaps anyway.
        let turns: &[u32] = match self.boxed.len() {
            0..3_000 => &[0, 1, 2, 3],
            3_000..15_000 => &[0, 1],
            _ => &[0],
        };
        let grown: Vec<Vec<ChartOutline>> = self
            .boxed
            .par_iter()
            .map(|b| {
                turns.iter().map(|&t| ChartOutline::new(b.rotated(density, t)).grown(self.margin)).collect()
            })
            .collect();
        let mut order: Vec<usize> = (0..grown.len()).collect();
        order.sort_by_key(|&i| (std::cmp::Reverse((grown[i][0].width(), grown[i][0].height)), i));
        let mut skyline = Skyline::new(width);
        let mut places = vec![ChartPlacement::default(); grown.len()];
        for (n, &chart) in order.iter().enumerate() {
            if n % 256 == 0 {
                self.progress.check()?;
            }
            let Some((x, y, turn)) = skyline.best_position(&grown[chart]) else { return Ok(None) };
            skyline.place(&grown[chart][turn], x, y);
            if skyline.height > max_height {
                return Ok(None);
            }
            places[chart] = ChartPlacement { x, y, turns: turns[turn] };
        }
        Ok(Some(Layout { width: skyline.width_used, height: skyline.height, density, places }))
    }
}
