//! Interreflection, compared with closed forms.

use super::*;
use crate::IrradianceOptions;

/// The six walls of a box, facing out.
pub(super) fn outside(low: DVec3, high: DVec3, material: &Material) -> Vec<Rectangle> {
    let size = high - low;
    let [x, y, z] = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
    let faces = [(low, x, z), (high, -z, -x), (low, y, x), (high, -x, -y), (low, z, y), (high, -y, -z)];
    faces.map(|(corner, side, other)| Rectangle(corner, side, other, material.clone())).into()
}

/// The six walls of a box, facing in.
pub(super) fn inside(low: DVec3, high: DVec3, material: &Material) -> Vec<Rectangle> {
    let turned = |Rectangle(corner, side, other, material)| Rectangle(corner, other, side, material);
    outside(low, high, material).into_iter().map(turned).collect()
}

fn transport(scene: Scene, world: World, paths: u32) -> Transport {
    let options = TransportOptions { paths, ..TransportOptions::default() };
    Transport::new(Arc::new(Tracer::new(Arc::new(scene))), world, options)
}

fn with_cached_irradiance(transport: Transport) -> Transport {
    let irradiance =
        Irradiance::solve(&transport, IrradianceOptions { patches: 6000, rays: 128 }, &Unwatched).unwrap();
    transport.with_irradiance(Arc::new(irradiance))
}

fn dark() -> World {
    World::uniform(Vec3::ZERO)
}

/// Mean radiance that points all over some triangles send toward an eye.
fn mean(transport: &Transport, eye: DVec3, triangles: std::ops::Range<u32>) -> Vec3 {
    let points = triangles.flat_map(|triangle| {
        (0..64).map(move |k| {
            let u = (DVec2::new(0.754_877_666, 0.569_840_291) * f64::from(k) + 0.5).fract();
            let barycentric = if u.x + u.y > 1.0 { DVec2::ONE - u } else { u };
            SurfacePoint { triangle, barycentric }
        })
    });
    let all: Vec<Vec3> = points.map(|point| transport.total_outgoing(point, eye)).collect();
    all.iter().sum::<Vec3>() / all.len() as f32
}

#[test]
fn a_closed_room_that_glows_has_its_series_sum() {
    // L = Le/(1 − ρ) in any room: every wall sends its own light and reflects that of the others.
    for (albedo, glow) in [(0.5f32, 1.0f32), (0.8, 0.25)] {
        let color = Vec3::new(albedo, albedo / 2.0, 0.0);
        let wall = Material {
            base_color: color.extend(1.0),
            emissive: Vec3::splat(glow),
            ..Material::lambertian_white()
        };
        let expected = glow / (Vec3::ONE - color);
        let room = || scene_of(&inside(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.5), &wall), &[]);
        let eye = DVec3::new(1.0, 0.5, 0.7);
        let by_paths = mean(&transport(room(), dark(), 64), eye, 0..12);
        assert!((by_paths / expected - 1.0).abs().max_element() < 0.01, "{by_paths}, not {expected}");
        let cached = mean(&with_cached_irradiance(transport(room(), dark(), 8)), eye, 0..12);
        assert!((cached / expected - 1.0).abs().max_element() < 0.01, "cached: {cached}, not {expected}");
        // Control: after two bounces the rest of the series is missing.
        let cut = mean(&transport(room(), World { bounces: Some(1), ..dark() }, 64), eye, 0..12);
        assert!(cut.x < 0.95 * expected.x, "{cut}");
    }
}

#[test]
fn a_closed_box_lit_from_without_stays_dark() {
    let wall = Material { base_color: Vec4::new(0.8, 0.8, 0.8, 1.0), ..Material::lambertian_white() };
    // Walls of some thickness.
    let mut walls = inside(DVec3::splat(-1.0), DVec3::ONE, &wall);
    walls.extend(outside(DVec3::splat(-1.02), DVec3::splat(1.02), &wall));
    let lamp = light(LightKind::Point, DVec3::new(2.0, 3.0, 1.0), DVec3::ZERO);
    let scene = scene_of(&walls, &[lamp]);
    let sky = World::uniform(Vec3::splat(0.5));
    for transport in
        [transport(scene.clone(), sky.clone(), 32), with_cached_irradiance(transport(scene.clone(), sky, 4))]
    {
        let within = mean(&transport, DVec3::ZERO, 0..12).max_element();
        let without = mean(&transport, DVec3::new(9.0, 9.0, 9.0), 12..24).max_element();
        assert!(without > 0.1 && within <= 1e-3 * without, "{within} within, {without} without");
    }
    // Control: a box without a floor.
    let open = scene_of(&walls[1..6], &[]);
    let open = with_cached_irradiance(transport(open, World::uniform(Vec3::ONE), 4));
    assert!(mean(&open, DVec3::ZERO, 0..10).max_element() > 0.05);
}

#[test]
fn a_white_floor_under_an_even_sky_is_as_bright_as_the_sky() {
    let of = |paths| {
        transport(scene_of(&[floor(Material::lambertian_white())], &[]), World::uniform(Vec3::ONE), paths)
    };
    for transport in [of(64), with_cached_irradiance(of(4))] {
        let actual = mean(&transport, ABOVE, 0..2);
        assert!((actual - 1.0).abs().max_element() < 0.01, "{actual}");
    }
}

/// A slab of glass, upper face first, over a glowing floor.
fn slab(ior: f32, volume: Option<Volume>, thickness: f64) -> Scene {
    let glass = Material {
        transmission: Scalar::constant(1.0),
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar::constant(0.0),
            roughness: Scalar::constant(0.0),
        },
        ior,
        volume,
        ..Material::default()
    };
    let mut walls = outside(DVec3::new(-9.0, 1.0, -9.0), DVec3::new(9.0, 1.0 + thickness, 9.0), &glass);
    walls.swap(0, 1);
    let glow = Material { emissive: Vec3::ONE, base_color: Vec4::ZERO, ..Material::lambertian_white() };
    walls.push(Rectangle(DVec3::new(-50.0, 0.0, 50.0), DVec3::X * 100.0, DVec3::Z * -100.0, glow));
    scene_of(&walls, &[])
}

/// A point at the centre of the slab's upper face, and an eye far above it.
const ON_SLAB: SurfacePoint = SurfacePoint { triangle: 0, barycentric: DVec2::new(0.0, 0.5) };
const FAR_ABOVE: DVec3 = DVec3::new(0.0, 400.0, 0.0);

#[test]
fn beers_law_holds_through_a_slab() {
    let color = Vec3::new(0.5, 0.25, 1.0);
    for (thickness, distance) in [(0.5, 1.0), (2.0, 0.5)] {
        let volume = Volume { attenuation_color: color, attenuation_distance: distance };
        let actual =
            transport(slab(1.0, Some(volume), thickness), dark(), 16).total_outgoing(ON_SLAB, FAR_ABOVE);
        let expected = color.powf((thickness / distance) as f32);
        assert!((actual - expected).abs().max_element() < 1e-4, "{actual}, not {expected}");
    }
    // Control: nothing is lost where nothing attenuates.
    let clear = Volume { attenuation_color: color, attenuation_distance: f64::INFINITY };
    assert_eq!(
        transport(slab(1.0, Some(clear), 0.5), dark(), 16).total_outgoing(ON_SLAB, FAR_ABOVE),
        Vec3::ONE
    );
}

#[test]
fn a_slab_of_glass_lets_through_what_its_faces_do() {
    // At normal incidence: (1 − r)/(1 + r) for both faces with all interreflections, r = 0.04.
    let clear = Volume { attenuation_color: Vec3::ONE, attenuation_distance: f64::INFINITY };
    let actual = transport(slab(1.5, Some(clear), 0.5), dark(), 1 << 14).total_outgoing(ON_SLAB, FAR_ABOVE);
    assert!((actual.y - 0.96 / 1.04).abs() < 4e-3, "{actual}");
    // A thin wall transmits 0.96, and so does the other.
    let thin = transport(slab(1.5, None, 0.5), dark(), 1 << 14).total_outgoing(ON_SLAB, FAR_ABOVE);
    assert!((thin.y - 0.96 / 1.04).abs() < 4e-3, "{thin}");
}

/// Fresnel reflectance of a dielectric in air.
fn mirrored(cos: f64, ior: f64) -> f64 {
    let cos_within = (1.0 - (1.0 - cos * cos) / (ior * ior)).sqrt();
    let upright = (cos - ior * cos_within) / (cos + ior * cos_within);
    let level = (ior * cos - cos_within) / (ior * cos + cos_within);
    (upright * upright + level * level) / 2.0
}

#[test]
fn a_pane_without_thickness_mirrors_as_one_face_tints_and_bends_nothing() {
    // glTF's thin wall is a single interface, R, where the two faces of a real pane reflect 2R/(1 + R). It is tinted by
    // its base colour once.
    let tint = Vec3::new(0.9, 0.5, 0.2);
    let pane = |roughness: f32| Material {
        transmission: Scalar::constant(1.0),
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar::constant(0.0),
            roughness: Scalar::constant(roughness),
        },
        base_color: tint.extend(1.0),
        double_sided: true,
        ..Material::default()
    };
    // A floor far below the pane that glows only on one side of x = 0.
    let glow = Material { emissive: Vec3::ONE, base_color: Vec4::ZERO, ..Material::lambertian_white() };
    let scene = |roughness: f32| {
        let floor =
            Rectangle(DVec3::new(0.0, -4.0, 200.0), DVec3::X * 400.0, DVec3::Z * -400.0, glow.clone());
        scene_of(&[super::floor(pane(roughness)), floor], &[])
    };
    let sky = Vec3::new(0.25, 0.5, 1.0);
    for cos in [1.0f64, 0.5, 0.2] {
        let from = DVec3::new((1.0 - cos * cos).sqrt(), cos, 0.0) * 50.0;
        let actual = |sky: Vec3, eye: DVec3| {
            transport(scene(0.0), World::uniform(sky), 1 << 13).total_outgoing(MIDDLE, eye)
        };
        let share = mirrored(cos, 1.5) as f32;
        // Seen from +x the ray continues toward −x, which is dark except for the sky; from −x it continues to the glow.
        let through = actual(Vec3::ZERO, from * DVec3::new(-1.0, 1.0, 1.0) - DVec3::X * 1e-3);
        assert!((through - tint * (1.0 - share)).abs().max_element() < 0.012, "cos {cos}: {through}");
        if cos < 1.0 {
            let beside = actual(Vec3::ZERO, from);
            assert_eq!(beside, Vec3::ZERO, "nothing is bent toward the glow");
            let mirror = actual(sky, from);
            let expected = sky * share + tint * (1.0 - share) * sky;
            assert!((mirror - expected).abs().max_element() < 0.012, "cos {cos}: {mirror}, not {expected}");
        }
        // Control: two faces.
        let slab = 2.0 * share / (1.0 + share);
        assert!((through - tint * (1.0 - slab)).max_element() > 0.02, "cos {cos}: it is as a real pane's");
    }
    // A rough pane blurs what is behind it: at the glow's edge half of it shows, and beside the edge some of it.
    let eye = DVec3::new(0.2, 50.0, 0.0);
    let blurred = transport(scene(0.5), dark(), 1 << 13).total_outgoing(MIDDLE, eye).x;
    let sharp = transport(scene(0.0), dark(), 1 << 13).total_outgoing(MIDDLE, eye).x;
    assert!((0.3..0.6).contains(&(blurred / tint.x)) && sharp == 0.0, "{blurred} and {sharp}");
}

#[test]
fn a_body_within_another_of_its_kind_is_invisible() {
    // Between equal media nothing is reflected: a block in a block transmits what one block does, except for its own
    // colour.
    let body = |color: Vec3| Material {
        transmission: Scalar::constant(1.0),
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar::constant(0.0),
            roughness: Scalar::constant(0.0),
        },
        volume: Some(Volume { attenuation_color: color, attenuation_distance: 1.0 }),
        ..Material::default()
    };
    let scene = |inner_ior: f32| {
        let mut scene =
            slab(1.5, Some(Volume { attenuation_color: Vec3::ONE, attenuation_distance: 1.0 }), 2.0);
        let inner = Material { ior: inner_ior, ..body(Vec3::new(0.5, 1.0, 1.0)) };
        let all = outside(DVec3::new(-8.0, 1.5, -8.0), DVec3::new(8.0, 2.0, 8.0), &inner);
        let inner = scene_of(&all, &[]);
        let (vertices, parts) = (scene.positions.len() as u32, scene.parts.len() as u32);
        let triangles = scene.triangles.len() as u32;
        scene.positions.extend(inner.positions);
        scene.uv[0].extend(&inner.uv[0]);
        scene.triangles.extend(inner.triangles.iter().map(|triangle| Triangle {
            vertices: triangle.vertices.map(|vertex| vertex + vertices),
            part: triangle.part + parts,
        }));
        scene.parts.extend(inner.parts.into_iter().map(|part| Part {
            material: part.material + parts,
            triangles: part.triangles.start + triangles..part.triangles.end + triangles,
            ..part
        }));
        scene.materials.extend(inner.materials);
        scene
    };
    let through = |ior| transport(scene(ior), dark(), 1 << 14).total_outgoing(ON_SLAB, FAR_ABOVE);
    let alike = through(1.5);
    assert!((alike.y - 0.96 / 1.04).abs() < 4e-3, "{alike}");
    // Red is absorbed in the inner body alone, over half a unit.
    assert!((alike.x / alike.y - 0.5f32.sqrt()).abs() < 5e-3, "{alike}");
    // Control: another medium reflects at its boundaries.
    let other = through(2.4);
    assert!(other.y < alike.y - 0.05, "{other}");
}

#[test]
fn cached_irradiance_agrees_with_full_path_tracing() {
    // A room with a lamp, a matte box and a box of rough metal.
    let white = Material { base_color: Vec4::new(0.7, 0.6, 0.5, 1.0), ..Material::lambertian_white() };
    let metal = Material {
        base_color: Vec4::new(0.9, 0.7, 0.4, 1.0),
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar::constant(1.0),
            roughness: Scalar::constant(0.4),
        },
        ..Material::default()
    };
    let lamp =
        Material { emissive: Vec3::splat(8.0), base_color: Vec4::ZERO, ..Material::lambertian_white() };
    let mut walls = outside(DVec3::new(0.4, 0.0, 0.4), DVec3::new(0.8, 0.5, 0.8), &metal);
    walls.extend(outside(DVec3::new(1.1, 0.0, 0.5), DVec3::new(1.5, 0.7, 0.9), &white));
    walls.extend(inside(DVec3::ZERO, DVec3::new(2.0, 1.2, 1.5), &white));
    walls.push(Rectangle(DVec3::new(0.8, 1.19, 0.6), DVec3::X * 0.4, DVec3::Z * 0.3, lamp));
    let scene = || scene_of(&walls, &[]);
    let eye = DVec3::new(0.2, 0.9, 1.4);
    let of_faces = |transport: Transport| -> Vec<Vec3> {
        (0..18).map(|face| mean(&transport, eye, 2 * face..2 * face + 2)).collect()
    };
    let paths = of_faces(transport(scene(), dark(), 256));
    let cached = of_faces(with_cached_irradiance(transport(scene(), dark(), 64)));
    for (face, (a, b)) in paths.iter().zip(&cached).enumerate() {
        let near = (*a - *b).abs().max_element() < 0.03 * a.max_element() + 0.004;
        assert!(near, "face {face}: {a} by paths, {b} cached");
    }
}
