//! What the program itself writes, or has written by hand: projects, cameras, strokes, light fields.

use crate::folder::{file, once};
use crate::outcome::read_or_refused;
use crate::scenes::limits;
use atlas::Atlas;
use glam::DVec3;
use lens::Camera;
use project::{FocusMapFile, PartFile, Preset, ProjectFile, Thumbnail, WorldFile};
use salf::SalfFile;
use scene::{Scene, SurfaceMesh};
use std::sync::{LazyLock, Once};

/// Reads a project, and its thumbnail.
pub fn project(bytes: &[u8]) {
    let path = file("project.fbrush", bytes);
    read_or_refused(ProjectFile::load(&path));
    if let Some(Some(thumbnail)) = read_or_refused(Thumbnail::read(&path)) {
        read_or_refused(thumbnail.reduced_to(16));
    }
}

/// Reads a part of a picture.
pub fn part(bytes: &[u8]) {
    read_or_refused(PartFile::open(&file("tile.part", bytes)));
}

/// Reads a camera with its lens.
pub fn camera(bytes: &[u8]) {
    let camera = read_or_refused(project::read_camera(&file("camera.json", bytes), &Camera::default()));
    // What was read can be used.
    if let Some(camera) = camera {
        camera.character_optics();
        camera.vignetting();
        camera.falloff();
    }
}

/// Reads a world and the light that it names.
pub fn world(bytes: &[u8]) {
    static SKY: Once = Once::new();
    once(
        &SKY,
        &[("sky.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x80\x40\x40\x40\x80")],
    );
    if let Some(world) = read_or_refused(WorldFile::read(&file("world.json", bytes))) {
        read_or_refused(world.load(&Scene::default()));
    }
}

/// Reads what paints a scene: a recipe, or what it names.
pub fn recipe(bytes: &[u8]) {
    read_or_refused(project::read_focus(&file("recipe.json", bytes)));
}

/// Reads recorded strokes.
pub fn strokes(bytes: &[u8]) {
    read_or_refused(project::read_strokes(&file("strokes.json", bytes)));
}

/// Reads keys of the lens.
pub fn keys(bytes: &[u8]) {
    read_or_refused(project::read_keys(&file("keys.json", bytes)));
}

/// Reads a preset.
pub fn preset(bytes: &[u8]) {
    read_or_refused(Preset::read(&file("preset.json", bytes)));
}

/// Reads a focus map, by its first bytes as OpenEXR or PNG.
pub fn focus_map(bytes: &[u8]) {
    let name = if bytes.starts_with(b"\x76\x2f\x31\x01") { "map.exr" } else { "map.png" };
    read_or_refused(FocusMapFile::read(&file(name, bytes)));
}

/// Reads a light field.
pub fn salf(bytes: &[u8]) {
    read_or_refused(SalfFile::read(bytes));
}

/// Reads the stored atlas of a square.
pub fn atlas(bytes: &[u8]) {
    static SQUARE: LazyLock<Scene> = LazyLock::new(|| {
        let mesh = SurfaceMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..SurfaceMesh::default()
        };
        Scene::from_mesh(mesh, &limits()).expect("a square")
    });
    read_or_refused(Atlas::from_bytes(bytes, &SQUARE));
}
