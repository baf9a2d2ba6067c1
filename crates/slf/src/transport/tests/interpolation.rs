use super::*;
use crate::{Irradiance, IrradianceOptions};
use scene::{Environment, EnvironmentMap};

/// Points of a floor, one per pixel.
fn points() -> Vec<ShadingPoint> {
    let place = |k: u32| DVec2::new(f64::from(k % 8), f64::from(k / 8)) + 0.5;
    let shading_point = |k: u32| ShadingPoint {
        // A square within the first triangle.
        point: SurfacePoint { triangle: 0, barycentric: DVec2::splat(0.1) + place(k) * 0.04 },
        pixel: place(k),
    };
    (0..64).map(shading_point).collect()
}

/// A bright upper half of the sky, and a sun.
fn sky() -> World {
    let (width, height) = (32u32, 16u32);
    let mut texels: Vec<[f32; 3]> =
        (0..width * height).map(|k| if k / width < height / 2 { [0.5; 3] } else { [0.1; 3] }).collect();
    texels[(3 * width + 11) as usize] = [60.0; 3];
    let map = EnvironmentMap { name: "sky".into(), width, height, texels };
    World { environment: Environment::Map(Arc::new(map)), ..World::uniform(Vec3::ZERO) }
}

#[test]
fn interpolated_light_equals_that_of_single_points() {
    let gloss = |roughness: f32| Material {
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar { factor: 0.0, texture: None },
            roughness: Scalar { factor: roughness, texture: None },
        },
        specular: Scalar { factor: 1.0, texture: None },
        ..grey()
    };
    let directional = light(LightKind::Directional, DVec3::ZERO, DVec3::new(-0.6, -0.8, 0.0));
    let point = light(LightKind::Point, DVec3::new(0.5, 3.0, 0.2), DVec3::ZERO);
    let garland =
        (0..20).map(|k| light(LightKind::Point, DVec3::new(f64::from(k) * 0.4 - 4.0, 2.0, 0.3), DVec3::ZERO));
    let all =
        [vec![], vec![directional.clone()], vec![point.clone()], vec![directional, point], garland.collect()];
    for lights in all {
        for material in [grey(), gloss(0.8)] {
            let scene = scene_of(&[floor(material)], &lights);
            let options = TransportOptions { paths: 32, light_samples: 32, ..TransportOptions::default() };
            let tracer = Arc::new(Tracer::new(Arc::new(scene)));
            let transport = Transport::new(tracer, sky(), options);
            let solved = IrradianceOptions { patches: 200, rays: 64 };
            let irradiance = Irradiance::solve(&transport, solved, &Unwatched).unwrap();
            let transport = transport.with_irradiance(Arc::new(irradiance));
            let points = points();
            let interpolated = transport.incident_batch(&points, ABOVE);
            for (shading_point, received) in points.iter().zip(interpolated).step_by(9) {
                assert!(received.is_some(), "{shading_point:?} is unoccluded");
                let outgoing = |incident, seed| {
                    let slot = SampleSlot { incident, ..SampleSlot::single(seed) };
                    transport.outgoing_sample(shading_point.point, ABOVE, slot).own
                };
                const SEEDS: u64 = 256;
                let actual = outgoing(received, 0);
                let expected = (0..SEEDS).map(|seed| outgoing(None, seed)).sum::<Vec3>() / SEEDS as f32;
                let off = (actual - expected).abs().max_element() / expected.max_element();
                assert!(off < 0.02, "{} lights: {actual}, not {expected}", lights.len());
            }
        }
    }
}

/// Skylight on a floor inside or in front of a box, interpolated from a few points, over the unoccluded light.
fn lit_in_a_box(lid: bool) -> f32 {
    let wall = grey();
    let mut walls = rooms::outside(DVec3::splat(-1.02), DVec3::splat(1.02), &wall);
    walls.extend(rooms::inside(DVec3::splat(-1.0), DVec3::ONE, &wall));
    let normals = scene_of(&walls, &[]);
    let up = |triangle: u32| normals.area_normal(triangle).normalize_or_zero().y.abs() > 0.9;
    // Without a lid the upper sides of the box are removed.
    if !lid {
        let height =
            |triangle: u32| SurfacePoint { triangle, barycentric: DVec2::splat(0.3) }.position(&normals).y;
        let is_lid = |k: usize| up(2 * k as u32) && height(2 * k as u32) > 0.5;
        walls = walls.into_iter().enumerate().filter(|(k, _)| !is_lid(*k)).map(|(_, wall)| wall).collect();
    }
    let scene = scene_of(&walls, &[]);
    let is_floor = |triangle: &u32| {
        let normal = scene.area_normal(*triangle).normalize_or_zero();
        let at = SurfacePoint { triangle: *triangle, barycentric: DVec2::splat(0.3) }.position(&scene);
        normal.y > 0.9 && (at.y + 1.0).abs() < 1e-3
    };
    let triangle = (0..2 * walls.len() as u32).find(is_floor).expect("a floor");
    let on_floor = |shading_point: ShadingPoint| ShadingPoint {
        point: SurfacePoint { triangle, ..shading_point.point },
        ..shading_point
    };
    let points: Vec<_> = points().into_iter().map(on_floor).collect();
    let transport =
        Transport::new(Arc::new(Tracer::new(Arc::new(scene))), sky(), TransportOptions::default());
    let solved = IrradianceOptions { patches: 400, rays: 64 };
    let irradiance = Arc::new(Irradiance::solve(&transport, solved, &Unwatched).unwrap());
    let unshaded = irradiance.unshaded(&sky(), DVec3::Y).unwrap().as_vec3();
    let transport = transport.with_irradiance(irradiance.clone());
    let interpolated = transport.incident_batch(&points, DVec3::new(0.0, 0.9, 0.0));
    let interpolated: Vec<_> = interpolated.into_iter().flatten().collect();
    assert!(!interpolated.is_empty());
    let all: Vec<_> =
        interpolated.iter().map(|received| irradiance.shaded(&sky(), received, DVec3::Y).as_vec3()).collect();
    (all.iter().sum::<Vec3>() / all.len() as f32 / unshaded).max_element()
}

#[test]
fn a_closed_box_receives_exactly_no_skylight() {
    let shut = lit_in_a_box(true);
    assert!(shut < 1e-6, "{shut}");
    // Control.
    let open = lit_in_a_box(false);
    assert!(open > 0.1, "{open}");
}

#[test]
fn rough_metal_is_interpolated_under_a_sky_of_lamps() {
    let (width, height) = (64u32, 32u32);
    let mut texels = vec![[0.02f32; 3]; (width * height) as usize];
    for (k, [x, y]) in
        [[3, 5], [19, 9], [26, 2], [33, 12], [41, 7], [55, 4], [60, 13]].into_iter().enumerate()
    {
        let colour = [k % 3, (k + 1) % 3, (k + 2) % 3].map(|c| [40.0, 15.0, 5.0][c]);
        texels[(y * width + x) as usize] = colour;
        texels[(y * width + x + 1) as usize] = colour;
    }
    let map = EnvironmentMap { name: "lamps".into(), width, height, texels };
    let world = World { environment: Environment::Map(Arc::new(map)), ..World::uniform(Vec3::ZERO) };
    let metal = |roughness: f32| Material {
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar { factor: 1.0, texture: None },
            roughness: Scalar { factor: roughness, texture: None },
        },
        ..grey()
    };
    for roughness in [0.4, 0.6, 1.0] {
        let tracer = Arc::new(Tracer::new(Arc::new(scene_of(&[floor(metal(roughness))], &[]))));
        let transport = Transport::new(tracer, world.clone(), TransportOptions::default());
        let solved = IrradianceOptions { patches: 200, rays: 64 };
        let irradiance = Irradiance::solve(&transport, solved, &Unwatched).unwrap();
        let transport = transport.with_irradiance(Arc::new(irradiance));
        let points = points();
        for eye in [ABOVE, DVec3::new(3.0, 1.5, -2.0)] {
            let interpolated = transport.incident_batch(&points, eye);
            let (mut actual, mut expected) = (Vec3::ZERO, Vec3::ZERO);
            for (shading_point, received) in points.iter().zip(interpolated).step_by(9) {
                let outgoing = |incident, seed| {
                    let slot = SampleSlot { incident, ..SampleSlot::single(seed) };
                    transport.outgoing_sample(shading_point.point, eye, slot).own
                };
                const SEEDS: u64 = 256;
                actual += outgoing(received, 0);
                expected += (0..SEEDS).map(|seed| outgoing(None, seed)).sum::<Vec3>() / SEEDS as f32;
            }
            let off = (actual / expected - 1.0).abs().max_element();
            assert!(off < 0.05, "roughness {roughness} from {eye}: {actual}, not {expected}");
        }
    }
}
