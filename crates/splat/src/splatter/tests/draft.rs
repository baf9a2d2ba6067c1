//! Pictures of fewer pixels from the same hierarchy.

use super::*;
use crate::canvas::PIXEL;

/// A smooth surface whose depth changes slowly.
fn surface() -> Arc<Salf> {
    let camera =
        Camera { width: 96, height: 64, focus_distance: 2.0, aperture_radius: 0.05, ..Camera::default() };
    let sample = |index: u32| {
        let (x, y) = (index % camera.width, index / camera.width);
        let wave = (x as f32 * 0.2).sin() * (y as f32 * 0.17).cos();
        Sample {
            center: Vec2::new(x as f32 + 0.5, y as f32 + 0.5),
            half_size: Vec2::splat(0.5),
            inverse_depth: 0.4 + x as f32 * 0.004,
            weight: 1.0,
            tilt: Vec2::ZERO,
            radiance: Vec3::new(0.5 + 0.4 * wave, 0.4, y as f32 / camera.height as f32),
            surface: Some(SurfacePoint { triangle: index, barycentric: DVec2::ZERO }),
            is_carried: false,
            visibility: Visibility::Open,
        }
    };
    let samples = (0..camera.width * camera.height).map(sample).collect();
    Arc::new(Salf::with_samples(camera, samples))
}

/// Root mean square of how far a draft is from the means of the pixels in its own.
fn distance(draft: &Picture, whole: &Picture, halvings: u32) -> f32 {
    let side = 1 << halvings;
    let [columns, rows] = [whole.width / side, whole.height / side];
    let mut squares = 0.0;
    for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
        let pixels = (0..side).flat_map(|dy| (0..side).map(move |dx| (x * side + dx, y * side + dy)));
        let mean =
            pixels.map(|(x, y)| Vec3::from(whole.radiance[(y * whole.width + x) as usize])).sum::<Vec3>()
                / (side * side) as f32;
        squares += mean.distance_squared(draft.radiance[(y * draft.width + x) as usize].into());
    }
    (squares / (3 * columns * rows) as f32).sqrt()
}

#[test]
fn a_draft_is_the_picture_with_fewer_pixels() {
    let salf = surface();
    let mut focus = ByTriangle(vec![FocusOffset::STANDARD; salf.samples.len()]);
    for (index, offset) in focus.0.iter_mut().enumerate().filter(|(index, _)| index % 96 > 60) {
        *offset = FocusOffset::new(1.0 + (index % 96) as f64 * 2e-5, 0.0);
    }
    let mut whole = Splatter::new(salf.clone());
    whole.set_tolerance(Tolerance::VIEWING);
    whole.render(&salf.camera, &focus, &Unwatched).unwrap();
    for halvings in 1..=3 {
        let mut draft = whole.draft(halvings as u8);
        draft.set_tolerance(Tolerance::VIEWING);
        draft.take_paint_of(&whole);
        for distance_of_focus in [1.6, 2.0, 2.5] {
            let camera = Camera { focus_distance: distance_of_focus, ..salf.camera.clone() };
            whole.refocus(&camera, &Unwatched).unwrap();
            draft.refocus(&camera, &Unwatched).unwrap();
            let size = [draft.picture().width, draft.picture().height];
            assert_eq!(size, [96, 64].map(|side: u32| side >> halvings));
            let apart = distance(draft.picture(), whole.picture(), halvings);
            assert!(apart < 0.02, "{halvings} at {distance_of_focus}: {apart}");
            let unfocused = Camera { focus_distance: 1.2, ..camera };
            whole.refocus(&unfocused, &Unwatched).unwrap();
            let control = distance(draft.picture(), whole.picture(), halvings);
            assert!(control > 2.0 * apart, "the control: {control}");
        }
    }
}

#[test]
fn a_draft_draws_what_is_alike_in_its_pixels_as_one() {
    let salf = surface();
    let whole = Splatter::new(salf.clone());
    let mut drawn = Vec::new();
    for mut splatter in [whole.draft(1), whole.draft(2), whole] {
        splatter.set_tolerance(Tolerance::VIEWING);
        splatter.render(&salf.camera, &standard_of(&salf), &Unwatched).unwrap();
        drawn.push(splatter.lists.iter().map(|list| list.drawn.len()).sum::<usize>());
    }
    assert!(drawn[0] * 2 < drawn[2] && drawn[1] * 2 < drawn[0], "{drawn:?}");
}

fn standard_of(salf: &Salf) -> ByTriangle {
    ByTriangle(vec![FocusOffset::STANDARD; salf.samples.len()])
}

#[test]
fn paint_that_is_looked_up_later_is_what_a_render_looks_up() {
    let mut focus = standard();
    let mut splatter = rendered(&focus).without_sums();
    assert!(splatter.has_paint());
    let changed: Vec<u32> = (0..500).map(|k| k * 13 % (96 * 80)).collect();
    for &index in &changed {
        focus.0[index as usize] = FocusOffset::new(1.0 + f64::from(index) * 1e-5, 0.0);
    }
    splatter.update_paint(&focus, &changed);
    splatter.refocus(&camera(), &Unwatched).unwrap();
    let fresh = rendered(&focus);
    assert!(splatter.sums == fresh.sums && splatter.picture().radiance == fresh.picture().radiance);
    let mut anew = fresh.twin();
    assert!(!anew.has_paint());
    anew.look_up_paint(&focus);
    anew.refocus(&camera(), &Unwatched).unwrap();
    assert!(anew.sums == fresh.sums);
}

#[test]
fn memory_of_sums_passes_from_one_to_the_next() {
    let focus = standard();
    let fresh = rendered(&focus);
    let mut painted = standard();
    painted.0[40 * 96 + 50] = FocusOffset::new(1.5, 0.0);
    let mut next = fresh.twin();
    next.look_up_paint(&focus);
    let mut resting = rendered(&painted).without_sums_but_for(&mut next);
    for (splatter, focus) in [(&mut next, &focus), (&mut resting, &painted)] {
        splatter.refocus(&camera(), &Unwatched).unwrap();
        let fresh = rendered(focus);
        assert!(splatter.sums == fresh.sums && splatter.picture().radiance == fresh.picture().radiance);
    }
}

#[test]
fn wide_images_are_those_of_the_samples_that_are_painted_so() {
    let mut focus = standard();
    focus.0[40 * 96 + 50] = FocusOffset::new(1.5, 0.0);
    let splatter = rendered(&focus);
    let all = splatter.images_wider_than(0.0);
    let widest = all.iter().copied().reduce(|a, b| if a.radius_px > b.radius_px { a } else { b }).unwrap();
    assert_eq!((widest.sample, widest.center_px), (40 * 96 + 50, Vec2::new(50.5, 40.5)));
    let wide = splatter.images_wider_than(f64::from(widest.radius_px) - 1.5 / f64::from(PIXEL));
    assert_eq!(wide, [widest]);
}
