//! Compares the shader's κ and colours with `lens` and the Rust colour map, on the graphics adapter of the
//! tests.

use super::{FocusTexture, OrbitCamera, Stale, SurfaceFrame, SurfaceMesh, SurfaceRenderer};
use crate::window::view_settings::SurfaceAppearance;
use crate::window::widgets::false_colour;
use atlas::Atlas;
use focus::FocusMap;
use glam::{DVec3, Mat3, Vec2};
use lens::{Camera, FocusOffset};
use scene::{Image, ImageLevel, Material, Node, Part, Scene, TextureRef, Triangle, Wrap};

/// Side of the drawn image, px; gives rows of the length required for copies from the card.
const SIDE: u32 = 64;

/// A white unlit square that fills the view of a camera at the origin, at depth `z`.
fn square_scene(z: f64) -> Scene {
    let half = 2.0 * z;
    let corner = |x: f64, y: f64| DVec3::new(x * half, y * half, -z);
    let image =
        Image { name: "white".into(), width: 1, height: 1, texels: ImageLevel::Bits16(vec![u16::MAX; 4]) };
    let texture = TextureRef {
        image: 0,
        is_color: true,
        uv_set: 0,
        transform: Mat3::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest: false,
    };
    Scene {
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![Triangle { vertices: [0, 1, 2], part: 0 }, Triangle { vertices: [0, 2, 3], part: 0 }],
        parts: vec![Part { node: 0, material: 0, triangles: 0..2, has_uv: [false; 2], mirrored: false }],
        nodes: vec![Node { name: "square".into(), index: 0, world: glam::DMat4::IDENTITY }],
        materials: vec![Material {
            name: "white".into(),
            base_color_texture: Some(texture),
            ..Material::unlit_white()
        }],
        images: vec![image],
        ..Scene::default()
    }
}

fn atlas() -> Atlas {
    let [a, b, c, d] = [[1.0, 7.0], [7.0, 7.0], [7.0, 1.0], [1.0, 1.0]].map(Vec2::from);
    Atlas::new([8, 8], vec![[a, b, c], [a, c, d]], vec![0, 0], &[0], 1.0)
}

/// The centre pixel of the renderer's output.
fn drawn_pixel(
    renderer: &mut SurfaceRenderer,
    z: f64,
    focus: FocusOffset,
    shot: &Camera,
    share: f32,
) -> [f32; 3] {
    let (device, queue) = renderer.device();
    let mesh = SurfaceMesh::upload(device, queue, &square_scene(z), &atlas(), None).unwrap();
    let texture = FocusTexture::new(device, queue, &FocusMap::new(8, 8, focus)).unwrap();
    let view = OrbitCamera::from_shot(shot, z);
    let appearance =
        SurfaceAppearance { focus_share: share, contours: false, photograph_counts: false, depth: false };
    let shown = SurfaceFrame { view: &view, shot, appearance, size: [SIDE, SIDE] };
    renderer.draw(&mesh, &texture, shown, Stale::Everything).unwrap();
    let pixels = read_pixels(renderer);
    let middle = (SIDE / 2 * SIDE + SIDE / 3) as usize * 4;
    std::array::from_fn(|c| pixels[middle + c] as f32 / 255.0)
}

fn read_pixels(renderer: &SurfaceRenderer) -> Vec<u8> {
    let (device, queue) = renderer.device();
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: (SIDE * SIDE * 4) as u64,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SIDE * 4), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        renderer.picture().unwrap().as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
    );
    queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |result| result.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    buffer.slice(..).get_mapped_range().unwrap().to_vec()
}

/// The expected colour of white facing the eye: the map's colour, a little lighter.
fn expected_color(shot: &Camera, z: f64, focus: FocusOffset) -> [f32; 3] {
    let optics = shot.optics();
    let circle_px = 2.0 * optics.splat_radius_px(optics.kappa(1.0 / z, focus));
    false_colour::color_at(false_colour::position(circle_px)).map(|c| (c * (0.78 + 0.3)).min(1.0))
}

#[test]
fn the_shader_colours_what_the_lens_blurs() {
    let setup = egui_kittest::wgpu::default_wgpu_setup();
    let state = egui_kittest::wgpu::create_render_state(setup, egui_wgpu::RendererOptions::PREDICTABLE);
    let mut renderer = SurfaceRenderer::new(&state).unwrap();
    let shot = Camera { width: 540, ..Camera::default() };
    let at_infinity = Camera { focus_distance: f64::INFINITY, ..shot.clone() };
    let pinhole = Camera { aperture_radius: 0.0, ..shot.clone() };
    let focal_length = shot.optics().focal_length();
    let hard = [
        FocusOffset::STANDARD,
        FocusOffset::SHARP,
        FocusOffset::new(0.99, 1.0),
        FocusOffset::new(1.003, 1.0),
        FocusOffset::new(1.01, 0.5),
        FocusOffset::new(0.0, 0.0),
        FocusOffset::new(1e6, 0.3),
    ];
    for shot in [&shot, &at_infinity, &pinhole] {
        for z in [focal_length, 1.5, 3.0, 40.0] {
            for focus in hard {
                let (actual, expected) =
                    (drawn_pixel(&mut renderer, z, focus, shot, 1.0), expected_color(shot, z, focus));
                let error = (0..3).map(|c| (actual[c] - expected[c]).abs()).fold(0.0, f32::max);
                assert!(error < 2.5 / 255.0, "{z} {focus:?}: {actual:?} for {expected:?}");
            }
        }
    }
    // Negative control: another t gives another colour; without false colour the surface is white.
    let (near, far) = (FocusOffset::new(0.99, 1.0), FocusOffset::new(1.01, 1.0));
    let near_color = drawn_pixel(&mut renderer, 3.0, near, &shot, 1.0);
    let far_color = expected_color(&shot, 3.0, far);
    assert!((near_color[2] - far_color[2]).abs() > 0.2, "{near_color:?} and {far_color:?}");
    assert_eq!(drawn_pixel(&mut renderer, 3.0, near, &shot, 0.0), [1.0; 3]);
}
