//! A shifted sensor: its picture is a part of what the same lens draws on a larger one, in focus and out of it, however it is drawn.

#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use document::Input;
use glam::DVec2;
use lens::{Camera, Picture};
use progress::Unwatched;
use render::{RenderOptions, Renderer, render_input};

/// Width and height of the part, px.
const PART: [u32; 2] = [48, 32];

/// The middle of the part, px right and up from that of a picture of three times the size: whole blocks of samples.
const MOVED: [i32; 2] = [-32, 16];

fn part() -> Camera {
    let [width, height] = PART;
    let shift = DVec2::new(f64::from(MOVED[0]), f64::from(MOVED[1])) / f64::from(height);
    Camera {
        width,
        height,
        yfov: 0.2,
        focus_distance: 2.6,
        aperture_radius: 0.06,
        shift,
        ..Camera::default()
    }
}

fn whole() -> Camera {
    let part = part();
    let [width, height] = PART.map(|side| 3 * side);
    Camera {
        width,
        height,
        yfov: 2.0 * (3.0 * (part.yfov / 2.0).tan()).atan(),
        sensor_height: 3.0 * part.sensor_height,
        shift: DVec2::ZERO,
        ..part
    }
}

fn drawn(camera: &Camera, renderer: Renderer) -> Picture {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let input = Input::open(&scene, &Default::default(), &Unwatched).unwrap();
    let focus = input.focus(None, &Default::default(), &Unwatched).unwrap();
    let options = RenderOptions { renderer, ..RenderOptions::default() };
    render_input(&input, camera, &focus, &options, &Unwatched).unwrap().picture
}

/// The mean square difference of the part's picture and what the whole one shows there, or a pixel beside it.
fn difference(renderer: Renderer, beside: i32) -> f32 {
    let (part, whole) = (drawn(&part(), renderer), drawn(&whole(), renderer));
    let corner = [0, 1].map(|axis| {
        let middle = [MOVED[0] + beside, -MOVED[1]][axis];
        (3 * PART[axis] as i32 - PART[axis] as i32) / 2 + middle
    });
    let pixels = (0..PART[1]).flat_map(|y| (0..PART[0]).map(move |x| (x, y)));
    let square = |(x, y): (u32, u32)| {
        let one = part.radiance[(y * part.width + x) as usize];
        let other = whole.radiance
            [((y as i32 + corner[1]) as u32 * whole.width + (x as i32 + corner[0]) as u32) as usize];
        one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f32>() / 3.0
    };
    pixels.map(square).sum::<f32>() / (PART[0] * PART[1]) as f32
}

#[test]
fn the_splat_of_a_part_is_a_part_of_the_splat() {
    let (same, beside) = (difference(Renderer::Splat, 0), difference(Renderer::Splat, 1));
    assert!(same < 1e-6, "{same}");
    assert!(beside > 100.0 * same.max(1e-8), "a pixel beside it is another picture: {beside}");
}

#[test]
fn the_truth_of_a_part_is_a_part_of_the_truth() {
    let (same, beside) = (difference(Renderer::Truth, 0), difference(Renderer::Truth, 1));
    assert!(same < 2e-4 && beside > 2.0 * same, "{same} {beside}");
}
