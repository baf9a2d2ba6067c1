//! Invariance of the picture under a change of units.

use crate::case::{Case, Effort, Verdict};
use crate::support::measure::{largest_difference, rms_difference, worst};
use crate::support::shot::Shot;
use glam::{DMat4, DQuat, DVec3};
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use test_scenes::{Mesh, unlit_scene_of};

pub const CASES: &[Case] = &[
    Case {
        name: "scaled by 2^±20",
        reason: "A power of two changes only exponents, provided that no absolute length is built in: the \
                 picture is bit-identical.",
        control: "all lengths scaled except the aperture's radius",
        check: by_powers_of_two,
    },
    Case {
        name: "scaled by 1e±6",
        reason: "Other factors change rounding, which occasionally moves a ray across an outline, and nothing \
                 else.",
        control: "all lengths scaled except the aperture's radius",
        check: by_powers_of_ten,
    },
];

/// The scene with all lengths times `factor`, and the aperture's radius times `aperture_factor`.
fn shot(effort: Effort, factor: f64, aperture_factor: f64) -> Shot {
    let sphere = Mesh::sphere(DVec3::new(0.3, 0.1, -2.0), 0.4, 12).scaled(factor);
    let wall = Mesh::wall(5.0, 20.0).scaled(factor);
    let floor =
        Mesh::rectangle(DVec3::new(-9.0, -0.6, -1.0), DVec3::X * 18.0, DVec3::Z * -17.0).scaled(factor);
    let scene =
        unlit_scene_of([(&sphere, [0.9, 0.4, 0.1]), (&wall, [0.2, 0.3, 0.4]), (&floor, [0.5, 0.6, 0.5])]);
    let turn = DQuat::from_rotation_y(0.1) * DQuat::from_rotation_x(-0.05);
    let pose = DMat4::from_rotation_translation(turn, DVec3::new(0.1, 0.2, 0.3) * factor);
    let (width, height) = effort.choose((64, 48), (40, 30));
    let camera = Camera {
        width,
        height,
        yfov: 0.6,
        focus_distance: 2.5 * factor,
        aperture_radius: 0.06 * aperture_factor,
        sensor_height: 0.05 * factor,
        camera_to_world: pose,
        ..Camera::default()
    };
    Shot::new(scene, camera)
}

fn pictures(shot: &Shot, progress: &dyn Progress) -> Result<[Picture; 2], Cancelled> {
    let offset = FocusOffset::new(0.97, 0.5);
    Ok([shot.splat(offset, progress)?, shot.truth(offset, 16, progress)?])
}

/// The largest difference from the unscaled scene, splatted and traced, over scenes scaled by pairs of factors:
/// for all lengths, and for the aperture's radius.
fn compared(
    effort: Effort,
    factors: &[[f64; 2]],
    difference: fn(&Picture, &Picture) -> f64,
    progress: &dyn Progress,
) -> Result<[f64; 2], Cancelled> {
    let expected = pictures(&shot(effort, 1.0, 1.0), progress)?;
    let mut differences = [Vec::new(), Vec::new()];
    for &[factor, aperture_factor] in factors {
        let actual = pictures(&shot(effort, factor, aperture_factor), progress)?;
        (0..2).for_each(|k| differences[k].push(difference(&actual[k], &expected[k])));
    }
    Ok(differences.map(worst))
}

fn by_powers_of_two(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let [up, down] = [20.0, -20.0].map(f64::exp2);
    let right = compared(effort, &[[up, up], [down, down]], largest_difference, progress)?;
    let wrong = compared(effort, &[[up, 1.0]], largest_difference, progress)?;
    Ok(Verdict::new("the same bits, splatted and traced", [("splat", 0.0), ("truth", 0.0)], right, wrong))
}

fn by_powers_of_ten(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let (up, down) = (1e6, 1e-6);
    let right = compared(effort, &[[up, up], [down, down]], rms_difference, progress)?;
    let wrong = compared(effort, &[[up, 1.0]], rms_difference, progress)?;
    let limits = [("splat", 1e-4), ("truth", 1e-4)];
    Ok(Verdict::new("the same to 1e-4 (RMS), splatted and traced", limits, right, wrong))
}
