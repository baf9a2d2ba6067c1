//! The card against the processor: the same integers, the same picture.
//!
//! Skipped, loudly, where no adapter is found; `mesa-vulkan-drivers` has one in software, which `./test` installs.

use super::layout::Layout;
use crate::Tolerance;
use crate::canvas::{Accumulator, Word};
use crate::splatter::Splatter;
use glam::{DVec2, Vec2, Vec3};
use graphics_card::{BackendChoice, Gpu};
use lens::{Aperture, ApertureMask, ApertureShape, Camera, FocusOffset, Picture};
use progress::Unwatched;
use salf::{Salf, Sample, Visibility};
use std::sync::Arc;
use surface::{SurfaceField, SurfacePoint};

/// Pixels and totals of every level.
pub type Accumulated = Vec<(Vec<i64>, Vec<i64>)>;

/// What a card's buffer holds.
pub fn accumulated(words: &[u32], layout: &Layout, is_wide: bool) -> Accumulated {
    let wide = |pair: &[u32]| (pair[0] as u64 | (pair[1] as u64) << 32) as i64;
    let of_level = |level: &super::layout::Level| {
        let pixels = &words[level.pixels as usize..level.totals as usize];
        let pixels = if is_wide {
            pixels.chunks_exact(2).map(wide).collect()
        } else {
            pixels.iter().map(|&word| word as i32 as i64).collect()
        };
        let of_row = |slots: &[u32]| slots.chunks_exact(2).map(wide).fold(0i64, i64::wrapping_add);
        let totals = words[level.totals as usize..][..2 * super::layout::SLOTS * (level.height + 2)]
            .chunks_exact(2 * super::layout::SLOTS);
        (pixels, totals.map(of_row).collect())
    };
    layout.levels.iter().map(of_level).collect()
}

/// What an accumulator of the processor holds.
fn accumulated_here<W: Word>(accumulator: &Accumulator<W>) -> Accumulated {
    let of_level = |level: &crate::canvas::Level<W>| {
        let (pixels, totals) = level.all();
        (pixels.iter().flatten().map(|word| word.wide()).collect(), totals.to_vec())
    };
    accumulator.levels.iter().map(of_level).collect()
}

/// An adapter, or none with a word about it.
fn gpu() -> Option<Gpu> {
    match Gpu::open(BackendChoice::Gpu, None) {
        Ok(gpu) => gpu,
        Err(why) => {
            assert!(graphics_card::adapters().is_empty(), "there is an adapter, and: {why}");
            eprintln!("SKIPPED: {why}");
            None
        }
    }
}

/// Focus by the index of a sample's triangle.
struct ByTriangle(Vec<FocusOffset>);

impl SurfaceField<FocusOffset> for ByTriangle {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        self.0[point.triangle as usize]
    }
    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }
}

const WIDTH: u32 = 75;
const HEIGHT: u32 = 53;

/// A small scene: what makes it hard.
#[derive(Clone)]
struct Hard {
    name: &'static str,
    shape: ApertureShape,
    ratio: f64,
    /// Of the lens, as a share of the baked one.
    stop: f64,
    aperture_radius: f64,
    /// A wall's inverse depths from left to right.
    inverse_depths: [f32; 2],
    tilt: f32,
    brightest: f32,
    /// One sample in so many is partly occluded; 0: none.
    partial: u32,
    /// The side of a sample's cell, px.
    cell: u32,
    is_painted: bool,
    tolerance: Tolerance,
}

impl Hard {
    const PLAIN: Self = Self {
        name: "plain",
        shape: ApertureShape::Disc,
        ratio: 1.0,
        stop: 1.0,
        aperture_radius: 0.05,
        inverse_depths: [0.2, 1.2],
        tilt: 0.0,
        brightest: 1.0,
        partial: 0,
        cell: 1,
        is_painted: false,
        tolerance: Tolerance::VIEWING,
    };

    fn all() -> Vec<Self> {
        let plain = Self::PLAIN;
        let polygon = ApertureShape::Polygon { blades: 5, rotation: 0.3, roundness: 0.2 };
        let mask = |side: u32, is_open: fn(u32) -> bool| {
            let transmission = (0..side * side).map(|k| f32::from(is_open(k))).collect();
            let mask = ApertureMask { width: side, height: side, transmission, file: String::new() };
            ApertureShape::Mask(Arc::new(mask))
        };
        vec![
            plain.clone(),
            Self { name: "exact", tolerance: Tolerance::NONE, ..plain.clone() },
            Self { name: "partly occluded, alone", aperture_radius: 0.4, partial: 2, ..plain.clone() },
            Self { name: "partly occluded, exact", partial: 2, tolerance: Tolerance::NONE, ..plain.clone() },
            Self { name: "painted", partial: 3, is_painted: true, ..plain.clone() },
            Self {
                name: "highlights and fireflies",
                aperture_radius: 0.4,
                brightest: 1e5,
                partial: 3,
                is_painted: true,
                ..plain.clone()
            },
            Self { name: "anamorphic", shape: polygon.clone(), ratio: 0.5, partial: 2, ..plain.clone() },
            Self { name: "stopped down", shape: polygon, stop: 0.4, partial: 2, tilt: 0.2, ..plain.clone() },
            Self { name: "letter", shape: mask(8, |k| k % 8 < 3 || k < 16), partial: 3, ..plain.clone() },
            Self { name: "one texel", shape: mask(16, |k| k == 40), partial: 3, ..plain.clone() },
            Self {
                name: "large circles",
                aperture_radius: 2.0,
                partial: 3,
                tilt: 0.3,
                tolerance: Tolerance::NONE,
                ..plain.clone()
            },
            Self {
                name: "large cells, some in focus",
                cell: 4,
                partial: 3,
                is_painted: true,
                ..plain.clone()
            },
            Self { name: "edge on", tilt: 1.5, partial: 4, inverse_depths: [0.45, 0.55], ..plain },
        ]
    }

    fn camera(&self) -> Camera {
        let aperture = Aperture { shape: self.shape.clone(), ratio: self.ratio };
        let aperture_radius = self.aperture_radius;
        Camera {
            width: WIDTH,
            height: HEIGHT,
            focus_distance: 2.0,
            aperture_radius,
            aperture,
            ..Camera::default()
        }
    }

    fn lens(&self) -> Camera {
        let camera = self.camera();
        Camera { aperture_radius: self.stop * camera.aperture_radius, ..camera }
    }

    fn light_field(&self) -> Arc<Salf> {
        let [near, far] = self.inverse_depths;
        let sample = |index: u32| {
            let (x, y) = (index % WIDTH, index / WIDTH);
            let mixed = index.wrapping_mul(2654435761) >> 8;
            let is_partial = self.partial > 0 && (x / 7 + y / 5) % self.partial == 0;
            let visibility = match (is_partial, mixed % 2) {
                (false, _) => Visibility::Open,
                (true, 0) => Visibility::Cells { words: Box::new([u64::MAX << (mixed % 60)]) },
                (true, _) => Visibility::Cells {
                    words: Box::new([1, 2, 3, 4].map(|k| u64::MAX / (k + mixed as u64 % 99))),
                },
            };
            let bright = if mixed % 600 == 1 { self.brightest } else { 1.0 };
            Sample {
                center: self.cell as f32 * Vec2::new(x as f32 + 0.5, y as f32 + 0.5),
                half_size: Vec2::splat(0.5 * self.cell as f32),
                inverse_depth: near + (far - near) * x as f32 * self.cell as f32 / WIDTH as f32,
                weight: 1.0,
                tilt: Vec2::new(self.tilt, (mixed % 5) as f32 * -0.1 * self.tilt),
                radiance: bright * Vec3::new(1e-3, 0.5, (mixed % 9) as f32),
                surface: Some(SurfacePoint { triangle: index, barycentric: DVec2::ZERO }),
                is_carried: mixed % 3 == 1,
                visibility,
            }
        };
        let is_within = |index: &u32| index % WIDTH * self.cell < WIDTH && index / WIDTH * self.cell < HEIGHT;
        let samples = (0..WIDTH * HEIGHT).filter(is_within).map(sample).collect();
        Arc::new(Salf::with_samples(self.camera(), samples))
    }

    fn focus(&self) -> ByTriangle {
        let offset = |k: u32| match (self.is_painted, k % WIDTH) {
            (true, 20..40) => FocusOffset::new(0.97, 0.5).with_gloss(0.4),
            (true, 55..58) => FocusOffset::new(1.04, 1.0),
            (true, 58..62) => FocusOffset::new(1.04, 1.0).with_gloss(1.0),
            _ => FocusOffset::STANDARD,
        };
        ByTriangle((0..WIDTH * HEIGHT).map(offset).collect())
    }

    fn rendered(&self, salf: Arc<Salf>, focus: &ByTriangle, gpu: Option<Gpu>) -> Splatter {
        let mut splatter = Splatter::new(salf);
        splatter.set_tolerance(self.tolerance);
        splatter.use_gpu(gpu);
        splatter.render(&self.lens(), focus, &Unwatched).unwrap();
        splatter
    }
}

/// The first word in which two sums differ.
fn first_difference(a: &[Accumulated], b: &[Accumulated]) -> Option<String> {
    for (kind, (a, b)) in a.iter().zip(b).enumerate() {
        for (level, ((pixels, totals), (other, other_totals))) in a.iter().zip(b).enumerate() {
            if let Some(at) = (0..pixels.len().max(other.len())).find(|&k| pixels.get(k) != other.get(k)) {
                let apart = pixels.iter().zip(other).filter(|(a, b)| a != b).count();
                let (a, b) = (pixels.get(at), other.get(at));
                return Some(format!("kind {kind}, level {level}, word {at}: {a:?} {b:?}, {apart} in all"));
            }
            if let Some(row) = (0..totals.len()).find(|&k| totals[k] != other_totals[k]) {
                let (a, b) = (totals[row], other_totals[row]);
                return Some(format!("kind {kind}, level {level}, total of row {row}: {a} {b}"));
            }
        }
    }
    (a.len() != b.len()).then(|| "numbers of sums".to_owned())
}

/// Free and sharing sums on the processor, ordinary ones first.
fn sums_here(splatter: &Splatter) -> Vec<Accumulated> {
    let sums = splatter.sums();
    let dim = [&sums.free, &sums.sharing].map(|sum| accumulated_here(&sum.dim));
    let bright = [&sums.free, &sums.sharing].map(|sum| sum.bright.as_ref().map(accumulated_here));
    dim.into_iter().chain(bright.into_iter().flatten()).collect()
}

/// The same on the card.
fn sums_there(splatter: &Splatter, has_bright: bool) -> Vec<Accumulated> {
    let sums = splatter.sums_on_card().expect("summed on the card");
    let mut all = sums.accumulated(0).unwrap().to_vec();
    if has_bright {
        all.extend(sums.accumulated(1).unwrap());
    }
    all
}

fn differing(a: &Picture, b: &Picture) -> usize {
    let radiance =
        a.radiance.iter().zip(&b.radiance).filter(|(a, b)| a.map(f32::to_bits) != b.map(f32::to_bits));
    let coverage = a.coverage.iter().zip(&b.coverage).filter(|(a, b)| a.to_bits() != b.to_bits());
    radiance.count() + coverage.count()
}

#[test]
fn card_and_processor_sum_the_same_bits() {
    let Some(gpu) = gpu() else { return };
    let mut wrong = Vec::new();
    for hard in Hard::all() {
        let (salf, focus) = (hard.light_field(), hard.focus());
        let here = hard.rendered(salf.clone(), &focus, None);
        let there = hard.rendered(salf.clone(), &focus, Some(gpu.clone()));
        assert!(there.gpu().is_some(), "{}: the card was lost", hard.name);
        let sums = sums_here(&here);
        let others = sums_there(&there, sums.len() == 4);
        assert!(sums[0].iter().any(|(pixels, _)| pixels.iter().any(|&word| word != 0)), "{}", hard.name);
        if let Some(difference) = first_difference(&sums, &others) {
            wrong.push(format!("{}: {difference}", hard.name));
        }
        let pixels = differing(here.picture(), there.picture());
        if pixels > 0 {
            wrong.push(format!("{}: {pixels} pixels differ", hard.name));
        }
        // The control: one sample whose light is some quanta more; those of bright sums are 64 times as large.
        let mut samples = salf.samples.to_vec();
        let quanta = if sums.len() == 4 { 2048.0 } else { 32.0 };
        let one = samples.len() / 4;
        samples[one].radiance.y += crate::QUANTUM as f32 * quanta;
        let other = Salf { samples: samples.into(), ..(*salf).clone() };
        let other = hard.rendered(Arc::new(other), &focus, None);
        assert!(first_difference(&sums_here(&other), &others).is_some(), "{}: the control", hard.name);
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn strokes_on_the_card_equal_renders_from_scratch() {
    let Some(gpu) = gpu() else { return };
    let hard = Hard { brightest: 1e5, partial: 3, ..Hard::PLAIN };
    let (salf, mut focus) = (hard.light_field(), hard.focus());
    let mut here = hard.rendered(salf.clone(), &focus, None);
    let mut there = hard.rendered(salf.clone(), &focus, Some(gpu.clone()));
    for round in 0..6u32 {
        let changed: Vec<u32> = (0..200).map(|k| (round * 977 + k * 13) % (WIDTH * HEIGHT)).collect();
        for &index in &changed {
            focus.0[index as usize] =
                FocusOffset::new(0.95 + 0.02 * round as f64, 0.5).with_gloss((round % 3) as f64 / 2.0);
        }
        let window = here.update(&focus, &changed).unwrap();
        assert_eq!(there.update(&focus, &changed).unwrap(), window);
        assert_eq!(differing(here.picture(), there.picture()), 0, "round {round}");
    }
    let fresh = hard.rendered(salf, &focus, Some(gpu));
    assert_eq!(first_difference(&sums_there(&fresh, true), &sums_there(&there, true)), None);
    assert_eq!(differing(fresh.picture(), there.picture()), 0);
}

#[test]
fn no_feature_is_needed() {
    let Some(gpu) = gpu() else { return };
    let plain = Gpu::with_features(gpu.name(), wgpu::Features::empty()).expect("it opened before");
    let features = gpu.device().features();
    eprintln!("{}: compared with none of {features:?}", gpu.name());
    assert!(!plain.device().features().intersects(Gpu::features(wgpu::Features::all())));
    let hard = Hard { partial: 3, is_painted: true, ..Hard::PLAIN };
    let (salf, focus) = (hard.light_field(), hard.focus());
    let [some, none] = [gpu, plain].map(|gpu| hard.rendered(salf.clone(), &focus, Some(gpu)));
    assert!(some.gpu().is_some() && none.gpu().is_some() && none.seconds_on_card().is_none());
    assert_eq!(differing(some.picture(), none.picture()), 0);
}

#[test]
fn what_stays_on_the_card_is_fetched() {
    let Some(gpu) = gpu() else { return };
    let hard = Hard { partial: 3, ..Hard::PLAIN };
    let (salf, mut focus) = (hard.light_field(), hard.focus());
    let mut here = hard.rendered(salf.clone(), &focus, None);
    let mut there = Splatter::new(salf.clone());
    there.set_tolerance(hard.tolerance);
    there.use_gpu(Some(gpu.clone()));
    there.keep_on_card(true);
    there.render(&hard.lens(), &focus, &Unwatched).unwrap();
    assert_eq!(there.picture(), &Picture::black(WIDTH, HEIGHT), "nobody asked for it");
    assert!(there.picture_on_card().is_some() && here.picture_on_card().is_none());
    let clock = gpu.device().features().contains(wgpu::Features::TIMESTAMP_QUERY);
    assert_eq!(
        there.seconds_on_card().map(|seconds| seconds > 0.0 && seconds < 600.0),
        clock.then_some(true)
    );
    there.fetch_picture().unwrap();
    assert_eq!(differing(here.picture(), there.picture()), 0);
    for round in 0..3u32 {
        let changed: Vec<u32> = (0..100).map(|k| (round * 977 + k * 13) % (WIDTH * HEIGHT)).collect();
        for &index in &changed {
            focus.0[index as usize] =
                FocusOffset::new(0.95 + 0.02 * round as f64, 0.5).with_gloss((round % 3) as f64 / 2.0);
        }
        here.update(&focus, &changed).unwrap();
        there.update(&focus, &changed).unwrap();
        assert!(differing(here.picture(), there.picture()) > 0, "round {round}: it is the one of before");
        if round == 2 {
            // Lost before anybody has seen it.
            gpu.destroy();
        }
        there.fetch_picture().unwrap();
        assert_eq!(differing(here.picture(), there.picture()), 0, "round {round}");
    }
    assert!(there.gpu().is_none(), "the processor has taken over");
}

#[test]
fn a_lost_card_loses_nothing() {
    if gpu().is_none() {
        return;
    }
    let hard = Hard { partial: 3, ..Hard::PLAIN };
    let (salf, mut focus) = (hard.light_field(), hard.focus());
    let mut here = hard.rendered(salf.clone(), &focus, None);
    let mut there = hard.rendered(salf, &focus, None);
    for round in 0..20u32 {
        let card = gpu().expect("an adapter as before");
        there.use_gpu(Some(card.clone()));
        there.refocus(&hard.lens(), &Unwatched).unwrap();
        assert!(there.gpu().is_some(), "round {round}: it is summed on the card");
        let changed: Vec<u32> = (0..100).map(|k| (round * 331 + k * 7) % (WIDTH * HEIGHT)).collect();
        for &index in &changed {
            focus.0[index as usize] = FocusOffset::new(1.0 + 0.01 * (1 + round) as f64, 0.3);
        }
        here.update(&focus, &changed).unwrap();
        // In the middle of a stroke, or between two pictures.
        card.destroy();
        if round % 2 == 0 {
            there.update(&focus, &changed).unwrap();
        } else {
            there.render(&hard.lens(), &focus, &Unwatched).unwrap();
        }
        assert!(there.gpu().is_none(), "round {round}: the processor has taken over");
        assert_eq!(differing(here.picture(), there.picture()), 0, "round {round}");
    }
}

#[test]
fn cards_are_opened_by_choice_and_by_name() {
    assert!(Gpu::open(BackendChoice::Auto, Some("no adapter has this name")).is_err());
    assert!(matches!(Gpu::open(BackendChoice::Cpu, None), Ok(None)));
    let Some(gpu) = gpu() else { return };
    // Another device of the same adapter is a card of its own.
    let other = Gpu::open(BackendChoice::Gpu, Some(gpu.name())).unwrap().expect("requested by name");
    other.destroy();
    assert!(!gpu.is_lost());
}
