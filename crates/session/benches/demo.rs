//! Times the road from scene to picture on the demo: `cargo bench -p session --bench demo [-- WIDTH HEIGHT]`.
//!
//! Prints times (of the dab and of F: medians) beside F, the time to copy one RGB float frame with all cores in the same
//! run, and checks on the way that a dab equals a render from scratch, and one thread the picture of many, bit for bit.

use lens::{Camera, FocusOffset, Picture};
use progress::Unwatched;
use rayon::prelude::*;
use salf::BakeOptions;
use scene::{LoadOptions, SurfaceField, SurfacePoint};
use slf::DirectLight;
use splat::{Splatter, Tolerance};
use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use trace::Tracer;

/// Samples of a dab.
const DAB: usize = 5000;

/// A focus with a dab on it: the samples at `points` are blurred.
struct Dabbed<'a> {
    focus: &'a dyn SurfaceField<FocusOffset>,
    points: HashSet<[u64; 3]>,
}

fn key(point: SurfacePoint) -> [u64; 3] {
    [point.triangle as u64, point.barycentric.x.to_bits(), point.barycentric.y.to_bits()]
}

impl SurfaceField<FocusOffset> for Dabbed<'_> {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        if self.points.contains(&key(point)) { FocusOffset::new(1.03, 1.0) } else { self.focus.at(point) }
    }
    fn at_infinity(&self) -> FocusOffset {
        self.focus.at_infinity()
    }
}

fn main() {
    let sizes: Vec<u32> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let [width, height] = *sizes.first_chunk().unwrap_or(&[1920, 1080]);
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/demo");
    let scene = scene::load(&demo.join("demo.glb"), &LoadOptions::default(), &Unwatched).expect("the demo");
    let scene = Arc::new(scene);
    let camera =
        project::read_camera(&demo.join("demo.camera.json"), &Camera::default()).expect("its camera");
    let camera = Camera { width, height, ..camera };
    let recipe = project::read_recipe(&demo.join("demo.focus.json")).expect("its recipe");
    let focus = recipe.evaluate(&scene).expect("the recipe fits the scene");
    let threads = rayon::current_num_threads();
    println!("demo at {width} × {height}, {threads} threads, {} triangles", scene.triangles.len());

    let copy = copy_seconds(width as usize * height as usize);
    let report = |what: &str, seconds: f64| {
        println!("{what:<42} {:>10.1} ms {:>9.1} F", seconds * 1e3, seconds / copy);
    };
    report("copy one frame (F)", copy);

    let start = Instant::now();
    let tracer = Arc::new(Tracer::new(scene.clone()));
    report("hierarchy", start.elapsed().as_secs_f64());
    let background = camera.background.map(|c| c as f32).into();
    let radiance = DirectLight::new(tracer.clone(), background);
    let start = Instant::now();
    let options = BakeOptions::for_focus(&tracer, &camera, &focus);
    let salf = salf::bake(&tracer, &radiance, &camera, &options, &Unwatched).expect("nobody cancels");
    report("bake", start.elapsed().as_secs_f64());
    let counts = salf.statistics();
    let (open, partial, bytes) = (counts.open, counts.partial, counts.bytes as f64 / (1 << 20) as f64);
    println!("  {open} open and {partial} partly occluded samples, {bytes:.0} MiB");

    let start = Instant::now();
    let mut splatter = Splatter::new(Arc::new(salf));
    report("hierarchy over the samples", start.elapsed().as_secs_f64());
    let [tree, sums] = splatter.bytes().map(|bytes| bytes >> 20);
    println!("  {tree} MiB of nodes, {sums} MiB of sums");
    let standard = focus::FocusRecipe::default().evaluate(&scene).expect("empty recipes fit");
    let mut exact: Vec<Picture> = Vec::new();
    for (name, tolerance) in [("exact", Tolerance::NONE), ("viewing", Tolerance::VIEWING)] {
        splatter.set_tolerance(tolerance);
        for (index, (what, focus)) in [("unpainted", &standard), ("painted", &focus)].into_iter().enumerate()
        {
            let mut times = [Vec::new(), Vec::new()];
            for _ in 0..3 {
                times[0].push(seconds(|| splatter.render(&camera, focus, &Unwatched).expect("in range")));
                times[1].push(seconds(|| splatter.refocus(&camera, &Unwatched).expect("in range")));
            }
            let [render, refocus] = times.map(|times| median(times.into_iter()));
            report(&format!("{name}, {what}: full splat"), render);
            report(&format!("{name}, {what}: another lens"), refocus);
            match exact.get(index) {
                None => exact.push(splatter.picture().clone()),
                Some(exact) => println!("  {:.1} dB against exact", psnr(splatter.picture(), exact)),
            }
        }
    }
    let painted = splatter.picture().clone();

    let dab = dab_samples(&splatter, width as f32, height as f32);
    let points = dab.iter().filter_map(|&index| splatter.salf().samples[index as usize].surface.map(key));
    let dabbed = Dabbed { focus: &focus, points: points.collect() };
    let mut update = |focus: &dyn SurfaceField<FocusOffset>| {
        seconds(|| {
            splatter.update(focus, &dab).expect("in range");
        })
    };
    let dab_seconds = median((0..21).map(|k| if k % 2 == 0 { update(&dabbed) } else { update(&focus) }));
    report(&format!("viewing, dab of {} samples", dab.len()), dab_seconds);
    let after_dab = splatter.picture().clone();

    let mut fresh = Splatter::new(splatter.salf().clone());
    fresh.set_tolerance(Tolerance::VIEWING);
    fresh.render(&camera, &dabbed, &Unwatched).expect("in range");
    check("a dab equals a render from scratch", fresh.picture() == &after_dab);
    check("the dab shows", after_dab != painted);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let one_thread: Picture = alone.install(|| {
        fresh.render(&camera, &focus, &Unwatched).expect("in range");
        fresh.picture().clone()
    });
    check(&format!("1 thread equals {threads}"), one_thread == painted);
}

/// PSNR in dB on values clipped to [0, 1].
fn psnr(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.radiance.iter().flatten().zip(b.radiance.iter().flatten());
    let square: f64 = pairs.map(|(a, b)| (a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).powi(2) as f64).sum();
    -10.0 * (square / (3 * a.radiance.len()) as f64).log10()
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// The samples nearest to a point of the fox.
fn dab_samples(splatter: &Splatter, width: f32, height: f32) -> Vec<u32> {
    let middle = glam::Vec2::new(0.32 * width, 0.78 * height);
    let samples = &splatter.salf().samples;
    let distance = |&index: &u32| samples[index as usize].center.distance_squared(middle);
    let mut indices: Vec<u32> =
        (0..samples.len() as u32).filter(|&i| samples[i as usize].surface.is_some()).collect();
    indices.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    indices.truncate(DAB);
    indices
}

/// The median time of copying `pixels` of three floats with all cores.
fn copy_seconds(pixels: usize) -> f64 {
    let (from, mut to) = (vec![[1.0f32; 3]; pixels], vec![[0.0f32; 3]; pixels]);
    median((0..21).map(|_| {
        let start = Instant::now();
        to.par_chunks_mut(1 << 16)
            .zip(from.par_chunks(1 << 16))
            .for_each(|(to, from)| to.copy_from_slice(from));
        std::hint::black_box(&to);
        start.elapsed().as_secs_f64()
    }))
}

fn median(seconds: impl Iterator<Item = f64>) -> f64 {
    let mut seconds: Vec<f64> = seconds.collect();
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

fn check(what: &str, holds: bool) {
    println!("{what}: {}", if holds { "yes" } else { "NO" });
    assert!(holds, "{what}");
}
