//! Many spots of a picture told by a few of them.
//!
//! Spots of one surface are parted into squares of the picture, each told by those nearest to its corners and its middle, if they
//! lie on a plane over the picture; else its quarters are. What is that even may still hide a small shadow: every other spot looks
//! at one light that the square's own all see, or all do not. So the rays go where shadows have edges. All spots draw the same
//! lights: neighbours differ by what they see alone, and the little that is off is off everywhere alike, which no eye finds.

use glam::{DMat2, DVec2, DVec3, Vec3};
use std::cell::OnceCell;
use std::iter;
use trace::{IncidentLight, ShadingPoint};

/// What is told lies within this share of the largest value of its square.
const MAX_PLANE_ERROR: f32 = 0.02;

/// The same where too few spots are known to tell a plane from anything else.
const MAX_SPREAD_OF_FEW: f32 = 0.05;

/// One of so many looks may tell otherwise: it is then one light of many.
const TESTS_PER_MISMATCH: usize = 40;

/// The cosine of the angle that a spot's normal may have to the nearest of those that tell it.
const MIN_NORMAL_COSINE: f64 = 0.9;

/// Fewer spots than this tell nothing of each other.
const MIN_POINTS: usize = 3;

/// What rays of a spot found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measurement {
    pub received: IncidentLight,
    pub normal: DVec3,
    /// What its spread lobes and its own gloss send of light that is 1 from everywhere.
    pub albedo: [Vec3; 2],
    /// What that makes the spot send.
    pub outgoing: Vec3,
    pub visibility: LightVisibility,
}

/// Of lights that all spots draw alike, a bit each: which stand above a spot's horizon, and which it sees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LightVisibility {
    pub above_horizon: [u64; 3],
    pub visible: [u64; 3],
}

/// A scene, as spots are asked about it.
pub(crate) trait IncidentSampler {
    /// What a spot receives, if that can be told.
    fn measure(&self, point: usize) -> Option<Measurement>;
    /// A spot's normal, without bumps.
    fn normal(&self, point: usize) -> DVec3;
    /// What a spot that was measured would send, did it receive this.
    fn outgoing(&self, measured: &Measurement, received: &IncidentLight) -> Vec3;
    /// Whether a spot sees some lights, the `turn`-th of those all draw, otherwise than `seen`, which some that agree about it do.
    fn visibility_differs(&self, point: usize, turn: usize, agreed: &LightVisibility) -> Option<bool>;
}

/// What each of some spots of one surface receives, numbered among `spots`; `tell` takes it.
pub(crate) fn interpolate_incident(
    points: &[ShadingPoint],
    surface: &[usize],
    sampler: &impl IncidentSampler,
    mut visit: impl FnMut(usize, IncidentLight),
) {
    let pixels = || surface.iter().map(|&point| points[point].pixel);
    let low = pixels().fold(DVec2::INFINITY, DVec2::min).floor();
    let extent = (pixels().fold(DVec2::NEG_INFINITY, DVec2::max) - low).max_element();
    let side = f64::from((extent.max(1.0).ceil() as u32).next_power_of_two());
    let measurements = vec![OnceCell::new(); points.len()];
    QuadtreeInterpolator { points, sampler, measurements }.interpolate_square(low, side, surface, &mut visit);
}

struct QuadtreeInterpolator<'a, M> {
    points: &'a [ShadingPoint],
    sampler: &'a M,
    measurements: Vec<OnceCell<Option<Measurement>>>,
}

impl<M: IncidentSampler> QuadtreeInterpolator<'_, M> {
    /// Tells the spots of a square, or of its quarters.
    fn interpolate_square(
        &self,
        corner: DVec2,
        side: f64,
        members: &[usize],
        visit: &mut impl FnMut(usize, IncidentLight),
    ) {
        if members.len() < MIN_POINTS {
            return;
        }
        if let Some(plane) = self.fit_plane(corner, side, members) {
            members.iter().for_each(|&point| visit(point, plane.at(self.points[point].pixel)));
            return;
        }
        if side <= 1.0 {
            return;
        }
        let half = side / 2.0;
        for quarter in [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE] {
            let corner = corner + quarter * half;
            let lies_in = |point: &usize| {
                let at = self.points[*point].pixel - corner;
                at.cmpge(DVec2::ZERO).all() && at.cmplt(DVec2::splat(half)).all()
            };
            let inside: Vec<usize> = members.iter().copied().filter(lies_in).collect();
            self.interpolate_square(corner, half, &inside, visit);
        }
    }

    /// The plane that tells all of a square's spots, if there is one.
    fn fit_plane(&self, corner: DVec2, side: f64, members: &[usize]) -> Option<Plane> {
        let anchor_places = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE, DVec2::splat(0.5)];
        let mut anchors: Vec<usize> =
            anchor_places.map(|place| self.nearest(corner + place * side, members)).to_vec();
        anchors.sort_unstable();
        anchors.dedup();
        let measurements: Vec<Measurement> =
            anchors.iter().map(|&point| self.measure(point)).collect::<Option<_>>()?;
        let plane = Plane::fit(
            anchors.iter().zip(&measurements).map(|(&point, m)| (self.points[point].pixel, m.received)),
        );
        let max_outgoing = measurements
            .iter()
            .fold(Vec3::ZERO, |max_outgoing, m| max_outgoing.max(m.outgoing))
            .max_element();
        let fits_plane = |(&point, measured): (&usize, &Measurement)| {
            let predicted = self.sampler.outgoing(measured, &plane.at(self.points[point].pixel));
            (predicted - measured.outgoing).abs().max_element() <= MAX_PLANE_ERROR * max_outgoing
        };
        if !iter::zip(&anchors, &measurements).all(fits_plane) {
            return None;
        }
        if anchors.len() <= MIN_POINTS {
            let smallest = measurements.iter().fold(Vec3::INFINITY, |smallest, m| smallest.min(m.outgoing));
            let largest = measurements.iter().fold(Vec3::ZERO, |max, m| max.max(m.outgoing));
            if (largest - smallest).max_element() > MAX_SPREAD_OF_FEW * max_outgoing {
                return None;
            }
        }
        self.has_uniform_visibility(members, &anchors, &measurements).then_some(plane)
    }

    /// Whether the spots between see the lights that all of `known` see, and none that they all do not.
    fn has_uniform_visibility(
        &self,
        members: &[usize],
        anchors: &[usize],
        measurements: &[Measurement],
    ) -> bool {
        let faces_as = |point: usize, anchor: usize| {
            self.sampler.normal(point).dot(self.sampler.normal(anchor)) >= MIN_NORMAL_COSINE
        };
        if !members.iter().all(|&point| anchors.iter().any(|&anchor| faces_as(point, anchor))) {
            return false;
        }
        let agreed = LightVisibility::agreement(measurements);
        let (mut tests, mut mismatches) = (0, 0);
        for (turn, &point) in members.iter().filter(|point| !anchors.contains(point)).enumerate() {
            if let Some(visibility_differs) = self.sampler.visibility_differs(point, turn, &agreed) {
                tests += 1;
                mismatches += usize::from(visibility_differs);
            }
        }
        mismatches * TESTS_PER_MISMATCH <= tests
    }

    fn measure(&self, point: usize) -> Option<Measurement> {
        *self.measurements[point].get_or_init(|| self.sampler.measure(point))
    }

    fn nearest(&self, place: DVec2, members: &[usize]) -> usize {
        let distance = |point: &&usize| self.points[**point].pixel.distance_squared(place);
        *members.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a square has spots")
    }
}

impl LightVisibility {
    /// Whether some lights of a kind are seen and others not.
    pub fn is_mixed(&self, kind: usize) -> bool {
        self.visible[kind] != 0 && self.visible[kind] != self.above_horizon[kind]
    }

    /// What all agree about: lights above the horizon of all, that all see or none does.
    fn agreement(all: &[Measurement]) -> Self {
        let each = |bits: fn(&LightVisibility) -> &[u64; 3],
                    join: fn(u64, u64) -> u64,
                    start: u64|
         -> [u64; 3] {
            std::array::from_fn(|kind| all.iter().fold(start, |sum, m| join(sum, bits(&m.visibility)[kind])))
        };
        let above_horizon = each(|lights| &lights.above_horizon, |a, b| a & b, u64::MAX);
        let every = each(|lights| &lights.visible, |a, b| a & b, u64::MAX);
        let any = each(|lights| &lights.visible, |a, b| a | b, 0);
        let above_horizon = std::array::from_fn(|kind| above_horizon[kind] & (every[kind] | !any[kind]));
        Self { above_horizon, visible: every }
    }
}

/// What is received over the picture, by least squares; slopes that few spots tell badly are kept small, as if each were as wide as a
/// pixel.
struct Plane {
    middle: DVec2,
    mean: IncidentLight,
    slope: [IncidentLight; 2],
}

/// What sums begin with.
const NOTHING: IncidentLight =
    IncidentLight { isotropic: Vec3::ZERO, vector_irradiance: [Vec3::ZERO; 3], gloss: Some(Vec3::ZERO) };

impl Plane {
    fn fit(points: impl Iterator<Item = (DVec2, IncidentLight)> + Clone) -> Self {
        let count = points.clone().count() as f64;
        let middle = points.clone().map(|(at, _)| at).sum::<DVec2>() / count;
        /// The variance of a pixel.
        const OF_A_PIXEL: f64 = 1.0 / 12.0;
        let mut moments = DMat2::from_diagonal(DVec2::splat(OF_A_PIXEL));
        let (mut mean, mut moment) = (NOTHING, [NOTHING; 2]);
        for (at, received) in points {
            let at = at - middle;
            moments += DMat2::from_cols(at * at.x, at * at.y);
            mean = mean.plus_scaled(&received, 1.0 / count);
            moment = [moment[0].plus_scaled(&received, at.x), moment[1].plus_scaled(&received, at.y)];
        }
        let inverse = moments.inverse();
        let slope = [inverse.col(0), inverse.col(1)]
            .map(|by| NOTHING.plus_scaled(&moment[0], by.x).plus_scaled(&moment[1], by.y));
        Self { middle, mean, slope }
    }

    fn at(&self, pixel: DVec2) -> IncidentLight {
        let at = pixel - self.middle;
        self.mean.plus_scaled(&self.slope[0], at.x).plus_scaled(&self.slope[1], at.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::SurfacePoint;
    use std::cell::Cell;

    /// A wall in front of a lamp, whose irradiance is a function of the picture's place; where it is dark, the lamp is not seen.
    struct Wall<'a> {
        points: &'a [ShadingPoint],
        light: &'a dyn Fn(DVec2) -> f32,
        measured: Cell<usize>,
    }

    impl IncidentSampler for Wall<'_> {
        fn measure(&self, point: usize) -> Option<Measurement> {
            self.measured.set(self.measured.get() + 1);
            let irradiance = Vec3::splat((self.light)(self.points[point].pixel));
            let received = IncidentLight { isotropic: irradiance, ..IncidentLight::default() };
            let visible = if irradiance.x > 0.5 { [u64::MAX; 3] } else { [0; 3] };
            let lights = LightVisibility { above_horizon: [u64::MAX; 3], visible };
            let albedo = [Vec3::ONE, Vec3::ZERO];
            Some(Measurement { received, normal: DVec3::Z, albedo, outgoing: irradiance, visibility: lights })
        }
        fn normal(&self, _spot: usize) -> DVec3 {
            DVec3::Z
        }
        fn outgoing(&self, measured: &Measurement, received: &IncidentLight) -> Vec3 {
            received.irradiance_over_pi(measured.normal)
        }
        fn visibility_differs(&self, point: usize, turn: usize, agreed: &LightVisibility) -> Option<bool> {
            let bit = 1 << (turn % 64);
            let visible = (self.light)(self.points[point].pixel) > 0.5;
            (agreed.above_horizon[0] & bit != 0).then(|| visible != (agreed.visible[0] & bit != 0))
        }
    }

    /// What 16 × 16 spots are told of a light, and how many were measured.
    fn interpolate(light: &dyn Fn(DVec2) -> f32) -> (Vec<(ShadingPoint, Option<f32>)>, usize) {
        let surface_point = SurfacePoint { triangle: 0, barycentric: DVec2::ZERO };
        let pixel = |k: usize| DVec2::new((k % 16) as f64, (k / 16) as f64) + 0.5;
        let points: Vec<_> =
            (0..256).map(|k| ShadingPoint { point: surface_point, pixel: pixel(k) }).collect();
        let wall = Wall { points: &points, light, measured: Cell::new(0) };
        let mut received = vec![None; points.len()];
        let surface: Vec<_> = (0..points.len()).collect();
        interpolate_incident(&points, &surface, &wall, |point, interpolated| {
            received[point] = Some(interpolated.isotropic.x)
        });
        let measured = wall.measured.get();
        (points.into_iter().zip(received).collect(), measured)
    }

    #[test]
    fn a_slope_is_interpolated_from_five_points() {
        let light = |at: DVec2| 1.0 + 0.03 * at.x as f32 - 0.01 * at.y as f32;
        let (interpolated, measured) = interpolate(&light);
        assert_eq!(measured, 5);
        for (point, interpolated) in interpolated {
            assert!(
                (interpolated.unwrap() / light(point.pixel) - 1.0).abs() < 2e-3,
                "{point:?} {interpolated:?}"
            );
        }
    }

    #[test]
    fn an_edge_is_left_uninterpolated() {
        let light = |at: DVec2| if at.x + 0.3 * at.y < 9.2 { 1.0 } else { 0.1 };
        let (interpolated, measured) = interpolate(&light);
        assert!(measured < 256, "{measured}");
        let mut uninterpolated = 0;
        for (point, interpolated) in interpolated {
            match interpolated {
                Some(interpolated) => {
                    assert!((interpolated - light(point.pixel)).abs() < 0.021, "{point:?} {interpolated}")
                }
                None => uninterpolated += 1,
            }
        }
        assert!((16..64).contains(&uninterpolated), "{uninterpolated} beside the edge");
    }

    #[test]
    fn a_shadow_between_the_anchors_is_detected() {
        let light = |at: DVec2| if (at - DVec2::new(4.5, 7.5)).length() < 2.2 { 0.2 } else { 1.0 };
        let (interpolated, _) = interpolate(&light);
        for (point, interpolated) in interpolated {
            let interpolated = interpolated.unwrap_or_else(|| light(point.pixel));
            assert!((interpolated - light(point.pixel)).abs() < 0.06, "{point:?} {interpolated}");
        }
    }
}
