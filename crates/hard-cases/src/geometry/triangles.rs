//! Triangles without area, needles, and duplicates.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::support::measure::{farthest_from, largest_difference, senseless, worst};
use crate::support::shot::{Shot, picture_of};
use glam::DVec3;
use lens::{Camera, FocusOffset};
use progress::{Cancelled, Progress};
use salf::{Salf, Sample, Visibility};
use test_scenes::{Mesh, unlit_scene_of};

pub const CASES: &[Case] = &[
    Case {
        name: "zero-area triangles",
        reason: "They cover nothing, so the picture is the same without them; no division by their area has \
                 an effect.",
        control: "their unit normals, computed by division by the length",
        check: without_area,
    },
    Case {
        name: "needles",
        reason: "White needles in front of a white wall change nothing: they replace what they hide.",
        control: "each needle drawn as if it hid nothing",
        check: needles,
    },
    Case {
        name: "duplicate coplanar triangles",
        reason: "Of coincident surfaces one is visible: radiance 1 stays 1, facing the camera and edge-on.",
        control: "every copy drawn",
        check: duplicates,
    },
];

const WHITE: [f32; 3] = [1.0; 3];

fn camera(effort: Effort) -> Camera {
    let (width, height) = effort.choose((64, 48), (32, 24));
    Camera { width, height, yfov: 0.6, aperture_radius: 0.1, focus_distance: 3.0, ..Camera::default() }
}

fn without_area(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let wall = Mesh::wall(4.0, 20.0);
    let p = DVec3::new(0.1, -0.05, -2.0);
    let (along, third) = (DVec3::new(0.3, 0.1, -0.2), DVec3::new(1.0, 2.0, 3.0) / 3.0);
    let flat = [
        [p, p, p],
        [p, p, p + along],
        [p, p + along, p + along * 3.0],
        [p - third, p, p + third],
        // At the camera, and through it.
        [DVec3::ZERO; 3],
        [DVec3::Z, DVec3::ZERO, -DVec3::Z],
    ]
    .map(Mesh::triangle);
    let alone = Shot::new(unlit_scene_of([(&wall, WHITE)]), camera(effort));
    let meshes = std::iter::once((&wall, WHITE)).chain(flat.iter().map(|mesh| (mesh, [7.0; 3])));
    let all = Shot::new(unlit_scene_of(meshes), camera(effort));
    let mut differences = Vec::new();
    for offset in [FocusOffset::STANDARD, FocusOffset::new(0.98, 1.0)] {
        differences.push(largest_difference(&all.splat(offset, progress)?, &alone.splat(offset, progress)?));
        let [with, without] = [all.truth(offset, 4, progress)?, alone.truth(offset, 4, progress)?];
        differences.push(largest_difference(&with, &without));
    }
    let salf = all.salf(FocusOffset::STANDARD, progress)?;
    let is_undefined = |sample: &Sample| !(sample.weight.is_finite() && sample.tilt.is_finite());
    let baked = salf.samples.iter().filter(is_undefined).count() as f64;
    let scene = all.tracer.scene();
    let divided = (0..scene.triangles.len() as u32).map(|triangle| {
        let normal = scene.area_normal(triangle);
        normal / normal.length()
    });
    let undefined = divided.filter(|normal| !normal.is_finite()).count();
    let limits = [("difference", 0.0), ("undefined", 0.0)];
    let expected = "the picture without them, bit for bit, splatted and traced; no weight undefined";
    Ok(Verdict::new(expected, limits, [worst(differences), baked], [NOT_COMPUTED, undefined as f64]))
}

fn needles(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let wall = Mesh::wall(4.0, 20.0);
    let widths = [1e-2, 1e-4, 1e-7, 1e-10];
    let needles: Vec<_> = widths
        .iter()
        .enumerate()
        .map(|(k, width)| {
            let foot = DVec3::new(-0.3 + 0.2 * k as f64, -0.8, -2.0 + 0.1 * k as f64);
            Mesh::triangle([foot, foot + DVec3::X * *width, foot + DVec3::new(0.15, 1.6, -0.3)])
        })
        .collect();
    let meshes = std::iter::once((&wall, WHITE)).chain(needles.iter().map(|mesh| (mesh, WHITE)));
    let shot = Shot::new(unlit_scene_of(meshes), camera(effort));
    let salf = shot.salf(FocusOffset::STANDARD, progress)?;
    let focus = shot.focus(FocusOffset::STANDARD);
    let open = |sample: &mut Sample| sample.visibility = Visibility::Open;
    let on_top = Salf { samples: salf.samples.changed(open), ..salf.clone() };
    let splatted = picture_of(salf, &focus, progress)?;
    let traced = shot.truth(FocusOffset::STANDARD, 16, progress)?;
    let right = [farthest_from(&splatted, 1.0), farthest_from(&traced, 1.0), senseless(&splatted)];
    let wrong = [farthest_from(&picture_of(on_top, &focus, progress)?, 1.0), NOT_COMPUTED, NOT_COMPUTED];
    let limits = [("splat", 0.03), ("truth", 1e-6), ("senseless", 0.0)];
    let expected = "1 ± 0.03 splatted, 1 traced, with needles of aspect 1e2 to 1e10";
    Ok(Verdict::new(expected, limits, right, wrong))
}

fn duplicates(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let wall = Mesh::wall(4.0, 20.0);
    let facing = Mesh::wall(3.0, 0.4);
    let edge_on = Mesh::rectangle(DVec3::new(0.02, -0.3, -2.0), DVec3::Y * 0.6, DVec3::Z * -0.9);
    let copies = |count: usize| {
        let copies = |mesh: &Mesh| vec![mesh.clone(); count];
        let meshes: Vec<_> = [vec![wall.clone()], copies(&facing), copies(&edge_on)].concat();
        Shot::new(unlit_scene_of(meshes.iter().map(|mesh| (mesh, WHITE))), camera(effort))
    };
    let (once, thrice) = (copies(1), copies(3));
    let standard = FocusOffset::STANDARD;
    let salf = thrice.salf(standard, progress)?;
    let scene = thrice.tracer.scene();
    let is_copied = |sample: &Sample| {
        sample.surface.is_some_and(|point| scene.triangles[point.triangle as usize].part > 0)
    };
    let copied = salf.samples.iter().filter(is_copied);
    let drawn = Salf { samples: salf.samples.iter().chain(copied).collect(), ..salf.clone() };
    let focus = thrice.focus(standard);
    let splatted = picture_of(salf, &focus, progress)?;
    let limits = [("splat", 1e-3), ("splat − 1", 0.03), ("truth", 1e-6)];
    let single = once.splat(standard, progress)?;
    let right = [
        largest_difference(&splatted, &single),
        farthest_from(&splatted, 1.0),
        farthest_from(&thrice.truth(standard, 4, progress)?, 1.0),
    ];
    let doubled = picture_of(drawn, &focus, progress)?;
    let wrong = [largest_difference(&doubled, &single), farthest_from(&doubled, 1.0), NOT_COMPUTED];
    let expected = "splatted as one copy to 1e-3, and 1 ± 0.03; traced 1";
    Ok(Verdict::new(expected, limits, right, wrong))
}
