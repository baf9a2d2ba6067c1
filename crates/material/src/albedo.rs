//! The directional albedo of GGX's single scattering, tabulated over the outgoing direction, the perceptual roughness and the
//! anisotropy.
//!
//! With Schlick's reflectance it is F0·A + F90·B: A is the share that does not rise with the angle, B the share that does. The rest,
//! 1 − A − B, is lost to multiple scattering.

use crate::fibonacci_lattice::{LATTICE, lattice};
use crate::fresnel::rise;
use crate::ggx::Ggx;
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;
use std::sync::OnceLock;

/// Number of cosines, from 0 to 1.
const COSINES: usize = 48;
/// Number of roughnesses, from 0 to 1, of isotropic surfaces; denser toward smooth ones, where grazing light
/// distinguishes them.
const ROUGHNESSES: usize = 48;
/// Number of roughnesses and of anisotropies of anisotropic surfaces, whose table has two more axes.
const ANISOTROPIC_STEPS: usize = 12;
/// Azimuths of the outgoing direction, from along the tangent to across it.
const AZIMUTHS: usize = 6;

/// A and B for one roughness and anisotropy: over cosines, and over azimuths if the surface is anisotropic.
struct Row {
    entries: Vec<DVec2>,
    azimuths: usize,
    /// The mean over the cosine-weighted hemisphere.
    mean: DVec2,
}

/// Cosines are dense toward grazing angles, where the albedo changes fast.
fn cosine_at(k: usize) -> f64 {
    (k as f64 / (COSINES - 1) as f64).powi(2).max(1e-4)
}

/// The index of the table entry below `x` in [0, 1] among `count`, and the fraction of the way to the next entry.
fn lerp_index(x: f64, count: usize) -> (usize, f64) {
    let position = x.clamp(0.0, 1.0) * (count - 1) as f64;
    let k = (position as usize).min(count.saturating_sub(2));
    (k, position - k as f64)
}

impl Row {
    fn new(ggx: &Ggx, azimuths: usize) -> Self {
        let azimuth =
            |k: usize| if azimuths > 1 { k as f64 / (azimuths - 1) as f64 * FRAC_PI_2 } else { 0.0 };
        let entry = |k: usize| integrate(ggx, cosine_at(k % COSINES), azimuth(k / COSINES));
        let entries = (0..azimuths * COSINES).map(entry).collect();
        let mut row = Self { entries, azimuths, mean: DVec2::ZERO };
        row.mean = row.hemisphere_mean();
        row
    }

    /// A and B at the square root of a cosine and an azimuth as a share of a right angle.
    fn at(&self, root: f64, azimuth: f64) -> DVec2 {
        let (c, fraction) = lerp_index(root, COSINES);
        let line = |a: usize| {
            let entries = &self.entries[a * COSINES..(a + 1) * COSINES];
            entries[c].lerp(entries[c + 1], fraction)
        };
        if self.azimuths == 1 {
            return line(0);
        }
        let (a, fraction) = lerp_index(azimuth, self.azimuths);
        line(a).lerp(line(a + 1), fraction)
    }

    /// (1/π)∫ … cos dω: with cos = x², dcos = 2x dx.
    fn hemisphere_mean(&self) -> DVec2 {
        const STEPS: usize = 256;
        let around = if self.azimuths == 1 { 1 } else { 16 };
        let step = |k: usize| {
            let x = ((k % STEPS) as f64 + 0.5) / STEPS as f64;
            self.at(x, ((k / STEPS) as f64 + 0.5) / around as f64) * 4.0 * x.powi(3)
        };
        (0..around * STEPS).map(step).sum::<DVec2>() / (around * STEPS) as f64
    }
}

/// A and B for one outgoing direction: when visible normals are sampled, a direction's weight is G₂/G₁.
fn integrate(ggx: &Ggx, cos: f64, azimuth: f64) -> DVec2 {
    let flat = (1.0 - cos * cos).max(0.0).sqrt();
    let o = DVec3::new(flat * azimuth.cos(), flat * azimuth.sin(), cos);
    let sum: DVec2 = lattice()
        .map(|u| {
            let h = ggx.visible_normal(o, u);
            let facing = o.dot(h);
            let i = 2.0 * facing * h - o;
            if i.z <= 0.0 {
                return DVec2::ZERO;
            }
            let risen = rise(facing);
            DVec2::new(1.0 - risen, risen) * (ggx.correlated_masking_shadowing(o, i) / ggx.masking(o))
        })
        .sum();
    sum / LATTICE as f64
}

/// The rows of isotropic surfaces, by roughness.
fn isotropic() -> &'static [Row] {
    static ROWS: OnceLock<Vec<Row>> = OnceLock::new();
    ROWS.get_or_init(|| {
        let roughness = |k: usize| (k as f64 / (ROUGHNESSES - 1) as f64).powi(2).max(2e-3);
        let row = |k: usize| Row::new(&Ggx::new(roughness(k), 0.0), 1);
        (0..ROUGHNESSES).map(row).collect()
    })
}

/// The rows of anisotropic surfaces, by roughness within anisotropy.
fn anisotropic() -> &'static [Row] {
    static ROWS: OnceLock<Vec<Row>> = OnceLock::new();
    ROWS.get_or_init(|| {
        let share = |k: usize| k as f64 / (ANISOTROPIC_STEPS - 1) as f64;
        let row = |k: usize| {
            Row::new(
                &Ggx::new(share(k % ANISOTROPIC_STEPS).max(0.02), share(k / ANISOTROPIC_STEPS)),
                AZIMUTHS,
            )
        };
        (0..ANISOTROPIC_STEPS * ANISOTROPIC_STEPS).map(row).collect()
    })
}

/// A gloss lobe whose albedo is looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gloss {
    /// Perceptual roughness.
    pub roughness: f64,
    /// Anisotropy strength.
    pub anisotropy: f64,
}

impl Gloss {
    /// A and B, each a share in [0, 1], toward a direction in the surface's axes (unit, z along the normal): the
    /// lobe's albedo is A·F0 + B·F90.
    pub fn shares(self, w: DVec3) -> DVec2 {
        let root = w.z.abs().min(1.0).sqrt();
        let azimuth = if self.anisotropy == 0.0 { 0.0 } else { w.y.abs().atan2(w.x.abs()) / FRAC_PI_2 };
        self.interpolated(|row| row.at(root, azimuth))
    }

    /// The means of A and B, as of [`Self::shares`], over the cosine-weighted hemisphere.
    pub fn mean_shares(self) -> DVec2 {
        self.interpolated(|row| row.mean)
    }

    fn interpolated(self, value: impl Fn(&Row) -> DVec2) -> DVec2 {
        if self.anisotropy == 0.0 {
            let (r, beyond) = lerp_index(self.roughness.max(0.0).sqrt(), ROUGHNESSES);
            let rows = isotropic();
            return value(&rows[r]).lerp(value(&rows[r + 1]), beyond);
        }
        let ((r, rough), (a, stretched)) =
            (lerp_index(self.roughness, ANISOTROPIC_STEPS), lerp_index(self.anisotropy, ANISOTROPIC_STEPS));
        let rows = anisotropic();
        let line = |a: usize| {
            value(&rows[a * ANISOTROPIC_STEPS + r]).lerp(value(&rows[a * ANISOTROPIC_STEPS + r + 1]), rough)
        };
        line(a).lerp(line(a + 1), stretched)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_what_their_lobe_sends_back() {
        for (roughness, anisotropy) in
            [(0.0, 0.0), (0.13, 0.0), (0.4, 0.0), (0.77, 0.0), (1.0, 0.0), (0.3, 0.6), (0.7, 0.9)]
        {
            let gloss = Gloss { roughness, anisotropy };
            let ggx = Ggx::new(roughness.max(2e-3), anisotropy);
            for (cos, azimuth) in [(0.1, 0.2), (0.5, 0.9), (0.9, 1.5)] {
                let o = DVec3::new(0.0, 0.0, cos)
                    + (1.0f64 - cos * cos).sqrt() * DVec3::new(f64::cos(azimuth), f64::sin(azimuth), 0.0);
                let [tabulated, integrated] = [gloss.shares(o), integrate(&ggx, cos, azimuth)];
                let tolerance = if anisotropy == 0.0 { 0.002 } else { 0.006 };
                assert!(
                    tabulated.distance(integrated) < tolerance,
                    "{gloss:?} {cos}: {tabulated}, not {integrated}"
                );
            }
        }
        // A mirror loses nothing.
        assert!((Gloss { roughness: 0.0, anisotropy: 0.0 }.mean_shares().element_sum() - 1.0).abs() < 1e-3);
    }
}
