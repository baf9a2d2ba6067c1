//! Refined light: paths correct the cache, so the error has no floor.

use super::rooms::{inside, outside};
use super::*;
use crate::{IrradianceOptions, IrradianceSolution};

const LAMP: f32 = 8.0;

/// A room with a red wall and a lamp, a matte and a metal box, and a floor of glossy paint.
fn room() -> Scene {
    let matte = |color: Vec3| Material { base_color: color.extend(1.0), ..Material::lambertian_white() };
    let glossy = |color: Vec3, metallic: f32, roughness: f32| Material {
        base_color: color.extend(1.0),
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar::constant(metallic),
            roughness: Scalar::constant(roughness),
        },
        ..Material::default()
    };
    let mut walls = inside(DVec3::ZERO, DVec3::new(2.0, 1.2, 1.5), &matte(Vec3::new(0.7, 0.7, 0.65)));
    walls[4].3 = matte(Vec3::new(0.8, 0.1, 0.1));
    walls[0].3 = glossy(Vec3::new(0.6, 0.6, 0.6), 0.0, 0.3);
    walls.extend(outside(DVec3::new(0.3, 0.0, 0.4), DVec3::new(0.7, 0.5, 0.8), &matte(Vec3::splat(0.6))));
    let metal = glossy(Vec3::new(0.9, 0.7, 0.4), 1.0, 0.15);
    walls.extend(outside(DVec3::new(1.1, 0.0, 0.5), DVec3::new(1.5, 0.7, 0.9), &metal));
    let lamp =
        Material { emissive: Vec3::splat(LAMP), base_color: Vec4::ZERO, ..Material::lambertian_white() };
    walls.push(Rectangle(DVec3::new(0.7, 1.19, 0.5), DVec3::X * 0.5, DVec3::Z * 0.5, lamp));
    scene_of(&walls, &[])
}

const EYE: DVec3 = DVec3::new(1.0, 0.9, 1.4);

/// Points on walls and boxes, some of them where two surfaces meet.
fn points(scene: &Scene) -> Vec<SurfacePoint> {
    let all = (0..96u32).map(|k| {
        let u = (DVec2::new(0.754_877_666, 0.569_840_291) * f64::from(k) + 0.5).fract();
        let barycentric = if u.x + u.y > 1.0 { DVec2::ONE - u } else { u };
        SurfacePoint { triangle: k % 36, barycentric }
    });
    all.filter(|point| {
        let toward = EYE - point.position(scene);
        scene.area_normal(point.triangle).dot(toward) > 0.0
    })
    .collect()
}

fn transport(tracer: &Arc<Tracer>, paths: u32) -> Transport {
    let options = TransportOptions { paths, ..TransportOptions::default() };
    Transport::new(tracer.clone(), World::uniform(Vec3::ZERO), options)
}

/// An irradiance with few patches, inaccurate where surfaces meet.
fn coarse(tracer: &Arc<Tracer>) -> Arc<Irradiance> {
    let options = IrradianceOptions { patches: 24, rays: 64 };
    Arc::new(Irradiance::solve(&transport(tracer, 1), options, &Unwatched).unwrap())
}

/// Outgoing radiance of points, with independent random numbers for each run.
fn sent(transport: &Transport, points: &[SurfacePoint], run: u64) -> Vec<Vec3> {
    let at = |(number, &point): (usize, &SurfacePoint)| {
        let seed = (number as u64) << 32 | run;
        transport.outgoing_sample(point, EYE, SampleSlot::single(seed)).total()
    };
    points.iter().enumerate().map(at).collect()
}

/// Root mean square difference.
fn off(actual: &[Vec3], truth: &[Vec3]) -> f64 {
    let squares = actual.iter().zip(truth).map(|(a, b)| f64::from((*a - *b).length_squared()) / 3.0);
    (squares.sum::<f64>() / actual.len() as f64).sqrt()
}

#[test]
fn refined_light_has_no_error_floor_and_cached_light_has_one() {
    let tracer = Arc::new(Tracer::new(Arc::new(room())));
    let points = points(tracer.scene());
    assert!(points.len() > 40, "{}", points.len());
    let irradiance = coarse(&tracer);
    let truth = sent(&transport(&tracer, 1 << 13), &points, 0);
    let refined = |paths: u32| {
        let checking = transport(&tracer, paths).with_control_variate(irradiance.clone());
        off(&sent(&checking, &points, 1), &truth)
    };
    let errors = [16, 64, 256, 1024].map(refined);
    let trusted = transport(&tracer, 1024).with_irradiance(irradiance.clone());
    let floor = off(&sent(&trusted, &points, 1), &truth);
    // Sixteen times the paths give a quarter of the error.
    for (few, many) in errors.iter().zip(&errors[2..]) {
        assert!((0.12..0.4).contains(&(many / few)), "{errors:?}");
    }
    // Control: as many paths that trust the cache have its error.
    assert!(floor > 3.0 * errors[3], "{floor} is the floor, refined {errors:?}");
}

#[test]
fn refined_light_equals_full_path_tracing_whatever_the_cache_holds() {
    // A cache of another world altogether: three times as much light everywhere.
    let tracer = Arc::new(Tracer::new(Arc::new(room())));
    let points = &points(tracer.scene())[..24];
    let irradiance = coarse(&tracer);
    let tripled = |values: &[Vec3]| values.iter().map(|v| *v * 3.0).collect();
    let right = irradiance.solution();
    let wrong = IrradianceSolution {
        direct: tripled(&right.direct),
        indirect: tripled(&right.indirect),
        is_cut_off: false,
    };
    let options = IrradianceOptions { patches: 24, rays: 64 };
    let world = World::uniform(Vec3::ZERO);
    let wrong = Irradiance::from_solution(tracer.scene(), &world, options, wrong).unwrap();
    let mean = |all: &[Vec3]| all.iter().sum::<Vec3>() / all.len() as f32;
    let truth = mean(&sent(&transport(&tracer, 1 << 12), points, 0));
    let wrong = Arc::new(wrong);
    let refined = mean(&sent(&transport(&tracer, 1 << 12).with_control_variate(wrong.clone()), points, 1));
    let trusted = mean(&sent(&transport(&tracer, 64).with_irradiance(wrong), points, 1));
    assert!((refined / truth - 1.0).abs().max_element() < 0.015, "{refined}, not {truth}");
    assert!((trusted / truth).min_element() > 1.3, "trusted, it is far off: {trusted}, not {truth}");
}
