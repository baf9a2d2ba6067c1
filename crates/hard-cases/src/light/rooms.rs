//! Interreflection in rooms, light leaks, and a sky with a small sun.

use crate::case::{Case, Effort, Verdict};
use crate::support::measure::worst;
use glam::{DVec2, DVec3, Vec3};
use progress::{Cancelled, Progress};
use scene::{Environment, EnvironmentMap, Light, LightKind, Material, Scene, SurfacePoint, World};
use slf::{Irradiance, IrradianceOptions, Transport, TransportOptions};
use std::f64::consts::PI;
use std::sync::Arc;
use test_scenes::{Mesh, scene_of, spread};
use trace::{Radiance, Tracer};

pub const CASES: &[Case] = &[
    Case {
        name: "a closed room that glows",
        reason: "In a closed room with uniformly emitting walls the radiance is the sum of a geometric \
                 series, L/(1 − ρ), for any shape.",
        control: "two bounces",
        check: closed_room,
    },
    Case {
        name: "a closed box lit from without",
        reason: "No light passes through walls: no patch of the irradiance cache represents both sides.",
        control: "a box without its floor",
        check: closed_box,
    },
    Case {
        name: "kept light has no borders",
        reason: "The cached irradiance is interpolated from several patches around a point, so that it varies \
                 smoothly along walls and across edges.",
        control: "independent paths from each point",
        check: borders,
    },
    Case {
        name: "refined light has no floor",
        reason: "The cached irradiance is a control variate of the paths that refine it: whatever its error, \
                 the mean is that of full paths.",
        control: "as many paths that rely on the cache",
        check: refined,
    },
    Case {
        name: "a sun of five texels",
        reason: "A sun of 5 texels among 131,072 is sampled in proportion to its importance: it neither \
                 vanishes nor causes fireflies.",
        control: "the sky without it",
        check: sun,
    },
];

fn lambert(albedo: f32) -> Material {
    Material { base_color: Vec3::splat(albedo).extend(1.0), ..Material::lambertian_white() }
}

fn transport(scene: Arc<Scene>, world: World, paths: u32) -> Transport {
    let options = TransportOptions { paths, ..TransportOptions::default() };
    Transport::new(Arc::new(Tracer::new(scene)), world, options)
}

fn with_cached_irradiance(
    transport: Transport,
    effort: Effort,
    progress: &dyn Progress,
) -> Result<Transport, Cancelled> {
    let options = IrradianceOptions { patches: 6000, rays: effort.choose(256, 96) };
    Irradiance::solve(&transport, options, progress)
        .map(|irradiance| transport.with_irradiance(Arc::new(irradiance)))
}

/// Mean outgoing radiance toward an eye over points of some triangles.
fn mean(transport: &Transport, eye: DVec3, triangles: std::ops::Range<u32>) -> f64 {
    let points = triangles.flat_map(|triangle| {
        (0..64).map(move |k| {
            let u = spread(k);
            let barycentric = if u.x + u.y > 1.0 { DVec2::ONE - u } else { u };
            SurfacePoint { triangle, barycentric }
        })
    });
    let all: Vec<f64> = points.map(|point| f64::from(transport.total_outgoing(point, eye).y)).collect();
    all.iter().sum::<f64>() / all.len() as f64
}

fn closed_room(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let eye = DVec3::new(1.0, 0.5, 0.7);
    let room = Mesh::cuboid(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.5)).turned();
    let mut errors = [Vec::new(), Vec::new(), Vec::new()];
    for (albedo, glow) in [(0.5f32, 1.0f32), (0.8, 0.25)] {
        let wall = Material { emissive: Vec3::splat(glow), ..lambert(albedo) };
        let scene = scene_of([(&room, wall)]);
        let expected = f64::from(glow / (1.0 - albedo));
        let world = World::uniform(Vec3::ZERO);
        let off = |transport: &Transport| mean(transport, eye, 0..12) / expected - 1.0;
        let paths = effort.choose(128, 32);
        errors[0].push(off(&transport(scene.clone(), world.clone(), paths)));
        errors[1].push(off(&with_cached_irradiance(
            transport(scene.clone(), world.clone(), 8),
            effort,
            progress,
        )?));
        let cut = World { bounces: Some(1), ..world };
        errors[2].push(off(&transport(scene, cut, paths)));
    }
    let [by_paths, by_cache, cut] = errors.map(worst);
    let limits = [("by paths", 0.01), ("kept", 0.01)];
    Ok(Verdict::new("L/(1 − ρ) ± 1 %, ρ 0.5 and 0.8", limits, [by_paths, by_cache], [cut, cut]))
}

fn closed_box(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let within = Mesh::cuboid(-DVec3::ONE, DVec3::ONE).turned();
    let without = Mesh::cuboid(DVec3::splat(-1.02), DVec3::splat(1.02));
    let sky = World::uniform(Vec3::splat(0.5));
    let scene = scene_of([(&within, lambert(0.8)), (&without, lambert(0.8))]);
    let closed = with_cached_irradiance(transport(scene, sky.clone(), 4), effort, progress)?;
    let outside = mean(&closed, DVec3::splat(9.0), 12..24);
    let inside = mean(&closed, DVec3::ZERO, 0..12) / outside;
    let mut open = within;
    open.triangles.truncate(10);
    let open =
        with_cached_irradiance(transport(scene_of([(&open, lambert(0.8))]), sky, 4), effort, progress)?;
    let control = mean(&open, DVec3::ZERO, 0..10) / outside;
    Ok(Verdict::new("dark to 0.1 % of its outside", [("inside", 1e-3)], [inside], [control]))
}

fn borders(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let room = Mesh::cuboid(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.5)).turned();
    let mut scene = (*scene_of([(&room, lambert(0.7))])).clone();
    scene.lights.push(Light {
        name: String::new(),
        kind: LightKind::Point,
        intensity: Vec3::ONE,
        position: DVec3::new(0.6, 0.7, 0.8),
        direction: DVec3::ZERO,
        range: f64::INFINITY,
    });
    let scene = Arc::new(scene);
    let count = effort.choose(4000, 1000);
    // Along both triangles of each wall, close to their common side.
    let step = |transport: &Transport, count: u32| {
        let along = |triangle: u32| {
            let at = |k: u32| SurfacePoint {
                triangle,
                barycentric: DVec2::new(0.03 + 0.9 * f64::from(k) / f64::from(count), 0.05),
            };
            let light = |k| f64::from(transport.total_outgoing(at(k), DVec3::new(1.0, 0.5, 0.7)).y);
            let all: Vec<f64> = (0..count).map(light).collect();
            worst(all.windows(2).map(|pair| pair[1] / pair[0] - 1.0))
        };
        worst((0..12).map(along))
    };
    let world = World::uniform(Vec3::ZERO);
    let cached = with_cached_irradiance(transport(scene.clone(), world.clone(), 4), effort, progress)?;
    let control = step(&transport(scene, world, 4), 50);
    let expected = format!("≤ 1 % between neighbours of {count} points along each wall");
    Ok(Verdict::new(expected, [("step", 0.01)], [step(&cached, count)], [control]))
}

fn refined(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let room = Mesh::cuboid(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.5)).turned();
    let block = Mesh::cuboid(DVec3::new(0.5, 0.0, 0.5), DVec3::new(0.9, 0.6, 0.9));
    let lamp = Mesh::cuboid(DVec3::new(1.3, 0.7, 0.6), DVec3::new(1.5, 0.8, 0.8));
    let glow = Material { emissive: Vec3::splat(8.0), ..lambert(0.0) };
    let scene = scene_of([(&room, lambert(0.7)), (&block, lambert(0.6)), (&lamp, glow)]);
    let dark = World::uniform(Vec3::ZERO);
    // So few patches that the error is large where surfaces meet.
    let options = IrradianceOptions { patches: 24, rays: 64 };
    let irradiance = Irradiance::solve(&transport(scene.clone(), dark.clone(), 1), options, progress)?;
    let irradiance = Arc::new(irradiance);
    let light = |paths| transport(scene.clone(), dark.clone(), paths);
    let eye = DVec3::new(1.0, 0.5, 1.3);
    let radiances = |transport: &Transport| -> Vec<f64> {
        let places = (0..48).map(|k| SurfacePoint { triangle: k % 12, barycentric: spread(k) * 0.5 });
        places.map(|point| f64::from(transport.total_outgoing(point, eye).y)).collect()
    };
    let paths = effort.choose(2048, 512);
    let truth = radiances(&light(8 * paths));
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let off = |transport: &Transport| {
        let squares = radiances(transport).iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        (squares / truth.len() as f64).sqrt() / mean
    };
    let error = off(&light(paths).with_control_variate(irradiance.clone()));
    let control = off(&light(paths).with_irradiance(irradiance));
    let limit = effort.choose(0.022, 0.045);
    let expected =
        format!("RMS of {paths} paths a point within {:.1} % of theirs in the mean", 100.0 * limit);
    Ok(Verdict::new(expected, [("off", limit)], [error], [control]))
}

fn sun(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    const SIZE: [u32; 2] = [512, 256];
    let dim = 0.2f32;
    let (row, glare) = (40usize, 2e4f32);
    let map = |glare: f32| {
        let [width, height] = SIZE;
        let mut texels = vec![[dim; 3]; (width * height) as usize];
        (100..105).for_each(|column| texels[row * width as usize + column] = [glare; 3]);
        let map = EnvironmentMap { name: "sun".into(), width, height, texels };
        let environment = Environment::Map(Arc::new(map));
        World { environment, ..World::uniform(Vec3::ONE) }
    };
    let floor = Mesh::rectangle(DVec3::new(-1.0, 0.0, 1.0), DVec3::X * 2.0, DVec3::Z * -2.0);
    let scene = scene_of([(&floor, lambert(1.0))]);
    // Bilinear interpolation of the map displaces a negligible amount of light at this latitude: 5 texels.
    let polar = (row as f64 + 0.5) / f64::from(SIZE[1]) * PI;
    let solid_angle = 5.0 * (PI / f64::from(SIZE[1])).powi(2) * polar.sin();
    let expected = f64::from(dim) + f64::from(glare - dim) * solid_angle * polar.cos() / PI;
    let points: Vec<_> = (0..effort.choose(400, 100)).map(|k| spread(k) * 0.49).collect();
    let off = |transport: &Transport| {
        let value_at = |&barycentric: &DVec2| {
            let point = SurfacePoint { triangle: 0, barycentric };
            f64::from(transport.total_outgoing(point, DVec3::new(0.3, 2.0, 0.4)).y) / expected - 1.0
        };
        let all: Vec<f64> = points.iter().map(value_at).collect();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        [mean.abs(), worst(all.iter().map(|value| value - mean))]
    };
    progress.check()?;
    let right = off(&transport(scene.clone(), map(glare), 32));
    let wrong = off(&transport(scene, map(dim), 32));
    let limits = [("mean", 0.01), ("farthest from it", 0.2)];
    Ok(Verdict::new("mean right to 1 %, no point of 32 paths off by 20 %", limits, right, wrong))
}
