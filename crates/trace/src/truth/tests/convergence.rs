//! How errors fall with the number of samples, and whether what the estimate says of them is so.

use super::*;
use lens::Exposure;
use std::ops::RangeInclusive;

fn options(samples_per_pixel: u32, seed: u32, sampler: Sampler) -> TruthOptions {
    TruthOptions { samples_per_pixel, seed, sampler, ..TruthOptions::default() }
}

/// A white half plane that faces the camera at depth `z`, its edge turned by `angle` from upright.
fn edge(angle: f64, z: f64) -> Arc<scene::Scene> {
    let across = DVec3::new(angle.cos(), angle.sin(), 0.0);
    let along = DVec3::new(-angle.sin(), angle.cos(), 0.0);
    let corner = DVec3::new(0.0, 0.0, -z) + 0.013 * across - 40.0 * along;
    scene_of([(Mesh::rectangle(corner, 80.0 * across, 80.0 * along), white())])
}

/// Directions of edges, none of them in line with anything.
const ANGLES: [f64; 4] = [0.29, 0.73, -0.41, 1.23];

/// A camera in which the depth `BLURRED_Z` is blurred to circles of `circle_px`.
fn camera_that_blurs(circle_px: f64) -> Camera {
    let wide = Camera { width: 16, height: 12, aperture_radius: 1.0, ..camera() };
    let kappa = wide.optics().standard_kappa(1.0 / BLURRED_Z);
    Camera { aperture_radius: circle_px / wide.optics().circle_of_confusion_px(kappa).abs(), ..wide }
}

const SHARP_Z: f64 = 3.0;
const BLURRED_Z: f64 = 6.0;

/// What the slope is measured on: edges of all directions, and the slope that low-discrepancy samples must reach.
///
/// What decides whether a ray meets an edge has as many dimensions d as it depends on of the four of a sample; the
/// error of nets and of grids on a curve then falls with N to the −½ − 1/(2d) (He and Wang 2015, He and Owen 2016).
/// A sharp edge has the two of the place, −¾. A blurred edge has all four, −⅝, but for samples that suit its circle
/// of confusion: then the two of where a ray crosses its depth, −¾. So has one that paint moves alike everywhere. Where
/// the blur that is painted grows across the surface, how many samples land in a pixel is itself a question of all
/// four, everywhere on it, and little better than with independent samples; divided by the coverage, of which the same is
/// true, better.
struct Edges {
    name: &'static str,
    camera: Camera,
    z: f64,
    focus: FocusOffset,
    /// How much t − 1 grows with x and y, relative, for each unit of length.
    growth: DVec2,
    exposure: Exposure,
    reached: f64,
}

/// Paint that grows over the surfaces of a scene, from two thirds of its middle to four thirds.
struct Growing {
    scene: Arc<scene::Scene>,
    middle: FocusOffset,
    growth: DVec2,
}

impl Growing {
    fn by(&self, x: f64) -> FocusOffset {
        FocusOffset { t: 1.0 + (self.middle.t - 1.0) * (1.0 + x.clamp(-1.0 / 3.0, 1.0 / 3.0)), ..self.middle }
    }
}

impl SurfaceField<FocusOffset> for Growing {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        self.by(self.growth.dot(point.position(&self.scene).truncate()))
    }
    fn at_infinity(&self) -> FocusOffset {
        self.middle
    }
    fn bounds(&self, triangle: u32) -> Option<[FocusOffset; 2]> {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y]
            .map(|barycentric| self.at(SurfacePoint { triangle, barycentric }).t);
        let bound = |of: fn(f64, f64) -> f64| FocusOffset {
            t: of(of(corners[0], corners[1]), corners[2]),
            ..self.middle
        };
        Some([bound(f64::min), bound(f64::max)])
    }
}

fn edges() -> [Edges; 8] {
    let blurred = |name, circle_px, reached| Edges {
        name,
        camera: camera_that_blurs(circle_px),
        z: BLURRED_Z,
        focus: FocusOffset::STANDARD,
        growth: DVec2::ZERO,
        exposure: Exposure::Conserve,
        reached,
    };
    let sharp = Edges { name: "sharp", z: SHARP_Z, ..blurred("", 6.0, -0.7) };
    // κ = (t − 1)/d by paint on the conjugate is κ of BLURRED_Z.
    let optics = sharp.camera.optics();
    let t = 1.0 + optics.standard_kappa(1.0 / BLURRED_Z) * optics.image_distance;
    let painted =
        Edges { z: SHARP_Z, focus: FocusOffset::new(t, 1.0), ..blurred("6 px, by paint", 6.0, -0.7) };
    // From 4 to 8 px over the picture's width and height.
    let width = 2.0 * SHARP_Z * optics.tan_half_yfov * sharp.camera.aspect();
    let growing = |name, exposure, reached| Edges {
        name,
        growth: DVec2::new(0.4, 0.4 * 0.75) / width,
        z: SHARP_Z,
        focus: FocusOffset::new(t, 1.0),
        exposure,
        ..blurred(name, 6.0, reached)
    };
    [
        sharp,
        blurred("1 px", 1.0, -0.7),
        blurred("2 px", 2.0, -0.7),
        blurred("10 px", 10.0, -0.7),
        blurred("40 px", 40.0, -0.7),
        painted,
        growing("4 to 8 px, by paint", Exposure::Conserve, -0.5),
        growing("4 to 8 px, by paint, normalised", Exposure::Normalise, -0.55),
    ]
}

/// The root of the mean squared error of pictures of edges of all directions, from `pairs` pairs of renders of
/// different seeds each; and what the renders say of it themselves.
fn rmse(edges: &Edges, samples: u32, sampler: Sampler, pairs: u32) -> [f64; 2] {
    let (mut squares, mut expected) = (0.0, 0.0);
    for angle in ANGLES {
        let scene = edge(angle, edges.z);
        let tracer = Tracer::new(scene.clone());
        let focus = Growing { scene: scene.clone(), middle: edges.focus, growth: edges.growth };
        let radiance = BaseColor(scene);
        for pair in 0..pairs {
            let [a, b] = [2 * pair, 2 * pair + 1].map(|seed| {
                let options = options(samples, seed, sampler);
                render(&tracer, &radiance, &focus, &edges.camera, &options, &Unwatched).unwrap()
            });
            let difference = |(a, b): (&[f32; 3], &[f32; 3])| f64::from(a[0] - b[0]).powi(2);
            let [first, second] = [&a, &b].map(|estimate| estimate.picture.exposed(edges.exposure));
            let sum: f64 = first.iter().zip(&second).map(difference).sum();
            squares += sum / first.len() as f64 / 2.0;
            expected += a.expected_rmse(edges.exposure).powi(2);
        }
    }
    [squares, expected].map(|sum| (sum / f64::from(pairs * ANGLES.len() as u32)).sqrt())
}

/// Slope of log RMSE over log samples: least squares over powers of two.
fn slope(edges: &Edges, powers: RangeInclusive<u32>, sampler: Sampler, pairs: u32) -> f64 {
    let points: Vec<(f64, f64)> = powers
        .map(|power| {
            let [rmse, expected] = rmse(edges, 1 << power, sampler, pairs);
            println!("  {} rays: RMSE {rmse:.3e}, estimated {expected:.3e}", 1 << power);
            (f64::from(power), rmse.log2())
        })
        .collect();
    let n = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let (above, below) = points
        .iter()
        .fold((0.0, 0.0), |(a, b), p| (a + (p.0 - mean.0) * (p.1 - mean.1), b + (p.0 - mean.0).powi(2)));
    above / below
}

/// `cargo test -p trace slopes_of_convergence -- --ignored --nocapture`
#[test]
#[ignore = "takes minutes"]
fn slopes_of_convergence() {
    for edges in edges() {
        for (sampler, powers) in [(Sampler::Independent, 4..=9), (Sampler::LowDiscrepancy, 4..=12)] {
            let slope = slope(&edges, powers, sampler, 8);
            println!("{}, {sampler:?}: slope {slope:.3}", edges.name);
            match sampler {
                Sampler::Independent => assert!((slope + 0.5).abs() <= 0.05, "{}: {slope}", edges.name),
                Sampler::LowDiscrepancy => assert!(slope <= edges.reached, "{}: {slope}", edges.name),
            }
        }
    }
}

#[test]
fn low_discrepancy_samples_converge_faster() {
    let [sharp, _, blurred, ..] = edges();
    for edges in [sharp, blurred] {
        let slope = |sampler| slope(&edges, 4..=9, sampler, 3);
        let (independent, spread) = (slope(Sampler::Independent), slope(Sampler::LowDiscrepancy));
        assert!((independent + 0.5).abs() < 0.1, "{}: {independent}", edges.name);
        assert!(spread < -0.66, "{}: {spread}", edges.name);
    }
}

#[test]
fn errors_are_as_large_as_estimated() {
    let [sharp, ..] = edges();
    let [found, expected] = rmse(&sharp, 64, Sampler::Independent, 8);
    assert!((found / expected - 1.0).abs() < 0.15, "found {found}, estimated {expected}");
    let [found, expected] = rmse(&sharp, 64, Sampler::LowDiscrepancy, 8);
    // Passes are spread out together: better than their scatter tells, never worse.
    assert!(found < expected && found > 0.1 * expected, "found {found}, estimated {expected}");
}

#[test]
fn energy_does_not_depend_on_paint() {
    // A square well inside a frame that holds all of its light, however it is blurred.
    let camera = Camera { width: 96, height: 96, ..camera() };
    let spot = spot(&camera, 4.0);
    let tracer = Tracer::new(spot.clone());
    let radiance = BaseColor(spot);
    let mut energies = Vec::new();
    for (t, anchor) in [(1.0, 0.0), (0.93, 0.0), (1.05, 1.0), (0.97, 0.5)] {
        for (estimator, sampler) in
            [(Estimator::Sensor, Sampler::Independent), (Estimator::Surface, Sampler::Independent)]
        {
            let options = TruthOptions { estimator, ..options(64, 3, sampler) };
            let focus = Uniform(FocusOffset::new(t, anchor));
            let estimate = render(&tracer, &radiance, &focus, &camera, &options, &Unwatched).unwrap();
            let energy: f64 = estimate.picture.radiance.iter().map(|rgb| f64::from(rgb[0])).sum();
            let variance = |rgb: &[f32; 3]| f64::from(rgb[0]).powi(2);
            let error = estimate.standard_error.radiance.iter().map(variance).sum::<f64>().sqrt();
            assert!(error > 0.0 && error < 0.05 * energy, "{error} of {energy}");
            energies.push((energy, error));
        }
    }
    for (energy, error) in &energies {
        let (first, its_error) = energies[0];
        assert!((energy - first).abs() <= 3.0 * error.hypot(its_error), "{energy} ± {error} of {first}");
    }
}
