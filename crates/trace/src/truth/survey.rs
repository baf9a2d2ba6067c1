//! Chooses the sample sequence of each pixel from a few rays that are traced in advance.
//!
//! [`super::sheared`] has samples for every radius of the circle of confusion; this chooses a pixel's. Where its rays
//! meet one depth, its texture lies there. Where they meet two, of one light each, the edge between them belongs to
//! what lies in front. The rays are used for nothing else, so that the choice does not depend on the samples that it
//! is made for.
//!
//! Where no order helps much, as with an edge before a texture of another depth, pixels have samples without one.
//!
//! All pixels whose light paint sends to other pixels have one sequence in common: what lands then is even by
//! construction (see [`super::samples`]). If nearly all that is there to decide is of one circle of confusion and moved
//! alike, that sequence suits it ([`Survey::moved`]); where several paints meet, no sequence suits them all.

mod paint;
mod survey_hit;

use super::options::{Region, TruthOptions};
use super::samples::PixelSample;
use super::sheared::{self, Level, Spread};
use glam::{DVec2, Vec3};
use paint::Paint;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
pub(super) use survey_hit::SurveyHit;
use survey_hit::{WITHIN, is_uniform, scatter, widest_gap};

/// Every pixel's samples.
pub(super) struct Survey {
    /// What the samples suit that all pixels have in common whose light paint moves; none if it is of many kinds.
    pub moved: Option<Spread>,
    /// The levels in use where light stays.
    pub levels: Vec<Level>,
    /// For every pixel of the region [`MOVED`], [`PLAIN`], or [`FIRST_LEVEL`] and the place of its level in `levels`.
    pub choices: Vec<u16>,
}

/// The choice of those samples that pixels have in common whose light paint moves.
pub(super) const MOVED: u16 = 0;
/// Of those without an order.
pub(super) const PLAIN: u16 = 1;
/// Of those of the first level.
pub(super) const FIRST_LEVEL: u16 = 2;

/// The number of survey rays per pixel: an eighth of the render's samples, and none where that is too few to
/// classify a pixel.
pub(super) fn rays_per_pixel(options: &TruthOptions) -> u32 {
    match options.samples_per_pixel / 8 {
        _ if !options.surveys_light => 0,
        0..MIN_RAYS => 0,
        rays => rays.min(MAX_RAYS),
    }
}

const MIN_RAYS: u32 = 16;
const MAX_RAYS: u32 = 32;
/// An order helps if the light along it is smoother than this share of what it is without order.
const SMOOTHER: f32 = 0.8;

impl Survey {
    /// Surveys a region's pixels. `trace_hit` traces a ray of the pixel with this upper left corner.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn run(
        region: Region,
        rays: &[PixelSample],
        aperture_radius: f64,
        trace_hit: impl Fn(DVec2, &PixelSample) -> SurveyHit + Sync,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let mut findings = vec![Finding::Nothing; region.pixels()];
        let orders: Vec<OnceLock<Vec<u32>>> = (0..Level::COUNT).map(|_| OnceLock::new()).collect();
        let order = |level: Level| -> &[u32] {
            orders[level.index()].get_or_init(|| sheared::order(rays, level, aperture_radius))
        };
        let done = AtomicUsize::new(0);
        let width = region.width.max(1) as usize;
        findings.par_chunks_mut(width).enumerate().try_for_each(|(row, pixels)| {
            progress.check()?;
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let corner =
                    DVec2::new(f64::from(region.x) + column as f64, f64::from(region.y) + row as f64);
                let hits: Vec<SurveyHit> = rays.iter().map(|ray| trace_hit(corner, ray)).collect();
                *pixel = classify(&hits, order);
            }
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / region.height.max(1) as f32);
            Ok(())
        })?;
        let pixels = (0..findings.len()).into_par_iter();
        let chosen: Vec<Option<Level>> = pixels.map(|pixel| vote(&findings, width, pixel)).collect();
        let mut levels: Vec<Level> = chosen.iter().copied().flatten().collect();
        levels.sort_unstable();
        levels.dedup();
        let choice = |level: Level| FIRST_LEVEL + levels.partition_point(|&other| other < level) as u16;
        let choose = |(level, finding): (Option<Level>, &Finding)| match finding {
            Finding::Moved(_) => MOVED,
            _ => level.map_or(PLAIN, choice),
        };
        let choices = chosen.into_iter().zip(&findings).map(choose).collect();
        let paints = findings.iter().filter_map(|finding| match finding {
            Finding::Moved(paint) => Some(*paint),
            _ => None,
        });
        Ok(Self { moved: paint::common_spread(paints), levels, choices })
    }
}

/// The classification of a pixel by its own rays.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Finding {
    /// All hits have the same radiance: any sequence will do.
    Nothing,
    /// No order helps.
    Plain,
    /// It should have those of a level.
    Level(Level),
    /// Paint sends light elsewhere.
    Moved(Paint),
}

/// The level whose order suits what a pixel's rays meet.
fn classify<'a>(hits: &[SurveyHit], order: impl Fn(Level) -> &'a [u32]) -> Finding {
    if hits.iter().any(|hit| hit.moved_px != 0.0) {
        return Finding::Moved(Paint::classify(hits));
    }
    if is_uniform(hits) {
        return Finding::Nothing;
    }
    let mut by_radius = hits.to_vec();
    by_radius.sort_by(|a, b| a.radius_px.total_cmp(&b.radius_px));
    // κ grows with depth.
    let (front, behind) = by_radius.split_at(widest_gap(&by_radius));
    let level = Level::from_radius(by_radius[front.len() / 2].radius_px);
    let suits = if behind.is_empty() {
        let along = |order: &mut dyn Iterator<Item = &SurveyHit>| -> f32 {
            let lights: Vec<Vec3> = order.map(|hit| hit.light).collect();
            lights.windows(2).map(|pair| (pair[1] - pair[0]).abs().element_sum()).sum()
        };
        let smooth = along(&mut order(level).iter().map(|&k| &hits[k as usize]));
        smooth < SMOOTHER * along(&mut hits.iter())
    } else {
        scatter(front) + scatter(behind) < WITHIN * scatter(hits)
    };
    if suits { Finding::Level(level) } else { Finding::Plain }
}

/// The level that most of a pixel and its neighbours agree on, its own if it can: few rays err, and miss what the
/// neighbours see. `None` for those without an order.
fn vote(findings: &[Finding], width: usize, pixel: usize) -> Option<Level> {
    let own = match findings[pixel] {
        Finding::Plain | Finding::Moved(_) => return None,
        Finding::Nothing => None,
        Finding::Level(level) => Some(level),
    };
    let (x, y) = (pixel % width, pixel / width);
    let rows = y.saturating_sub(1)..(y + 2).min(findings.len() / width);
    let columns = x.saturating_sub(1)..(x + 2).min(width);
    let levels: Vec<Level> = rows
        .flat_map(|y| columns.clone().map(move |x| findings[y * width + x]))
        .filter_map(|finding| if let Finding::Level(level) = finding { Some(level) } else { None })
        .collect();
    let support = |level: Level| levels.iter().filter(|other| other.is_near(level)).count();
    let best = levels.iter().copied().max_by_key(|&level| (support(level), std::cmp::Reverse(level)))?;
    let level = own.filter(|&own| support(own) == support(best)).unwrap_or(best);
    (level != Level::SHARP).then_some(level)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::Sampler;
    use crate::truth::samples::points;

    /// Rays of a pixel whose front half, of the signed radius `front`, is bright to one side of a line; behind it is
    /// the radius `behind`, with light that `texture` gives at where the ray crosses that depth.
    pub(super) fn survey_hits(
        rays: &[PixelSample],
        [front, behind]: [f64; 2],
        line: f64,
        texture: impl Fn(DVec2) -> f32,
    ) -> Vec<SurveyHit> {
        let crossing =
            |ray: &PixelSample, radius: f64| ray.within_px - radius * DVec2::new(ray.u.x, -ray.u.y);
        let survey_hit = |ray: &PixelSample| {
            let is_front = crossing(ray, front).dot(DVec2::new(0.8, 0.6)) < line;
            let light = if is_front { 5.0 } else { texture(crossing(ray, behind)) };
            let radius_px = if is_front { front } else { behind };
            SurveyHit { radius_px, moved_px: 0.0, light: Vec3::splat(light) }
        };
        rays.iter().map(survey_hit).collect()
    }

    pub(super) fn rays() -> Vec<PixelSample> {
        let aperture = lens::ApertureSampler::new(&lens::ApertureShape::Disc.into());
        points(Sampler::LowDiscrepancy, 5, 0..u64::from(MAX_RAYS))
            .map(|[x, y, a, b]| PixelSample { within_px: DVec2::new(x, y), u: aperture.sample(a, b) })
            .collect()
    }

    fn finding_of(radii: [f64; 2], line: f64, texture: impl Fn(DVec2) -> f32) -> Finding {
        let rays = rays();
        let orders: Vec<OnceLock<Vec<u32>>> = (0..Level::COUNT).map(|_| OnceLock::new()).collect();
        classify(&survey_hits(&rays, radii, line, texture), |level| {
            orders[level.index()].get_or_init(|| sheared::order(&rays, level, 1.0))
        })
    }

    #[test]
    fn an_edge_has_the_level_of_what_lies_in_front() {
        for radii in [[-4.0, 0.0], [0.0, 9.0], [3.0, 12.0]] {
            assert_eq!(
                finding_of(radii, 0.7, |_| 1.0),
                Finding::Level(Level::from_radius(radii[0])),
                "{radii:?}"
            );
        }
    }

    #[test]
    fn a_texture_has_its_own_level_but_behind_an_edge_none() {
        let texture = |place: DVec2| if place.x < 0.5 { 0.0 } else { 40.0 };
        assert_eq!(
            finding_of([-6.0, 2.0], f64::NEG_INFINITY, texture),
            Finding::Level(Level::from_radius(2.0))
        );
        assert_eq!(finding_of([-6.0, 2.0], 0.7, texture), Finding::Plain);
    }

    #[test]
    fn one_light_says_nothing_and_no_order_is_none() {
        assert_eq!(finding_of([-6.0, 0.0], 0.7, |_| 5.0), Finding::Nothing);
        // Light without any order in space.
        let noise = |place: DVec2| (place.x * 12345.678).sin() as f32;
        assert_eq!(finding_of([2.0, 2.0], f64::NEG_INFINITY, noise), Finding::Plain);
    }

    #[test]
    fn neighbours_outvote_an_error_and_tell_those_that_saw_nothing() {
        let level = |radius| Finding::Level(Level::from_radius(radius));
        let (edge, error) = (level(3.0), level(9.0));
        let found = [
            edge,
            edge,
            error,
            Finding::Nothing,
            Finding::Plain,
            edge,
            Finding::Nothing,
            Finding::Nothing,
            edge,
        ];
        let agreed: Vec<_> = (0..9).map(|pixel| vote(&found, 3, pixel)).collect();
        let [edge, none] = [Some(Level::from_radius(3.0)), None];
        assert_eq!(agreed, [edge, edge, edge, edge, none, edge, none, edge, edge]);
        assert_eq!(vote(&[level(0.0), level(0.0)], 2, 0), None, "in focus the common samples are best");
        assert_eq!(
            vote(&[level(5.0), level(2.0)], 2, 0),
            Some(Level::from_radius(5.0)),
            "its own if no more say otherwise"
        );
    }
}
