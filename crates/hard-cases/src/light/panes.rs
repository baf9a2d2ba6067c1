//! Partial opacity without grain.

use crate::case::{Case, Effort, Verdict};
use crate::support::shot::Shot;
use glam::Vec4;
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use scene::{AlphaMode, Material};
use test_scenes::{Mesh, scene_of};

pub const CASES: &[Case] = &[
    Case {
        name: "a card of opacity 0.5",
        reason: "Half of every aperture point is visible from each sample behind it, so the picture has no \
                 grain.",
        control: "rays that pass at random",
        check: card,
    },
    Case {
        name: "twelve panes",
        reason: "The visibility of each pane is the product of the transmissions of those in front of it.",
        control: "the panes in reverse order",
        check: stack,
    },
];

fn unlit([r, g, b]: [f32; 3], opacity: f32) -> Material {
    let alpha = if opacity < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque };
    Material { base_color: Vec4::new(r, g, b, opacity), alpha, ..Material::unlit_white() }
}

fn camera(effort: Effort) -> Camera {
    let (width, height) = effort.choose((60, 40), (36, 24));
    Camera { width, height, yfov: 0.6, aperture_radius: 0.05, focus_distance: 3.0, ..Camera::default() }
}

/// The mean of each colour over the centre of the picture, and the largest relative deviation.
fn middle(picture: &Picture) -> ([f64; 3], f64) {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let pixels: Vec<_> = (height / 3..2 * height / 3)
        .flat_map(|y| (width / 3..2 * width / 3).map(move |x| y * width + x))
        .map(|at| picture.radiance[at].map(f64::from))
        .collect();
    let count = pixels.len() as f64;
    let mean = [0, 1, 2].map(|c| pixels.iter().map(|pixel| pixel[c]).sum::<f64>() / count);
    let deviation = [0, 1, 2].map(|c| {
        let square = pixels.iter().map(|pixel| (pixel[c] / mean[c] - 1.0).powi(2)).sum::<f64>();
        (square / count).sqrt()
    });
    (mean, deviation.into_iter().fold(0.0, f64::max))
}

fn card(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let [wall, card] = [[0.8f32, 0.6, 0.4], [0.2, 0.3, 0.9]];
    let meshes = [(Mesh::wall(4.0, 9.0), unlit(wall, 1.0)), (Mesh::wall(2.0, 5.0), unlit(card, 0.5))];
    let shot = Shot::new(scene_of(meshes), camera(effort));
    let off = |picture: &Picture| {
        let (mean, deviation) = middle(picture);
        let wanted = |c: usize| f64::from(wall[c] + card[c]) / 2.0;
        let off = (0..3).map(|c| (mean[c] / wanted(c) - 1.0).abs()).fold(0.0, f64::max);
        [off, deviation]
    };
    let right = off(&shot.splat(FocusOffset::STANDARD, progress)?);
    let wrong = off(&shot.truth(FocusOffset::STANDARD, 16, progress)?);
    let limits = [("mean", 2e-3), ("deviation", 3e-3)];
    Ok(Verdict::new("mean to 0.2 %, deviation of pixels ≤ 0.3 %", limits, right, wrong))
}

fn stack(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let panes: Vec<_> = (0..12u16)
        .map(|k| {
            let shade = f32::from(k) / 11.0;
            ([0.1 + 0.8 * shade, 0.9 - 0.7 * shade, 0.3 + 0.05 * f32::from(k % 3)], 0.1 + 0.8 * shade)
        })
        .collect();
    let ground = [0.5, 0.4, 0.9];
    let composited = |panes: &[([f32; 3], f32)]| {
        // Composited from back to front.
        panes.iter().rev().fold(ground.map(f64::from), |behind, (color, opacity)| {
            let opacity = f64::from(*opacity);
            std::array::from_fn(|c| opacity * f64::from(color[c]) + (1.0 - opacity) * behind[c])
        })
    };
    let meshes: Vec<_> = panes
        .iter()
        .enumerate()
        .map(|(k, &(color, opacity))| (Mesh::wall(2.5 + 0.1 * k as f64, 9.0), unlit(color, opacity)))
        .chain([(Mesh::wall(4.0, 12.0), unlit(ground, 1.0))])
        .collect();
    let shot = |focus_distance: f64| {
        let scene = scene_of(meshes.clone());
        Shot::new(scene, Camera { focus_distance, ..camera(effort) })
    };
    let mut measured = Vec::new();
    for focus_distance in [3.0, 0.6, f64::INFINITY] {
        measured.push(middle(&shot(focus_distance).splat(FocusOffset::STANDARD, progress)?));
    }
    let off = |expected: [f64; 3]| {
        let deviation_of = |(mean, _): &([f64; 3], f64)| {
            (0..3).map(|c| (mean[c] / expected[c] - 1.0).abs()).fold(0.0, f64::max)
        };
        measured.iter().map(deviation_of).fold(0.0, f64::max)
    };
    let reversed: Vec<_> = panes.iter().rev().copied().collect();
    let deviation = measured.iter().map(|(_, deviation)| *deviation).fold(0.0, f64::max);
    let limits = [("mean", 3e-3), ("deviation", 5e-3)];
    let (right, wrong) = (off(composited(&panes)), off(composited(&reversed)));
    let expected =
        "opacity 0.1 … 0.9 over a wall, in focus and not: mean to 0.3 %, deviation of pixels ≤ 0.5 %";
    Ok(Verdict::new(expected, limits, [right, deviation], [wrong, 0.0]))
}
