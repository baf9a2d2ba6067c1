//! The promises of the sums: order, threads and paint leave no trace.

mod character;
mod draft;
mod mattes;

use super::*;
use crate::lens_in_use::NodeFocus;
use glam::{DVec2, Vec2, Vec3};
use progress::Unwatched;
use salf::{Sample, Visibility};
use surface::SurfacePoint;

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

fn camera() -> Camera {
    Camera { width: 96, height: 80, focus_distance: 2.0, aperture_radius: 0.05, ..Camera::default() }
}

/// A pixel grid of samples at mixed depths, every third partly occluded, every fifth of carried light, one very bright.
fn light_field() -> Arc<Salf> {
    let camera = camera();
    let sample = |index: u32| {
        let (x, y) = (index % camera.width, index / camera.width);
        let mixed = index.wrapping_mul(2654435761) >> 8;
        let visibility = match index % 3 {
            0 => Visibility::Cells { words: Box::new([0x0123_4567_89AB_CDEF ^ mixed as u64]) },
            _ => Visibility::Open,
        };
        Sample {
            center: Vec2::new(x as f32 + 0.5, y as f32 + 0.5),
            half_size: Vec2::splat(0.5),
            inverse_depth: 0.2 + (mixed % 100) as f32 * 0.01,
            weight: 1.0,
            tilt: Vec2::new((mixed % 7) as f32 * 0.03, (mixed % 5) as f32 * -0.04),
            radiance: if index == 1234 { Vec3::splat(1e6) } else { Vec3::new(1e-3, 0.5, (mixed % 9) as f32) },
            surface: Some(SurfacePoint { triangle: index, barycentric: DVec2::ZERO }),
            is_carried: index % 5 == 1,
            visibility,
        }
    };
    let samples = (0..camera.width * camera.height).map(sample).collect();
    Arc::new(Salf::with_samples(camera, samples))
}

fn standard() -> ByTriangle {
    ByTriangle(vec![FocusOffset::STANDARD; 96 * 80])
}

fn rendered(focus: &ByTriangle) -> Splatter {
    let mut splatter = Splatter::new(light_field());
    splatter.render(&camera(), focus, &Unwatched).unwrap();
    splatter
}

#[test]
fn an_update_equals_a_render_bit_for_bit() {
    let mut focus = standard();
    let mut splatter = rendered(&focus);
    for round in 0..20u32 {
        let changed: Vec<u32> = (0..300).map(|k| (round * 977 + k * 13) % (96 * 80)).collect();
        for &index in &changed {
            let t = 0.9 + (index % 21) as f64 * 0.01 * round as f64;
            let (anchor, gloss) = ((round % 3) as f64 / 2.0, (round % 4) as f64 / 3.0);
            let painted = FocusOffset::new(t, anchor).with_gloss(gloss);
            focus.0[index as usize] = if round % 7 == 6 { FocusOffset::STANDARD } else { painted };
        }
        splatter.update(&focus, &changed).unwrap();
    }
    let fresh = rendered(&focus);
    assert!(splatter.sums == fresh.sums, "the accumulators");
    assert_eq!(splatter.picture(), fresh.picture());
    assert_ne!(splatter.picture(), rendered(&standard()).picture(), "the paint shows");
}

#[test]
fn carried_light_obeys_the_paint_as_far_as_gloss_does() {
    let is_carried = |carried: bool| {
        let salf = Salf::clone(&light_field());
        Arc::new(Salf { samples: salf.samples.changed(|sample| sample.is_carried = carried), ..salf })
    };
    let picture = |salf: &Arc<Salf>, focus: FocusOffset| {
        let mut splatter = Splatter::new(salf.clone());
        splatter.render(&camera(), &ByTriangle(vec![focus; 96 * 80]), &Unwatched).unwrap();
        splatter.picture().clone()
    };
    let (own, carried) = (is_carried(false), is_carried(true));
    let painted = FocusOffset::new(0.93, 0.6);
    assert_eq!(picture(&carried, painted), picture(&own, FocusOffset::STANDARD));
    assert_eq!(picture(&carried, painted.with_gloss(1.0)), picture(&own, painted));
    let half = painted.with_gloss(0.5);
    assert_eq!(picture(&carried, half), picture(&own, FocusOffset::new(0.965, 0.3)));
    assert_eq!(picture(&own, half), picture(&own, painted), "what is own does not look at it");
    assert_ne!(picture(&own, painted), picture(&own, FocusOffset::STANDARD));
}

#[test]
fn what_is_painted_at_first_and_then_no_more_leaves_no_trace() {
    let mut focus = standard();
    let painted: Vec<u32> = (500..900).collect();
    painted.iter().for_each(|&index| focus.0[index as usize] = FocusOffset::new(0.5, 0.0));
    let mut splatter = rendered(&focus);
    splatter.update(&standard(), &painted).unwrap();
    // Evened again, with gains that a painted picture does without.
    assert_eq!(splatter.picture(), rendered(&standard()).picture());
}

#[test]
fn the_first_dab_on_a_live_picture_changes_what_it_moves_and_nothing_else() {
    let live = || {
        let mut splatter = Splatter::new(light_field());
        splatter.set_live(true);
        splatter
    };
    let mut focus = standard();
    let mut splatter = live();
    splatter.render(&camera(), &focus, &Unwatched).unwrap();
    let (blank, even) = (splatter.picture().clone(), rendered(&focus));
    assert_ne!(blank, *even.picture());
    let exposed = |picture: &Picture| picture.exposed(lens::Exposure::Normalise);
    for (uneven, even) in exposed(&blank).iter().zip(&exposed(even.picture())) {
        assert!((0..3).all(|c| (uneven[c] - even[c]).abs() <= 0.12 * even[c].abs()), "{uneven:?} {even:?}");
    }

    let dab: Vec<u32> =
        (0..5).flat_map(|row| (0..5).map(move |column| (40 + row) * 96 + 40 + column)).collect();
    dab.iter().for_each(|&index| focus.0[index as usize] = FocusOffset::new(1.01, 0.5));
    let [rows, columns] = splatter.update(&focus, &dab).unwrap();
    assert!(rows.len() < 40 && columns.len() < 40, "{rows:?} {columns:?}");
    for (at, (now, before)) in (0u32..).zip(splatter.picture().radiance.iter().zip(&blank.radiance)) {
        let is_inside = rows.contains(&(at / 96)) && columns.contains(&(at % 96));
        assert!(now == before || is_inside, "row {}, column {}", at / 96, at % 96);
    }
    let mut fresh = live();
    fresh.render(&camera(), &focus, &Unwatched).unwrap();
    assert_eq!(splatter.picture(), fresh.picture());
    splatter.update(&standard(), &dab).unwrap();
    assert_eq!(*splatter.picture(), blank, "undone");
}

#[test]
fn a_twin_shares_the_hierarchy_and_nothing_else() {
    let mut focus = standard();
    focus.0.iter_mut().step_by(5).for_each(|offset| *offset = FocusOffset::new(1.2, 0.7));
    let mut first = Splatter::new(light_field());
    first.set_tolerance(Tolerance::VIEWING);
    first.render(&camera(), &focus, &Unwatched).unwrap();
    let viewed = first.picture().clone();
    let mut twin = first.twin();
    twin.render(&camera(), &focus, &Unwatched).unwrap();
    assert!(Arc::ptr_eq(first.nodes.as_ref().unwrap(), twin.nodes.as_ref().unwrap()));
    assert_eq!(twin.picture(), rendered(&focus).picture(), "exact, as a new one");
    assert_eq!(*first.picture(), viewed);
}

#[test]
fn what_is_prepared_changes_no_picture() {
    let mut focus = standard();
    focus
        .0
        .iter_mut()
        .enumerate()
        .for_each(|(k, offset)| *offset = FocusOffset::new(1.0 + k as f64 * 1e-5, 0.3));
    let splatter = Splatter::new(light_field());
    splatter.prepare()(&Unwatched);
    let mut prepared = splatter.twin();
    prepared.render(&camera(), &focus, &Unwatched).unwrap();
    assert_eq!(prepared.picture(), rendered(&focus).picture());
}

/// Says how often it was asked, and stops when it has been often enough.
struct Patience(std::sync::atomic::AtomicU32);

impl Progress for Patience {
    fn report(&self, _: f32) {}
    fn cancelled(&self) -> bool {
        self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= 3
    }
}

#[test]
fn a_sum_is_given_up_within_a_band_and_can_be_made_again() {
    let mut splatter = Splatter::new(light_field());
    let patience = Patience(0.into());
    assert_eq!(splatter.render(&camera(), &standard(), &patience), Err(SplatError::Cancelled));
    splatter.render(&camera(), &standard(), &Unwatched).unwrap();
    assert_eq!(splatter.picture(), rendered(&standard()).picture());
}

#[test]
fn ten_thousand_dabs_and_undos_leave_no_trace() {
    let (mut focus, mut random) = (standard(), 1u32);
    let mut next = |below: u32| {
        random = random.wrapping_mul(1664525).wrapping_add(1013904223);
        (random >> 8) % below
    };
    let live = || {
        let mut splatter = Splatter::new(light_field());
        splatter.set_tolerance(Tolerance::VIEWING);
        splatter.set_live(true);
        splatter
    };
    let mut splatter = live();
    splatter.render(&camera(), &focus, &Unwatched).unwrap();
    let mut done: Vec<Vec<(u32, FocusOffset)>> = Vec::new();
    for _ in 0..10_000 {
        let undone = if next(3) == 0 { done.pop() } else { None };
        let changes = undone.unwrap_or_else(|| {
            let offset = FocusOffset::new(0.9 + f64::from(next(21)) * 0.01, f64::from(next(3)) / 2.0)
                .with_gloss(f64::from(next(3)) / 2.0);
            let corner = next(96 * 80);
            let square = (0..25).map(|k| (corner + k % 5 + k / 5 * 96) % (96 * 80));
            let dab: Vec<_> = square.map(|index| (index, offset)).collect();
            done.push(dab.iter().map(|&(index, _)| (index, focus.0[index as usize])).collect());
            dab
        });
        changes.iter().for_each(|&(index, offset)| focus.0[index as usize] = offset);
        let changed: Vec<u32> = changes.iter().map(|&(index, _)| index).collect();
        splatter.update(&focus, &changed).unwrap();
    }
    let mut fresh = live();
    fresh.render(&camera(), &focus, &Unwatched).unwrap();
    assert!(splatter.sums == fresh.sums, "the accumulators");
    assert_eq!(splatter.picture(), fresh.picture());
}

#[test]
fn threads_leave_no_trace() {
    let mut focus = standard();
    focus.0.iter_mut().step_by(5).for_each(|offset| *offset = FocusOffset::new(1.2, 0.7));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| rendered(&focus).picture().clone())
    };
    assert_eq!(with(1), with(3));
}

/// The light field with another radiance of one sample.
fn with_radiance(index: usize, radiance: f32) -> Arc<Salf> {
    let salf = light_field();
    let mut samples = salf.samples.to_vec();
    samples[index].radiance = Vec3::splat(radiance);
    Arc::new(Salf { samples: samples.into(), ..(*salf).clone() })
}

#[test]
fn a_firefly_changes_no_other_pixel() {
    let sharp = ByTriangle(vec![FocusOffset::SHARP; 96 * 80]);
    let with_firefly = rendered(&sharp);
    let mut without = Splatter::new(with_radiance(1234, 0.5));
    without.render(&camera(), &sharp, &Unwatched).unwrap();
    let pixels = with_firefly.picture().radiance.iter().zip(&without.picture().radiance);
    let changed: Vec<usize> = pixels.enumerate().filter(|(_, (a, b))| a != b).map(|(k, _)| k).collect();
    assert_eq!(changed, [1234]);
}

#[test]
fn too_bright_is_an_error() {
    let result = Splatter::new(with_radiance(0, 1e8)).render(&camera(), &standard(), &Unwatched);
    assert_eq!(result, Err(SplatError::Overflow));
}

/// The standard picture of a slanted wall is uniform, wherever its blur goes through 0.
#[test]
fn a_slanted_wall_is_covered_evenly() {
    for (slope, limit) in [(0.0, 1e-5), (0.01, 0.005), (0.04, 0.01), (0.1, 0.015), (0.3, 0.04)] {
        for across in [false, true] {
            let found = ripple_of_wall(slope, slope, across);
            assert!(found < limit, "slope {slope}, {across}: {found}");
        }
    }
    assert!(ripple_of_wall(0.3, 0.0, false) > 0.02, "weights that ignore the slope");
}

/// The largest difference of the coverage from 1 in the middle of a wall whose splat radius changes by `slope` px a px.
fn ripple_of_wall(slope: f64, tilt: f64, across: bool) -> f64 {
    const SIDE: u32 = 120;
    const MARGIN: i32 = 48;
    let camera =
        Camera { width: SIDE, height: SIDE, focus_distance: 2.0, aperture_radius: 0.1, ..Camera::default() };
    let per_kappa = camera.optics().splat_radius_px(1.0);
    let mut samples = Vec::new();
    for y in -MARGIN..SIDE as i32 + MARGIN {
        for x in -MARGIN..SIDE as i32 + MARGIN {
            let center = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let along = if across { center.y } else { center.x };
            let radius = slope * (along - 51.3);
            let tilt = if across { Vec2::new(0.0, -tilt as f32) } else { Vec2::new(tilt as f32, 0.0) };
            samples.push(Sample {
                center: center.as_vec2(),
                half_size: Vec2::splat(0.5),
                inverse_depth: (0.5 - radius / per_kappa) as f32,
                weight: 1.0,
                tilt,
                radiance: Vec3::ONE,
                surface: None,
                is_carried: false,
                visibility: Visibility::Open,
            });
        }
    }
    let mut splatter =
        Splatter::new(Arc::new(Salf { margin_px: 48, ..Salf::with_samples(camera.clone(), samples.into()) }));
    splatter.render(&camera, &standard(), &Unwatched).unwrap();
    let coverage = &splatter.picture().coverage;
    let inside = |k: &usize| [k % 120, k / 120].iter().all(|c| (20..100).contains(c));
    (0..coverage.len()).filter(inside).map(|k| (coverage[k] as f64 - 1.0).abs()).fold(0.0, f64::max)
}

/// Samples that see one cell of the aperture each, painted to any blur: no picture row need meet that row of cells, but the
/// light is that of a 256th of the aperture.
#[test]
fn what_sees_one_cell_loses_no_light() {
    use lens::{Aperture, ApertureShape};
    let square = Aperture { shape: ApertureShape::Square, ..Aperture::default() };
    let camera = Camera { aperture: square, ..camera() };
    let sample = |index: u32| {
        let mut words = [0u64; 4];
        words[index as usize % 4] = 1 << (index * 29 % 64);
        Sample {
            center: Vec2::new(30.5 + (index % 36) as f32, 25.5 + (index / 36) as f32),
            half_size: Vec2::splat(0.5),
            inverse_depth: 0.5,
            weight: 1.0,
            tilt: Vec2::ZERO,
            radiance: Vec3::ONE,
            surface: Some(SurfacePoint { triangle: index, barycentric: DVec2::ZERO }),
            is_carried: false,
            visibility: Visibility::Cells { words: words.into() },
        }
    };
    let samples: Vec<_> = (0..36 * 30).map(sample).collect();
    let sent = samples.len() as f64 / 256.0;
    let mut splatter = Splatter::new(Arc::new(Salf::with_samples(camera.clone(), samples.into())));
    for tolerance in [Tolerance::NONE, Tolerance::VIEWING] {
        splatter.set_tolerance(tolerance);
        for radius_px in [0.3, 1.0, 1.7, 2.5, 4.0, 7.0, 15.0] {
            // With the anchor 1, κ is (t − 1)/d.
            let optics = camera.optics();
            let t = 1.0 + radius_px / optics.splat_radius_px(1.0) * optics.image_distance;
            let focus = ByTriangle(vec![FocusOffset::new(t, 1.0); 36 * 30]);
            splatter.render(&camera, &focus, &Unwatched).unwrap();
            let coverage = splatter.picture().coverage.iter();
            let found: f64 = coverage.map(|&covered| f64::from(covered)).sum();
            assert!((found / sent - 1.0).abs() < 1e-4, "{tolerance:?}, {radius_px} px: {found} of {sent}");
        }
    }
}

/// Samples at depths and of masks so mixed that none are joined, far out of focus.
#[test]
fn what_stands_alone_is_drawn_coarsely_and_keeps_its_light() {
    let wide = Camera { aperture_radius: 0.6, ..camera() };
    let salf = light_field();
    let dim = |samples: Vec<Sample>| -> Vec<Sample> {
        let dimmed = |sample: Sample| Sample { radiance: sample.radiance.min(Vec3::ONE), ..sample };
        samples.into_iter().map(dimmed).collect()
    };
    let samples = dim(salf.samples.to_vec()).into();
    let mut splatter = Splatter::new(Arc::new(Salf { camera: wide.clone(), samples, ..(*salf).clone() }));
    splatter.render(&wide, &standard(), &Unwatched).unwrap();
    let exact = splatter.picture().clone();
    let is_drawn_on = |splatter: &Splatter, level: usize| {
        let level = &splatter.sums.free.dim.levels[level];
        (0..level.height as i32).any(|row| level.row(row).is_some())
    };
    assert!(is_drawn_on(&splatter, 0) && !is_drawn_on(&splatter, 1));
    splatter.set_tolerance(Tolerance::VIEWING);
    splatter.render(&wide, &standard(), &Unwatched).unwrap();
    assert!(is_drawn_on(&splatter, 2), "circles of {} px", wide.optics().splat_radius_px(1.0));
    let sum = |picture: &Picture| picture.radiance.iter().flatten().map(|&x| f64::from(x)).sum::<f64>();
    let (wanted, found) = (sum(&exact), sum(splatter.picture()));
    assert!((found / wanted - 1.0).abs() < 4e-3, "{found} of {wanted}");
    // Beside the frame's edge few samples make a pixel.
    let inner = |picture: &Picture| {
        let exposed = picture.exposed(lens::Exposure::Normalise);
        let rows = (16..64).flat_map(|row| (16..80).map(move |column| row * 96 + column));
        rows.flat_map(|at| exposed[at]).collect::<Vec<f32>>()
    };
    let (found, wanted) = (inner(splatter.picture()), inner(&exact));
    let square: f32 = found.iter().zip(&wanted).map(|(a, b)| (a - b).powi(2)).sum();
    let rms = (square / found.len() as f32).sqrt();
    assert!(rms < 0.01, "{rms}");
}

#[test]
fn a_bright_sample_of_a_large_cell_sends_all_its_light() {
    let cell = |radiance: f32| Sample {
        center: Vec2::new(50.0, 42.0),
        half_size: Vec2::splat(2.0),
        inverse_depth: 0.5,
        weight: 16.0,
        tilt: Vec2::ZERO,
        radiance: Vec3::splat(radiance),
        surface: Some(SurfacePoint { triangle: 0, barycentric: DVec2::ZERO }),
        is_carried: false,
        visibility: Visibility::Open,
    };
    for radiance in [3.0, 12.0, 300.0] {
        let salf = Salf::with_samples(camera(), vec![cell(radiance)].into());
        let mut splatter = Splatter::new(Arc::new(salf));
        splatter.render(&camera(), &standard(), &Unwatched).unwrap();
        let sum: f32 = splatter.picture().radiance.iter().map(|pixel| pixel[0]).sum();
        assert!((sum / (16.0 * radiance) - 1.0).abs() < 1e-4, "{radiance}: {sum}");
    }
}

/// Frames whose border is the first column behind a mark, too.
#[test]
fn pictures_of_any_width_are_summed() {
    for width in [126, 127, 128, 129, 255] {
        let camera = Camera { width, height: 20, aperture_radius: 0.3, ..camera() };
        let sample = |index: u32| Sample {
            center: Vec2::new((index % width) as f32 + 0.5, (index / width) as f32 + 0.5),
            half_size: Vec2::splat(0.5),
            inverse_depth: 0.8,
            weight: 1.0,
            tilt: Vec2::ZERO,
            radiance: Vec3::ONE,
            surface: Some(SurfacePoint { triangle: index, barycentric: DVec2::ZERO }),
            is_carried: false,
            visibility: Visibility::Open,
        };
        let samples = (0..width * 20).map(sample).collect();
        let mut splatter = Splatter::new(Arc::new(Salf::with_samples(camera.clone(), samples)));
        let mut focus = ByTriangle(vec![FocusOffset::STANDARD; (width * 20) as usize]);
        splatter.render(&camera, &focus, &Unwatched).unwrap();
        assert_eq!(splatter.nodes.as_ref().unwrap().scale, Scale::FINEST, "{width}: nothing overflows");
        let dab: Vec<u32> = (0..12).flat_map(|row| (row * width + width - 9)..(row + 1) * width).collect();
        dab.iter().for_each(|&index| focus.0[index as usize] = FocusOffset::SHARP);
        splatter.update(&focus, &dab).unwrap();
        assert_eq!(splatter.nodes.as_ref().unwrap().scale, Scale::FINEST, "{width}: nothing overflows");
        let painted = splatter.picture().clone();
        splatter.render(&camera, &focus, &Unwatched).unwrap();
        assert_eq!(painted, *splatter.picture(), "{width}");
    }
}

/// Else a band would lack what the one beside it sends.
#[test]
fn light_stays_within_reach() {
    let camera =
        Camera { width: 256, height: 192, focus_distance: 2.0, aperture_radius: 0.3, ..Camera::default() };
    let mut hash = 7u32;
    let mut random = move || {
        hash = (hash ^ hash >> 15).wrapping_mul(0x2C1B_3C6D).wrapping_add(0x9E37_79B9);
        (hash >> 8) as f32 / (1 << 24) as f32
    };
    let mut levels = [0; salf::tree::LEVELS];
    for trial in 0..1800 {
        // Cells of the margin are large: some are drawn in pieces.
        let (center, half) = match trial % 3 {
            0 => (Vec2::new(-30.0 * random(), 20.0 + 150.0 * random()), 4.0),
            _ => (Vec2::new(60.0 + 136.0 * random(), 60.0 + 72.0 * random()), 0.5),
        };
        let seen = (random() * u32::MAX as f32) as u64;
        let visibility = match trial % 2 {
            0 => Visibility::Open,
            _ => Visibility::Cells { words: Box::new([seen << 32 | seen >> 7]) },
        };
        // The light of what is edge-on leans far.
        let [weight, steep] = if trial % 4 < 2 { [1.0, 1.0] } else { [0.2 * random(), 2.0] };
        let sample = Sample {
            center,
            half_size: half * Vec2::new(0.5 + 2.0 * random(), 0.5 + random()),
            inverse_depth: 0.5 + (random() - 0.5) * 0.6 * random(),
            weight,
            tilt: steep * Vec2::new(random() - 0.5, random() - 0.5),
            radiance: Vec3::ONE,
            surface: Some(SurfacePoint { triangle: 0, barycentric: DVec2::ZERO }),
            is_carried: false,
            visibility,
        };
        let samples = vec![sample].into();
        let mut splatter =
            Splatter::new(Arc::new(Salf { margin_px: 64, ..Salf::with_samples(camera.clone(), samples) }));
        splatter.set_live(true);
        splatter.set_tolerance([Tolerance::NONE, Tolerance::px(2.0), Tolerance::px(10.0)][trial / 6 % 3]);
        let t = if trial % 5 == 0 { 1.0 + 0.05 * f64::from(random()) } else { 1.0 };
        let offset = FocusOffset::new(t, 0.0);
        splatter.render(&camera, &ByTriangle(vec![offset]), &Unwatched).unwrap();
        let node = &splatter.nodes.as_ref().unwrap().nodes[0];
        let placed = splatter.lens.place(node, &NodeFocus::new(offset));
        let [columns, rows] =
            [(0, camera.width), (1, camera.height)].map(|(axis, side)| placed.reach(node, axis, side));
        for (at, &covered) in (0u32..).zip(&splatter.picture().coverage) {
            let (x, y) = (at % camera.width, at / camera.width);
            let is_within = columns.contains(&x) && rows.contains(&y);
            assert!(is_within || covered == 0.0, "{trial}: {x}, {y} of {columns:?}, {rows:?}: {placed:?}");
            levels[placed.level as usize] += usize::from(covered != 0.0);
        }
    }
    assert!(levels.iter().all(|&lit| lit > 1000), "{levels:?}");
}

#[test]
fn what_is_blackened_still_covers() {
    let mut splatter = Splatter::new(light_field());
    splatter.blacken(|sample| sample % 2 == 0);
    splatter.render(&camera(), &standard(), &Unwatched).unwrap();
    let whole = rendered(&standard());
    assert_eq!(splatter.picture().coverage, whole.picture().coverage);
    // The very bright one is among the black ones; the others send 0.5 of green.
    let green: f64 = splatter.picture().radiance.iter().map(|rgb| f64::from(rgb[1])).sum();
    assert!((green / (96.0 * 80.0 * 0.25) - 1.0).abs() < 0.05, "{green}");
}
