use super::*;
use glam::{DVec2, Vec2, Vec4};
use progress::Unwatched;
use scene::{
    Backdrop, Image, ImageLevel, Light, LightKind, Material, Node, Part, Scalar, Scene, TextureRef, Triangle,
    Volume, Workflow, Wrap,
};
use std::f64::consts::{FRAC_1_PI, PI};

mod interpolation;
mod mirrors;
mod refining;
mod rooms;

fn grey() -> Material {
    Material { base_color: Vec4::new(0.5, 0.25, 1.0, 1.0), ..Material::lambertian_white() }
}

/// A rectangle of two triangles, counter-clockwise when viewed against side × other.
struct Rectangle(DVec3, DVec3, DVec3, Material);

/// The floor [−1, 1]² at y = 0 with its normal up; its centre lies on the long side of its first triangle.
fn floor(material: Material) -> Rectangle {
    Rectangle(DVec3::new(-1.0, 0.0, 1.0), DVec3::X * 2.0, DVec3::Z * -2.0, material)
}

const MIDDLE: SurfacePoint = SurfacePoint { triangle: 0, barycentric: DVec2::new(0.0, 0.5) };
const ABOVE: DVec3 = DVec3::new(0.3, 2.0, 0.4);

fn scene_of(rectangles: &[Rectangle], lights: &[Light]) -> Scene {
    let mut scene = Scene { lights: lights.to_vec(), ..Scene::default() };
    scene.nodes.push(Node { name: "node 0".into(), index: 0, world: glam::DMat4::IDENTITY });
    for (part, Rectangle(corner, side, other, material)) in rectangles.iter().enumerate() {
        let (part, v) = (part as u32, scene.positions.len() as u32);
        scene.positions.extend([*corner, *corner + *side, *corner + *side + *other, *corner + *other]);
        scene.uv[0].extend([Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO]);
        scene.triangles.push(Triangle { vertices: [v, v + 1, v + 2], part });
        scene.triangles.push(Triangle { vertices: [v, v + 2, v + 3], part });
        let triangles = 2 * part..2 * part + 2;
        scene.parts.push(Part { node: 0, material: part, triangles, has_uv: [true, false], mirrored: false });
        scene.materials.push(material.clone());
    }
    scene
}

/// Direct light alone, with a backdrop that lights nothing.
fn direct(scene: Scene) -> Transport {
    direct_by(scene, 1)
}

fn direct_by(scene: Scene, paths: u32) -> Transport {
    let backdrop = Backdrop::Color(Vec3::new(0.1, 0.2, 0.3));
    let world = World { backdrop, bounces: Some(0), ..World::uniform(Vec3::ZERO) };
    let options = TransportOptions { paths, ..TransportOptions::default() };
    Transport::new(Arc::new(Tracer::new(Arc::new(scene))), world, options)
}

fn light(kind: LightKind, position: DVec3, direction: DVec3) -> Light {
    let name = String::new();
    Light { name, kind, intensity: Vec3::new(3.0, 2.0, 1.0), position, direction, range: f64::INFINITY }
}

fn assert_near(actual: Vec3, expected: Vec3) {
    assert!(
        (actual - expected).abs().max_element() <= 1e-6 * expected.max_element(),
        "{actual}, not {expected}"
    );
}

const ALBEDO: Vec3 = Vec3::new(0.5, 0.25, 1.0);
const INTENSITY: Vec3 = Vec3::new(3.0, 2.0, 1.0);

#[test]
fn a_point_light_over_a_plane() {
    let at = DVec3::new(0.6, 0.8, 0.0) * 2.0;
    let point = light(LightKind::Point, at, DVec3::ZERO);
    // albedo/π · I cosθ/r², cosθ = 0.8, r = 2.
    let expected = ALBEDO * INTENSITY * (0.8 / 4.0 / PI) as f32;
    let scene = scene_of(&[floor(grey())], std::slice::from_ref(&point));
    assert_near(direct(scene.clone()).total_outgoing(MIDDLE, ABOVE), expected);
    assert_eq!(
        direct(scene).total_outgoing(MIDDLE, -ABOVE),
        Vec3::ZERO,
        "from below, where no light arrives"
    );

    // Winding does not matter: the side that faces the eye counts.
    let turned = Rectangle(DVec3::new(-1.0, 0.0, -1.0), DVec3::X * 2.0, DVec3::Z * 2.0, grey());
    assert_near(
        direct(scene_of(&[turned], std::slice::from_ref(&point))).total_outgoing(MIDDLE, ABOVE),
        expected,
    );

    let windowed = Light { range: 4.0, ..point.clone() };
    let scene = scene_of(&[floor(grey())], &[windowed]);
    assert_near(direct(scene).total_outgoing(MIDDLE, ABOVE), expected * (1.0 - 0.5f32.powi(4)));
    let out_of_range = Light { range: 1.9, ..point };
    assert_eq!(direct(scene_of(&[floor(grey())], &[out_of_range])).total_outgoing(MIDDLE, ABOVE), Vec3::ZERO);
}

#[test]
fn a_spot_light_has_a_soft_cone() {
    let (inner, outer) = (0.2, 0.5);
    for (angle, share) in [
        (0.0f64, 1.0),
        (0.199, 1.0),
        (0.4, ((0.4f64.cos() - 0.5f64.cos()) / (0.2f64.cos() - 0.5f64.cos())).powi(2)),
        (0.501, 0.0),
    ] {
        let direction = DVec3::new(angle.sin(), -angle.cos(), 0.0);
        let spot = light(LightKind::Spot { inner, outer }, DVec3::Y * 3.0, direction);
        let expected = ALBEDO * INTENSITY * (share / 9.0 / PI) as f32;
        let actual = direct(scene_of(&[floor(grey())], &[spot])).total_outgoing(MIDDLE, ABOVE);
        assert!((actual - expected).abs().max_element() < 1e-6, "{angle}: {actual}, not {expected}");
    }
}

#[test]
fn directional_light() {
    let sun = light(LightKind::Directional, DVec3::ZERO, DVec3::new(0.6, -0.8, 0.0));
    let scene = scene_of(&[floor(grey())], &[sun]);
    assert_near(direct(scene).total_outgoing(MIDDLE, ABOVE), ALBEDO * INTENSITY * (0.8 * FRAC_1_PI) as f32);
}

#[test]
fn of_many_lights_one_is_sampled_and_the_mean_is_right() {
    let lights: Vec<_> = (0..9)
        .map(|k| {
            light(
                LightKind::Point,
                DVec3::new(f64::from(k) * 0.3 - 1.0, 0.5 + 0.2 * f64::from(k), 0.1),
                DVec3::ZERO,
            )
        })
        .collect();
    let each = lights.iter().map(|light| {
        direct(scene_of(&[floor(grey())], std::slice::from_ref(light))).total_outgoing(MIDDLE, ABOVE)
    });
    let expected: Vec3 = each.sum();
    let actual = direct_by(scene_of(&[floor(grey())], &lights), 1 << 12).total_outgoing(MIDDLE, ABOVE);
    assert!((actual / expected - 1.0).abs().max_element() < 2e-3, "{actual}, not {expected}");
}

#[test]
fn an_occluder_casts_a_shadow() {
    let lights = [
        light(LightKind::Point, DVec3::Y * 3.0, DVec3::ZERO),
        light(LightKind::Directional, DVec3::ZERO, -DVec3::Y),
    ];
    for light in lights {
        let lid = |x: f64| Rectangle(DVec3::new(x, 1.0, 0.1), DVec3::X * 0.2, DVec3::Z * -0.2, grey());
        let lit = |x: f64| {
            let scene = scene_of(&[floor(grey()), lid(x)], std::slice::from_ref(&light));
            direct(scene).total_outgoing(MIDDLE, ABOVE) != Vec3::ZERO
        };
        assert!(!lit(-0.1) && lit(0.01), "{:?}", light.kind);
    }
}

#[test]
fn unlit_is_the_texture_on_both_sides() {
    let texels = vec![255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 188, 188, 188, 255];
    let image = Image { name: "four".into(), width: 2, height: 2, texels: ImageLevel::Bits8(texels) };
    let texture = TextureRef {
        image: 0,
        uv_set: 0,
        transform: glam::Mat3::IDENTITY,
        wrap: [Wrap::Clamp; 2],
        is_color: true,
        nearest: true,
    };
    let unlit = Material { unlit: true, base_color_texture: Some(texture), ..grey() };
    let mut scene = scene_of(&[floor(unlit)], &[light(LightKind::Point, DVec3::Y, DVec3::ZERO)]);
    scene.images.push(image);
    let direct = direct(scene);
    // Texture coordinates start at the upper left: u along x, v along z.
    let lower_right = SurfacePoint { triangle: 0, barycentric: DVec2::new(0.9, 0.0) };
    let lower_left = SurfacePoint { triangle: 0, barycentric: DVec2::new(0.1, 0.0) };
    for eye in [ABOVE, -ABOVE] {
        assert_near(direct.total_outgoing(lower_left, eye), ALBEDO * Vec3::Z);
        let grey = ((188.0f32 / 255.0 + 0.055) / 1.055).powf(2.4);
        assert_near(direct.total_outgoing(lower_right, eye), ALBEDO * grey);
    }
    assert_eq!(direct.environment(DVec3::Y), Vec3::new(0.1, 0.2, 0.3));
}

#[test]
fn emission_leaves_by_the_front() {
    let lamp = Material { emissive: Vec3::new(4.0, 5.0, 6.0), base_color: Vec4::ZERO, ..grey() };
    let both = Material { double_sided: true, ..lamp.clone() };
    for (material, below) in [(lamp.clone(), Vec3::ZERO), (both, lamp.emissive)] {
        let direct = direct(scene_of(&[floor(material)], &[]));
        assert_eq!(direct.total_outgoing(MIDDLE, ABOVE), lamp.emissive);
        assert_eq!(direct.total_outgoing(MIDDLE, -ABOVE), below);
    }
}

/// The form factor of a parallel rectangle [0, a] × [0, b] at height c over a point (Siegel and Howell,
/// configuration 5).
fn corner_form_factor(a: f64, b: f64, c: f64) -> f64 {
    let (a, b) = (a / c, b / c);
    let (p, q) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / p * (b / p).atan() + b / q * (a / q).atan()) / (2.0 * PI)
}

#[test]
fn an_emissive_rectangle_lights_by_its_form_factor() {
    let lamp = Material { emissive: Vec3::splat(2.0), base_color: Vec4::ZERO, ..grey() };
    // Over the floor's middle, facing down, [−0.5, 0.5] × [−0.25, 0.25] at height 0.75.
    let down = |material| Rectangle(DVec3::new(-0.5, 0.75, -0.25), DVec3::X, DVec3::Z * 0.5, material);
    let up = |material| Rectangle(DVec3::new(-0.5, 0.75, 0.25), DVec3::X, DVec3::Z * -0.5, material);
    let expected = 4.0 * corner_form_factor(0.5, 0.25, 0.75) * 2.0;
    let mean = |lamp: Rectangle, samples| {
        let direct = direct_by(scene_of(&[floor(grey()), lamp], &[]), samples);
        // Points next to the centre use other samples.
        let points = (0..64).map(|k| SurfacePoint {
            triangle: 0,
            barycentric: MIDDLE.barycentric + DVec2::new(1e-6, 2e-6) * f64::from(k),
        });
        let radiances: Vec<_> =
            points.map(|point| f64::from(direct.total_outgoing(point, ABOVE).z)).collect();
        let mean = radiances.iter().sum::<f64>() / 64.0;
        let deviation = radiances.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / 63.0;
        (mean, deviation.sqrt())
    };
    let (actual, deviation) = mean(down(lamp.clone()), 32);
    assert!((actual / expected - 1.0).abs() < 2e-3, "{actual}, expected {expected}");
    assert!(deviation / expected < 0.05, "each point is off by {deviation} of {expected}");
    let (actual, _) = mean(down(lamp.clone()), 1);
    assert!((actual / expected - 1.0).abs() < 0.1, "one sample a point: {actual}, expected {expected}");
    assert_eq!(mean(up(lamp.clone()), 32).0, 0.0, "a lamp that faces away");
    let (actual, _) = mean(up(Material { double_sided: true, ..lamp }), 32);
    assert!((actual / expected - 1.0).abs() < 2e-3, "two-sided: {actual}, expected {expected}");
}

#[test]
fn an_emissive_box_is_not_its_own_shadow() {
    // A lamp with six faces: its own triangles and edges must not block its light.
    let lamp = Material { emissive: Vec3::ONE, base_color: Vec4::ZERO, ..grey() };
    let (low, high) = (DVec3::new(-0.2, 0.6, -0.2), DVec3::new(0.2, 1.0, 0.2));
    let size = high - low;
    let [x, y, z] = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
    let faces = [(low, x, z), (high, -z, -x), (low, y, x), (high, -x, -y), (low, z, y), (high, -y, -z)];
    let mut rectangles = vec![floor(grey())];
    rectangles.extend(faces.map(|(corner, side, other)| Rectangle(corner, side, other, lamp.clone())));
    let actual = direct_by(scene_of(&rectangles, &[]), 20_000).total_outgoing(MIDDLE, ABOVE).z;
    // From the centre only the lower face is visible.
    let expected = 4.0 * corner_form_factor(0.2, 0.2, 0.6) as f32;
    assert!((actual / expected - 1.0).abs() < 0.02, "{actual}, expected {expected}");
}
