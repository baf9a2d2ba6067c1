//! How much less light arrives beside the axis.

use super::character_optics::CharacterOptics;
use super::rims::RimLimit;
use crate::{Aperture, ApertureRows};
use glam::DVec2;

/// Rows that the aperture is cut into.
const ROWS: usize = 128;

/// Places in a half-height at which it is computed; between them it is linear.
const PLACES: f64 = 32.0;

/// F(q) of a picture: the share of the aperture, weighed by its transmission, that the rims leave open for the light that lands at q,
/// whatever its depth.
#[derive(Clone, Debug, PartialEq)]
pub struct Falloff {
    first: DVec2,
    columns: usize,
    shares: Vec<f32>,
}

/// The share of an aperture of this radius (scene units), cut into rows, that all `limits` let through.
pub fn open_share(rows: &ApertureRows, radius: f64, limits: impl Iterator<Item = RimLimit> + Clone) -> f64 {
    if radius <= 0.0 {
        return f64::from(u8::from(limits.clone().all(|limit| limit.passes(DVec2::ZERO))));
    }
    let height = 2.0 / rows.rows.len() as f64;
    let (mut open, mut all) = (0.0, 0.0);
    for (row, runs) in rows.rows.iter().enumerate() {
        let v = -1.0 + (row as f64 + 0.5) * height;
        let chord = limits.clone().try_fold([f64::NEG_INFINITY, f64::INFINITY], |[from, to], limit| {
            limit.chord(v * radius).map(|chord| [from.max(chord[0]), to.min(chord[1])])
        });
        for run in &runs.runs {
            all += (run.end - run.start) * run.transmission;
            if let Some([from, to]) = chord {
                let width = run.end.min(to / radius) - run.start.max(from / radius);
                open += width.max(0.0) * run.transmission;
            }
        }
    }
    if all > 0.0 { open / all } else { 0.0 }
}

impl Falloff {
    /// F over the picture whose middle and half extent are `frame` (half-heights from the axis, [`Camera::frame_q`](crate::Camera::frame_q)).
    pub(crate) fn new(optics: &CharacterOptics, aperture: &Aperture, frame: [DVec2; 2]) -> Self {
        let [middle, half] = frame;
        let size = (2.0 * half * PLACES).ceil() + 1.0;
        let [columns, count] = [size.x as usize + 1, size.y as usize + 1];
        let (first, rows) = (middle - half, aperture.rows(ROWS));
        let place = |k: usize| first + DVec2::new((k % columns) as f64, (k / columns) as f64) / PLACES;
        let radius = optics.optics.aperture_radius;
        let reach = radius * std::f64::consts::SQRT_2;
        let share = |q: DVec2| {
            let limits = optics.limits_in_focus(q);
            match limits.clone().all(|limit| limit.passes_all(reach)) {
                true => 1.0,
                false => open_share(&rows, radius, limits) as f32,
            }
        };
        let shares = (0..columns * count).map(|k| share(place(k))).collect();
        Self { first, columns, shares }
    }

    /// F at `q`, half-heights from the axis, in [0, 1].
    pub fn at(&self, q: DVec2) -> f32 {
        let rows = self.shares.len() / self.columns;
        let most = DVec2::new((self.columns - 1) as f64, (rows - 1) as f64);
        let at = ((q - self.first) * PLACES).clamp(DVec2::ZERO, most);
        let [column, row] = [(at.x as usize).min(self.columns - 2), (at.y as usize).min(rows - 2)];
        let [right, down] = [at.x - column as f64, at.y - row as f64].map(|x| x as f32);
        let along = |row: usize| {
            let first = row * self.columns + column;
            self.shares[first] * (1.0 - right) + self.shares[first + 1] * right
        };
        along(row) * (1.0 - down) + along(row + 1) * down
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ApertureShape, Camera, Character, Rim};
    use std::f64::consts::PI;

    /// The area that two discs share, their centres `apart`.
    fn shared_area(a: f64, b: f64, apart: f64) -> f64 {
        if apart >= a + b {
            return 0.0;
        }
        if apart <= (a - b).abs() {
            return PI * a.min(b).powi(2);
        }
        let x = (apart * apart + a * a - b * b) / (2.0 * apart);
        let half = (a * a - x * x).max(0.0).sqrt();
        a * a * (x / a).acos() + b * b * ((apart - x) / b).acos() - apart * half
    }

    /// The closed form: at five places the area of the cut disc is that of two discs' intersection, to 0.5 %.
    #[test]
    fn the_cut_aperture_has_the_area_of_two_discs() {
        let rim = Rim { radius: 0.016, distance: 0.03 };
        let camera = Camera {
            aperture_radius: 0.0125,
            focus_distance: 2.0,
            character: Character { rims: [Some(rim), None], ..Character::default() },
            ..Camera::default()
        };
        let (optics, falloff) = (camera.character_optics(), camera.falloff().unwrap());
        let scale = 1.0 - rim.distance / camera.focus_distance;
        let mut least = 1.0f64;
        for q in [
            DVec2::ZERO,
            DVec2::new(0.5, 0.2),
            DVec2::new(-1.0, 0.4),
            DVec2::new(0.3, -0.95),
            DVec2::new(1.7, 0.9),
        ] {
            let apart = rim.distance * q.length() * optics.optics.tan_half_yfov / scale;
            let area = shared_area(camera.aperture_radius, rim.radius / scale, apart);
            let expected = area / (PI * camera.aperture_radius.powi(2));
            let found = f64::from(falloff.at(q));
            assert!((found / expected - 1.0).abs() < 5e-3, "{q}: {found} {expected}");
            let rows = Aperture::default().rows(512);
            let exact = open_share(&rows, camera.aperture_radius, optics.limits_in_focus(q));
            assert!((exact / expected - 1.0).abs() < 1e-3, "{q}: {exact} {expected}");
            // The control: without the scale of the focus distance.
            let other = shared_area(camera.aperture_radius, rim.radius, apart * scale)
                / (PI * camera.aperture_radius.powi(2));
            least = least.min(expected);
            assert!(expected > 0.99 || (found / other - 1.0).abs() > 5e-3, "{q}: {found} {other}");
        }
        assert!(least < 0.7, "the corner is cut: {least}");
    }

    #[test]
    fn what_is_not_cut_is_whole() {
        let wide = Rim { radius: 0.1, distance: 0.02 };
        for shape in [ApertureShape::Disc, ApertureShape::Square] {
            let camera = Camera {
                aperture: shape.into(),
                character: Character { rims: [Some(wide), Some(wide)], ..Character::default() },
                ..Camera::default()
            };
            let falloff = camera.falloff().unwrap();
            assert!(
                [DVec2::ZERO, DVec2::new(1.7, -1.0), DVec2::splat(9.0)]
                    .into_iter()
                    .all(|q| falloff.at(q) == 1.0)
            );
        }
        assert!(Camera::default().falloff().is_none());
        let pinhole = Camera {
            aperture_radius: 0.0,
            character: Character {
                rims: [Some(Rim { radius: 0.01, distance: 0.1 }), None],
                ..Character::default()
            },
            ..Camera::default()
        };
        let falloff = pinhole.falloff().unwrap();
        assert_eq!((falloff.at(DVec2::ZERO), falloff.at(DVec2::new(1.7, 0.0))), (1.0, 0.0));
    }
}
