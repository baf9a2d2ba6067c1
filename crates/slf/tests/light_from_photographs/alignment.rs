//! Photographs whose poses are a few pixels off.

use crate::place::{Photographs, floor, floor_places, gauge, solve_with, tracer};
use glam::{DMat3, DMat4, DQuat, DVec3, Vec3};
use scene::{Scene, SurfacePoint, View};
use slf::{DirectPhotographs, PhotographLight, PhotographOptions, Poses};
use std::sync::Arc;
use trace::{Radiance, Tracer};

/// A floor with a pattern as fine as pixels resolve, beneath a plain box.
fn patterned(scene: &Scene, point: SurfacePoint, _eye: DVec3) -> Vec3 {
    let position = point.position(scene);
    if point.triangle < 2 { pattern(position.x, position.z) } else { Vec3::new(0.6, 0.08, 0.08) }
}

fn pattern(x: f64, z: f64) -> Vec3 {
    let wave = (7.0 * x + 1.5 * z).sin() * (8.0 * z).sin() + 0.6 * (4.3 * x - 5.1 * z).sin();
    Vec3::new(0.25, 0.3, 0.2) * (1.0 + 0.5 * wave as f32)
}

/// The same photographs, with cameras turned by about two pixels.
fn perturbed(views: &[View]) -> Vec<View> {
    let turned = |(number, view): (usize, &View)| {
        // Angles of 0.013 rad and more are 1.4 px and more; their mean is 0.
        let (up, aside) = (0.021 * (2.4 * number as f64).sin(), 0.021 * (2.4 * number as f64).cos());
        let turn = DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, up, aside, 0.5 * up));
        let axes = DMat3::from_mat4(view.camera_to_world) * turn;
        View { camera_to_world: DMat4::from_mat3_translation(axes, view.position()), ..view.clone() }
    };
    views.iter().enumerate().map(turned).collect()
}

/// RMS error of the floor's radiance.
fn error(radiance: &dyn Radiance) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for [x, z] in floor_places() {
        let actual = radiance.outgoing(floor(x, z), DVec3::new(0.7, 4.0, 3.1)).total() / gauge();
        sum += f64::from(actual.distance_squared(pattern(x, z)));
        count += 1.0;
    }
    (sum / count).sqrt()
}

fn solve(tracer: &Arc<Tracer>, views: &[View], poses: Poses) -> PhotographLight {
    solve_with(tracer, views, &PhotographOptions { poses, ..PhotographOptions::default() })
}

#[test]
fn photographs_with_pose_errors_are_aligned() {
    let plain = tracer();
    let photographs = Photographs::take("aligned", &plain, patterned, false);
    let views = perturbed(&photographs.views);
    let scene = Arc::new(Scene { views: views.clone(), ..Scene::clone(plain.scene()) });
    let tracer = Arc::new(Tracer::new(scene.clone()));
    let [unaligned, aligned] =
        [Poses::AsCalibrated, Poses::Aligned].map(|poses| solve(&tracer, &views, poses));
    let (before, after) = (error(&unaligned), error(&aligned));
    // 0.066 and 0.012; 0.005 with exact poses.
    assert!(after < 0.3 * before, "{before} {after}");
    assert!(unaligned.max_displacements_px().iter().all(|&px| px == 0.0));
    let moved = aligned.max_displacements_px();
    assert!(moved.iter().filter(|&&px| (0.5..6.0).contains(&px)).count() > 15, "{moved:?}");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let by_one = pool.install(|| solve(&tracer, &views, Poses::Aligned));
    assert!(by_one.to_bytes() == aligned.to_bytes(), "the number of threads does not matter");
    // It is stored with the light, and the photographs themselves are looked up the same way.
    let again = PhotographLight::from_bytes(&aligned.to_bytes(), &tracer).unwrap();
    assert_eq!(again.max_displacements_px(), moved);
    let options = PhotographOptions::default();
    let direct = DirectPhotographs::load(Arc::new(again), &options, &progress::Unwatched).unwrap();
    let directly = error(&direct);
    assert!(directly < 0.3 * before, "{before} {directly}");
}

#[test]
fn photographs_with_exact_poses_stay_unchanged() {
    let tracer = tracer();
    for (name, sends) in [("exact", patterned as crate::place::Sends), ("exact_gloss", crate::place::glossy)]
    {
        let photographs = Photographs::take(name, &tracer, sends, false);
        let [unaligned, aligned] =
            [Poses::AsCalibrated, Poses::Aligned].map(|poses| solve(&tracer, &photographs.views, poses));
        assert_eq!(aligned.max_displacements_px(), [0.0; 20], "{name}");
        assert!(unaligned.to_bytes() == aligned.to_bytes(), "{name}");
    }
}
