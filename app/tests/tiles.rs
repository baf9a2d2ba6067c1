//! Pictures in tiles: the same bytes as the whole, however the tiles are distributed; missing, truncated and
//! foreign tiles are named.

mod program;
#[allow(dead_code, reason = "shared by several tests")]
#[path = "../../crates/session/tests/tiny_glb/mod.rs"]
mod tiny_glb;

use program::{done, run};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Circles of confusion are wider than tiles.
const CAMERA: &str =
    r#"{"width": 150, "height": 100, "focus_distance": 2.0, "aperture_radius": 0.25, "sensor_height": 0.1}"#;
/// Only the card is painted: tiles far from it are unaffected.
const RECIPE: &str = r#"{"nodes": {"card": {"t": 1.02, "anchor": 0.5}}}"#;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    std::fs::write(folder.path().join("scene.glb"), tiny_glb::glb(&tiny_glb::QUADS)).unwrap();
    put("camera.json", CAMERA);
    put("recipe.json", RECIPE);
    folder
}

fn bytes(folder: &TempDir, name: &str) -> Vec<u8> {
    std::fs::read(folder.path().join(name)).unwrap()
}

/// The parts in a folder, by name.
fn parts(folder: &Path) -> Vec<String> {
    let names =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut parts: Vec<_> = names.filter(|name| name.ends_with(".part")).collect();
    parts.sort();
    parts
}

/// Its error message on stderr, and its exit code.
fn refused(folder: &TempDir, arguments: &str) -> (String, Option<i32>) {
    let output = run(folder.path(), arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    let error = said.lines().find(|line| line.starts_with("error: "));
    (error.unwrap_or_else(|| panic!("{arguments}: {said}")).to_string(), output.status.code())
}

#[test]
fn tiles_are_the_whole_whatever_is_asked_for() {
    let folder = folder();
    let shot = "render scene.glb --camera camera.json --backend cpu";
    for (asked, grid) in [
        ("", "5x4"),
        ("--focus recipe.json --exposure conserve --aov coverage", "4x3"),
        ("--focus recipe.json --tolerance 6 --overscan 13", "3x4"),
        ("--tolerance 0 --size 70x66 --half", "3x3"),
        (
            "--focus recipe.json --aov alpha,crypto,coc,depth,t,pinhole,seen,coverage --half --compression piz",
            "5x1",
        ),
        ("--aperture-radius 0 --aov alpha --color-space acescg --compression zips", "1x4"),
    ] {
        done(folder.path(), &format!("{shot} {asked} -o whole.exr"));
        let told = done(folder.path(), &format!("{shot} {asked} --tiles {grid} -o tiles.exr --json"));
        assert!(bytes(&folder, "whole.exr") == bytes(&folder, "tiles.exr"), "{asked} {grid}");
        let told: Value = serde_json::from_str(&told).unwrap();
        assert_eq!(told["written"], told["tiles"].as_array().unwrap().len(), "{asked}");
        assert_eq!(parts(folder.path()), [""; 0], "parts are gone once they are merged");
    }
}

/// A lit, glossy wall: light depends on the scene alone, refined or not.
#[test]
fn tiles_of_a_lit_scene_are_the_whole() {
    let folder = folder();
    let glb = tiny_glb::glb(&tiny_glb::QUADS);
    let text = b"\"KHR_materials_unlit\":{}";
    let lit = glb.windows(text.len()).filter(|window| window == text).count();
    assert_eq!(lit, 3, "three materials to be lit");
    let mut glb = glb;
    for at in (0..glb.len() - text.len()).collect::<Vec<_>>() {
        if glb[at..].starts_with(text) {
            glb[at + 5] = b'X';
        }
    }
    std::fs::write(folder.path().join("lit.glb"), glb).unwrap();
    let shot = "render lit.glb --camera camera.json --size 70x40 --world";
    std::fs::write(folder.path().join("w.json"), r#"{"environment": [1.0, 0.8, 0.6]}"#).unwrap();
    for light in ["", "--light-passes 2"] {
        done(folder.path(), &format!("{shot} w.json {light} --backend cpu -o whole.exr"));
        done(folder.path(), &format!("{shot} w.json {light} --tiles 3x2 -o tiles.exr"));
        assert!(bytes(&folder, "whole.exr") == bytes(&folder, "tiles.exr"), "{light}");
    }
}

#[test]
fn shares_in_any_order_merge_to_the_whole_and_what_is_wrong_is_named() {
    let folder = folder();
    let shot = "scene.glb --camera camera.json --focus recipe.json --aov crypto";
    done(folder.path(), &format!("render {shot} --backend cpu -o whole.exr"));
    for shard in ["3/3", "1/3", "2/3", "1/3"] {
        done(folder.path(), &format!("render {shot} --tiles 4x2 --shard {shard} -o shot.exr"));
    }
    let mut all = parts(folder.path());
    assert_eq!(all.len(), 8);
    assert_eq!(all[0], "shot.tile1-of-8.part");
    assert!(!folder.path().join("shot.exr").exists());
    all.rotate_left(3);
    let together = all.join(" ");
    done(folder.path(), &format!("merge -o merged.exr {together}"));
    assert!(bytes(&folder, "merged.exr") == bytes(&folder, "whole.exr"));

    let merge = |parts: &str| refused(&folder, &format!("merge -o bad.exr {parts}"));
    let (error, code) = merge(&together.replace("shot.tile5-of-8.part", ""));
    assert!(error.starts_with("error: shot.tile5-of-8.part: ") && error.contains("is missing"), "{error}");
    assert_eq!(code, Some(3));
    let (error, _) = merge(&format!("{together} shot.tile2-of-8.part"));
    assert!(error.contains("same tile as shot.tile2-of-8.part"), "{error}");

    let other = format!("render {shot} --exposure conserve --tiles 4x2 --shard 7/8 -o other.exr");
    done(folder.path(), &other);
    let (error, code) = merge(&together.replace("shot.tile7-of-8.part", "other.tile7-of-8.part"));
    assert!(error.starts_with("error: other.tile7-of-8.part: is of another plan"), "{error}");
    assert_eq!(code, Some(3));

    let whole = bytes(&folder, "shot.tile4-of-8.part");
    std::fs::write(folder.path().join("shot.tile4-of-8.part"), &whole[..whole.len() / 2]).unwrap();
    let (error, code) = merge(&together);
    assert!(error.starts_with("error: shot.tile4-of-8.part: is cut short"), "{error}");
    assert_eq!(code, Some(3));
    assert!(!folder.path().join("bad.exr").exists(), "nothing is written");
    // Exactly the truncated tile is rendered again.
    let again = done(folder.path(), &format!("render {shot} --tiles 4x2 --shard 1/1 -o shot.exr --json"));
    let again: Value = serde_json::from_str(&again).unwrap();
    assert_eq!((&again["written"], &again["skipped"]), (&1.into(), &7.into()));
    assert!(bytes(&folder, "shot.tile4-of-8.part") == whole);
}

#[test]
fn a_farm_tells_the_share() {
    let folder = folder();
    let arguments = "render scene.glb --camera camera.json --tiles 2x2 --shard env -o a.exr";
    let program = Command::new(env!("CARGO_BIN_EXE_focus-brush"))
        .args(arguments.split_whitespace())
        .current_dir(folder.path())
        .env("XDG_CACHE_HOME", folder.path().join("cache"))
        .envs([("SLURM_ARRAY_TASK_ID", "5"), ("SLURM_ARRAY_TASK_MIN", "3"), ("SLURM_ARRAY_TASK_COUNT", "4")])
        .output()
        .unwrap();
    assert!(program.status.success());
    assert_eq!(parts(folder.path()), ["a.tile3-of-4.part"]);
}

#[test]
fn what_is_stopped_goes_on() {
    let folder = folder();
    // Enough tiles to take sufficient time.
    let shot = "render scene.glb --camera camera.json --aperture-radius 0.1 --aov crypto --tiles 5x4 --progress json -o a.exr";
    let mut program = Command::new(env!("CARGO_BIN_EXE_focus-brush"))
        .args(shot.split_whitespace())
        .current_dir(folder.path())
        .env("XDG_CACHE_HOME", folder.path().join("cache"))
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while parts(folder.path()).len() < 2 {
        assert!(begun.elapsed() < Duration::from_secs(120), "two tiles of 20");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").arg(program.id().to_string()).status().unwrap().success());
    let stopped = Instant::now();
    let status = program.wait().unwrap();
    assert!(stopped.elapsed() < Duration::from_secs(5));
    assert_eq!(status.code(), Some(75));
    let finished = parts(folder.path());
    assert!(!folder.path().join("a.exr").exists());
    let output = run(folder.path(), shot);
    assert!(output.status.success());
    let told = String::from_utf8(output.stderr).unwrap();
    let tiles: Vec<Value> = told
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok())
        .filter(|line| line["tile"].is_u64())
        .collect();
    assert_eq!(tiles.len(), 20);
    let skipped = tiles.iter().filter(|tile| tile["state"] == "skipped").count();
    assert_eq!(skipped, finished.len());
    done(
        folder.path(),
        "render scene.glb --camera camera.json --aperture-radius 0.1 --aov crypto --backend cpu -o whole.exr",
    );
    assert!(bytes(&folder, "a.exr") == bytes(&folder, "whole.exr"));
}

#[test]
fn what_has_no_tiles_is_refused() {
    let folder = folder();
    done(folder.path(), "bake scene.glb --camera camera.json -o baked.salf");
    let (shot, tiles) = ("scene.glb --camera camera.json", "--tiles 2x2 -o a.exr");
    for (arguments, said) in [
        (format!("render {shot} --renderer truth {tiles}"), "--renderer truth does not support tiles"),
        (format!("render {shot} --backend gpu {tiles}"), "summed on the processor"),
        (format!("render {shot} --tiles 2x2 -o a.png"), "name an .exr"),
        (format!("render {shot} --stereo anaglyph {tiles}"), "--stereo"),
        (format!("render {shot} --frames 1-2 {tiles}"), "--frames"),
        (format!("render {shot} --tiles 9x1 -o a.exr"), "at most 5 columns of tiles"),
        (format!("render {shot} --tiles 0x1 -o a.exr"), "as in 4x4"),
        (format!("render {shot} --shard 1/2 -o a.exr"), "--frames or --tiles"),
        (format!("render {shot} --integers 21,22 {tiles}"), "14"),
        (format!("render {shot} --integers 14,22 -o a.exr"), "--tiles"),
        (format!("render baked.salf {tiles}"), "leave out --tiles"),
    ] {
        let (error, code) = refused(&folder, &arguments);
        assert!(error.contains(said), "{arguments}: {error}");
        assert_eq!(code, Some(2), "{arguments}: {error}");
    }
    assert_eq!(parts(folder.path()), [""; 0]);
    let (error, code) = refused(&folder, "merge -o a.exr scene.glb");
    assert!(error.contains("scene.glb: is no part of a picture"), "{error}");
    assert_eq!(code, Some(3));
    let missing: PathBuf = folder.path().join("none.part");
    assert!(refused(&folder, "merge -o a.exr none.part").0.contains("none.part"), "{missing:?}");
}
