//! The exported GLB, read back by the scene crate.

use crate::Test;
use crate::layout::unwrap;
use crate::meshes::{grid, scene, sphere};
use atlas::{UnwrapOptions, write_glb};
use glam::{DVec3, Mat3, Vec2, Vec3, Vec4};
use progress::Unwatched;
use scene::{AlphaMode, Image, ImageLevel, LoadOptions, Scene, TextureRef, Wrap};

pub const TESTS: &[Test] = &[
    ("export::what_is_written_reads_back", what_is_written_reads_back),
    ("export::a_folder_that_is_not_there_is_named", a_folder_that_is_not_there_is_named),
];

fn rich_scene() -> Scene {
    let mut scene = scene(vec![sphere(6, 1.0, DVec3::ZERO), grid(3, 2.0, |x, _| x)]);
    scene.images = vec![Image {
        name: "checker".into(),
        width: 2,
        height: 1,
        texels: ImageLevel::Bits8(vec![1, 2, 3, 4, 250, 251, 252, 253]),
    }];
    let (sin, cos) = 0.4f32.sin_cos();
    let transform = Mat3::from_cols(
        Vec3::new(2.0 * cos, -2.0 * sin, 0.0),
        Vec3::new(-3.0 * sin, -3.0 * cos, 0.0),
        Vec3::new(0.1, 0.2, 1.0),
    );
    let texture =
        TextureRef { image: 0, uv_set: 0, transform, wrap: [Wrap::Mirror, Wrap::Clamp], nearest: true };
    let mut shiny = scene.materials[0].clone();
    shiny.name = "shiny".into();
    shiny.base_color = Vec4::new(0.1, 0.2, 0.3, 0.5);
    shiny.base_color_texture = Some(texture);
    shiny.emissive = Vec3::new(1.0, 4.0, 0.0);
    shiny.emissive_texture = Some(TextureRef { uv_set: 2, ..texture });
    scene.further_uv = vec![(0..scene.positions.len()).map(|i| Vec2::new(i as f32, 0.25)).collect()];
    shiny.alpha = AlphaMode::Mask(0.25);
    shiny.unlit = true;
    shiny.double_sided = true;
    scene.materials.push(shiny);
    scene.parts[1].material = 1;
    scene.colors[3] = Vec4::new(0.5, 1.0, 0.25, 1.0);
    scene
}

fn what_is_written_reads_back() {
    let scene = rich_scene();
    let atlas = unwrap(&scene, &UnwrapOptions::default());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.glb");
    write_glb(&scene, &atlas, &path, &Unwatched).unwrap();
    let again = scene::load(&path, &LoadOptions::default(), &Unwatched).unwrap();
    assert_eq!(again.warnings, Vec::<String>::new());
    assert_eq!(again.triangles.len(), scene.triangles.len());
    let names = |s: &Scene| s.nodes.iter().map(|n| n.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&again), names(&scene));
    let size = Vec2::new(atlas.width as f32, atlas.height as f32);
    for t in 0..scene.triangles.len() as u32 {
        for k in 0..3 {
            assert!((again.corners(t)[k] - scene.corners(t)[k]).length() < 1e-6);
            let place = again.corner_uv(t, 1)[k] * size;
            assert!((place - atlas.corners[t as usize][k]).length() < 1e-3, "TEXCOORD_1 is the atlas");
        }
        if scene.triangles[t as usize].part == 1 {
            assert_eq!(again.corner_uv(t, 0), scene.corner_uv(t, 0));
        }
    }
    let (shiny, was) = (&again.materials[again.parts[1].material as usize], &scene.materials[1]);
    assert_eq!((&shiny.name, shiny.alpha, shiny.unlit), (&was.name, was.alpha, was.unlit));
    assert!((shiny.base_color - was.base_color).length() < 1e-6);
    assert!((shiny.emissive - was.emissive).length() < 1e-6);
    let (texture, had) = (shiny.base_color_texture.unwrap(), was.base_color_texture.unwrap());
    assert!(texture.transform.abs_diff_eq(had.transform, 1e-5), "{} {}", texture.transform, had.transform);
    assert_eq!((texture.wrap, texture.nearest), (had.wrap, had.nearest));
    let glow = shiny.emissive_texture.unwrap();
    for t in again.parts[1].triangles.clone() {
        assert_eq!(again.corner_uv(t, glow.uv_set), scene.corner_uv(t, 2));
    }
    let ImageLevel::Bits8(texels) = &again.images[texture.image as usize].texels else { panic!("8 bits") };
    assert_eq!(*texels, [1, 2, 3, 4, 250, 251, 252, 253]);
}

fn a_folder_that_is_not_there_is_named() {
    let scene = rich_scene();
    let atlas = unwrap(&scene, &UnwrapOptions::default());
    let error = write_glb(&scene, &atlas, "/nowhere/at/all/out.glb".as_ref(), &Unwatched).unwrap_err();
    assert!(error.to_string().starts_with("/nowhere/at/all/out.glb: "), "{error}");
}
