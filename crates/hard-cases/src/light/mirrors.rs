//! A mirror shows the ordinary lens's picture of the mirrored scene, whatever is painted on the mirror.

use crate::case::{Case, Effort, Verdict};
use crate::support::measure::rms_difference;
use crate::support::shot::{Shot, picture_of};
use focus::Focus;
use glam::{DVec3, Vec4};
use lens::{Camera, FocusOffset};
use progress::{Cancelled, Progress};
use salf::Salf;
use scene::{Material, Scalar, Workflow};
use test_scenes::{Mesh, scene_of};

pub const CASES: &[Case] = &[Case {
    name: "a mirror and the mirrored scene",
    reason: "The light of a mirror keeps the standard κ of the reflected point, and so shows what the lens \
             sees behind the mirror plane.",
    control: "its light treated as emitted by its surface, which paint displaces",
    check: mirror,
}];

/// Unlit coloured cards at several depths behind the camera, or mirrored to beyond the mirror plane.
fn cards(is_mirrored: bool) -> Vec<(Mesh, Material)> {
    const MIRROR: f64 = -4.0;
    let cards =
        [(-0.6, 0.1, 1.0, 0.9), (0.4, -0.9, 2.0, 0.5), (0.9, 0.6, 5.0, 0.7), (-20.0, -20.0, 9.0, 0.3)];
    cards
        .map(|(x, y, z, bright)| {
            let place = if is_mirrored { 2.0 * MIRROR - z } else { z };
            let side = if x < -9.0 { 40.0 } else { 0.7 };
            let color = Vec4::new(bright, bright * 0.5, 0.3, 1.0);
            let material = Material { base_color: color, ..Material::unlit_white() };
            (Mesh::rectangle(DVec3::new(x, y, place), DVec3::X * side, DVec3::Y * side), material)
        })
        .into()
}

fn mirror(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let camera = Camera {
        width: 60,
        height: 40,
        yfov: 0.8,
        focus_distance: 6.0,
        aperture_radius: 0.1,
        sensor_height: 0.05,
        ..Camera::default()
    };
    let silver = Material {
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar::constant(1.0),
            roughness: Scalar::constant(0.0),
        },
        ..Material::default()
    };
    let mut meshes = cards(false);
    meshes.push((Mesh::wall(4.0, 20.0), silver));
    let shot_of = |meshes: Vec<(Mesh, Material)>| Shot::new(scene_of(meshes), camera.clone());
    let (shot, mirrored) = (shot_of(meshes), shot_of(cards(true)));
    let expected = mirrored.truth(FocusOffset::STANDARD, effort.choose(1024, 256), progress)?;
    let paint = FocusOffset::new(1.06, 1.0);
    let focus: Focus = shot.focus(paint);
    let salf = shot.salf(paint, progress)?;
    let own = Salf { samples: salf.samples.changed(|sample| sample.is_carried = false), ..salf.clone() };
    let splat = rms_difference(&picture_of(salf, &focus, progress)?, &expected);
    let traced = rms_difference(&shot.truth(paint, effort.choose(1024, 256), progress)?, &expected);
    let control = rms_difference(&picture_of(own, &focus, progress)?, &expected);
    let limits = [("splat", 0.008), ("truth", 0.01)];
    Ok(Verdict::new(
        "painted, the mirrored scene's picture: RMS ≤ 0.008 of 0.3 … 0.9",
        limits,
        [splat, traced],
        [control, 0.0],
    ))
}
