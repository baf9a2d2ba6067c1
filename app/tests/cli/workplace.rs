//! The folder in which the program is run.

use crate::tiny_glb;
use focus::Focus;
use project::{NamedCamera, ProjectFile};
use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::Arc;

/// A folder with the scene, its camera and a recipe.
pub struct Workplace {
    folder: tempfile::TempDir,
}

impl Workplace {
    pub fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        tiny_glb::write(&place.path("quads.glb"));
        let camera = r#"{"width": 96, "height": 64, "focus_distance": 2.0, "aperture_radius": 0.1, "sensor_height": 0.1}"#;
        std::fs::write(place.path("camera.json"), camera).unwrap();
        let recipe = r#"{"default": {"t": 1, "anchor": 0}, "nodes": {"card": {"t": 1.2, "anchor": 1}},
            "materials": {"wall paint": {"t": 1, "anchor": 1}}}"#;
        std::fs::write(place.path("recipe.json"), recipe).unwrap();
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs the program in the folder.
    pub fn run(&self, arguments: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_focus-brush"))
            .args(arguments.split_whitespace())
            .current_dir(&self.folder)
            .env_remove("XDG_RUNTIME_DIR")
            .output()
            .unwrap()
    }

    /// Runs the program, which must succeed. Returns its stdout.
    pub fn done(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments}: {}: {errors}", output.status);
        String::from_utf8(output.stdout).unwrap()
    }

    pub fn json(&self, arguments: &str) -> Value {
        serde_json::from_str(&self.done(arguments)).unwrap()
    }

    /// Runs the program, which must fail with `code` and a single line that contains all of `words`.
    pub fn fails(&self, arguments: &str, code: i32, words: &[&str]) {
        let output = self.run(arguments);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments}: {errors}");
        let lines: Vec<_> = errors.lines().filter(|line| line.starts_with("error: ")).collect();
        assert_eq!(lines.len(), 1, "{arguments}: {errors}");
        for word in words {
            assert!(lines[0].contains(word), "{arguments}: no {word:?} in {}", lines[0]);
        }
        assert!(lines[0].ends_with(')'), "{arguments}: says what to do: {}", lines[0]);
    }

    pub fn psnr(&self, a: &str, b: &str) -> f64 {
        self.json(&format!("compare {a} {b} --json"))["psnr"].as_f64().unwrap()
    }

    /// A project with a painted card, as the window saves it.
    pub fn paint(&self, name: &str) -> PathBuf {
        let scene = self.path("quads.glb");
        let loaded = scene::load(&scene, &Default::default(), &progress::Unwatched).unwrap();
        let loaded = Arc::new(loaded);
        let atlas = atlas::Atlas::unwrap(&loaded, &Default::default(), &progress::Unwatched).unwrap();
        let recipe = project::read_recipe(&self.path("recipe.json")).unwrap();
        let focus: Focus = recipe.evaluate(&loaded).unwrap();
        let map = focus.bake(&atlas.texel_map(&loaded));
        let defaults = document::shot_camera_from(&loaded.cameras[0], &Default::default());
        let camera = project::read_camera(&self.path("camera.json"), &defaults).unwrap();
        let cameras = vec![NamedCamera { name: "shot".into(), camera, focus_hold: None }];
        let file = self.path(name);
        let new = ProjectFile::new(&scene, cameras).unwrap();
        let painted = ProjectFile { atlas: Some(atlas.to_bytes()), focus_map: Some(map), ..new };
        painted.save(&file).unwrap();
        file
    }
}
