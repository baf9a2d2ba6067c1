//! Incident light of many picture points, interpolated from a few.
//!
//! The points of one surface are divided into a quadtree over the picture. A square is interpolated from the points
//! nearest to its corners and its centre if their light fits a plane over the picture; otherwise it is split. An even
//! result may still hide a small shadow, so every other point tests one light that the anchors all see, or all do not
//! see: rays are spent where shadows have edges. All points sample the same lights, so neighbours differ by visibility
//! alone, and the remaining error is the same everywhere and therefore invisible.

use glam::{DMat2, DVec2, DVec3, Vec3};
use std::cell::OnceCell;
use std::iter;
use trace::{IncidentLight, ShadingPoint};

/// Largest error of the plane at an anchor, as a share of the largest value of the square.
const MAX_PLANE_ERROR: f32 = 0.02;

/// The same for the spread of values, where there are too few anchors to verify a plane.
const MAX_SPREAD_OF_FEW: f32 = 0.05;

/// One test in this many may disagree: it is then one light of many.
const TESTS_PER_MISMATCH: usize = 40;

/// Smallest cosine between a point's normal and the nearest anchor normal.
const MIN_NORMAL_COSINE: f64 = 0.9;

/// Squares with fewer points are not interpolated.
const MIN_POINTS: usize = 3;

/// What was measured at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measurement {
    pub incident: IncidentLight,
    pub normal: DVec3,
    /// Albedo of its spread lobes and of its own gloss.
    pub albedo: [Vec3; 2],
    /// Radiance that the point sends as a result.
    pub outgoing: Vec3,
    pub visibility: LightVisibility,
}

/// Bit sets of lights that all points sample alike, by kind of light: those above a point's horizon, and those visible
/// from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LightVisibility {
    pub above_horizon: [u64; 3],
    pub visible: [u64; 3],
}

/// A scene in which incident light can be measured at the points of a batch.
pub(crate) trait IncidentSampler {
    /// Measures the incident light of a point; `None` if that is not possible.
    fn measure(&self, point: usize) -> Option<Measurement>;
    /// Normal of a point, without the normal map.
    fn normal(&self, point: usize) -> DVec3;
    /// Radiance that a measured point would send if it received `incident`.
    fn outgoing(&self, measured: &Measurement, incident: &IncidentLight) -> Vec3;
    /// Whether the visibility of the `turn`-th of the shared lights differs from `agreed`, the visibility on which some
    /// points agree; `None` if it cannot be compared.
    fn visibility_differs(&self, point: usize, turn: usize, agreed: &LightVisibility) -> Option<bool>;
}

/// Interpolates incident light at the points of one surface, which are indices into `points`; `visit` receives the
/// results. Points that could not be interpolated are not visited.
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
    /// Interpolates the points of a square, or of its quarters.
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

    /// The plane that represents all points of a square, if there is one.
    fn fit_plane(&self, corner: DVec2, side: f64, members: &[usize]) -> Option<Plane> {
        let anchor_places = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE, DVec2::splat(0.5)];
        let mut anchors: Vec<usize> =
            anchor_places.map(|place| self.nearest(corner + place * side, members)).to_vec();
        anchors.sort_unstable();
        anchors.dedup();
        let measurements: Vec<Measurement> =
            anchors.iter().map(|&point| self.measure(point)).collect::<Option<_>>()?;
        let plane = Plane::fit(
            anchors.iter().zip(&measurements).map(|(&point, m)| (self.points[point].pixel, m.incident)),
        );
        let max_outgoing = measurements.iter().fold(Vec3::ZERO, |max, m| max.max(m.outgoing)).max_element();
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

    /// Whether the points between the anchors see the lights that all anchors see, and none that no anchor sees.
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
            if let Some(differs) = self.sampler.visibility_differs(point, turn, &agreed) {
                tests += 1;
                mismatches += usize::from(differs);
            }
        }
        mismatches * TESTS_PER_MISMATCH <= tests
    }

    fn measure(&self, point: usize) -> Option<Measurement> {
        *self.measurements[point].get_or_init(|| self.sampler.measure(point))
    }

    fn nearest(&self, place: DVec2, members: &[usize]) -> usize {
        let distance = |point: &&usize| self.points[**point].pixel.distance_squared(place);
        *members.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a square has points")
    }
}

impl LightVisibility {
    /// Whether some of the lights of kind `kind` above the horizon are visible and others are not.
    pub fn is_mixed(&self, kind: usize) -> bool {
        self.visible[kind] != 0 && self.visible[kind] != self.above_horizon[kind]
    }

    /// What all agree on: lights above the horizon of all that are visible from all or from none.
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

/// Incident light over the picture, by least squares. Slopes that few points determine poorly are kept small, as if
/// each point were as wide as a pixel.
struct Plane {
    middle: DVec2,
    mean: IncidentLight,
    slope: [IncidentLight; 2],
}

/// Zero, to start sums from.
const NOTHING: IncidentLight =
    IncidentLight { isotropic: Vec3::ZERO, vector_irradiance: [Vec3::ZERO; 3], gloss: Some(Vec3::ZERO) };

impl Plane {
    fn fit(points: impl Iterator<Item = (DVec2, IncidentLight)> + Clone) -> Self {
        let count = points.clone().count() as f64;
        let middle = points.clone().map(|(at, _)| at).sum::<DVec2>() / count;
        /// Variance of a uniform distribution over a pixel.
        const OF_A_PIXEL: f64 = 1.0 / 12.0;
        let mut moments = DMat2::from_diagonal(DVec2::splat(OF_A_PIXEL));
        let (mut mean, mut moment) = (NOTHING, [NOTHING; 2]);
        for (at, incident) in points {
            let at = at - middle;
            moments += DMat2::from_cols(at * at.x, at * at.y);
            mean = mean.plus_scaled(&incident, 1.0 / count);
            moment = [moment[0].plus_scaled(&incident, at.x), moment[1].plus_scaled(&incident, at.y)];
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

    /// A wall in front of a light, whose irradiance is a function of the pixel position; where it is dark, the light is
    /// not visible.
    struct Wall<'a> {
        points: &'a [ShadingPoint],
        light: &'a dyn Fn(DVec2) -> f32,
        measured: Cell<usize>,
    }

    impl IncidentSampler for Wall<'_> {
        fn measure(&self, point: usize) -> Option<Measurement> {
            self.measured.set(self.measured.get() + 1);
            let irradiance = Vec3::splat((self.light)(self.points[point].pixel));
            let incident = IncidentLight { isotropic: irradiance, ..IncidentLight::default() };
            let visible = if irradiance.x > 0.5 { [u64::MAX; 3] } else { [0; 3] };
            let lights = LightVisibility { above_horizon: [u64::MAX; 3], visible };
            let albedo = [Vec3::ONE, Vec3::ZERO];
            Some(Measurement { incident, normal: DVec3::Z, albedo, outgoing: irradiance, visibility: lights })
        }
        fn normal(&self, _spot: usize) -> DVec3 {
            DVec3::Z
        }
        fn outgoing(&self, measured: &Measurement, incident: &IncidentLight) -> Vec3 {
            incident.irradiance_over_pi(measured.normal)
        }
        fn visibility_differs(&self, point: usize, turn: usize, agreed: &LightVisibility) -> Option<bool> {
            let bit = 1 << (turn % 64);
            let visible = (self.light)(self.points[point].pixel) > 0.5;
            (agreed.above_horizon[0] & bit != 0).then(|| visible != (agreed.visible[0] & bit != 0))
        }
    }

    /// Interpolates a light at 16 × 16 points; also returns how many were measured.
    fn interpolate(light: &dyn Fn(DVec2) -> f32) -> (Vec<(ShadingPoint, Option<f32>)>, usize) {
        let surface_point = SurfacePoint { triangle: 0, barycentric: DVec2::ZERO };
        let pixel = |k: usize| DVec2::new((k % 16) as f64, (k / 16) as f64) + 0.5;
        let points: Vec<_> =
            (0..256).map(|k| ShadingPoint { point: surface_point, pixel: pixel(k) }).collect();
        let wall = Wall { points: &points, light, measured: Cell::new(0) };
        let mut incident = vec![None; points.len()];
        let surface: Vec<_> = (0..points.len()).collect();
        interpolate_incident(&points, &surface, &wall, |point, interpolated| {
            incident[point] = Some(interpolated.isotropic.x)
        });
        let measured = wall.measured.get();
        (points.into_iter().zip(incident).collect(), measured)
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
        assert!((16..64).contains(&uninterpolated), "{uninterpolated} at the edge");
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
