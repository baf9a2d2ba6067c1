//! Surfaces on, behind and across the aperture plane, and planes that extend to the horizon.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::support::measure::{farthest_from, largest_difference, rms_difference, senseless, worst};
use crate::support::shot::{Shot, picture_of};
use glam::{DVec3, Vec2};
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use test_scenes::{Mesh, unlit_scene_of};

pub const CASES: &[Case] = &[
    Case {
        name: "points on and behind the aperture plane",
        reason: "They send no light through the aperture to the sensor: the picture is the same with and \
                 without them.",
        control: "(x, y)/z evaluated for them, too: the number that land in the frame",
        check: behind,
    },
    Case {
        name: "triangles that straddle the aperture plane",
        reason: "The part in front of the camera of a floor that continues beneath it is entirely visible: \
                 splat and ray tracing agree.",
        control: "triangles with a corner behind the aperture plane left out",
        check: straddling,
    },
    Case {
        name: "grazing planes to the horizon",
        reason: "A floor of radiance 1 under a background of radiance 1 is 1 everywhere, at any grazing \
                 angle, because a sample's weight is linear over the aperture, w + tilt·u; what remains is a \
                 ripple at the nearest floor.",
        control: "weights without tilt, constant over the aperture",
        check: grazing,
    },
];

const WHITE: [f32; 3] = [1.0; 3];

fn camera(effort: Effort) -> Camera {
    let (width, height) = effort.choose((96, 72), (48, 36));
    Camera { width, height, yfov: 0.6, aperture_radius: 0.1, focus_distance: 3.0, ..Camera::default() }
}

/// A horizontal rectangle from depth `from` to `to`, with the half width `half`.
fn floor(height: f64, [from, to]: [f64; 2], half: f64) -> Mesh {
    Mesh::rectangle(DVec3::new(-half, height, -from), DVec3::X * 2.0 * half, DVec3::Z * (from - to))
}

fn behind(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let wall = Mesh::wall(4.0, 1.0);
    let unseen = [
        Mesh::wall(-1.0, 3.0),
        Mesh::wall(-1e-9, 3.0),
        Mesh::rectangle(DVec3::new(0.2, -1.0, 0.0), DVec3::X, DVec3::Y * 2.0),
        floor(-1.0, [-5.0, 0.0], 2.0),
        Mesh::triangle([DVec3::new(0.3, 0.0, 0.0), DVec3::new(0.4, 0.2, 2.0), DVec3::new(0.5, 0.0, 2.0)]),
    ];
    let camera = camera(effort);
    let alone = Shot::new(unlit_scene_of([(&wall, WHITE)]), camera.clone());
    let all = std::iter::once((&wall, WHITE)).chain(unseen.iter().map(|mesh| (mesh, [9.0, 9.0, 9.0])));
    let both = Shot::new(unlit_scene_of(all), camera.clone());
    let mut differences = Vec::new();
    for offset in [FocusOffset::STANDARD, FocusOffset::new(0.97, 1.0)] {
        let pictures = |shot: &Shot| -> Result<[Picture; 2], Cancelled> {
            Ok([shot.splat(offset, progress)?, shot.truth(offset, 4, progress)?])
        };
        let [expected, actual] = [pictures(&alone)?, pictures(&both)?];
        differences.extend((0..2).map(|k| largest_difference(&actual[k], &expected[k])));
    }
    let optics = camera.optics();
    let projected = unseen.iter().flat_map(|mesh| &mesh.positions).filter(|position| {
        let q = optics.chief(camera.camera_from_world(**position));
        q.x.abs() <= camera.aspect() && q.y.abs() <= 1.0
    });
    let expected = "the picture without them, bit for bit, splatted and traced";
    Ok(Verdict::new(expected, [("difference", 0.0)], [worst(differences)], [projected.count() as f64]))
}

fn straddling(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let meshes = [
        (floor(-0.4, [-3.0, 40.0], 30.0), [0.9, 0.6, 0.3]),
        // A wall beside the camera, edge-on to it.
        (Mesh::rectangle(DVec3::new(0.45, -2.0, 2.0), DVec3::Y * 4.0, DVec3::Z * -9.0), [0.2, 0.5, 0.9]),
    ];
    let camera = Camera { background: Some([0.05; 3]), ..camera(effort) };
    let shot = Shot::new(unlit_scene_of(meshes.iter().map(|(mesh, color)| (mesh, *color))), camera.clone());
    let samples = effort.choose(256, 200);
    let culled = Shot::new(unlit_scene_of([]), camera);
    let mut right = [0.0f64; 2];
    let mut wrong = 0.0f64;
    for offset in [FocusOffset::STANDARD, FocusOffset::new(0.98, 1.0)] {
        let truth = shot.truth(offset, samples, progress)?;
        let splat = shot.splat(offset, progress)?;
        right =
            [right[0].max(rms_difference(&splat, &truth)), right[1] + senseless(&splat) + senseless(&truth)];
        wrong = wrong.max(rms_difference(&culled.splat(offset, progress)?, &truth));
    }
    let expected = "splat and ray tracing agree to 0.02 (RMS, radiances 0.05 … 0.9); no senseless number";
    Ok(Verdict::new(expected, [("RMS", 0.02), ("senseless", 0.0)], right, [wrong, NOT_COMPUTED]))
}

fn grazing(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let camera = Camera { background: Some([1.0; 3]), ..camera(effort) };
    let (mut splatted, mut traced, mut untilted) = (Vec::new(), Vec::new(), Vec::new());
    for height in [-0.2, -0.4, -1.0, -20.0] {
        let scene = unlit_scene_of([(&floor(height, [-1.0, 1e6], 1e6), WHITE)]);
        let shot = Shot::new(scene, camera.clone());
        let salf = shot.salf(FocusOffset::STANDARD, progress)?;
        let focus = shot.focus(FocusOffset::STANDARD);
        let untilt = |sample: &mut salf::Sample| sample.tilt = Vec2::ZERO;
        let flat = salf::Salf { samples: salf.samples.changed(untilt), ..salf.clone() };
        splatted.push(farthest_from(&picture_of(salf, &focus, progress)?, 1.0));
        untilted.push(farthest_from(&picture_of(flat, &focus, progress)?, 1.0));
        traced.push(farthest_from(&shot.truth(FocusOffset::STANDARD, 4, progress)?, 1.0));
    }
    let limits = [("splat", 0.05), ("truth", 1e-6)];
    let expected = "1 ± 0.05 splatted, 1 traced, from floors 2 to 200 aperture radii below";
    Ok(Verdict::new(expected, limits, [worst(splatted), worst(traced)], [worst(untilted), NOT_COMPUTED]))
}
