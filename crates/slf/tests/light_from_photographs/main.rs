//! Light from photographs of a synthetic place.

mod alignment;
mod place;

use atlas::{Atlas, Density, UnwrapOptions};
use glam::{DVec2, DVec3, Vec3};
use place::{
    Photographs, SKY, UNDERSIDE, box_occludes, floor, floor_color, floor_places, gain_stops, gauge, glossy,
    lacquered, matte, solve, tracer,
};
use progress::{Part, Progress, Unwatched};
use scene::{Scene, SurfacePoint, View};
use slf::{PhotographError, PhotographLight, PhotographOptions};
use std::sync::{Arc, Mutex};
use trace::{Radiance, Tracer};

#[test]
fn gains_are_recovered_and_occluders_leave_no_colour() {
    let tracer = tracer();
    let photographs = Photographs::take("gains", &tracer, matte, false);
    let light = solve(&tracer, &photographs.views);
    let mean = f64::from(gauge().log2());
    for (number, exposure) in light.exposures().iter().enumerate() {
        for gain in exposure.gain_stops {
            assert!((gain - (gain_stops(number) - mean)).abs() < 0.05, "{number}: {gain}");
        }
    }
    // From many sides the red box occludes the floor; if that were missed, red would rise from 0.1 to 0.2 and more.
    for [x, z] in floor_places() {
        let actual = light.constant(floor(x, z)) / gauge();
        assert!(actual.distance(floor_color(x, z)) < 0.04, "{x} {z}: {actual}");
    }
}

#[test]
fn a_card_in_a_fifth_of_the_photographs_is_rejected() {
    let tracer = tracer();
    let [without, with] = [("no_card", false), ("card", true)].map(|(name, has_card)| {
        let photographs = Photographs::take(name, &tracer, matte, has_card);
        solve(&tracer, &photographs.views)
    });
    let (mut sum, mut count) = (0.0, 0.0);
    for [x, z] in floor_places() {
        let [without, with] =
            [&without, &with].map(|light| light.total_outgoing(floor(x, z), DVec3::new(0.5, 4.0, 3.0)));
        sum += without.distance_squared(with);
        count += 1.0;
    }
    // A mean would show a fifth of the card's difference (1.05 in length) where the card is visible.
    let off = (sum / count as f32).sqrt();
    assert!(off > 0.0 && off < 0.04, "{off}");
}

#[test]
fn ten_photographs_of_differing_exposures_suffice() {
    let tracer = tracer();
    let photographs = Photographs::take("ten", &tracer, matte, false);
    let views: Vec<View> = photographs.views.iter().step_by(2).cloned().collect();
    let light = solve(&tracer, &views);
    let mean = (0..10).map(|k| gain_stops(2 * k)).sum::<f64>() / 10.0;
    for (k, exposure) in light.exposures().iter().enumerate() {
        let off = exposure.gain_stops.map(|gain| (gain - gain_stops(2 * k) + mean).abs());
        assert!(off.into_iter().all(|off| off < 0.05), "{k}: {off:?}");
    }
    for [x, z] in floor_places() {
        let actual = light.total_outgoing(floor(x, z), DVec3::new(0.5, 4.0, 3.0)) / mean.exp2() as f32;
        assert!(actual.distance(floor_color(x, z)) < 0.02, "{x} {z}: {actual}");
    }
}

#[test]
fn unobserved_texels_are_filled_and_marked() {
    let tracer = tracer();
    let photographs = Photographs::take("filled", &tracer, matte, false);
    let light = solve(&tracer, &photographs.views);
    for triangle in UNDERSIDE {
        let point = SurfacePoint { triangle, barycentric: DVec2::splat(1.0 / 3.0) };
        assert_eq!(light.observed_share(point), 0.0);
        let filled = light.total_outgoing(point, DVec3::new(0.0, -5.0, 1.0));
        assert!(filled.is_finite() && filled.max_element() > 0.05, "{filled}");
    }
    assert_eq!(light.observed_share(floor(1.5, 0.3)), 1.0);
    // A direction past the floor's edge in the view of camera 0.
    let sky = light.environment(DVec3::new(0.25, -0.25, -1.0)) / gauge();
    assert!(sky.distance(SKY) < 0.03, "{sky}");
}

#[test]
fn gloss_is_reproduced_where_photographed_and_changes_smoothly() {
    let tracer = tracer();
    let photographs = Photographs::take("gloss", &tracer, glossy, false);
    let light = solve(&tracer, &photographs.views);
    let point = floor(1.2, 1.0);
    let position = point.position(tracer.scene());
    let [to_lamp, away] = [DVec3::new(0.0, 3.5, 3.5), DVec3::new(0.0, 3.5, -3.5)].map(|step| position + step);
    let truth = glossy(tracer.scene(), point, to_lamp);
    let [actual, flat] =
        [light.total_outgoing(point, to_lamp), light.constant(point)].map(|light| light / gauge());
    assert!(actual.distance(truth) < 0.8 * flat.distance(truth), "{actual} {flat} for {truth}");
    let [actual, truth] = [light.total_outgoing(point, away) / gauge(), glossy(tracer.scene(), point, away)];
    assert!(actual.distance(truth) < 0.1, "{actual} for {truth}");
    // Nothing pops over an aperture between photographs.
    let along = |k: u32| light.total_outgoing(point, to_lamp.lerp(away, f64::from(k) / 400.0));
    let steepest = (0..400).map(|k| along(k).distance(along(k + 1))).fold(0.0, f32::max);
    assert!(steepest < 0.02 && steepest > 0.0, "{steepest}");
}

#[test]
fn a_mirror_shows_its_surroundings_where_the_scene_does_not_block_it() {
    let tracer = tracer();
    let photographs = Photographs::take("mirror", &tracer, lacquered, false);
    let light = solve(&tracer, &photographs.views);
    // Between cameras 0 and 1, at several elevations.
    let eyes = [0.45f64, 0.7, 0.9].map(|elevation| {
        let (sin, cos) = 0.26f64.sin_cos();
        5.0 * DVec3::new(elevation.cos() * sin, elevation.sin(), elevation.cos() * cos)
    });
    let mut sums = [[0.0; 3]; 2];
    for (eye, [x, z]) in eyes.into_iter().flat_map(|eye| floor_places().map(move |place| (eye, place))) {
        let (point, position) = (floor(x, z), DVec3::new(x, 0.0, z));
        let outgoing = light.outgoing(point, eye);
        let is_blocked = box_occludes(position, eye);
        assert!(!is_blocked || outgoing.carried == Vec3::ZERO, "{x} {z}");
        let truth = lacquered(tracer.scene(), point, eye);
        let [mirrored, flat] = [outgoing.total(), light.constant(point)].map(|light| light / gauge());
        let sum = &mut sums[usize::from(is_blocked)];
        *sum =
            [sum[0] + mirrored.distance_squared(truth), sum[1] + flat.distance_squared(truth), sum[2] + 1.0];
    }
    let [open, blocked] =
        sums.map(|[mirrored, flat, count]| [mirrored, flat].map(|sum| (sum / count).sqrt()));
    assert!(open[0] < 0.5 * open[1], "{open:?}");
    assert!(blocked[0] < 0.04, "{blocked:?}");
}

#[test]
fn light_does_not_depend_on_the_number_of_threads() {
    let tracer = tracer();
    let photographs = Photographs::take("threads", &tracer, glossy, false);
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&tracer, &photographs.views))
    });
    assert_eq!(one.exposures(), three.exposures());
    for [x, z] in floor_places() {
        let [one, three] = [&one, &three].map(|light| light.outgoing(floor(x, z), DVec3::new(1.0, 3.0, 2.0)));
        assert_eq!(one, three, "{x} {z}");
    }
}

#[test]
fn no_photographs_and_cancellation_are_errors() {
    let tracer = tracer();
    let photographs = Photographs::take("stopped", &tracer, matte, false);
    let options = UnwrapOptions { density: Density::Side(64), ..UnwrapOptions::default() };
    let atlas = Atlas::unwrap(tracer.scene(), &options, &Unwatched).unwrap();
    let solve = |views: &[View], progress: &dyn Progress| {
        PhotographLight::solve(&tracer, &atlas, views, &PhotographOptions::default(), progress)
    };
    assert!(matches!(solve(&[], &Unwatched), Err(PhotographError::None)));
    let stopped = solve(&photographs.views, &Parts::stopping_in(""));
    assert!(matches!(stopped, Err(PhotographError::Cancelled)));
}

#[test]
fn light_is_restored_from_its_bytes_and_from_no_others() {
    let tracer = tracer();
    let photographs = Photographs::take("stored", &tracer, matte, false);
    let scene = Arc::new(Scene { views: photographs.views.clone(), ..Scene::clone(tracer.scene()) });
    let tracer = Arc::new(Tracer::new(scene.clone()));
    let light = solve(&tracer, &photographs.views);
    let bytes = light.to_bytes();
    let again = PhotographLight::from_bytes(&bytes, &tracer).unwrap();
    assert_eq!(again.to_bytes(), bytes);
    assert_eq!(again.exposures(), light.exposures());
    let eye = DVec3::new(0.3, 2.0, 1.5);
    for (x, z) in [(0.1, 0.2), (-1.7, 1.1), (1.9, -1.9)] {
        let [a, b] = [&light, &again].map(|light| light.outgoing(floor(x, z), eye));
        assert_eq!((a.own, a.carried), (b.own, b.carried));
    }
    for length in (0..bytes.len()).step_by(bytes.len() / 97) {
        assert!(PhotographLight::from_bytes(&bytes[..length], &tracer).is_none(), "{length}");
    }
    let other = Arc::new(Scene { triangles: scene.triangles[1..].to_vec(), ..Scene::clone(&scene) });
    assert!(PhotographLight::from_bytes(&bytes, &Arc::new(Tracer::new(other))).is_none());
}

/// Records the parts that have begun; cancels in the part `stop_in`, or at once if that is empty.
struct Parts {
    begun: Mutex<Vec<Part>>,
    stop_in: Option<&'static str>,
}

impl Parts {
    fn stopping_in(part: &'static str) -> Self {
        Self { begun: Mutex::default(), stop_in: Some(part) }
    }

    fn names(&self) -> Vec<&'static str> {
        self.begun.lock().unwrap().iter().map(|part| part.name).collect()
    }
}

impl Progress for Parts {
    fn report(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        self.stop_in.is_some_and(|stop| stop.is_empty() || self.names().contains(&stop))
    }
    fn begin_part(&self, part: &Part) {
        self.begun.lock().unwrap().push(*part);
    }
}

#[test]
fn every_part_has_a_name_and_a_share_and_can_be_cancelled() {
    let tracer = tracer();
    let photographs = Photographs::take("parts", &tracer, glossy, false);
    let options = UnwrapOptions { density: Density::Side(64), ..UnwrapOptions::default() };
    let atlas = Atlas::unwrap(tracer.scene(), &options, &Unwatched).unwrap();
    let solve = |progress: &Parts| {
        let options = PhotographOptions::default();
        PhotographLight::solve(&tracer, &atlas, &photographs.views[..7], &options, progress).map(drop)
    };
    let parts = Parts { begun: Mutex::default(), stop_in: None };
    solve(&parts).unwrap();
    let names = ["photographs", "exposures", "transients", "alignment", "texels", "mirrors", "gloss"];
    assert_eq!(parts.names(), names);
    let begun = parts.begun.into_inner().unwrap();
    assert!(begun.windows(2).all(|two| (two[0].to - two[1].from).abs() < 1e-6), "{begun:?}");
    assert!(begun[0].from == 0.0 && begun[6].to > 0.9 && begun.iter().all(|part| part.from < part.to));
    for name in names {
        let parts = Parts::stopping_in(name);
        assert!(matches!(solve(&parts), Err(PhotographError::Cancelled)), "{name}");
        assert_eq!(parts.names().last(), Some(&name), "nothing begins after it");
    }
}
