//! The two sides of a refracting surface, and what rough glass reflects and loses by single scattering on either.

use crate::fibonacci_lattice::{LATTICE, lattice};
use crate::fresnel::dielectric_reflectance;
use crate::ggx::Ggx;
use glam::{DVec2, DVec3};
use std::sync::OnceLock;

/// Number of cosines of a row.
const COSINES: usize = 48;
/// Number of roughnesses in the table.
const ROUGHNESSES: usize = 24;
/// The smoothest row of the table.
const SMOOTHEST_ROUGHNESS: f64 = 2e-3;

/// The media in front of and behind a surface. Made once per material: rough glass needs tables.
#[derive(Debug)]
pub struct Interface {
    /// Index of refraction on the front.
    front: f64,
    /// Index of refraction on the back.
    back: f64,
    tables: OnceLock<[Vec<Entries>; 2]>,
}

/// For every cosine of a row: the share that single scattering reflects, and the share that it sends to neither side.
type Entries = [DVec2; COSINES];

/// Rough glass as seen from one side, over the cosine.
///
/// Lobes of all widths are alike if the cosine is measured in α, so the cosines of a row are α·s/(1 + α − s) for even steps of s in
/// [0, 1], and rows of neighbouring roughness are interpolated at equal s. Between its cosines a row is linear.
#[derive(Clone, Debug)]
pub(crate) struct GlassRow {
    alpha: f64,
    entries: Entries,
    /// ∫ of the lost share, 2∫₀ … cos dcos, up to every cosine.
    lost_below: [f64; COSINES],
    /// The mean reflected share over the cosine-weighted hemisphere.
    pub mean_mirrored: f64,
}

/// Rough glass as seen from its front and from its back.
#[derive(Clone, Debug)]
pub(crate) struct RoughGlass {
    rows: [GlassRow; 2],
    eta: [f64; 2],
}

impl Interface {
    /// The interface with vacuum on the front and a medium with this index of refraction on the back.
    pub fn from_ior(ior: f64) -> Self {
        Self::between(1.0, ior)
    }

    /// The interface between media with the indices of refraction `front` and `back`.
    pub fn between(front: f64, back: f64) -> Self {
        Self { front, back, tables: OnceLock::new() }
    }

    /// The index of refraction on the far side over that on the near side, seen from the front or the back.
    pub fn eta(&self, from_front: bool) -> f64 {
        if from_front { self.back / self.front } else { self.front / self.back }
    }

    /// The tables for glass of a roughness between the media.
    pub(crate) fn rough(&self, roughness: f64) -> RoughGlass {
        let tables = self.tables.get_or_init(|| {
            let roughness_at = |k: usize| k as f64 / (ROUGHNESSES - 1) as f64;
            [true, false]
                .map(|front| (0..ROUGHNESSES).map(|k| entries(roughness_at(k), self.eta(front))).collect())
        });
        let place = roughness.clamp(0.0, 1.0) * (ROUGHNESSES - 1) as f64;
        let r = (place as usize).min(ROUGHNESSES - 2);
        let row = |rows: &Vec<Entries>| {
            let join = |k: usize| rows[r][k].lerp(rows[r + 1][k], place - r as f64);
            GlassRow::new(roughness, std::array::from_fn(join))
        };
        let [front, back] = tables;
        RoughGlass { rows: [row(front), row(back)], eta: [true, false].map(|side| self.eta(side)) }
    }
}

impl RoughGlass {
    /// The glass as seen from the front (`true`) or the back.
    pub fn side(&self, front: bool) -> &GlassRow {
        &self.rows[usize::from(!front)]
    }

    /// The share of the lost light that returns on the outgoing side. The transmitted share is chosen so that transmission is reciprocal:
    /// (1 − r)/((1 − Ē')n'²) is the same from both sides.
    pub fn returned_share(&self, from_front: bool) -> f64 {
        let side_terms = |front: bool| {
            let beyond = self.side(!front).mean_lost() * self.eta[usize::from(!front)].powi(2);
            (1.0 - self.side(front).mean_mirrored, beyond)
        };
        let ((own, beyond), (others, before)) = (side_terms(from_front), side_terms(!from_front));
        // In units of n² of the near side: `beyond` of the other side is in its own units.
        let eta2 = self.eta[usize::from(!from_front)].powi(2);
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
        let k = ratio(own, beyond).min(ratio(others, before * eta2));
        1.0 - (k * beyond).clamp(0.0, 1.0)
    }
}

/// The cosine of a step of s.
fn cosine_at(alpha: f64, k: usize) -> f64 {
    let s = k as f64 / (COSINES - 1) as f64;
    alpha * s / (1.0 + alpha - s)
}

fn alpha_of(roughness: f64) -> f64 {
    roughness.max(SMOOTHEST_ROUGHNESS).powi(2)
}

/// One row of the table.
fn entries(roughness: f64, eta: f64) -> Entries {
    let alpha = alpha_of(roughness);
    let ggx = Ggx::new(alpha.sqrt(), 0.0);
    std::array::from_fn(|k| {
        // At the horizon itself nothing is visible; the first cosine is a little above it.
        let directional = integrate(&ggx, cosine_at(alpha, k).max(1e-3 * alpha), eta);
        // The integration is not exact: the sum may come out a little above 1.
        DVec2::new(directional.x, (1.0 - directional.element_sum()).max(0.0))
    })
}

/// 2∫ (a + b·t)·t dt between two cosines, of a value linear between them.
fn integral(from: f64, to: f64, at_from: f64, at_to: f64) -> f64 {
    let b = (at_to - at_from) / (to - from);
    let a = at_from - b * from;
    a * (to * to - from * from) + 2.0 / 3.0 * b * (to.powi(3) - from.powi(3))
}

impl GlassRow {
    fn new(roughness: f64, entries: Entries) -> Self {
        let alpha = alpha_of(roughness);
        let cell = |k: usize, component: &dyn Fn(DVec2) -> f64| {
            let [from, to] = [k - 1, k].map(|k| cosine_at(alpha, k));
            integral(from, to, component(entries[k - 1]), component(entries[k]))
        };
        let mut lost_below = [0.0; COSINES];
        for k in 1..COSINES {
            lost_below[k] = lost_below[k - 1] + cell(k, &|entry| entry.y);
        }
        let mean_mirrored = (1..COSINES).map(|k| cell(k, &|entry| entry.x)).sum();
        Self { alpha, entries, lost_below, mean_mirrored }
    }

    fn at(&self, cos: f64) -> DVec2 {
        let cos = cos.clamp(0.0, 1.0);
        let s = cos * (1.0 + self.alpha) / (cos + self.alpha);
        let k = ((s * (COSINES - 1) as f64) as usize).min(COSINES - 2);
        let [from, to] = [k, k + 1].map(|k| cosine_at(self.alpha, k));
        self.entries[k].lerp(self.entries[k + 1], ((cos - from) / (to - from)).clamp(0.0, 1.0))
    }

    /// The share, in [0, 1], that single scattering reflects where light comes in at an angle with this cosine.
    pub fn mirrored(&self, cos: f64) -> f64 {
        self.at(cos).x
    }

    /// The share, in [0, 1], that single scattering sends to neither side where light comes in at an angle with this
    /// cosine.
    pub fn lost(&self, cos: f64) -> f64 {
        self.at(cos).y
    }

    /// The mean of [`Self::lost`] over the cosine-weighted hemisphere, in [0, 1].
    pub fn mean_lost(&self) -> f64 {
        self.lost_below[COSINES - 1]
    }

    /// Samples a cosine of the lost light: its density over the hemisphere is lost·cos/(π · mean lost).
    pub fn cosine_of_lost(&self, u: f64) -> f64 {
        let target = u.clamp(0.0, 1.0) * self.mean_lost();
        let k = self.lost_below.partition_point(|below| *below <= target).clamp(1, COSINES - 1);
        let [from, to] = [k - 1, k].map(|k| cosine_at(self.alpha, k));
        let end = |cos: f64| {
            let share = (cos - from) / (to - from);
            let [a, b] = [self.entries[k - 1].y, self.entries[k].y];
            if cos > from { integral(from, cos, a, a + (b - a) * share) } else { 0.0 }
        };
        let (mut low, mut high) = (from, to);
        for _ in 0..40 {
            let middle = (low + high) / 2.0;
            if self.lost_below[k - 1] + end(middle) < target { low = middle } else { high = middle }
        }
        (low + high) / 2.0
    }
}

/// The reflected and the transmitted share for a cosine.
fn integrate(ggx: &Ggx, cos: f64, eta: f64) -> DVec2 {
    let o = DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let sum: DVec2 = lattice()
        .map(|u| {
            let h = ggx.visible_normal(o, u);
            let facing = o.dot(h);
            let mirrored = dielectric_reflectance(facing, eta);
            let i = 2.0 * facing * h - o;
            let stays = if i.z > 0.0 {
                mirrored * ggx.correlated_masking_shadowing(o, i) / ggx.masking(o)
            } else {
                0.0
            };
            let beyond = refracted(o, h, eta).filter(|i| i.z < 0.0);
            DVec2::new(stays, beyond.map_or(0.0, |i| (1.0 - mirrored) * ggx.masking(i)))
        })
        .sum();
    sum / LATTICE as f64
}

/// The direction that light toward `o` comes from through a facet of normal `h`; `None` beyond the critical angle.
pub(crate) fn refracted(o: DVec3, h: DVec3, eta: f64) -> Option<DVec3> {
    let cos = o.dot(h);
    let cos2_beyond = 1.0 - (1.0 - cos * cos) / (eta * eta);
    (cos2_beyond > 0.0).then(|| (h * cos - o) / eta - h * cos2_beyond.sqrt())
}
