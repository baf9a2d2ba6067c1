//! The two estimators against each other: what either gets wrong that the other does not shows as pixels farther
//! apart than their standard errors allow.

use super::*;
use crate::OutgoingRadiance;
use glam::{Vec4, vec4};
use scene::{AlphaMode, Material};

/// Light that changes from place to place and with the direction; a sky that is brighter above.
struct Shaded(Arc<scene::Scene>);

impl Radiance for Shaded {
    fn outgoing(&self, point: SurfacePoint, eye: DVec3) -> OutgoingRadiance {
        let position = point.position(&self.0);
        let toward = (eye - position).normalize();
        let normal = self.0.area_normal(point.triangle).normalize();
        let shade = 0.6 + 0.2 * (3.0 * position.x + position.y).sin() + 0.2 * normal.dot(toward).abs();
        OutgoingRadiance::from_own(self.0.base_color(point).truncate() * shade as f32)
    }
    fn environment(&self, direction: DVec3) -> Vec3 {
        Vec3::new(0.2, 0.3, 0.5) * (1.0 + direction.normalize().y as f32)
    }
}

/// A focus for each part, which changes over the triangle from its first corner to its second.
struct ByPart(Arc<scene::Scene>, Vec<FocusOffset>);

impl ByPart {
    fn of(&self, part: u32) -> FocusOffset {
        self.1.get(part as usize).copied().unwrap_or(FocusOffset::STANDARD)
    }
}

impl SurfaceField<FocusOffset> for ByPart {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        let focus = self.of(self.0.triangles[point.triangle as usize].part);
        let t = 1.0 + (focus.t - 1.0) * (1.0 - 0.4 * point.barycentric.x);
        FocusOffset { t, ..focus }
    }
    fn at_infinity(&self) -> FocusOffset {
        self.of(0)
    }
    fn bounds(&self, triangle: u32) -> Option<[FocusOffset; 2]> {
        let at = |b1| self.at(SurfacePoint { triangle, barycentric: DVec2::new(b1, 0.0) });
        let (a, b) = (at(0.0), at(1.0));
        let [low, high] = [a.t.min(b.t), a.t.max(b.t)].map(|t| FocusOffset { t, ..a });
        Some([low, high])
    }
}

fn colored(color: Vec4) -> Material {
    Material { base_color: color, ..white() }
}

/// A floor from behind the camera to far away, a wall with a hole in front of a sky, a ball, a fence near the lens
/// with see-through bars, a card edge-on to the lens and a bright lamp outside the frame.
pub(super) fn stage() -> Arc<scene::Scene> {
    let floor = Mesh::rectangle(DVec3::new(-20.0, -0.8, 5.0), DVec3::X * 40.0, DVec3::new(0.0, 0.0, -60.0));
    let wall = Mesh::rectangle(DVec3::new(-2.0, -0.8, -6.0), DVec3::X * 2.5, DVec3::Y * 2.0);
    let glass = Material { alpha: AlphaMode::Blend, ..colored(vec4(0.3, 0.9, 0.4, 0.6)) };
    let bars = |x: f64| {
        Mesh::rectangle(DVec3::new(x, -1.0, -1.2), DVec3::new(0.06, 0.0, 0.02), DVec3::new(0.1, 2.0, 0.0))
    };
    let card = Mesh::rectangle(DVec3::new(0.05, -0.4, -2.0), DVec3::new(0.0, 0.0, -1.5), DVec3::Y * 0.9);
    let lamp = Mesh::rectangle(DVec3::new(1.1, 0.3, -2.9), DVec3::X * 0.2, DVec3::Y * 0.2);
    scene_of([
        (floor, colored(vec4(0.5, 0.45, 0.4, 1.0))),
        (wall, colored(vec4(0.8, 0.3, 0.2, 1.0))),
        (Mesh::sphere(DVec3::new(0.5, 0.0, -3.5), 0.5, 10), colored(vec4(0.2, 0.4, 0.9, 1.0))),
        (bars(-0.3), glass.clone()),
        (bars(0.15), colored(vec4(0.9, 0.8, 0.1, 1.0))),
        (card, colored(vec4(0.9, 0.9, 0.9, 1.0))),
        (lamp, colored(vec4(30.0, 25.0, 20.0, 1.0))),
    ])
}

/// Floor (and sky), wall, ball, see-through bar, bar, card, lamp.
pub(super) fn focuses() -> [(&'static str, [FocusOffset; 7]); 4] {
    let all = |t, anchor| [FocusOffset::new(t, anchor); 7];
    let mixed = [(1.0, 0.0), (1.04, 0.3), (0.94, 1.0), (1.0, 1.0), (0.97, 0.0), (1.05, 0.7), (1.08, 1.0)];
    [
        ("standard", all(1.0, 0.0)),
        ("relative", all(0.95, 0.0)),
        ("absolute", all(1.06, 1.0)),
        ("mixed", mixed.map(|(t, anchor)| FocusOffset::new(t, anchor))),
    ]
}

fn apertures() -> Vec<lens::Aperture> {
    let polygon = |roundness| ApertureShape::Polygon { blades: 5, rotation: 0.4, roundness };
    vec![
        ApertureShape::Disc.into(),
        polygon(0.0).into(),
        polygon(0.6).into(),
        ApertureShape::Square.into(),
        upper_right(),
        lens::Aperture { ratio: 2.0, ..ApertureShape::Disc.into() },
    ]
}

/// The share of numbers (radiances and coverages) that lie at most three standard errors apart.
pub(super) fn share_in_agreement(a: &Estimate, b: &Estimate) -> f64 {
    let numbers = |picture: &Picture| -> Vec<f64> {
        picture.radiance.iter().flatten().chain(&picture.coverage).map(|&x| f64::from(x)).collect()
    };
    let [xa, xb, ea, eb] = [&a.picture, &b.picture, &a.standard_error, &b.standard_error].map(numbers);
    // Pictures are f32, whose rounding is no disagreement.
    let rounding = |x: f64| x.abs() * f64::from(f32::EPSILON);
    let agrees = |k: &usize| (xa[*k] - xb[*k]).abs() <= 3.0 * ea[*k].hypot(eb[*k]) + rounding(xa[*k]);
    (0..xa.len()).filter(agrees).count() as f64 / xa.len() as f64
}

/// What must agree.
const SHARE: f64 = 0.9975;
/// The same for few samples that are spread out no better than independent ones: then even exact errors are more
/// than three of their estimates apart in 0.3 to 0.5 % of the numbers (Student's t, 31 to 62 degrees of freedom).
pub(super) const SHARE_OF_FEW: f64 = 0.994;

fn estimate(
    scene: &Arc<scene::Scene>,
    focus: &[FocusOffset],
    camera: &Camera,
    options: TruthOptions,
) -> Estimate {
    let tracer = Tracer::new(scene.clone());
    let focus = ByPart(scene.clone(), focus.to_vec());
    render(&tracer, &Shaded(scene.clone()), &focus, camera, &options, &Unwatched).unwrap()
}

pub(super) fn both(
    scene: &Arc<scene::Scene>,
    focus: &[FocusOffset],
    camera: &Camera,
    options: TruthOptions,
) -> [Estimate; 2] {
    [(Estimator::Sensor, 1), (Estimator::Surface, 2)].map(|(estimator, seed)| {
        estimate(scene, focus, camera, TruthOptions { estimator, seed: seed + 2 * options.seed, ..options })
    })
}

pub(super) fn small(samples_per_pixel: u32) -> (Camera, TruthOptions) {
    let camera = Camera { width: 48, height: 32, aperture_radius: 0.1, sensor_height: 0.06, ..camera() };
    (camera, TruthOptions { samples_per_pixel, ..TruthOptions::default() })
}

#[test]
fn both_estimators_agree() {
    let scene = stage();
    let mut shares = Vec::new();
    for ((name, focus), aperture) in focuses().into_iter().zip(apertures()) {
        let (camera, options) = small(128);
        let camera = Camera { aperture, ..camera };
        let [a, b] = both(&scene, &focus, &camera, options);
        let share = share_in_agreement(&a, &b);
        shares.push((share, name));
    }
    assert!(shares.iter().all(|(share, _)| *share >= SHARE), "{shares:?}");
}

/// The same light, a share of it carried.
struct Mirroring(Shaded, f32);

impl Radiance for Mirroring {
    fn outgoing(&self, point: SurfacePoint, eye: DVec3) -> OutgoingRadiance {
        let (all, share) = (self.0.total_outgoing(point, eye), self.1);
        OutgoingRadiance {
            own: all * (1.0 - share),
            carried: all * share,
            carried_share: share,
            ..OutgoingRadiance::default()
        }
    }
    fn environment(&self, direction: DVec3) -> Vec3 {
        self.0.environment(direction)
    }
}

/// An estimate of light of which a share is carried; the sky is not painted.
fn carrying(share: f32, focus: &[FocusOffset; 7], estimator: Estimator, seed: u32) -> Estimate {
    let (camera, options) = small(128);
    let scene = stage();
    let tracer = Tracer::new(scene.clone());
    let focus = ByPart(scene.clone(), focus.to_vec());
    let light = Mirroring(Shaded(scene), share);
    render(&tracer, &light, &focus, &camera, &TruthOptions { estimator, seed, ..options }, &Unwatched)
        .unwrap()
}

#[test]
fn carried_light_keeps_the_focus_of_the_lens() {
    let [(_, standard), .., (_, painted)] = focuses();
    // Half of it carried: both estimators part it alike.
    let [a, b] = [(Estimator::Sensor, 1), (Estimator::Surface, 2)]
        .map(|(estimator, seed)| carrying(0.5, &painted, estimator, seed));
    let share = share_in_agreement(&a, &b);
    assert!(share >= SHARE_OF_FEW, "{share}");
    // All of it: paint changes nothing, where nothing else is painted.
    let unpainted = carrying(0.0, &standard, Estimator::Sensor, 5);
    let mirrored =
        |carried| share_in_agreement(&carrying(carried, &painted, Estimator::Sensor, 4), &unpainted);
    let share = mirrored(1.0);
    assert!(share >= SHARE_OF_FEW, "{share}");
    // The control: its own light moves.
    let share = mirrored(0.0);
    assert!(share < 0.9, "{share}");
}

#[test]
fn carried_light_obeys_the_paint_as_far_as_gloss_does() {
    let [.., (_, painted)] = focuses();
    // The sky, and the floor, are not painted: nothing of them is carried either.
    let with = |gloss: f64| painted.map(|focus| focus.with_gloss(gloss));
    for gloss in [0.3, 1.0] {
        let [a, b] = [(Estimator::Sensor, 1), (Estimator::Surface, 2)]
            .map(|(estimator, seed)| carrying(0.5, &with(gloss), estimator, seed));
        let share = share_in_agreement(&a, &b);
        assert!(share >= SHARE_OF_FEW, "{gloss}: {share}");
    }
    // All of it carried is as if all of it were own, focused where the carried light is.
    let own = |focus: &[FocusOffset; 7]| carrying(0.0, focus, Estimator::Sensor, 5);
    let carried = |gloss: f64| carrying(1.0, &with(gloss), Estimator::Sensor, 4);
    let share = share_in_agreement(&carried(1.0), &own(&painted));
    assert!(share >= SHARE_OF_FEW, "{share}");
    // The control: half of the way is neither end.
    for end in [&painted, &focuses()[0].1] {
        let share = share_in_agreement(&carried(0.5), &own(end));
        assert!(share < 0.95, "{share}");
    }
}

/// A bright square, whose level says how wide it is blurred.
fn square() -> Arc<scene::Scene> {
    let square = Mesh::rectangle(DVec3::new(-0.25, -0.25, -3.0), DVec3::X * 0.5, DVec3::Y * 0.5);
    scene_of([(square, colored(Vec4::splat(4.0)))])
}

/// Both estimators of the square: they agree, and do not where one of them has κ off by a factor.
fn check_that_blur_is_noticed(width: u32, samples: u32, agreement: f64, factors: [f64; 2]) {
    let (camera, options) = small(samples);
    let camera = Camera { width, height: width * 2 / 3, ..camera };
    let focus = [FocusOffset::new(1.25, 1.0)];
    let [a, b] = both(&square(), &focus, &camera, options);
    let share = share_in_agreement(&a, &b);
    println!("κ as it is: {:.2} %", 100.0 * share);
    assert!(share >= agreement, "{share}");
    for factor in factors {
        // κ·U, by way of U: as wrong as κ by that factor.
        let off = Camera { aperture_radius: camera.aperture_radius * factor, ..camera.clone() };
        let b = estimate(&square(), &focus, &off, TruthOptions { estimator: Estimator::Surface, ..options });
        let share = share_in_agreement(&a, &b);
        println!("κ off by {factor}: {:.2} %", 100.0 * share);
        assert!(share < agreement, "{factor}: {share}");
    }
}

#[test]
fn wrong_blur_is_not_overlooked() {
    check_that_blur_is_noticed(48, 256, SHARE_OF_FEW, [0.9, 1.1]);
}

/// Few pixels of many samples: what is off by one per cent is so in every pixel of the rim. One of the 192 numbers may be three standard
/// errors off by chance.
#[test]
fn one_per_cent_of_blur_is_not_overlooked() {
    check_that_blur_is_noticed(12, 1 << 15, SHARE_OF_FEW, [0.99, 1.01]);
}

/// `cargo test -p trace agreement_in_full -- --ignored --nocapture`
#[test]
#[ignore = "takes minutes: every focus with every aperture, sampler and filter"]
fn agreement_in_full() {
    let scene = stage();
    let mut worst = 1.0f64;
    for (k, (name, focus)) in focuses().into_iter().enumerate() {
        for (j, aperture) in apertures().into_iter().enumerate() {
            for sampler in [Sampler::LowDiscrepancy, Sampler::Independent] {
                let (camera, options) = small(1024);
                let camera = Camera { aperture: aperture.clone(), ..camera };
                let filter = match j % 3 {
                    0 => ReconstructionFilter::default(),
                    1 => ReconstructionFilter::Tent { radius: 1.0 },
                    _ => ReconstructionFilter::Gaussian { radius: 1.5 },
                };
                let seed = (10 * k + j) as u32;
                let [a, b] = both(&scene, &focus, &camera, TruthOptions { sampler, filter, seed, ..options });
                let share = share_in_agreement(&a, &b);
                println!("{name}, {:?}, {sampler:?}, {filter:?}: {:.3} %", aperture.shape, 100.0 * share);
                if sampler == Sampler::LowDiscrepancy {
                    worst = worst.min(share);
                }
            }
        }
    }
    assert!(worst >= SHARE, "{worst}");
}

#[test]
fn a_region_is_a_piece_of_the_frame_and_passes_go_on() {
    let scene = stage();
    let (_, focus) = focuses()[3];
    let (camera, options) = small(32);
    let (tracer, field) = (Tracer::new(scene.clone()), ByPart(scene.clone(), focus.to_vec()));
    let light = Shaded(scene);
    let whole = render(&tracer, &light, &field, &camera, &options, &Unwatched).unwrap();
    let region = Region { x: 20, y: 12, width: 100, height: 9 };
    let part = TruthOptions { region: Some(region), ..options };
    let mut truth = Truth::new(&tracer, &light, &field, &camera, &part);
    let mut passes = 0;
    while !truth.is_done() {
        truth.pass(&Unwatched).unwrap();
        passes += 1;
        assert_eq!(truth.estimate().passes, passes);
    }
    assert_eq!(truth.region(), Region { width: 28, ..region }, "what lies outside of the frame is left out");
    let part = truth.estimate();
    // Without bright surfaces' own rays, of which there are as many as the picture's size asks for, pixels would
    // be the same bit for bit; coverage knows none of these rays.
    for y in 0..9 {
        let row = (12 + y) * 48 + 20;
        assert_eq!(part.picture.coverage[y * 28..(y + 1) * 28], whole.picture.coverage[row..row + 28]);
    }
    assert_ne!(part.standard_error.coverage, vec![0.0; 28 * 9]);
}

/// A focus by rays that is a painted one, written as f and T.
struct Painted(lens::Optics, FocusOffset);

impl RayFocus for Painted {
    fn optics(&self, _point: Option<SurfacePoint>, _u: DVec2) -> RayOptics {
        RayOptics {
            inverse_focal_length: 1.0 / self.0.focal_length(),
            transmission_distance: self.1.t * self.0.image_distance,
        }
    }
    fn bounds(&self) -> [RayOptics; 2] {
        [self.optics(None, DVec2::ZERO); 2]
    }
}

/// A cylindrical lens on top of the common one: rays are followed farther the farther right they enter.
struct Slanted(Painted);

impl RayFocus for Slanted {
    fn optics(&self, point: Option<SurfacePoint>, u: DVec2) -> RayOptics {
        let common = self.0.optics(point, u);
        RayOptics { transmission_distance: common.transmission_distance * (1.0 + 0.2 * u.x), ..common }
    }
    fn bounds(&self) -> [RayOptics; 2] {
        [-1.0, 1.0].map(|x| self.optics(None, DVec2::new(x, 0.0)))
    }
}

#[test]
fn rays_may_be_focused_one_by_one() {
    let scene = stage();
    let (camera, options) = small(64);
    let (tracer, light) = (Tracer::new(scene.clone()), Shaded(scene));
    let focus = FocusOffset::new(0.95, 0.0);
    let with = |rays: &dyn RayFocus, estimator| {
        let options = TruthOptions { estimator, ..options };
        let unpainted = Uniform(FocusOffset::STANDARD);
        let mut truth = Truth::new(&tracer, &light, &unpainted, &camera, &options).with_ray_focus(rays);
        while !truth.is_done() {
            truth.pass(&Unwatched).unwrap();
        }
        truth.estimate()
    };
    let painted = render(&tracer, &light, &Uniform(focus), &camera, &options, &Unwatched).unwrap();
    let rays = Painted(camera.optics(), focus);
    let by_ray = with(&rays, Estimator::Sensor);
    let difference = |a: &Estimate, b: &Estimate| {
        let pairs = a.picture.coverage.iter().zip(&b.picture.coverage);
        pairs.map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / a.picture.coverage.len() as f64
    };
    assert!(difference(&painted, &by_ray) < 1e-3, "{}", difference(&painted, &by_ray));
    let slanted = Slanted(rays);
    let (a, b) = (with(&slanted, Estimator::Sensor), with(&slanted, Estimator::Surface));
    let unlike = share_in_agreement(&a, &by_ray);
    assert!(unlike < 0.99, "it is another focus, but {unlike} of it is alike");
    assert!(share_in_agreement(&a, &b) >= SHARE_OF_FEW, "{}", share_in_agreement(&a, &b));
}
