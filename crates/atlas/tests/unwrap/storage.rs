//! The stored form and the hash.

use crate::Test;
use crate::layout::unwrap;
use crate::meshes::{grid, scene, soup, sphere};
use atlas::{Atlas, AtlasError, UnwrapOptions};
use glam::{DVec3, Vec2};

pub const TESTS: &[Test] = &[
    ("storage::an_atlas_survives_its_bytes", an_atlas_survives_its_bytes),
    ("storage::damaged_or_foreign_bytes_are_refused", damaged_or_foreign_bytes_are_refused),
    ("storage::the_hash_is_that_of_size_and_corners", the_hash_is_that_of_size_and_corners),
];

fn an_atlas_survives_its_bytes() {
    let scene = scene(vec![sphere(10, 1.0, DVec3::ZERO), soup([[DVec3::X; 3]]), grid(3, 1.0, |_, _| 0.0)]);
    let atlas = unwrap(&scene, &UnwrapOptions::default());
    assert_eq!(Atlas::from_bytes(&atlas.to_bytes(), &scene).unwrap(), atlas);
}

fn damaged_or_foreign_bytes_are_refused() {
    let scene_a = scene(vec![sphere(10, 1.0, DVec3::ZERO), grid(3, 1.0, |_, _| 0.0)]);
    let scene_b = scene(vec![grid(3, 1.0, |_, _| 0.0), sphere(10, 1.0, DVec3::ZERO)]);
    let scene_c = scene(vec![grid(3, 1.0, |_, _| 0.0)]);
    let bytes = unwrap(&scene_a, &UnwrapOptions::default()).to_bytes();
    let refused = |bytes: &[u8], scene: &scene::Scene| {
        matches!(Atlas::from_bytes(bytes, scene), Err(AtlasError::Stored { .. }))
    };
    assert!(refused(&bytes, &scene_b) && refused(&bytes, &scene_c));
    for length in [0, 5, 20, 40, 1000, bytes.len() - 1] {
        assert!(refused(&bytes[..length], &scene_a), "cut at {length}");
    }
    assert!(refused(&[bytes.as_slice(), b"x"].concat(), &scene_a));
    // A flipped bit anywhere in counts, corners, charts or hash; the density (24..32) is not in the hash.
    for at in (0..24).chain((32..bytes.len()).step_by(37)) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x40;
        let read = Atlas::from_bytes(&damaged, &scene_a);
        let same_part =
            read.is_ok_and(|a| a.chart_of != unwrap(&scene_a, &UnwrapOptions::default()).chart_of);
        assert!(same_part || refused(&damaged, &scene_a), "byte {at}");
    }
}

fn the_hash_is_that_of_size_and_corners() {
    let corners = vec![[Vec2::new(1.0, 2.0), Vec2::new(3.5, 2.0), Vec2::new(1.0, 4.25)]];
    let atlas = Atlas::new([16, 8], corners.clone(), vec![0], &[0], 1.0);
    // From `struct.pack("<II6f", 16, 8, 1, 2, 3.5, 2, 1, 4.25)` through Python's hashlib.
    assert_eq!(atlas.hash, "68cbd0eb59f167a1204bae6dacfdce0052a1bdacdebe2da181132e897fe47ef3");
    assert_ne!(Atlas::new([16, 9], corners.clone(), vec![0], &[0], 1.0).hash, atlas.hash);
    let moved = vec![corners[0].map(|c| c + Vec2::X * 1e-6)];
    assert_ne!(Atlas::new([16, 8], moved, vec![0], &[0], 1.0).hash, atlas.hash);
    let scene = scene(vec![sphere(20, 1.0, DVec3::ZERO)]);
    let options = UnwrapOptions::default();
    assert_eq!(unwrap(&scene, &options).hash, unwrap(&scene, &options).hash);
}
