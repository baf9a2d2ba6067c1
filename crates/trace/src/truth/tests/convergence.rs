//! How errors fall with the number of samples, and whether what the estimate says of them is so.

use super::*;

fn options(samples_per_pixel: u32, seed: u32, sampler: Sampler) -> TruthOptions {
    TruthOptions { samples_per_pixel, seed, sampler, ..TruthOptions::default() }
}

/// Edges: upright and slanted, sharp, and blurred by depth and by paint.
fn edges(slope: f64, z: f64) -> Arc<scene::Scene> {
    let wall = rectangle(
        DVec3::new(0.013 - 9.0 * slope, -9.0, -z),
        DVec3::X * 20.0,
        DVec3::new(18.0 * slope, 18.0, 0.0),
    );
    scene_of(&[(wall, WHITE)])
}

/// The root of the mean squared error of a render, from pairs of renders of different seeds; and what they say
/// of it themselves.
fn rmse(
    scene: &Arc<scene::Scene>,
    focus: FocusOffset,
    camera: &Camera,
    samples: u32,
    sampler: Sampler,
) -> [f64; 2] {
    const PAIRS: u32 = 24;
    let tracer = Tracer::new(scene.clone());
    let (radiance, focus) = (BaseColor(scene.clone()), Uniform(focus));
    let (mut squares, mut expected) = (0.0, 0.0);
    for pair in 0..PAIRS {
        let [a, b] = [2 * pair, 2 * pair + 1].map(|seed| {
            render(&tracer, &radiance, &focus, camera, &options(samples, seed, sampler), &Unwatched).unwrap()
        });
        let difference = |(a, b): (&[f32; 3], &[f32; 3])| f64::from(a[0] - b[0]).powi(2);
        let pixels = a.picture.radiance.len() as f64;
        let sum: f64 = a.picture.radiance.iter().zip(&b.picture.radiance).map(difference).sum();
        squares += sum / pixels / 2.0;
        expected += a.expected_rmse(lens::Exposure::Conserve).powi(2);
    }
    [squares, expected].map(|sum| (sum / f64::from(PAIRS)).sqrt())
}

/// Slope of log RMSE over log samples: least squares over powers of two.
fn slope(
    scene: &Arc<scene::Scene>,
    focus: FocusOffset,
    camera: &Camera,
    powers: std::ops::Range<u32>,
    sampler: Sampler,
) -> f64 {
    let points: Vec<(f64, f64)> = powers
        .map(|power| {
            let [rmse, expected] = rmse(scene, focus, camera, 1 << power, sampler);
            println!("  {} spp: RMSE {rmse:.3e}, estimated {expected:.3e}", 1 << power);
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

/// Name, scene, focus, and the slope that low-discrepancy samples must reach.
///
/// What decides whether a sample is in front of an edge or beside it has as many dimensions d as it depends on
/// of the four (picture and aperture): the error of scrambled nets then falls with N to the −½ − 1/(2d) (He and
/// Wang 2015). A sharp edge has the picture's two, an upright blurred one x and u: −¾. A slanted blurred edge
/// has all four: −⅝, and no set of points in four dimensions does better.
fn edge_scenes() -> [(&'static str, Arc<scene::Scene>, FocusOffset, f64); 4] {
    [
        ("slanted edge, sharp", edges(0.3, 3.0), FocusOffset::STANDARD, -0.7),
        ("upright edge, blurred by depth", edges(0.0, 6.0), FocusOffset::STANDARD, -0.7),
        ("slanted edge, blurred by depth", edges(0.3, 6.0), FocusOffset::STANDARD, -0.57),
        ("slanted edge, blurred by paint", edges(0.3, 3.0), FocusOffset::new(1.05, 1.0), -0.57),
    ]
}

fn edge_camera() -> Camera {
    Camera { width: 16, height: 12, ..camera() }
}

/// `cargo test -p trace slopes_of_convergence -- --ignored --nocapture`
#[test]
#[ignore = "takes minutes"]
fn slopes_of_convergence() {
    for (name, scene, focus, reached) in edge_scenes() {
        for (sampler, powers) in [(Sampler::Independent, 5..10), (Sampler::LowDiscrepancy, 5..12)] {
            println!("{name}, {sampler:?}");
            let slope = slope(&scene, focus, &edge_camera(), powers, sampler);
            println!("{name}, {sampler:?}: slope {slope:.3}");
            match sampler {
                Sampler::Independent => assert!((slope + 0.5).abs() <= 0.05, "{name}: {slope}"),
                Sampler::LowDiscrepancy => assert!(slope <= reached, "{name}: {slope}"),
            }
        }
    }
}

#[test]
fn errors_are_as_large_as_estimated() {
    let (_, scene, focus, _) = &edge_scenes()[0];
    let [found, expected] = rmse(scene, *focus, &edge_camera(), 64, Sampler::Independent);
    assert!((found / expected - 1.0).abs() < 0.15, "found {found}, estimated {expected}");
    let [found, expected] = rmse(scene, *focus, &edge_camera(), 64, Sampler::LowDiscrepancy);
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
