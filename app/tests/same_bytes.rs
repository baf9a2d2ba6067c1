//! Reproducibility: the same commands give the same bytes in another process, at another time, with any number
//! of threads.

mod command_inputs;
#[path = "../../crates/session/tests/tiny_glb/mod.rs"]
mod tiny_glb;

use command_inputs::{CAMERA, RECIPE, STROKES};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

const COMMANDS: [&str; 14] = [
    "render scene.glb --camera camera.json --focus recipe.json -o picture.exr --aov coverage,coc,depth,t",
    "render scene.glb --camera camera.json --focus recipe.json -o picture.png --aov coc",
    "render scene.glb --camera camera.json --focus recipe.json -o layers.exr --aov alpha,crypto,pinhole \
     --overscan 3 --half",
    "render scene.glb --camera camera.json -o truth.exr --renderer truth --spp 32 --aov stderr,coverage,depth",
    "render scene.glb --camera camera.json -o scatter.exr --renderer scatter",
    "new scene.glb --camera camera.json --focus recipe.json -o project.fbrush",
    "replay project.fbrush strokes.json -o painted.fbrush",
    "unwrap scene.glb -o unwrapped.glb --ignore-uv",
    "bake scene.glb --camera camera.json -o field.salf",
    "export painted.fbrush --focus-map map.exr --glb export.glb --layers layers.exr",
    "export painted.fbrush --focus-map map.png",
    "export painted.fbrush --web page.html --apertures 1,2",
    "compare picture.exr truth.exr --error-map errors.exr",
    "compare picture.exr truth.exr --error-map errors.png",
];

/// Every file written by the commands in a folder of this name.
fn written(name: &str, threads: usize) -> BTreeMap<String, Vec<u8>> {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join(name);
    std::fs::create_dir(&folder).unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    tiny_glb::write(&folder.join("scene.glb"));
    put("camera.json", CAMERA);
    put("recipe.json", RECIPE);
    put("strokes.json", STROKES);
    let given = names(&folder);
    for command in COMMANDS {
        let output = Command::new(env!("CARGO_BIN_EXE_focus-brush"))
            .args(command.split_whitespace())
            .current_dir(&folder)
            .env_remove("XDG_RUNTIME_DIR")
            .env("RAYON_NUM_THREADS", threads.to_string())
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{command}: {errors}");
    }
    let files = names(&folder).into_iter().filter(|file| !given.contains(file));
    files.map(|file| (file.clone(), std::fs::read(folder.join(file)).unwrap())).collect()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    let files = entries.filter(|entry| entry.file_type().unwrap().is_file());
    files.map(|entry| entry.file_name().into_string().unwrap()).collect()
}

#[test]
fn the_same_commands_write_the_same_bytes() {
    let first = written("one", 1);
    assert_eq!(first.len(), 17, "{:?}", first.keys());
    // Repeatedly: an undefined order may be the same by chance.
    for threads in [1, 2, 5] {
        let again = written("another", threads);
        assert_eq!(first.keys().collect::<Vec<_>>(), again.keys().collect::<Vec<_>>());
        for (file, bytes) in &first {
            assert!(again[file] == *bytes, "{file} differs with {threads} threads");
        }
    }
}
