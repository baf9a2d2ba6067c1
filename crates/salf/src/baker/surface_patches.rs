//! Samples placed on the surface itself.
//!
//! A triangle whose plane passes through or close by the aperture covers next to nothing of the pinhole picture, yet the
//! rim of the aperture sees it: the weight |n·(P − U)|/|n·P| of pinhole samples has no bound there. And a small lamp may
//! lie between the pinhole's rays. Such triangles ([`crate::baker::placement`]) are cut into patches of about a pixel, and each
//! side of a patch that can be seen is a sample.

use crate::baker::block_baker::BlockBaker;
use crate::baker::outgoing::{LightComponent, MeanRadiance};
use crate::baker::shadow_rays::{self, Fineness, Patterns, VisiblePart};
use crate::domain::Domain;
use crate::jitter::jitter;
use crate::sample::Sample;
use crate::samples::block_corner;
use crate::view::View;
use glam::{DVec2, DVec3, IVec2};
use surface::SurfacePoint;
use trace::Viewpoint;

/// More pieces than this are not made of one triangle: the largest is then split no further.
const MAX_PATCHES: usize = 20_000;

/// Pieces whose image on the picture is brighter are cut further: one alone would show the cells of its visibility.
const GLARING: f64 = 0.5;

/// Pieces of at most this extent, px, are cut no further, however bright.
const FINEST_PX: f64 = 1.0 / 16.0;

/// A piece of a triangle: its corners as barycentrics and in camera space.
#[derive(Clone, Copy)]
struct Piece {
    barycentric: [DVec2; 3],
    corners: [DVec3; 3],
}

impl Piece {
    fn center(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 3.0
    }

    /// Where its centre is in the pinhole picture, px.
    fn pixel(&self, view: &View) -> DVec2 {
        view.camera.pixel_from_q(view.optics.chief(self.center()))
    }

    /// Along its normal, as long as it is large.
    fn area_normal(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a) / 2.0
    }

    /// How bright its image is at most, where the standard lens makes it, if its points are of such a `brightness`.
    fn glare(&self, view: &View, brightness: f64) -> f64 {
        let (position, normal) = (self.center(), self.area_normal());
        let rim = view.optics.aperture_radius * normal.truncate().abs().element_sum();
        let largest = (normal.dot(position).abs() + rim) * view.density(position.z);
        let kappa = view.optics.standard_kappa(1.0 / position.z);
        largest * brightness / view.optics.circle_of_confusion_px(kappa).powi(2).max(1.0)
    }

    /// Half the sides of its box in the pinhole picture, px; as large as its largest weight, px², where it is edge-on.
    fn half_size_px(&self, view: &View, largest_weight: f64) -> DVec2 {
        const SMALLEST_PX: f64 = 0.03;
        const LARGEST_PX: f64 = 8.0;
        let pixels = self.corners.map(|p| view.camera.pixel_from_q(view.optics.chief(p)));
        let low = pixels[0].min(pixels[1]).min(pixels[2]);
        let high = pixels[0].max(pixels[1]).max(pixels[2]);
        let half = ((high - low) / 2.0).max(DVec2::splat(SMALLEST_PX));
        let enlarged = half * (largest_weight / (4.0 * half.x * half.y)).max(1.0).sqrt();
        enlarged.min(DVec2::splat(LARGEST_PX))
    }
}

/// The samples of one triangle.
///
/// `is_selected` decides by the corner of a block whether its patches are made.
pub fn samples(baker: &BlockBaker, triangle: u32, is_selected: &dyn Fn(IVec2) -> bool) -> Vec<Sample> {
    let BlockBaker { view, domain, .. } = baker;
    let scene = baker.tracer.scene();
    let corners = scene.corners(triangle).map(|p| view.camera.camera_from_world(p));
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
    if normal == DVec3::ZERO {
        return Vec::new();
    }
    // Camera space is left-handed (z forward): the front's normal points the other way.
    let front = -normal;
    let whole = Piece { barycentric: [DVec2::ZERO, DVec2::X, DVec2::Y], corners };
    let mut samples = Vec::new();
    let center = SurfacePoint { triangle, barycentric: DVec2::splat(1.0 / 3.0) };
    let brightness = f64::from(scene.emitted_radiance(center).max_element());
    for piece in split(whole, view, domain, brightness) {
        if !is_selected(block_corner(piece.pixel(view).as_vec2().floor().as_ivec2())) {
            continue;
        }
        let point = SurfacePoint { triangle, barycentric: piece.barycentric.iter().sum::<DVec2>() / 3.0 };
        let sides = if scene.culls_back_face(triangle) { &[front][..] } else { &[front, -front] };
        for &side in sides {
            samples.extend(patch(baker, point, piece, side));
        }
    }
    samples
}

/// One side of a piece.
fn patch(baker: &BlockBaker, point: SurfacePoint, piece: Piece, normal: DVec3) -> Vec<Sample> {
    let BlockBaker { tracer, radiance, view, patterns, .. } = baker;
    let optics = &view.optics;
    let position = piece.center();
    // w(P, U) = dA·n·(U − P)/(z³ tan²θ), linear in U.
    let density = piece.area_normal().length() * view.density(position.z);
    let weight = -normal.dot(position) * density;
    let tilt = normal.truncate() * (optics.aperture_radius * density);
    let largest = weight + tilt.abs().element_sum();
    if largest <= 0.0 {
        return Vec::new();
    }
    let pixel = piece.pixel(view);
    let inverse_depth = 1.0 / position.z;
    let fineness = Fineness::for_depth(view, inverse_depth);
    let seed = [point.triangle, (jitter(point.barycentric.x.to_bits() as u32, 0, 0)[0] * 1e9) as u32];
    let is_on_side = |u: DVec2| weight + tilt.dot(u) > 0.0;
    let from = Viewpoint::Surface(point);
    let parts = shadow_rays::visible_parts(
        tracer,
        view,
        patterns,
        from,
        fineness,
        Patterns::random_number(seed),
        is_on_side,
    );
    if parts.is_empty() {
        return Vec::new();
    }
    let rim = view.aperture_point(tilt.signum());
    let there = tracer.scene().opacity(point);
    let kinds: Vec<_> = MeanRadiance::mean([(radiance.outgoing(point, rim), 1.0)]).components().collect();
    let masked = |(visibility, share): VisiblePart| {
        let sample = move |kind: LightComponent| {
            let share = there * share * kind.share;
            Sample {
                center: pixel.as_vec2(),
                half_size: piece.half_size_px(view, largest).as_vec2(),
                inverse_depth: inverse_depth as f32,
                weight: weight as f32 * share,
                tilt: tilt.as_vec2() * share,
                radiance: kind.radiance,
                surface: Some(point),
                is_carried: kind.is_carried,
                visibility: visibility.clone(),
            }
        };
        kinds.clone().into_iter().map(sample)
    };
    parts.into_iter().filter(|_| there > 0.0).flat_map(masked).collect()
}

/// Cuts a triangle by its longest projected side until every piece is about a pixel, or an eighth of its own circle of
/// confusion; drops what lies behind the aperture or outside the domain.
///
/// Pieces of such a `brightness` that a single image would be visible are cut further.
fn split(whole: Piece, view: &View, domain: &Domain, brightness: f64) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut pending = vec![(whole, 0)];
    let low = DVec2::splat(-domain.margin as f64);
    let high = (domain.size + domain.margin).as_dvec2();
    while let Some((piece, depth)) = pending.pop() {
        if piece.corners.iter().all(|p| p.z <= 0.0) {
            continue;
        }
        if piece.corners.iter().all(|p| p.z > 0.0) {
            let pixels = piece.corners.map(|p| view.camera.pixel_from_q(view.optics.chief(p)));
            let (first, last) = pixels.iter().fold((pixels[0], pixels[0]), |(a, b), &p| (a.min(p), b.max(p)));
            if first.cmpgt(high).any() || last.cmplt(low).any() {
                continue;
            }
            let nearest = piece.corners.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
            let kappa = view.optics.standard_kappa(1.0 / nearest);
            let fine = (view.optics.circle_of_confusion_px(kappa) / 8.0).max(1.0);
            let extent = (last - first).max_element();
            let is_small = extent <= FINEST_PX || extent <= fine && piece.glare(view, brightness) <= GLARING;
            if is_small || depth >= 24 || pieces.len() >= MAX_PATCHES {
                pieces.push(piece);
                continue;
            }
        } else if depth >= 24 {
            continue;
        }
        let [first, second] = halves(piece);
        pending.push((first, depth + 1));
        pending.push((second, depth + 1));
    }
    pieces
}

/// Cuts a piece through the middle of its longest side.
fn halves(piece: Piece) -> [Piece; 2] {
    let length = |i: usize| piece.corners[i].distance_squared(piece.corners[(i + 1) % 3]);
    let i = (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j))).expect("three sides");
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    let middle = (piece.barycentric[i] + piece.barycentric[j]) / 2.0;
    let corner = (piece.corners[i] + piece.corners[j]) / 2.0;
    let piece_of = |a: usize, b: usize| Piece {
        barycentric: [piece.barycentric[a], middle, piece.barycentric[b]],
        corners: [piece.corners[a], corner, piece.corners[b]],
    };
    [piece_of(i, k), piece_of(k, j)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::Camera;

    #[test]
    fn glaring_lamps_are_cut_finely() {
        let camera = Camera { width: 64, height: 64, aperture_radius: 0.1, ..Camera::default() };
        let (view, domain) = (View::new(&camera, 2.0), Domain::new(64, 64, 0.0));
        let side = 0.3 / (view.density(4.0) * 4.0).sqrt();
        let corners = [DVec3::ZERO, DVec3::X * side, DVec3::Y * side].map(|corner| corner + DVec3::Z * 4.0);
        let lamp = Piece { barycentric: [DVec2::ZERO, DVec2::X, DVec2::Y], corners };
        let cut = [0.0, 1.0, 1e3, 1e9].map(|brightness| split(lamp, &view, &domain, brightness));
        for pieces in &cut {
            let area: f64 = pieces.iter().map(|piece| piece.area_normal().length()).sum();
            assert!((area / lamp.area_normal().length() - 1.0).abs() < 1e-9);
        }
        let [dark, dim, bright, glaring] = cut.each_ref().map(Vec::len);
        assert!(dark == 1 && dim == 1 && bright > 4 && glaring >= bright, "{dark} {dim} {bright} {glaring}");
        assert!(
            cut[2].iter().all(|piece| piece.glare(&view, 1e3) <= GLARING),
            "none is smaller than need be"
        );
        assert!(glaring <= 256, "however bright: {glaring}");
    }
}
