//! File names that are not UTF-8: on Unix a name is bytes.
#![cfg(unix)]

#[path = "../../crates/session/tests/tiny_glb/mod.rs"]
mod tiny_glb;

use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::OsStrExt;
use std::path::PathBuf;
use std::process::{Command, Output};

/// A folder with a Latin-1 name, containing a scene and its files.
struct Place {
    parent: tempfile::TempDir,
    /// The part of every name that is not UTF-8.
    mark: &'static [u8],
}

const CAMERA: &str = r#"{"width": 48, "height": 32, "focus_distance": 2.0, "aperture_radius": 0.1, "sensor_height": 0.1,
    "aperture": {"shape": "mask", "mask": "mask.png"}}"#;
const RECIPE: &str = r#"{"nodes": {"card": {"map": "map.png"}, "wall": {"t": 1.1, "anchor": 1}}}"#;
const STROKES: &str = r#"{"format": "focus-brush strokes", "version": 3, "steps": [
    {"fill": {"layer": "Paint", "targets": [{"node": 1}], "focus": {"t": 1.2, "anchor": 1}}}]}"#;

impl Place {
    fn new(mark: &'static [u8]) -> Self {
        let place = Self { parent: tempfile::tempdir().unwrap(), mark };
        std::fs::create_dir(place.folder()).unwrap();
        tiny_glb::write(&place.path("scene.glb"));
        std::fs::write(place.path("camera.json"), CAMERA).unwrap();
        std::fs::write(place.path("recipe.json"), RECIPE).unwrap();
        std::fs::write(place.path("strokes.json"), STROKES).unwrap();
        // File names inside files are text.
        let mask = image::GrayImage::from_fn(8, 8, |x, y| image::Luma([(100 + 10 * x + y) as u8]));
        mask.save(place.folder().join("mask.png")).unwrap();
        let map = image::ImageBuffer::from_fn(4, 4, |x, _| image::Rgb([32768u16 + 900 * x as u16, 9000, 0]));
        map.save(place.folder().join("map.png")).unwrap();
        place
    }

    fn folder(&self) -> PathBuf {
        self.parent.path().join(self.named("folder"))
    }

    fn named(&self, name: &str) -> OsString {
        OsStr::from_bytes(&[self.mark, name.as_bytes()].concat()).to_owned()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder().join(self.named(name))
    }

    /// Runs the program; an argument with a `/` is a file of the folder.
    fn run(&self, arguments: &str) -> Output {
        let words = arguments.split_whitespace();
        let words = words.map(|word| match word.strip_prefix('/') {
            Some(name) => self.path(name).into_os_string(),
            None => word.into(),
        });
        Command::new(env!("CARGO_BIN_EXE_focus-brush"))
            .args(words)
            .env_remove("XDG_RUNTIME_DIR")
            .output()
            .unwrap()
    }

    fn done(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments}: {}: {errors}", output.status);
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs the program, which prints JSON and writes a file.
    fn told(&self, arguments: &str, file: &str) -> Vec<u8> {
        let told = self.done(&format!("{arguments} --json"));
        serde_json::from_str::<serde_json::Value>(&told).unwrap();
        self.bytes(file)
    }

    fn bytes(&self, file: &str) -> Vec<u8> {
        std::fs::read(self.path(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
    }
}

/// All files that the command line reads and writes by name.
fn everything(place: &Place) -> Vec<Vec<u8>> {
    let shot = "--camera /camera.json --focus /recipe.json";
    let mut made =
        vec![place.told(&format!("render /scene.glb {shot} -o /picture.exr --aov depth"), "picture.exr")];
    made.push(
        place.told(&format!("render /scene.glb {shot} -o /picture.png --aov depth"), "picture.depth.exr"),
    );
    made.push(place.told("unwrap /scene.glb -o /unwrapped.glb", "unwrapped.glb"));
    place.told(&format!("bake /scene.glb {shot} -o /field.salf"), "field.salf");
    made.push(place.told("render /field.salf -o /baked.exr --focus /recipe.json", "baked.exr"));
    place.done(&format!("new /scene.glb {shot} -o /project.fbrush"));
    made.push(place.told("render /project.fbrush -o /project.exr", "project.exr"));
    place.done("export /project.fbrush --focus-map /map.exr --glb /export.glb --layers /layers.exr");
    made.extend(["map.exr", "export.glb", "layers.exr"].map(|file| place.bytes(file)));
    place.done("export /project.fbrush --focus-map /map16.png");
    made.extend(["map16.png", "map16.png.json"].map(|file| place.bytes(file)));
    made.push(place.told("render /project.fbrush --focus /map16.png -o /again.exr", "again.exr"));
    place.told("replay /project.fbrush /strokes.json -o /painted.fbrush", "painted.fbrush");
    made.push(place.told("render /painted.fbrush --focus /map.exr -o /again.exr", "again.exr"));
    made.push(place.told("compare /picture.exr /project.exr --error-map /errors.png", "errors.png"));
    for file in ["scene.glb", "unwrapped.glb", "field.salf", "project.fbrush"] {
        place.done(&format!("info /{file}"));
        place.done(&format!("info /{file} --json"));
    }
    made
}

#[test]
fn names_that_are_no_text_do_as_well_as_others() {
    let plain = everything(&Place::new(b"plain "));
    for mark in [&b"caf\xe9 \xff"[..], b"\x80"] {
        let made = everything(&Place::new(mark));
        assert_eq!(made.len(), plain.len());
        for (index, (made, plain)) in made.iter().zip(&plain).enumerate() {
            assert!(made == plain, "file {index} of {mark:?} differs");
        }
    }
    assert_ne!(plain[0], plain[3], "negative control: the files are not all one");
}

#[test]
fn what_is_not_there_is_told_in_a_line() {
    let place = Place::new(b"caf\xe9 ");
    let missing = [
        "render /lost.glb -o /x.exr",
        "render /scene.glb --camera /lost.json -o /x.exr",
        "render /scene.glb --camera /lost -o /x.exr",
        "render /scene.glb --focus /lost.exr -o /x.exr",
        "new /lost.glb -o /x.fbrush",
        "unwrap /lost.glb -o /x.glb",
        "export /lost.fbrush --focus-map /x.exr",
        "compare /lost.exr /lost.png",
        "info /lost.salf --json",
        "replay /scene.glb /lost.json -o /x.fbrush",
    ];
    for arguments in missing {
        let output = place.run(arguments);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{arguments}: {errors}");
        let lines: Vec<_> = errors.lines().filter(|line| line.starts_with("error: ")).collect();
        assert_eq!(lines.len(), 1, "{arguments}: {errors}");
        assert!(lines[0].contains("lost"), "{arguments}: {errors}");
    }
    let adapter = place.run("render /scene.glb -o /x.exr --adapter /card");
    assert_eq!(adapter.status.code(), Some(5), "{}", String::from_utf8_lossy(&adapter.stderr));
}
