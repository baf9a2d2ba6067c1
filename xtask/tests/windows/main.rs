//! The package for Windows under Wine, without a screen, beside this system's program: the same bytes, and the same promises.
//!
//! It is tried where there are Wine and a package (`cargo xtask package --windows`, or the unpacked folder in FOCUS_BRUSH_WINDOWS).
//! `cargo test --package xtask --test windows -- --nocapture` prints what was compared.

#[path = "../../../app/tests/card_light_field/mod.rs"]
mod card_light_field;
#[path = "../../../app/tests/command_inputs/mod.rs"]
mod command_inputs;
mod inputs;
mod programs;
#[path = "../../../crates/session/tests/tiny_glb/mod.rs"]
mod tiny_glb;
#[path = "../../../app/tests/wall_capture/mod.rs"]
mod wall_capture;

use programs::Programs;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

/// What both programs do, one after the other, in a folder with [`inputs`].
const COMMANDS: &[&str] = &[
    // What there is.
    "info scene.glb",
    "info photos",
    "info views",
    "info splats.ply",
    // Ten kinds of input.
    "render scene.glb --camera camera.json --focus recipe.json -o scene.exr --aov coverage,coc,depth,t",
    "render folder/scene.gltf --camera camera.json -o gltf.exr",
    "render metal.glb --camera camera.json --world studio -o lit.exr",
    "render metal.glb --camera camera.json --world evening --floor -o evening.png",
    "new scene.glb --camera camera.json --focus recipe.json -o project.fbrush",
    "replay project.fbrush strokes.json -o painted.fbrush",
    "render painted.fbrush -o painted.exr",
    "bake scene.glb --camera camera.json -o field.salf",
    "render field.salf -o field.exr",
    "render photos --camera photo:1.png --aperture-radius 0.05 -o photos.exr",
    "render views --aperture-radius 0.5 -o views.exr",
    "import cat.png --near white -o cat.fbrush",
    "render cat.fbrush -o cat.exr",
    "render splats.ply --camera camera.json -o splats.exr",
    "render demo/demo.fbrush --size 160x90 -o demo.exr",
    // Rays, atlases, maps, pages.
    "render scene.glb --camera camera.json -o truth.exr --renderer truth --spp 16",
    "unwrap scene.glb -o unwrapped.glb --ignore-uv",
    "unwrap demo/demo.glb -o demo-unwrapped.glb --ignore-uv",
    "export painted.fbrush --focus-map map.exr --glb export.glb --layers layers.exr",
    "export painted.fbrush --focus-map map.png",
    "export painted.fbrush --web page.html --apertures 1,2",
    "compare scene.exr truth.exr --error-map errors.png",
];

/// Files that a folder had before, and what a command prints there, and every file that it wrote.
fn outcome(programs: &Programs, on_windows: bool) -> BTreeMap<String, Vec<u8>> {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("a folder");
    inputs::write(&folder);
    let given = names(&folder);
    let mut results = BTreeMap::new();
    for command in COMMANDS {
        let started = std::time::Instant::now();
        let output = programs.command(on_windows, &folder).args(command.split_whitespace()).output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        let which = if on_windows { "Windows" } else { "here" };
        eprintln!("{which}: {:.1} s: {command}", started.elapsed().as_secs_f64());
        let printed = String::from_utf8_lossy(&output.stdout).replace("\r\n", "\n").replace('\\', "/");
        let failed = if output.status.success() { String::new() } else { format!("FAILED: {errors}") };
        if !output.status.success() {
            eprintln!("{which}: FAILED {}: {errors}", output.status);
        }
        results.insert(format!("printed by: {command}"), (printed + &failed).into_bytes());
    }
    let written = names(&folder).into_iter().filter(|file| !given.contains(file));
    results.extend(written.map(|file| (file.clone(), std::fs::read(folder.join(file)).unwrap())));
    results
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    let files = entries.filter(|entry| entry.file_type().unwrap().is_file());
    files.map(|entry| entry.file_name().into_string().unwrap()).collect()
}

#[test]
fn files_have_the_same_bytes_on_windows() {
    let Some(programs) = Programs::find() else { return };
    let (here, windows) = (outcome(programs, false), outcome(programs, true));
    assert_eq!(here.keys().collect::<Vec<_>>(), windows.keys().collect::<Vec<_>>());
    assert!(here.values().all(|bytes| !bytes.starts_with(b"FAILED")), "commands failed here, see above");
    let files = here.keys().filter(|name| !name.starts_with("printed by")).count();
    assert!(files >= 22, "{:?}", here.keys());
    let different: Vec<_> = here.iter().filter(|(name, bytes)| windows[*name] != **bytes).collect();
    for (name, bytes) in &different {
        let other = &windows[*name];
        let first = bytes.iter().zip(other).position(|(a, b)| a != b);
        let counted = bytes.iter().zip(other).filter(|(a, b)| a != b).count();
        eprintln!("{name}: {} and {} bytes, {counted} differ, first at {first:?}", bytes.len(), other.len());
        if name.starts_with("printed by") {
            eprintln!("{}\n-----\n{}", String::from_utf8_lossy(bytes), String::from_utf8_lossy(other));
        }
    }
    eprintln!("{files} files written by {} commands, {} differ", COMMANDS.len(), different.len());
    assert!(different.is_empty(), "{:?}", different.iter().map(|(name, _)| name).collect::<Vec<_>>());
}

#[test]
fn doctor_tells_what_windows_has() {
    let Some(programs) = Programs::find() else { return };
    let folder = tempfile::tempdir().unwrap();
    let output = programs.command(true, folder.path()).args(["doctor", "--json"]).output().unwrap();
    let printed = String::from_utf8_lossy(&output.stdout);
    eprintln!("{printed}");
    let told: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(told["command_line_works"], true);
    assert_eq!(told["missing_libraries"].as_array().map(Vec::len), Some(0));
    assert!(!printed.contains("apt-get"));
    let text = programs.command(true, folder.path()).arg("doctor").output().unwrap();
    assert!(!text.stdout.contains(&0x1b), "no colours where there is no console");
}

#[test]
fn a_killed_program_leaves_the_old_file() {
    let Some(programs) = Programs::find() else { return };
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("a folder");
    inputs::write(&folder);
    std::fs::write(folder.join("field.salf"), "old").unwrap();
    // Large enough to be killed while it works.
    let large = "bake demo/demo.glb --camera demo/demo.camera.json --size 640x360 -o field.salf";
    for wait in [300, 1500, 4000] {
        let mut child = programs.command(true, &folder).args(large.split_whitespace()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait));
        let ended = child.try_wait().unwrap().is_some();
        let _ = child.kill();
        child.wait().unwrap();
        if !ended {
            assert_eq!(std::fs::read(folder.join("field.salf")).unwrap(), b"old", "killed after {wait} ms");
        }
    }
    let small = "bake scene.glb --camera camera.json -o field.salf";
    let output = programs.command(true, &folder).args(small.split_whitespace()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(std::fs::metadata(folder.join("field.salf")).unwrap().len() > 1000);
    let left: Vec<_> = names(&folder).into_iter().filter(|name| name.starts_with(".field")).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_full_disk_leaves_the_old_file() {
    let Some(programs) = Programs::find() else { return };
    let parent = tempfile::tempdir().unwrap();
    let (folder, disk) = (parent.path().join("a folder"), parent.path().join("disk"));
    inputs::write(&folder);
    std::fs::create_dir(&disk).unwrap();
    let mount = |arguments: &[&str]| {
        let status = std::process::Command::new(arguments[0]).args(&arguments[1..]).arg(&disk).status();
        status.is_ok_and(|status| status.success())
    };
    if !mount(&["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs"]) {
        eprintln!("SKIPPED: a small disk cannot be mounted (only root may)");
        return;
    }
    std::fs::write(disk.join("field.salf"), "old").unwrap();
    let command = "bake scene.glb --camera camera.json -o ../disk/field.salf";
    let output = programs.command(true, &folder).args(command.split_whitespace()).output().unwrap();
    let (old, left) = (std::fs::read(disk.join("field.salf")).unwrap(), names(&disk));
    mount(&["umount"]);
    let errors = String::from_utf8_lossy(&output.stderr);
    eprintln!("{}: {errors}", output.status);
    assert!(!output.status.success());
    assert_eq!(errors.lines().filter(|line| line.starts_with("error: ")).count(), 1, "{errors}");
    assert_eq!(old, b"old");
    assert_eq!(left, ["field.salf"]);
}

#[test]
fn long_paths_and_other_scripts_are_names_like_others() {
    let Some(programs) = Programs::find() else { return };
    // The second is longer than the 260 characters of old programs; Windows' working folder itself cannot be.
    for long in ["Ω b".repeat(20), vec!["Ω b".repeat(20); 5].join("/")] {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join(&long);
        inputs::write(&folder);
        for [command, input, output] in [
            ["new", "folder/scene.gltf", "Ωß.fbrush"],
            ["render", "Ωß.fbrush", "Ωß.png"],
            ["bake", "folder/scene.gltf", "λ.salf"],
            ["render", "λ.salf", "λ.png"],
        ] {
            let named = |name: &str| format!("{long}/{name}");
            let mut program = programs.command(true, parent.path());
            program.args([command, &named(input), "-o", &named(output)]);
            if input.ends_with(".gltf") {
                program.args(["--camera", &named("camera.json")]);
            }
            let done = program.output().unwrap();
            let errors = String::from_utf8_lossy(&done.stderr);
            if errors.contains("os error 234") {
                eprintln!(
                    "SKIPPED: this Wine resolves no path of more than 260 characters (Wine 8 does not)"
                );
                return;
            }
            assert!(done.status.success(), "{command} {input}: {errors}");
        }
        assert!(folder.join("Ωß.png").exists() && folder.join("λ.png").exists());
    }
}

#[test]
fn kinds_of_files_are_registered_and_unregistered() {
    let Some(programs) = Programs::find() else { return };
    let registered = || programs.tool(&["reg", "query", "HKCU\\Software\\Classes\\FocusBrush.Project", "/s"]);
    let (done, said) = programs.tool(&["cmd", "/c", "register.cmd"]);
    assert!(done && said.contains("focus-brush-window.exe"), "{said}");
    let (known, entries) = registered();
    assert!(known && entries.contains("focus-brush-window.exe\" \"%1\""), "{entries}");
    assert!(programs.tool(&["cmd", "/c", "unregister.cmd"]).0);
    assert!(!registered().0);
}

#[test]
fn nothing_but_the_program_is_packed() {
    let Some(programs) = Programs::find() else { return };
    let packed = programs.packed();
    assert!(packed.iter().any(|name| name == "focus-brush-window.exe"), "{packed:?}");
    assert!(packed.iter().all(|name| !name.ends_with(".dll")), "{packed:?}");
}
