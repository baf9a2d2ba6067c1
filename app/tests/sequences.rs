//! Frames of an animated scene: each is independent of which others are rendered, finished ones are not
//! repeated, shards add up to the whole, and paint stays on its surface.

mod program;
#[allow(dead_code, reason = "shared by several tests")]
#[path = "../../crates/session/tests/tiny_glb/mod.rs"]
mod tiny_glb;

use program::{done, run};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::TempDir;

const CAMERA: &str =
    r#"{"width": 48, "height": 32, "focus_distance": 2.0, "aperture_radius": 0.05, "sensor_height": 0.1}"#;
/// The painted part is red in the picture: only the card stays sharp, whatever the lens does.
const RECIPE: &str = r#"{"nodes": {"card": {"t": 1.0, "anchor": 1}}}"#;
const KEYS: &str = r#"{"focus": [{"seconds": 0, "value": {"distance": 1.5}},
    {"seconds": 0.125, "value": {"point": {"triangle": 0, "barycentric": [0.5, 0.5]}}}],
    "f_number": [{"seconds": 0, "value": 4.0, "ease": "linear"}, {"seconds": 0.25, "value": 2.0}]}"#;
/// Seven frames of the scene's one second of motion.
const SHOT: &str = "scene.glb --camera camera.json --focus recipe.json --fps 6";

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    std::fs::write(folder.path().join("scene.glb"), tiny_glb::moving(&tiny_glb::QUADS)).unwrap();
    put("camera.json", CAMERA);
    put("recipe.json", RECIPE);
    put("keys.json", KEYS);
    folder
}

/// The pictures in a folder.
fn pictures(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let pictures = entries.filter(|path| path.extension().is_some_and(|e| e == "exr" || e == "png"));
    pictures
        .map(|path| (path.file_name().unwrap().to_string_lossy().into(), std::fs::read(&path).unwrap()))
        .collect()
}

fn report(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_frame_alone_is_that_of_the_sequence_and_finished_ones_stay() {
    let (all, alone) = (folder(), folder());
    let first =
        report(&done(all.path(), &format!("render {SHOT} --keys keys.json --frames 1-7 -o f.##.exr --json")));
    assert_eq!((&first["written"], &first["skipped"]), (&7.into(), &0.into()));
    let frames = pictures(all.path());
    assert_eq!(frames.len(), 7);
    let all_differ = frames.values().collect::<std::collections::BTreeSet<_>>().len() == 7;
    assert!(all_differ, "everything moves all the time");
    for frame in [4, 7] {
        done(alone.path(), &format!("render {SHOT} --keys keys.json --frame {frame} -o f.##.exr"));
    }
    for (name, bytes) in pictures(alone.path()) {
        assert!(frames[&name] == bytes, "{name}");
    }

    // One is truncated, one is another picture, one belongs to another plan: exactly these are rendered again.
    let file = |frame: u32| all.path().join(format!("f.{frame:02}.exr"));
    let whole = std::fs::read(file(2)).unwrap();
    std::fs::write(file(2), &whole[..whole.len() - 9]).unwrap();
    std::fs::copy(file(4), file(3)).unwrap();
    let mut flipped = std::fs::read(file(5)).unwrap();
    let at = flipped.len() - 3;
    flipped[at] ^= 4;
    std::fs::write(file(5), flipped).unwrap();
    let again = done(all.path(), &format!("render {SHOT} --keys keys.json --frames 1-7 -o f.##.exr --json"));
    let states: Vec<String> = report(&again)["frames"]
        .as_array()
        .unwrap()
        .iter()
        .map(|frame| frame["state"].as_str().unwrap().into())
        .collect();
    assert_eq!(states, ["skipped", "written", "written", "skipped", "written", "skipped", "skipped"]);
    assert!(pictures(all.path()) == frames, "the same bytes again");
    let other = done(all.path(), &format!("render {SHOT} --frames 7 -o f.##.exr --json"));
    assert_eq!(report(&other)["written"], 1, "without keys it is another picture");
}

#[test]
fn frames_below_0_are_before_the_first_key() {
    let folder = folder();
    let text = done(folder.path(), &format!("render {SHOT} --frames -3--1:2,1 -o f.##.png --json"));
    let numbers: Vec<i64> = report(&text)["frames"]
        .as_array()
        .unwrap()
        .iter()
        .map(|frame| frame["frame"].as_i64().unwrap())
        .collect();
    assert_eq!(numbers, [-3, -1, 1]);
    let frames = pictures(folder.path());
    assert_eq!(frames.keys().collect::<Vec<_>>(), ["f.-01.png", "f.-03.png", "f.01.png"]);
    assert!(frames["f.-01.png"] == frames["f.-03.png"], "an animation holds still before its first key");
    let alone = done(folder.path(), &format!("render {SHOT} --frame -1 -o f.##.png --json"));
    assert_eq!(report(&alone)["skipped"], 1);
}

#[test]
fn shares_make_the_whole_in_any_order() {
    let (whole, shared) = (folder(), folder());
    done(whole.path(), &format!("render {SHOT} --frames 1-7x2,6 -o f.#.png --aov depth"));
    for shard in ["3/3", "1/3", "2/3", "1/3"] {
        done(
            shared.path(),
            &format!("render {SHOT} --frames 1-7:2,6 -o f.#.png --aov depth --shard {shard}"),
        );
    }
    let frames = pictures(whole.path());
    assert_eq!(frames.len(), 10, "{:?}", frames.keys());
    assert!(pictures(shared.path()) == frames);
    // A missing layer is written again.
    std::fs::remove_file(shared.path().join("f.6.depth.exr")).unwrap();
    let again = done(shared.path(), &format!("render {SHOT} --frames 1-7x2,6 -o f.#.png --aov depth --json"));
    assert_eq!(report(&again)["written"], 1);
    assert!(pictures(shared.path()) == frames);
}

#[test]
fn what_stands_still_is_baked_once() {
    let folder = folder();
    let shot = "scene.glb --animation stay --camera camera.json --focus recipe.json";
    let text = done(folder.path(), &format!("render {shot} --keys keys.json --frames 1-5 -o f.#.exr --json"));
    let fields = &report(&text)["light_fields"];
    assert_eq!((&fields["baked"], &fields["kept"]), (&1.into(), &4.into()), "{text}");
    let frames = pictures(folder.path());
    assert_ne!(frames["f.1.exr"], frames["f.3.exr"], "the lens moves");
    std::fs::remove_file(folder.path().join("f.3.exr")).unwrap();
    done(folder.path(), &format!("render {shot} --keys keys.json --frame 3 -o f.#.exr"));
    assert!(pictures(folder.path()) == frames);
    let moved = done(folder.path(), &format!("render {SHOT} --frames 1-2 -o g.#.exr --json"));
    assert_eq!(report(&moved)["light_fields"]["baked"], 2);
}

/// Centroid of the red part of a picture, px.
fn middle_of_red(file: &Path) -> f64 {
    let picture = project::read_picture(file).unwrap();
    let (mut sum, mut all) = (0.0, 0.0);
    for (index, [r, g, _]) in picture.rgb.iter().enumerate() {
        let red = f64::from((r - g).max(0.0));
        sum += red * (f64::from(index as u32 % picture.width) + 0.5);
        all += red;
    }
    assert!(all > 1.0, "{}: the card is to be seen", file.display());
    sum / all
}

#[test]
fn paint_and_card_move_together() {
    let folder = folder();
    done(folder.path(), "new scene.glb --camera camera.json --focus recipe.json -o painted.fbrush");
    let rendered = "painted.fbrush --fps 6 --frames 1,4,7 --aov t --aperture-radius 0.2 -o f.#.exr";
    done(folder.path(), &format!("render {rendered}"));
    let mut last = 0.0;
    for frame in [1, 4, 7] {
        let file = folder.path().join(format!("f.{frame}.exr"));
        let red = middle_of_red(&file);
        assert!(red > last + 2.0, "the card goes right: {last} {red}");
        last = red;
        // Exactly the texels of the card have a painted anchor of 1.
        let layers = project::read_picture(&file).unwrap();
        let (anchor, rgb) = (&layers.layers["anchor"], &layers.rgb);
        let (mut painted, mut both) = (0, 0);
        for (anchor, [r, g, _]) in anchor.iter().zip(rgb) {
            if *anchor > 0.99 {
                painted += 1;
                both += u32::from(r - g > 0.2);
            }
        }
        assert!(painted > 20 && both * 10 > painted * 9, "frame {frame}: {both} of {painted}");
    }
}

#[test]
fn progress_is_lines_of_json_and_mistakes_are_told() {
    let folder = folder();
    let output = run(folder.path(), &format!("render {SHOT} --frames 1-2 -o f.#.exr --progress json"));
    assert!(output.status.success());
    let text = String::from_utf8(output.stderr).unwrap();
    let events: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let frames: Vec<_> =
        events.iter().filter(|event| event["state"] == "written").map(|e| &e["frame"]).collect();
    assert_eq!(frames, [1, 2]);
    assert!(events.iter().any(|event| event["step"] == "baking" && event["done"] == 1.0));

    for (arguments, code, said) in [
        ("--frames 1-2 -o f.exr", 2, "out.####.exr"),
        ("--frames 2-1 -o f.#.exr", 2, "ends before it begins"),
        ("--frames 1 -o f.#.exr --animation gallop", 3, "\"slide\", \"stay\""),
        ("--frames 1 -o f.#.exr --shard 3/2", 2, "K/N"),
        ("--frames 1 -o f.#.exr --keys camera.json", 3, "keys"),
        ("--frames 1-3 -o f.#.exr --shard env", 2, "SLURM_ARRAY_TASK_ID"),
    ] {
        let output = run(folder.path(), &format!("render {SHOT} {arguments}"));
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments}: {text}");
        assert!(
            text.contains(said) && text.trim_end().lines().last().unwrap().starts_with("error: "),
            "{text}"
        );
    }
}

#[test]
fn keys_are_set_on_a_project_and_followed() {
    let folder = folder();
    done(folder.path(), "new scene.glb --camera camera.json --focus recipe.json -o still.fbrush");
    // The card's middle, then the wall beside it.
    done(
        folder.path(),
        "keys still.fbrush -o keyed.fbrush --point 16,16@0 --point 44,30@1 --f-number 4@0 --ease linear",
    );
    let keys = report(&done(folder.path(), "keys keyed.fbrush"));
    assert_eq!(keys["lens"]["focus"].as_array().unwrap().len(), 2);
    assert_eq!(keys["lens"]["f_number"][0]["value"], 4.0);
    let shown = |project: &str, frame: u32| {
        let name = format!("{project}.{frame}.exr");
        done(folder.path(), &format!("render {project}.fbrush --fps 6 --frame {frame} -o {name}"));
        project::read_picture(&folder.path().join(name)).unwrap().rgb
    };
    assert_ne!(shown("keyed", 1), shown("still", 1), "another stop");
    let soft = r#"{"format": "focus-brush preset", "version": 1, "name": "Soft", "lens": {"focal_length": 0.05, "f_number": 1.4,
        "sensor_height": 0.024, "character": {"edges": -0.9}}}"#;
    std::fs::write(folder.path().join("soft.json"), soft).unwrap();
    done(
        folder.path(),
        "keys still.fbrush -o softened.fbrush --character none@0 --character soft.json@1 --ease linear",
    );
    let keys = report(&done(folder.path(), "keys softened.fbrush"));
    assert_eq!(keys["lens"]["character"][1]["value"]["edges"], -0.9);
    assert_eq!(shown("softened", 1), shown("still", 1), "not yet");
    assert_ne!(shown("softened", 7), shown("still", 7), "another character");
    for (wrong, said) in [
        ("--distance 0@1", "above 0"),
        ("--character nobody's@1", "no lens preset"),
        ("--point 900,900@0", "no surface is visible"),
        ("--opacity Sky=0.5@0", "single layer"),
        ("--set camera.json", "not a valid file of lens keys"),
    ] {
        let output = run(folder.path(), &format!("keys still.fbrush -o other.fbrush {wrong}"));
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(3) && text.contains(said), "{wrong}: {text}");
    }
}

#[cfg(unix)]
#[test]
fn a_signal_ends_it_within_seconds_and_the_rest_follows() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let (whole, stopped) = (folder(), folder());
    let arguments = format!("render {SHOT} --size 240x160 --frames 1-40 -o f.##.exr --progress json");
    let begin = || {
        let mut program = Command::new(env!("CARGO_BIN_EXE_focus-brush"));
        program.args(arguments.split_whitespace()).current_dir(stopped.path());
        program.env("XDG_CACHE_HOME", stopped.path().join("cache")).env_remove("XDG_RUNTIME_DIR");
        program.stderr(Stdio::null()).spawn().unwrap()
    };
    let mut running = begin();
    let patience = Instant::now() + Duration::from_secs(120);
    while pictures(stopped.path()).len() < 2 && Instant::now() < patience {
        std::thread::sleep(Duration::from_millis(20));
    }
    Command::new("kill").args(["-TERM", &running.id().to_string()]).status().unwrap();
    let asked = Instant::now();
    let status = running.wait().unwrap();
    assert_eq!(status.code(), Some(75));
    assert!(asked.elapsed() < Duration::from_secs(5), "{:?}", asked.elapsed());
    let finished = pictures(stopped.path());
    assert!((2..40).contains(&finished.len()), "{}", finished.len());
    let rest = done(stopped.path(), &arguments.replace("--progress json", "--json"));
    assert_eq!(report(&rest)["skipped"], finished.len());
    done(whole.path(), &arguments);
    assert!(pictures(stopped.path()) == pictures(whole.path()));
}
