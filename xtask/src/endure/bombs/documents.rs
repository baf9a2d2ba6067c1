//! Projects, light fields, parts, recipes, and what is asked on the command line.

use super::super::harness::archive::{Entry, zip};
use super::super::harness::made_files::{glb_of, put, scene};
use super::bomb::{Bomb, bomb};
use std::path::Path;

/// Bombs in the program's own files, and in what is asked for.
pub const BOMBS: &[Bomb] = &[
    bomb("a project whose manifest inflates to 4 GB", "info p.fbrush", |to| {
        put(to, "p.fbrush", zip(&[Entry::zeros("manifest.json", (4 << 30) - 1)]))
    }),
    bomb("a project whose atlas inflates to 4 GB", "info p.fbrush", |to| {
        scene_file(to)?;
        let entries = [Entry::plain("manifest.json", MANIFEST), Entry::zeros("atlas.bin", (4 << 30) - 1)];
        put(to, "p.fbrush", zip(&entries))
    }),
    bomb("a recipe 200,000 deep", "render s.glb --focus r.json --size 8x8 --backend cpu -o o.png", |to| {
        scene_file(to)?;
        put(to, "r.json", deep("default"))
    }),
    bomb("a camera 200,000 deep", "render s.glb --camera c.json --size 8x8 --backend cpu -o o.png", |to| {
        scene_file(to)?;
        put(to, "c.json", deep("camera_to_world"))
    }),
    bomb("a light field with 2³² − 1 of everything", "info l.salf", |to| {
        put(to, "l.salf", salf(u64::from(u32::MAX)))
    }),
    bomb("a light field with 2⁶³ of everything", "info l.salf", |to| put(to, "l.salf", salf(1 << 63))),
    bomb("a part whose description has 2⁶³ bytes", "merge -o o.exr a.part", |to| {
        let mut part = b"focus-brush part 1\n{}".to_vec();
        part.extend((1u64 << 63).to_le_bytes());
        part.extend([0; 32]);
        put(to, "a.part", part)
    }),
    bomb(
        "a billion frames in a still scene's folder that is not there",
        "render s.glb --frames 1-1000000000 --backend cpu -o none/o.####.exr",
        scene_file,
    ),
    bomb("60,000 × 60,000 tiles", "render s.glb --tiles 60000x60000 --backend cpu -o o.exr", scene_file),
    bomb(
        "a picture of 4 billion pixels a side",
        "render s.glb --size 4294967295x4294967295 --backend cpu -o o.exr",
        scene_file,
    ),
];

const MANIFEST: &[u8] = br#"{"format": "focus-brush project", "version": 1, "scene": {"path": "s.glb"}}"#;

fn scene_file(to: &Path) -> Result<(), String> {
    put(to, "s.glb", glb_of(&scene()))
}

fn deep(field: &str) -> String {
    format!("{{\"{field}\": {}1{}}}", "[".repeat(200_000), "]".repeat(200_000))
}

/// The head of a light field with these counts.
fn salf(count: u64) -> Vec<u8> {
    let mut file = b"FBSALF\r\n".to_vec();
    file.extend(6u32.to_le_bytes());
    file.extend(5u32.to_le_bytes());
    file.extend(b"s.glb");
    file.extend(2u32.to_le_bytes());
    file.extend([24u32, 24].into_iter().flat_map(u32::to_le_bytes));
    let mut numbers = vec![0.8, 2.5, 0.1, 0.024, 0.0, 0.0, 0.5, 0.5, 0.5];
    numbers.extend([1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 3.0, 1.0, 1.0]);
    file.extend(numbers.into_iter().flat_map(f64::to_le_bytes));
    // A disc, no margin.
    file.extend([0, 0, 0, 0, 0]);
    file.extend([count; 7].into_iter().flat_map(u64::to_le_bytes));
    file.extend([0; 64]);
    file
}
