//! Files that hold meshes and textures compressed show what their plain forms do, and break with one error.
//!
//! The files lie in `compressed`: a grid and a picture of our own, written by gltf-transform 4 with Google's Draco, meshoptimizer
//! and Binomial's Basis Universal encoders.

use progress::Unwatched;
use scene::{ImageLevel, LoadOptions, Scene, SceneError};
use std::path::{Path, PathBuf};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/compressed").join(name)
}

fn load(path: &Path) -> Result<Scene, SceneError> {
    scene::load(path, &LoadOptions::default(), &Unwatched)
}

const MESHES: [&str; 4] =
    ["grid.draco.glb", "grid.draco-sequential.glb", "grid.meshopt.glb", "grid.meshopt-filtered.glb"];

/// The largest distance of a corner of a triangle from the nearest of the plain scene's, and of their normals.
fn apart(found: &Scene, plain: &Scene) -> [f64; 2] {
    let corners = |scene: &Scene| {
        let vertices = scene.triangles.iter().flat_map(|triangle| triangle.vertices);
        let corner = |v: u32| (scene.positions[v as usize], scene.normals[v as usize].as_dvec3());
        vertices.map(corner).collect::<Vec<_>>()
    };
    let plain = corners(plain);
    corners(found).into_iter().fold([0.0f64; 2], |[far, turned], (position, normal)| {
        let nearest = plain.iter().min_by(|a, b| a.0.distance(position).total_cmp(&b.0.distance(position)));
        let nearest = nearest.expect("it has corners");
        [far.max(nearest.0.distance(position)), turned.max(nearest.1.distance(normal))]
    })
}

#[test]
fn compressed_meshes_are_what_they_were() {
    let plain = load(&path("grid.glb")).unwrap();
    for name in MESHES {
        let found = load(&path(name)).unwrap();
        assert_eq!(found.triangles.len(), plain.triangles.len(), "{name}");
        let [far, turned] = apart(&found, &plain);
        assert!(far < 3e-4 && turned < 0.03, "{name}: {far} apart, {turned} turned");
        assert!(found.warnings.iter().all(|warning| !warning.contains("ignored")), "{:?}", found.warnings);
        let inspection = scene::inspect(&path(name), &LoadOptions::default()).unwrap();
        let is_told = inspection.extensions_required.iter().any(|name| name.contains("compression"));
        assert!(is_told, "{:?}", inspection.extensions_required);
    }
}

#[test]
fn basis_textures_match_the_picture() {
    let texels = |name: &str| {
        let scene = load(&path(name)).unwrap();
        assert_eq!((scene.images[0].width, scene.images[0].height), (32, 32), "{name}");
        let ImageLevel::Bits8(texels) = &scene.images[0].texels else { panic!("8 bits") };
        texels.clone()
    };
    let plain = texels("colours.glb");
    for (name, most) in [("colours.etc1s.glb", 10.0), ("colours.uastc.glb", 2.5)] {
        let found = texels(name);
        let square: f64 =
            found.iter().zip(&plain).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
        let off = (square / plain.len() as f64).sqrt();
        assert!(off < most, "{name}: {off} of 255");
    }
}

/// A file with some bits of its binary chunk turned over, or cut short.
fn mutilated(bytes: &[u8], round: u64) -> Vec<u8> {
    let json = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let chunk = 20 + json + 8;
    let mut state = round.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    let mut bytes = bytes.to_vec();
    if round % 5 == 4 {
        bytes.truncate(chunk + next(bytes.len() - chunk));
        return bytes;
    }
    for _ in 0..1 << (round % 5 * 2) {
        let at = chunk + next(bytes.len() - chunk);
        bytes[at] ^= 1 << next(8);
    }
    bytes
}

#[test]
fn broken_ones_give_an_error_of_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("broken.glb");
    let (mut refused, mut tried) = (0, 0);
    for name in MESHES.into_iter().chain(["colours.etc1s.glb", "colours.uastc.glb"]) {
        let bytes = std::fs::read(path(name)).unwrap();
        for round in 0..60 {
            std::fs::write(&file, mutilated(&bytes, round)).unwrap();
            tried += 1;
            // A turned bit may be a slightly other mesh, and a texture that is broken is white.
            let Err(error) = load(&file) else { continue };
            let told = error.to_string();
            assert!(told.contains("broken.glb") && !told.contains('\n'), "{told}");
            assert!(!told.contains("unexpected"), "a decoder panicked: {told}");
            refused += 1;
        }
    }
    assert!(refused > tried / 8, "{refused} of {tried}");
    assert!(most_memory().is_none_or(|bytes| bytes < 1 << 30), "{:?} bytes", most_memory());
}

/// The most memory that this process has held so far, where the system tells it.
fn most_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix(" kB")?.parse::<u64>().ok()? << 10)
}

#[test]
fn counts_that_lie_are_refused_before_there_is_room_for_them() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("broken.glb");
    for (name, from, to, why) in [
        ("grid.meshopt.glb", "\"count\":256,", "\"count\":4e9,", "cannot"),
        ("grid.meshopt.glb", "\"mode\":\"TRIANGLES\"", "\"mode\":\"TRIANGLEs\"", "not ATTRIBUTES"),
        ("grid.draco.glb", "\"NORMAL\":1", "\"NORMAL\":7", "NORMAL"),
    ] {
        let bytes = std::fs::read(path(name)).unwrap();
        let json = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        let text = std::str::from_utf8(&bytes[20..20 + json]).unwrap();
        assert!(text.contains(from), "{name} has {from}: {text}");
        let changed = text.replace(from, to);
        let changed = format!("{:1$}", changed.trim_end(), json);
        let mut broken = bytes.clone();
        broken.splice(20..20 + json, changed.into_bytes());
        std::fs::write(&file, broken).unwrap();
        let told = load(&file).unwrap_err().to_string();
        assert!(!told.contains('\n') && (why == "cannot" || told.contains(why)), "{told}");
    }
}
