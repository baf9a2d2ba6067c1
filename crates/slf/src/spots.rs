//! Many spots of a picture told by a few of them.
//!
//! Spots of one surface are parted into squares of the picture, each told by those nearest to its corners and its middle, if they
//! lie on a plane over the picture; else its quarters are. What is that even may still hide a small shadow: every other spot looks
//! at one light that the square's own all see, or all do not. So the rays go where shadows have edges. All spots draw the same
//! lights: neighbours differ by what they see alone, and the little that is off is off everywhere alike, which no eye finds.

use glam::{DMat2, DVec2, DVec3, Vec3};
use std::cell::OnceCell;
use std::iter;
use trace::{Received, Spot};

/// What is told lies within this share of the largest value of its square.
const EVEN: f32 = 0.02;

/// The same where too few spots are known to tell a plane from anything else.
const SAME: f32 = 0.05;

/// One of so many looks may tell otherwise: it is then one light of many.
const LOOKS_AN_ERROR: usize = 40;

/// The cosine of the angle that a spot's normal may have to the nearest of those that tell it.
const FACING: f64 = 0.9;

/// Fewer spots than this tell nothing of each other.
const FEWEST: usize = 3;

/// What rays of a spot found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    pub received: Received,
    pub normal: DVec3,
    /// What its spread lobes and its own gloss send of light that is 1 from everywhere.
    pub albedo: [Vec3; 2],
    /// What that makes the spot send.
    pub sent: Vec3,
    pub lights: Seen,
}

/// Of lights that all spots draw alike, a bit each: which stand above a spot's horizon, and which it sees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Seen {
    pub above: [u64; 3],
    pub seen: [u64; 3],
}

/// A scene, as spots are asked about it.
pub(crate) trait Measure {
    /// What a spot receives, if that can be told.
    fn measure(&self, spot: usize) -> Option<Measured>;
    /// A spot's normal, without bumps.
    fn normal(&self, spot: usize) -> DVec3;
    /// What a spot that was measured would send, did it receive this.
    fn sent(&self, measured: &Measured, received: &Received) -> Vec3;
    /// Whether a spot sees some lights, the `turn`-th of those all draw, otherwise than `seen`, which some that agree about it do.
    fn differs(&self, spot: usize, turn: usize, agreed: &Seen) -> Option<bool>;
}

/// What each of some spots of one surface receives, numbered among `spots`; `tell` takes it.
pub(crate) fn tell(
    spots: &[Spot],
    surface: &[usize],
    scene: &impl Measure,
    mut tell: impl FnMut(usize, Received),
) {
    let pixels = || surface.iter().map(|&spot| spots[spot].pixel);
    let low = pixels().fold(DVec2::INFINITY, DVec2::min).floor();
    let extent = (pixels().fold(DVec2::NEG_INFINITY, DVec2::max) - low).max_element();
    let side = f64::from((extent.max(1.0).ceil() as u32).next_power_of_two());
    let measured = vec![OnceCell::new(); spots.len()];
    Telling { spots, scene, measured }.square(low, side, surface, &mut tell);
}

struct Telling<'a, M> {
    spots: &'a [Spot],
    scene: &'a M,
    measured: Vec<OnceCell<Option<Measured>>>,
}

impl<M: Measure> Telling<'_, M> {
    /// Tells the spots of a square, or of its quarters.
    fn square(&self, corner: DVec2, side: f64, members: &[usize], tell: &mut impl FnMut(usize, Received)) {
        if members.len() < FEWEST {
            return;
        }
        if let Some(plane) = self.plane(corner, side, members) {
            members.iter().for_each(|&spot| tell(spot, plane.at(self.spots[spot].pixel)));
            return;
        }
        if side <= 1.0 {
            return;
        }
        let half = side / 2.0;
        for quarter in [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE] {
            let corner = corner + quarter * half;
            let lies_in = |spot: &usize| {
                let at = self.spots[*spot].pixel - corner;
                at.cmpge(DVec2::ZERO).all() && at.cmplt(DVec2::splat(half)).all()
            };
            let inside: Vec<usize> = members.iter().copied().filter(lies_in).collect();
            self.square(corner, half, &inside, tell);
        }
    }

    /// The plane that tells all of a square's spots, if there is one.
    fn plane(&self, corner: DVec2, side: f64, members: &[usize]) -> Option<Plane> {
        let places = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE, DVec2::splat(0.5)];
        let mut known: Vec<usize> = places.map(|place| self.nearest(corner + place * side, members)).to_vec();
        known.sort_unstable();
        known.dedup();
        let measured: Vec<Measured> = known.iter().map(|&spot| self.measure(spot)).collect::<Option<_>>()?;
        let plane =
            Plane::of(known.iter().zip(&measured).map(|(&spot, m)| (self.spots[spot].pixel, m.received)));
        let most = measured.iter().fold(Vec3::ZERO, |most, m| most.max(m.sent)).max_element();
        let is_told = |(&spot, measured): (&usize, &Measured)| {
            let told = self.scene.sent(measured, &plane.at(self.spots[spot].pixel));
            (told - measured.sent).abs().max_element() <= EVEN * most
        };
        if !iter::zip(&known, &measured).all(is_told) {
            return None;
        }
        if known.len() <= FEWEST {
            let least = measured.iter().fold(Vec3::INFINITY, |least, m| least.min(m.sent));
            let largest = measured.iter().fold(Vec3::ZERO, |most, m| most.max(m.sent));
            if (largest - least).max_element() > SAME * most {
                return None;
            }
        }
        self.is_plain(members, &known, &measured).then_some(plane)
    }

    /// Whether the spots between see the lights that all of `known` see, and none that they all do not.
    fn is_plain(&self, members: &[usize], known: &[usize], measured: &[Measured]) -> bool {
        let faces_as = |spot: usize, of: usize| self.scene.normal(spot).dot(self.scene.normal(of)) >= FACING;
        if !members.iter().all(|&spot| known.iter().any(|&of| faces_as(spot, of))) {
            return false;
        }
        let agreed = Seen::agreed(measured);
        let (mut looks, mut errors) = (0, 0);
        for (turn, &spot) in members.iter().filter(|spot| !known.contains(spot)).enumerate() {
            if let Some(differs) = self.scene.differs(spot, turn, &agreed) {
                looks += 1;
                errors += usize::from(differs);
            }
        }
        errors * LOOKS_AN_ERROR <= looks
    }

    fn measure(&self, spot: usize) -> Option<Measured> {
        *self.measured[spot].get_or_init(|| self.scene.measure(spot))
    }

    fn nearest(&self, place: DVec2, members: &[usize]) -> usize {
        let distance = |spot: &&usize| self.spots[**spot].pixel.distance_squared(place);
        *members.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a square has spots")
    }
}

impl Seen {
    /// Whether some lights of a kind are seen and others not.
    pub fn is_mixed(&self, kind: usize) -> bool {
        self.seen[kind] != 0 && self.seen[kind] != self.above[kind]
    }

    /// What all agree about: lights above the horizon of all, that all see or none does.
    fn agreed(all: &[Measured]) -> Self {
        let each = |of: fn(&Seen) -> &[u64; 3], join: fn(u64, u64) -> u64, start: u64| -> [u64; 3] {
            std::array::from_fn(|kind| all.iter().fold(start, |sum, m| join(sum, of(&m.lights)[kind])))
        };
        let above = each(|lights| &lights.above, |a, b| a & b, u64::MAX);
        let every = each(|lights| &lights.seen, |a, b| a & b, u64::MAX);
        let any = each(|lights| &lights.seen, |a, b| a | b, 0);
        let above = std::array::from_fn(|kind| above[kind] & (every[kind] | !any[kind]));
        Self { above, seen: every }
    }
}

/// What is received over the picture, by least squares; slopes that few spots tell badly are kept small, as if each were as wide as a
/// pixel.
struct Plane {
    middle: DVec2,
    mean: Received,
    slope: [Received; 2],
}

/// What sums begin with.
const NOTHING: Received = Received { even: Vec3::ZERO, flow: [Vec3::ZERO; 3], gloss: Some(Vec3::ZERO) };

impl Plane {
    fn of(points: impl Iterator<Item = (DVec2, Received)> + Clone) -> Self {
        let count = points.clone().count() as f64;
        let middle = points.clone().map(|(at, _)| at).sum::<DVec2>() / count;
        /// The variance of a pixel.
        const OF_A_PIXEL: f64 = 1.0 / 12.0;
        let mut moments = DMat2::from_diagonal(DVec2::splat(OF_A_PIXEL));
        let (mut mean, mut moment) = (NOTHING, [NOTHING; 2]);
        for (at, received) in points {
            let at = at - middle;
            moments += DMat2::from_cols(at * at.x, at * at.y);
            mean = mean.plus(&received, 1.0 / count);
            moment = [moment[0].plus(&received, at.x), moment[1].plus(&received, at.y)];
        }
        let inverse = moments.inverse();
        let slope =
            [inverse.col(0), inverse.col(1)].map(|by| NOTHING.plus(&moment[0], by.x).plus(&moment[1], by.y));
        Self { middle, mean, slope }
    }

    fn at(&self, pixel: DVec2) -> Received {
        let at = pixel - self.middle;
        self.mean.plus(&self.slope[0], at.x).plus(&self.slope[1], at.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::SurfacePoint;
    use std::cell::Cell;

    /// A wall in front of a lamp, whose irradiance is a function of the picture's place; where it is dark, the lamp is not seen.
    struct Wall<'a> {
        spots: &'a [Spot],
        light: &'a dyn Fn(DVec2) -> f32,
        measured: Cell<usize>,
    }

    impl Measure for Wall<'_> {
        fn measure(&self, spot: usize) -> Option<Measured> {
            self.measured.set(self.measured.get() + 1);
            let irradiance = Vec3::splat((self.light)(self.spots[spot].pixel));
            let received = Received { even: irradiance, ..Received::default() };
            let seen = if irradiance.x > 0.5 { [u64::MAX; 3] } else { [0; 3] };
            let lights = Seen { above: [u64::MAX; 3], seen };
            let albedo = [Vec3::ONE, Vec3::ZERO];
            Some(Measured { received, normal: DVec3::Z, albedo, sent: irradiance, lights })
        }
        fn normal(&self, _spot: usize) -> DVec3 {
            DVec3::Z
        }
        fn sent(&self, measured: &Measured, received: &Received) -> Vec3 {
            received.at(measured.normal)
        }
        fn differs(&self, spot: usize, turn: usize, agreed: &Seen) -> Option<bool> {
            let bit = 1 << (turn % 64);
            let seen = (self.light)(self.spots[spot].pixel) > 0.5;
            (agreed.above[0] & bit != 0).then(|| seen != (agreed.seen[0] & bit != 0))
        }
    }

    /// What 16 × 16 spots are told of a light, and how many were measured.
    fn told(light: &dyn Fn(DVec2) -> f32) -> (Vec<(Spot, Option<f32>)>, usize) {
        let point = SurfacePoint { triangle: 0, barycentric: DVec2::ZERO };
        let pixel = |k: usize| DVec2::new((k % 16) as f64, (k / 16) as f64) + 0.5;
        let spots: Vec<_> = (0..256).map(|k| Spot { point, pixel: pixel(k) }).collect();
        let wall = Wall { spots: &spots, light, measured: Cell::new(0) };
        let mut received = vec![None; spots.len()];
        let surface: Vec<_> = (0..spots.len()).collect();
        tell(&spots, &surface, &wall, |spot, told| received[spot] = Some(told.even.x));
        let measured = wall.measured.get();
        (spots.into_iter().zip(received).collect(), measured)
    }

    #[test]
    fn a_slope_is_told_by_five_spots() {
        let light = |at: DVec2| 1.0 + 0.03 * at.x as f32 - 0.01 * at.y as f32;
        let (told, measured) = told(&light);
        assert_eq!(measured, 5);
        for (spot, told) in told {
            assert!((told.unwrap() / light(spot.pixel) - 1.0).abs() < 2e-3, "{spot:?} {told:?}");
        }
    }

    #[test]
    fn an_edge_is_left_to_be_asked() {
        let light = |at: DVec2| if at.x + 0.3 * at.y < 9.2 { 1.0 } else { 0.1 };
        let (told, measured) = told(&light);
        assert!(measured < 256, "{measured}");
        let mut asked = 0;
        for (spot, told) in told {
            match told {
                Some(told) => assert!((told - light(spot.pixel)).abs() < 0.021, "{spot:?} {told}"),
                None => asked += 1,
            }
        }
        assert!((16..64).contains(&asked), "{asked} beside the edge");
    }

    #[test]
    fn a_shadow_between_the_known_spots_is_found() {
        let light = |at: DVec2| if (at - DVec2::new(4.5, 7.5)).length() < 2.2 { 0.2 } else { 1.0 };
        let (told, _) = told(&light);
        for (spot, told) in told {
            let told = told.unwrap_or_else(|| light(spot.pixel));
            assert!((told - light(spot.pixel)).abs() < 0.06, "{spot:?} {told}");
        }
    }
}
