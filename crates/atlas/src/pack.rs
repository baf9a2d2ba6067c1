//! Packing charts into one atlas.
//!
//! A skyline packer over outlines: the atlas remembers for every column how far down it is filled; a chart goes
//! where its underside, column by column, comes to rest highest up. Charts go in by size, in up to four quarter
//! turns. Every chart carries half of the gutter around it. The density that fills the wanted side is searched
//! for by packing a few times.

use crate::AtlasError;
use crate::chart::{LooseChart, area};
use crate::options::{Density, MAX_SIDE, MIN_GUTTER};
use crate::shape::Shape;
use glam::{DVec2, Vec2};
use progress::Progress;
use rayon::prelude::*;

/// Sides that [`Density::Auto`] chooses from: a simple scene's and one of many triangles.
const AUTO_SIDES: [f64; 2] = [1024.0, 2048.0];

/// Texels a triangle that `Auto` aims for between those sides.
const AUTO_TEXELS_PER_TRIANGLE: f64 = 100.0;

/// Packings tried for the best density. Each halves the error, the first is within about 10 %.
const TRIALS: usize = 6;

/// A layout this full of its side is good enough.
const FULL_ENOUGH: f64 = 0.95;

/// The charts in their places.
pub(crate) struct Packed {
    pub width: u32,
    pub height: u32,
    pub density: f64,
    /// For each chart its triangles' corners in texels.
    pub corners: Vec<Vec<[Vec2; 3]>>,
    pub notes: Vec<String>,
}

/// A chart turned into its smallest box, which starts at 0 and is at least as wide as high.
struct Boxed {
    corners: Vec<[DVec2; 3]>,
    size: DVec2,
}

/// Where a chart lies: the atlas column and row of its grown outline, and its quarter turns.
#[derive(Clone, Copy, Default)]
struct Place {
    x: u32,
    y: u32,
    turns: u32,
}

struct Layout {
    width: u32,
    height: u32,
    density: f64,
    places: Vec<Place>,
}

/// Packs the charts.
pub(crate) fn pack(
    charts: &[LooseChart],
    density: Density,
    gutter: u32,
    progress: &dyn Progress,
) -> Result<Packed, AtlasError> {
    let boxed: Vec<Boxed> = charts.par_iter().map(Boxed::new).collect();
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
        chart.turned(layout.density, place.turns).map(put).collect()
    });
    let corners = corners.collect();
    Ok(Packed { width: layout.width, height: layout.height, density: layout.density, corners, notes })
}

struct Packer<'a> {
    boxed: &'a [Boxed],
    /// Half of the gutter, which every chart has around it.
    margin: u32,
    progress: &'a dyn Progress,
}

impl Packer<'_> {
    /// The layout of the wanted density; `None` if the charts do not even fit at one texel each.
    fn layout(
        &self,
        density: Density,
        charts: &[LooseChart],
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
                let fitted = self.fit(MAX_SIDE)?;
                if let Some(layout) = &fitted {
                    notes.push(format!(
                        "{density} texels per unit would exceed {MAX_SIDE}×{MAX_SIDE} texels: {:.3} were used",
                        layout.density
                    ));
                }
                return Ok(fitted);
            }
            Density::TexelsPerUnit(density) => {
                notes.push(format!("{density} texels per unit is no density: an automatic one was used"));
                self.auto_side(charts)
            }
        };
        if let Some(layout) = self.fit(side)? {
            return Ok(Some(layout));
        }
        let fitted = if side < MAX_SIDE { self.fit(MAX_SIDE)? } else { None };
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

    fn auto_side(&self, charts: &[LooseChart]) -> u32 {
        let triangles: usize = charts.iter().map(|c| c.triangles.len()).sum();
        let wanted = (triangles as f64 * AUTO_TEXELS_PER_TRIANGLE).sqrt().clamp(AUTO_SIDES[0], AUTO_SIDES[1]);
        // Charts of two texels with their gutters should not take more than half of it.
        let chart = f64::from(2 * self.margin + 2).powi(2);
        let needed = (2.0 * chart * charts.len() as f64).sqrt();
        (wanted.max(needed).ceil() as u32).next_multiple_of(64).min(MAX_SIDE)
    }

    /// About how many texels the charts take at a density, gutters and gaps included.
    fn texels_at(&self, density: f64) -> f64 {
        let margin = f64::from(2 * self.margin);
        let padded = |b: &Boxed| (b.size * b.scale(density)).ceil() + DVec2::splat(margin);
        1.1 * self.boxed.iter().map(|b| padded(b).element_product()).sum::<f64>()
    }

    /// The densest layout found within a square.
    fn fit(&self, side: u32) -> Result<Option<Layout>, AtlasError> {
        let longest = self.boxed.iter().map(|b| b.size.x).fold(0.0, f64::max);
        // One chart may be as wide as the side, and all fall to a texel at the other end.
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
                    if fill >= FULL_ENOUGH {
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
        // More turns pack closer and take longer; with very many charts the small ones fill the gaps anyway.
        let turns: &[u32] = match self.boxed.len() {
            0..3_000 => &[0, 1, 2, 3],
            3_000..15_000 => &[0, 1],
            _ => &[0],
        };
        let grown: Vec<Vec<Shape>> = self
            .boxed
            .par_iter()
            .map(|b| turns.iter().map(|&t| Shape::new(b.turned(density, t)).grown(self.margin)).collect())
            .collect();
        let mut order: Vec<usize> = (0..grown.len()).collect();
        order.sort_by_key(|&i| (std::cmp::Reverse((grown[i][0].width(), grown[i][0].height)), i));
        let mut skyline = Skyline::new(width);
        let mut places = vec![Place::default(); grown.len()];
        for (n, &chart) in order.iter().enumerate() {
            if n % 256 == 0 {
                self.progress.check()?;
            }
            let Some((x, y, turn)) = skyline.best(&grown[chart]) else { return Ok(None) };
            skyline.put(&grown[chart][turn], x, y);
            if skyline.height > max_height {
                return Ok(None);
            }
            places[chart] = Place { x, y, turns: turns[turn] };
        }
        Ok(Some(Layout { width: skyline.width_used, height: skyline.height, density, places }))
    }
}

/// How far down every column is filled.
struct Skyline {
    rows: Vec<u32>,
    width_used: u32,
    height: u32,
}

impl Skyline {
    fn new(width: u32) -> Self {
        Self { rows: vec![0; width as usize], width_used: 1, height: 1 }
    }

    /// The column, row and index of the outline that ends highest up, the one leaving the least gap among equals.
    fn best(&self, outlines: &[Shape]) -> Option<(u32, u32, usize)> {
        let mut best = None;
        let mut best_score = (u32::MAX, u64::MAX);
        for (turn, outline) in outlines.iter().enumerate() {
            let Some(last) = self.rows.len().checked_sub(outline.columns.len()) else { continue };
            // A wide chart gains nothing from being tried at every column.
            let step = (outline.columns.len() / 16).max(1);
            for x in (0..=last).step_by(step) {
                let limit = best_score.0.saturating_sub(outline.height);
                let Some((y, gap)) = self.rest(outline, x, limit) else { continue };
                let score = (y + outline.height, gap);
                if score < best_score {
                    best_score = score;
                    best = Some((x as u32, y, turn));
                }
            }
        }
        best
    }

    /// The row at which an outline comes to rest and the gap under it, if the row is at most `limit`.
    fn rest(&self, outline: &Shape, x: usize, limit: u32) -> Option<(u32, u64)> {
        let mut y = 0;
        let rows = &self.rows[x..x + outline.columns.len()];
        for (&filled, &(low, high)) in rows.iter().zip(&outline.columns) {
            if low < high {
                y = y.max(filled.saturating_sub(low));
                if y > limit {
                    return None;
                }
            }
        }
        let gap = |(&filled, &(low, high)): (&u32, &(u32, u32))| {
            if low < high { u64::from(y + low - filled) } else { 0 }
        };
        Some((y, rows.iter().zip(&outline.columns).map(gap).sum()))
    }

    fn put(&mut self, outline: &Shape, x: u32, y: u32) {
        for (filled, &(low, high)) in self.rows[x as usize..].iter_mut().zip(&outline.columns) {
            if low < high {
                *filled = (*filled).max(y + high);
            }
        }
        self.width_used = self.width_used.max(x + outline.width());
        self.height = self.height.max(y + outline.height);
    }
}

impl Boxed {
    fn new(chart: &LooseChart) -> Self {
        let axis = if chart.turnable { smallest_box_axis(&chart.corners) } else { DVec2::X };
        let turn = |c: DVec2| DVec2::new(c.dot(axis), axis.perp_dot(c));
        let mut corners: Vec<[DVec2; 3]> = chart.corners.iter().map(|t| t.map(turn)).collect();
        let low = corners.iter().flatten().fold(DVec2::INFINITY, |low, &c| low.min(c));
        corners.iter_mut().flatten().for_each(|c| *c -= low);
        let mut size = corners.iter().flatten().fold(DVec2::ZERO, |high, &c| high.max(c));
        if size.y > size.x {
            corners.iter_mut().flatten().for_each(|c| *c = DVec2::new(size.y - c.y, c.x));
            size = DVec2::new(size.y, size.x);
        }
        debug_assert!(
            corners.iter().all(|&c| area(c) >= 0.0 || area(c).abs() < 1e-9 * size.length_squared())
        );
        Self { corners, size }
    }

    /// Texels a world length: the density, but more for a chart that would be shorter than a texel, as it takes
    /// a whole one anyway.
    fn scale(&self, density: f64) -> f64 {
        if self.size.x > 0.0 { density.max(1.0 / self.size.x) } else { density }
    }

    /// Its triangles in texels after quarter turns, starting at 0.
    fn turned(&self, density: f64, turns: u32) -> impl Iterator<Item = [DVec2; 3]> + Clone {
        let scale = self.scale(density);
        let size = self.size * scale;
        let turn = move |c: DVec2| match turns {
            0 => c,
            1 => DVec2::new(size.y - c.y, c.x),
            2 => size - c,
            _ => DVec2::new(c.y, size.x - c.x),
        };
        self.corners.iter().map(move |t| t.map(|c| turn(c * scale).max(DVec2::ZERO)))
    }
}

/// The direction of the smallest box around some triangles: along an edge of their convex hull.
fn smallest_box_axis(triangles: &[[DVec2; 3]]) -> DVec2 {
    let hull = convex_hull(triangles.iter().flatten().copied().collect());
    let mut best = (f64::INFINITY, DVec2::X);
    for (i, &from) in hull.iter().enumerate() {
        let Some(axis) = (hull[(i + 1) % hull.len()] - from).try_normalize() else { continue };
        let (low, high) = hull.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), c| {
            let c = DVec2::new(c.dot(axis), axis.perp_dot(*c));
            (low.min(c), high.max(c))
        });
        let area = (high - low).element_product();
        if area < best.0 {
            best = (area, axis);
        }
    }
    best.1
}

/// The convex hull (Andrew's monotone chain).
fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let mut hull: Vec<DVec2> = Vec::new();
    for pass in 0..2 {
        let start = hull.len();
        for &p in &points {
            while hull.len() >= start + 2
                && (hull[hull.len() - 1] - hull[hull.len() - 2]).perp_dot(p - hull[hull.len() - 2]) <= 0.0
            {
                hull.pop();
            }
            hull.push(p);
        }
        hull.pop();
        if pass == 0 {
            points.reverse();
        }
    }
    if hull.is_empty() { points } else { hull }
}
