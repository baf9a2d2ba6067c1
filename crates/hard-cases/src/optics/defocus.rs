//! κ at the poles of other forms of its formula.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::support::light_field::{offset_of, picture_of_stars, star};
use crate::support::measure::{energy, worst};
use glam::DVec2;
use lens::{Aperture, ApertureShape, Camera, FocusOffset, Optics, Picture};
use progress::{Cancelled, Progress};

pub const CASES: &[Case] = &[
    Case {
        name: "κ → 0 through both signs",
        reason: "The rays of a splat are displaced by at most its radius, so its picture converges to the \
                 sharp one, keeps its mass, and is rotated by 180° when κ changes sign.",
        control: "a disc of density 1/(area·r²), sampled at pixel centres",
        check: kappa_to_zero,
    },
    Case {
        name: "z = f and both sides",
        reason: "At z = f the conjugate is at infinity and κ = (a·t − 1)/d; on both sides κ is linear in 1/z.",
        control: "κ = (T/z' − 1)/d, computed through the conjugate z' and T = t·lerp(d, z', a)",
        check: depth_of_the_focal_length,
    },
    Case {
        name: "s = ∞, s = f, object at infinity",
        reason: "Infinite distances are represented by a reciprocal of 0; with s = f the sensor is at \
                 infinity, and paint relative to it has no effect.",
        control: "κ = (z − s)/(s·z), computed from the distances",
        check: infinite_distances,
    },
];

/// κ of the first case: radii of 13 px and less.
const SMALL_KAPPAS: [f64; 9] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 0.0];

fn small_camera() -> Camera {
    let triangle = ApertureShape::Polygon { blades: 3, rotation: 0.3, roundness: 0.0 };
    Camera {
        width: 65,
        height: 65,
        yfov: 0.48,
        aperture_radius: 10.0,
        aperture: triangle.into(),
        ..Camera::default()
    }
}

fn kappa_to_zero(_: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let camera = small_camera();
    let splat_at = |kappa: f64| {
        let samples = vec![star(DVec2::splat(32.5), 0.5, 1.0)];
        picture_of_stars(&camera, samples, offset_of(kappa, &camera), progress)
    };
    let naive = |kappa: f64| Ok(naive_disc(&camera, camera.optics().splat_radius_px(kappa)));
    let expected = "mass 1 ± 1e-5; L1 distance from sharp ≤ 4r; P(−κ) is P(κ) turned, to 1e-3";
    let limits = [("mass", 1e-5), ("distance/4r", 1.0), ("turned", 1e-3)];
    Ok(Verdict::new(expected, limits, tends_to_sharp(&camera, splat_at)?, tends_to_sharp(&camera, naive)?))
}

/// Largest error of the mass, L1 distance from the sharp picture over 4r, and difference between both signs.
fn tends_to_sharp(
    camera: &Camera,
    picture_at: impl Fn(f64) -> Result<Picture, Cancelled>,
) -> Result<[f64; 3], Cancelled> {
    let sharp = picture_at(0.0)?;
    let (mut mass, mut moved, mut turned) = (Vec::new(), Vec::new(), Vec::new());
    for kappa in SMALL_KAPPAS {
        let [far, near] = [picture_at(kappa)?, picture_at(-kappa)?];
        let values =
            |picture: &Picture| picture.radiance.iter().map(|rgb| f64::from(rgb[1])).collect::<Vec<_>>();
        let (far_values, near_values, sharp) = (values(&far), values(&near), values(&sharp));
        let distance: f64 = far_values.iter().zip(&sharp).map(|(a, b)| (a - b).abs()).sum();
        mass.extend([energy(&far) - 1.0, energy(&near) - 1.0]);
        // Even an undisplaced splat differs by the quantum of the integer sums.
        moved.push(distance / (4.0 * camera.optics().splat_radius_px(kappa) + 1e-6));
        turned.extend(far_values.iter().zip(near_values.iter().rev()).map(|(a, b)| a - b));
    }
    Ok([worst(mass), worst(moved), worst(turned)])
}

/// The aperture's shape scaled by r and divided by its area, sampled at pixel centres.
fn naive_disc(camera: &Camera, radius_px: f64) -> Picture {
    let mut picture = Picture::black(camera.width, camera.height);
    let area = camera.aperture.rows(64).open_area() * radius_px * radius_px;
    for (k, rgb) in picture.radiance.iter_mut().enumerate() {
        let pixel = DVec2::new((k % 65) as f64, (k / 65) as f64) - 32.0;
        let u = DVec2::new(pixel.x, -pixel.y) / radius_px;
        *rgb = [(camera.aperture.transmission(u) / area) as f32; 3];
    }
    picture
}

/// An aperture whose numbers are exact in binary: s = 4, d = 1/32, 1/f = 32.25.
fn exact_optics() -> Optics {
    Optics {
        inverse_focus_distance: 0.25,
        image_distance: 1.0 / 32.0,
        aperture_radius: 0.0125,
        tan_half_yfov: 0.25,
        half_height_px: 270.0,
    }
}

fn depth_of_the_focal_length(_: Effort, _: &dyn Progress) -> Result<Verdict, Cancelled> {
    let optics = exact_optics();
    let naive = |inverse_depth: f64, FocusOffset { t, anchor, .. }: FocusOffset| {
        let d = optics.image_distance;
        let conjugate = 1.0 / (optics.inverse_focus_distance + 1.0 / d - inverse_depth);
        let travelled = t * ((1.0 - anchor) * d + anchor * conjugate);
        (travelled / conjugate - 1.0) / d
    };
    let right = error_about_the_focal_length(&optics, |z, focus| optics.kappa(z, focus));
    let wrong = error_about_the_focal_length(&optics, naive);
    Ok(Verdict::new(
        "κ = (a·t − 1)/d + t·(1 − a)·(1/f − 1/z), to 1e-14",
        [("error", 1e-14)],
        [right],
        [wrong],
    ))
}

/// The largest error of `kappa` relative to (1 + |t|)/d, from z = f/2 through f to 2f.
fn error_about_the_focal_length(optics: &Optics, kappa: impl Fn(f64, FocusOffset) -> f64) -> f64 {
    let d = optics.image_distance;
    let at_f = 1.0 / optics.focal_length();
    let mut errors = Vec::new();
    for step in [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.5, 1.0] {
        for inverse_depth in [at_f * (1.0 + step), at_f * (1.0 - step / 2.0)] {
            for t in [-2.0, 0.0, 0.5, 1.0, 1.5, 1e6] {
                for a in [0.0, 0.25, 0.5, 1.0] {
                    let expected = (a * t - 1.0) / d + t * (1.0 - a) * (at_f - inverse_depth);
                    let found = kappa(inverse_depth, FocusOffset::new(t, a));
                    errors.push((found - expected) * d / (1.0 + f64::abs(t)));
                }
            }
        }
    }
    worst(errors)
}

fn infinite_distances(_: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let circle_at = |s: f64, z: f64| {
        let camera = Camera { focus_distance: s, ..Camera::default() };
        camera.optics().kappa(1.0 / z, FocusOffset::STANDARD)
    };
    let naive = |s: f64, z: f64| (z - s) / (s * z);
    let error = |kappa: &dyn Fn(f64, f64) -> f64| {
        let far = f64::INFINITY;
        let known = [(far, far, 0.0), (far, 2.0, -0.5), (2.0, far, 0.5), (2.0, 2.0, 0.0), (1e-3, far, 1e3)];
        worst(known.map(|(s, z, expected)| kappa(s, z) - expected))
    };
    // For a lens focused at infinity a star is a point; for others it has the aperture's shape.
    let radius = |s: f64| -> Result<f64, Cancelled> {
        let camera = Camera { focus_distance: s, aperture: Aperture::default(), ..small_camera() };
        let samples = vec![star(DVec2::splat(32.5), 0.5, 1.0)];
        Ok(disc_radius(&picture_of_stars(&camera, samples, FocusOffset::STANDARD, progress)?))
    };
    let at = |s: f64| Camera { focus_distance: s, ..small_camera() }.optics().splat_radius_px(1.0 / s);
    let stars =
        worst([radius(f64::INFINITY)?, radius(100.0)? / at(100.0) - 1.0, radius(200.0)? / at(200.0) - 1.0]);
    // s = f: the sensor is infinitely far, and therefore infinitely high.
    let far_sensor = Optics { image_distance: f64::INFINITY, ..exact_optics() };
    let painted = worst([-3.0, 0.0, 0.9, 1e6].map(|t| far_sensor.kappa(0.5, FocusOffset::new(t, 1.0))));
    let same_f = far_sensor.focal_length() * far_sensor.inverse_focus_distance - 1.0;
    let limits = [("κ", 0.0), ("star", 0.01), ("s = f", 0.0)];
    let right = [error(&circle_at), stars, worst([painted, same_f])];
    let expected = "κ = 1/s − 1/z exactly; a star's radius 0 at s = ∞, else that of 1/s, to 1 %; paint on the conjugate of \
                    an infinitely far sensor leaves κ = 0";
    Ok(Verdict::new(expected, limits, right, [error(&naive), NOT_COMPUTED, NOT_COMPUTED]))
}

/// Radius of the disc with the same second moment as the picture, after subtracting that of a pixel, px.
fn disc_radius(picture: &Picture) -> f64 {
    let (mut mass, mut second) = (0.0, 0.0);
    for (k, rgb) in picture.radiance.iter().enumerate() {
        let place = DVec2::new((k % 65) as f64, (k / 65) as f64) - 32.0;
        mass += f64::from(rgb[1]);
        second += f64::from(rgb[1]) * place.length_squared();
    }
    // The square of a star and the box of a pixel add a variance of 1/12 each in x and y; neither shows if
    // all light falls on one pixel.
    if mass > 0.999 && second == 0.0 { 0.0 } else { (2.0 * (second / mass - 1.0 / 3.0)).max(0.0).sqrt() }
}
