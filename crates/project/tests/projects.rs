//! Saving and loading documents.

mod damage;

use damage::{damage, is_one_line};
use focus::{Brush, BrushMode, FocusMap};
use lens::{Aperture, ApertureMask, ApertureShape, Camera, Exposure, FocusOffset};
use project::{
    CaptureChoices, NamedCamera, ProjectError, ProjectFile, SceneState, SplatsFile, TexelSet, Thumbnail,
    find_recovery, recovery_path_for, remove_recovery, unsaved_recovery_path,
};
use relief::{DepthRepair, DepthStroke};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

/// What a project's manifest says.
fn manifest(file: &Path) -> serde_json::Value {
    let mut zip = zip::ZipArchive::new(std::fs::File::open(file).unwrap()).unwrap();
    serde_json::from_reader(zip.by_name("manifest.json").unwrap()).unwrap()
}

fn document(folder: &Path) -> ProjectFile {
    std::fs::create_dir_all(folder.join("models")).unwrap();
    let scene = folder.join("models/scene.glb");
    std::fs::write(&scene, b"a scene").unwrap();
    let transmission = vec![0.0, 0.25, 1.0 / 3.0, 0.5, 0.75, 1.0];
    let mask = ApertureMask { width: 3, height: 2, transmission, file: "bokeh/heart.png".into() };
    let masked = Camera {
        yfov: 0.1 + 0.2,
        focus_distance: f64::INFINITY,
        aperture: Aperture { shape: ApertureShape::Mask(Arc::new(mask)), ratio: 1.5 },
        ..Camera::default()
    };
    let mut map = FocusMap::new(130, 70, FocusOffset::STANDARD);
    map.background = FocusOffset::new(1.1, 0.3);
    for i in 0..70 {
        map.set(i, i, [i as f32 / 7.0, 1.0 / (1.0 + i as f32)]);
    }
    let cameras = [("shot", Camera::default()), ("masked", masked)];
    let cameras = cameras.map(|(name, camera)| NamedCamera { name: name.into(), camera, focus_hold: None });
    ProjectFile {
        active_camera: 1,
        exposure: Exposure::Conserve,
        brush: Brush { radius: 1.0 / 3.0, mode: BrushMode::Smooth, ..Brush::default() },
        view: serde_json::json!({"panels": [1, 2], "orbit": 0.1}),
        atlas: Some((0..=255).cycle().take(5000).collect()),
        surface: Some(b"a surface".to_vec()),
        background_focus: map.background,
        focus_map: Some(map),
        thumbnail: Some(Thumbnail::from_linear(2, 1, vec![[0.25; 3], [1.0, 0.0, 0.5]])),
        ..ProjectFile::new(&scene, cameras.into()).unwrap()
    }
}

#[test]
fn the_selection_is_restored_and_a_brush_mirrored_by_objects_raises_the_version() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("selected.fbrush");
    let texels =
        (0..70).flat_map(|y| (0..130).map(move |x| [x, y])).filter(|[x, y]| (x * 7 + y * 3) % 5 == 0);
    let selected =
        ProjectFile { selection: Some(TexelSet::new([130, 70], texels)), ..document(folder.path()) };
    selected.save(&file).unwrap();
    assert_eq!(ProjectFile::load(&file).unwrap(), selected);
    let version = |file: &Path| manifest(file)["version"].clone();
    assert_eq!(version(&file), 1, "older programs let everything be painted");
    let brush = Brush { mirror: [true, false, false], mirror_by_object: true, ..Brush::default() };
    let mirrored = ProjectFile { brush, ..selected.clone() };
    mirrored.save(&file).unwrap();
    assert_eq!(ProjectFile::load(&file).unwrap(), mirrored);
    assert_eq!(version(&file), 3, "older programs could not read the brush");
    let wrong = ProjectFile { selection: Some(TexelSet::new([70, 130], std::iter::empty())), ..selected };
    let error = wrong.save(&file).unwrap_err().to_string();
    assert!(error.contains("selection"), "{error}");
    assert_eq!(ProjectFile::load(&file).unwrap(), mirrored, "the old file stays");
}

#[test]
fn layers_are_restored_and_a_plain_document_keeps_its_old_version() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("layers.fbrush");
    let plain = document(folder.path());
    plain.save(&file).unwrap();
    assert_eq!((&manifest(&file)["version"], manifest(&file).get("layers")), (&1.into(), None));

    let mut masked = FocusMap::transparent(130, 70);
    masked.set(5, 6, [0.8, 0.25]);
    masked.background = FocusOffset::SHARP;
    let mut rows = masked.mask_rows().unwrap();
    rows[6 * 130 + 5] = 0.75;
    assert!(masked.set_mask_rows(Some(&rows)) && !masked.set_mask_rows(Some(&rows[1..])));
    masked.background_mask = 0.5;
    let curve = focus::DepthCurve::sharp_between(0.5, 20.0).unwrap();
    let layers = vec![
        focus::FocusLayer::from_map("Paint", plain.focus_map.clone().unwrap()),
        focus::FocusLayer {
            opacity: 0.3,
            blend: focus::BlendMode::MultiplyDefocus,
            is_visible: false,
            ..focus::FocusLayer::from_map("far \"lamp\"", masked)
        },
        focus::FocusLayer {
            adjustment: Some(focus::Adjustment::Curve(curve)),
            ..focus::FocusLayer::from_map("surface", FocusMap::new(130, 70, FocusOffset::STANDARD))
        },
    ];
    let layers = focus::LayerStack::new(layers, 1).unwrap();
    let layered = ProjectFile { layers: Some(layers.clone()), ..plain };
    layered.save(&file).unwrap();
    assert_eq!(manifest(&file)["version"], 2);
    let again = ProjectFile::load(&file).unwrap();
    assert!(again == layered);

    // A focal plane is more than older programs know.
    let points = [[0.0, 0.0, -2.0], [1.0, 0.0, -2.0], [0.0, 1.0, -3.0]].map(glam::DVec3::from_array);
    let plane = focus::FocalPlane { curvature: -0.25, ..focus::FocalPlane::through(points).unwrap() };
    let plane = focus::FocusLayer {
        adjustment: Some(focus::Adjustment::Plane(plane)),
        ..focus::FocusLayer::from_map("plane", FocusMap::new(130, 70, FocusOffset::STANDARD))
    };
    let stack = focus::LayerStack::new(vec![layers.layers()[0].clone(), plane], 1).unwrap();
    let planar = ProjectFile { layers: Some(stack), ..layered.clone() };
    planar.save(&file).unwrap();
    assert_eq!(manifest(&file)["version"], 4);
    assert!(ProjectFile::load(&file).unwrap() == planar);

    // Older programs would show the scene's own materials in the place of a variant.
    let varied = ProjectFile { variant: Some("Midnight \"blue\"".into()), ..planar.clone() };
    varied.save(&file).unwrap();
    assert_eq!(manifest(&file)["version"], 5);
    assert!(ProjectFile::load(&file).unwrap() == varied && varied != planar);
    layered.save(&file).unwrap();
    assert_eq!((&manifest(&file)["version"], manifest(&file).get("variant")), (&2.into(), None));

    // They would take gloss that obeys the paint for gloss that does not: in the map, in a layer, of the background, in hand.
    let glossy = FocusOffset::new(1.1, 0.5).with_gloss(0.5);
    let in_map = |changed: &dyn Fn(&mut FocusMap)| {
        let mut map = varied.focus_map.clone().unwrap();
        changed(&mut map);
        map
    };
    let painted = in_map(&|map| map.set_gloss(100, 3, 0.25));
    let behind = in_map(&|map| map.background = glossy);
    let layer = focus::FocusLayer::from_map("glossy", painted.clone());
    let stack = focus::LayerStack::new(vec![layers.layers()[0].clone(), layer], 1).unwrap();
    for glossy in [
        ProjectFile { focus_map: Some(painted), ..varied.clone() },
        ProjectFile { background_focus: behind.background, focus_map: Some(behind), ..varied.clone() },
        ProjectFile { layers: Some(stack), ..varied.clone() },
        ProjectFile { brush: Brush { target: glossy, ..Brush::default() }, ..varied.clone() },
    ] {
        glossy.save(&file).unwrap();
        assert_eq!(manifest(&file)["version"], 6);
        assert!(ProjectFile::load(&file).unwrap() == glossy && glossy != varied);
    }
    // What is painted and taken away again leaves nothing.
    let blank = in_map(&|map| [0.25, 0.0].into_iter().for_each(|gloss| map.set_gloss(100, 3, gloss)));
    ProjectFile { focus_map: Some(blank), ..varied.clone() }.save(&file).unwrap();
    assert_eq!(manifest(&file)["version"], 5);
    assert!(!manifest(&file).to_string().contains("gloss"));
    layered.save(&file).unwrap();

    // What cannot be is refused, on saving and on opening.
    let small = focus::LayerStack::from_map(FocusMap::new(4, 4, FocusOffset::STANDARD));
    let error = ProjectFile { layers: Some(small), ..layered.clone() }.save(&file).unwrap_err();
    assert!(error.to_string().contains("layers"), "{error}");
    let broken = repack(&file, &|name, bytes| match name {
        "manifest.json" => {
            let text = String::from_utf8(bytes).unwrap();
            text.replacen("\"opacity\": 0.3", "\"opacity\": 3.0", 1).into_bytes()
        }
        _ => bytes,
    });
    let error = ProjectFile::load(&broken).unwrap_err().to_string();
    assert!(error.contains("layers that cannot be used"), "{error}");
    let damaged = repack(&file, &|name, bytes| match name {
        "layers/1.mask.f32" => bytes[4..].into(),
        _ => bytes,
    });
    assert!(ProjectFile::load(&damaged).unwrap_err().to_string().contains("layers/1.mask.f32"));
}

#[test]
fn documents_come_back_the_same() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("work.fbrush");
    let document = document(folder.path());
    document.save(&file).unwrap();
    let read = ProjectFile::load(&file).unwrap();
    assert_eq!(read, document);
    assert_eq!(read.scene_state(), SceneState::Same);
    // The same document gives the same bytes, and a save leaves nothing else in the folder.
    let bytes = std::fs::read(&file).unwrap();
    read.save(&file).unwrap();
    assert_eq!(std::fs::read(&file).unwrap(), bytes);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);

    let bare = ProjectFile { atlas: None, focus_map: None, view: serde_json::Value::Null, ..document };
    bare.save(&file).unwrap();
    assert_eq!(ProjectFile::load(&file).unwrap(), bare);
}

#[test]
fn the_manifest_is_first_and_is_json() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("work.fbrush");
    document(folder.path()).save(&file).unwrap();
    let mut zip = zip::ZipArchive::new(std::fs::File::open(&file).unwrap()).unwrap();
    let mut text = String::new();
    let mut first = zip.by_index(0).unwrap();
    assert_eq!(first.name().unwrap(), "manifest.json");
    first.read_to_string(&mut text).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(manifest["scene"]["path"], "models/scene.glb");
    assert_eq!(manifest["version"], 1);
}

#[test]
fn project_and_scene_move_together() {
    let folder = TempDir::new().unwrap();
    let (old, new) = (folder.path().join("old"), folder.path().join("new"));
    let document = document(&old);
    std::fs::create_dir(old.join("shots")).unwrap();
    document.save(&old.join("shots/work.fbrush")).unwrap();
    std::fs::rename(&old, &new).unwrap();
    let read = ProjectFile::load(&new.join("shots/work.fbrush")).unwrap();
    assert_eq!(read.scene, new.join("models/scene.glb"));
    assert_eq!(read.scene_state(), SceneState::Same);
    std::fs::write(&read.scene, b"another scene").unwrap();
    assert_eq!(read.scene_state(), SceneState::Changed);
    std::fs::remove_file(&read.scene).unwrap();
    assert_eq!(read.scene_state(), SceneState::Missing);
}

#[test]
fn damaged_projects_are_errors() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("work.fbrush");
    let document = document(folder.path());
    document.save(&file).unwrap();
    // A changed byte is found by a checksum, or lies where nothing is read (dates, say): then all is the same.
    damage(&file, |file| {
        let read = ProjectFile::load(file)?;
        assert_eq!(ProjectFile { scene: document.scene.clone(), ..read }, document);
        Ok::<_, ProjectError>(())
    });
    let whole = std::fs::read(&file).unwrap();
    for place in (0..whole.len()).step_by(7) {
        let mut changed = whole.clone();
        changed[place] ^= 0xff;
        std::fs::write(&file, &changed).unwrap();
        match ProjectFile::load(&file) {
            Ok(read) => assert_eq!(read, document, "byte {place}"),
            Err(error) => is_one_line(&error.to_string(), &file),
        }
    }
}

/// What to make of an entry, by its name and bytes.
type Change<'a> = &'a dyn Fn(&str, Vec<u8>) -> Vec<u8>;

/// The entries of a project, changed, in a new file.
fn repack(file: &Path, change: Change<'_>) -> PathBuf {
    let mut zip = zip::ZipArchive::new(std::fs::File::open(file).unwrap()).unwrap();
    let target = file.with_file_name("repacked.fbrush");
    let mut new = zip::ZipWriter::new(std::fs::File::create(&target).unwrap());
    for index in 0..zip.len() {
        let mut entry = zip.by_index(index).unwrap();
        let name = entry.name().unwrap().into_owned();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        new.start_file(&*name, zip::write::SimpleFileOptions::default()).unwrap();
        new.write_all(&change(&name, bytes)).unwrap();
    }
    new.finish().unwrap();
    target
}

#[test]
fn repaired_depth_is_saved_and_raises_the_version() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("work.fbrush");
    let stroke = DepthStroke {
        repair: DepthRepair::Spread,
        path: vec![[12.5, 3.25], [40.0, -1.0]],
        radius_px: 7.5,
        hardness: 0.5,
        strength: 1.0,
    };
    let choices = CaptureChoices { depth_strokes: vec![stroke], ..CaptureChoices::default() };
    let project = ProjectFile { capture: Some(choices.clone()), ..document(folder.path()) };
    project.save(&file).unwrap();
    assert_eq!(manifest(&file)["version"], 7);
    assert_eq!(ProjectFile::load(&file).unwrap().capture, Some(choices));
    let wide = |name: &str, bytes: Vec<u8>| match name {
        "manifest.json" => String::from_utf8(bytes).unwrap().replacen("7.5", "1e30", 1).into_bytes(),
        _ => bytes,
    };
    let error = ProjectFile::load(&repack(&file, &wide)).unwrap_err().to_string();
    assert!(error.contains("capture.depth_strokes has a stroke beyond all pictures"), "{error}");
}

#[test]
fn edited_splats_are_saved_and_raise_the_version() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("scan.fbrush");
    let edit = scene::SplatEdit::default().hiding([3, 4, 9]);
    let splats = SplatsFile { file: Some(folder.path().join("scan.ply")), edit };
    let project = ProjectFile { splats: Some(splats), ..document(folder.path()) };
    project.save(&file).unwrap();
    assert_eq!(ProjectFile::load(&file).unwrap(), project);
    assert_eq!(
        (&manifest(&file)["version"], &manifest(&file)["splats"]["file"]),
        (&10.into(), &"scan.ply".into())
    );
}

#[test]
fn a_chosen_layer_is_saved_and_raises_the_version() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("work.fbrush");
    let choices = CaptureChoices { layer: Some("ViewLayer_001".into()), ..CaptureChoices::default() };
    let project = ProjectFile { capture: Some(choices.clone()), ..document(folder.path()) };
    project.save(&file).unwrap();
    assert_eq!(manifest(&file)["version"], 8);
    assert_eq!(ProjectFile::load(&file).unwrap().capture, Some(choices));
}

#[test]
fn wrong_content_is_reported_with_its_entry() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("work.fbrush");
    document(folder.path()).save(&file).unwrap();
    let in_manifest = |from: &'static str, to: &'static str| {
        move |name: &str, bytes: Vec<u8>| match name {
            "manifest.json" => String::from_utf8(bytes).unwrap().replacen(from, to, 1).into_bytes(),
            _ => bytes,
        }
    };
    let load = |change: Change<'_>| {
        let target = repack(&file, change);
        let result = ProjectFile::load(&target);
        if let Err(error) = &result {
            is_one_line(&error.to_string(), &target);
        }
        result.map_err(|error| error.to_string())
    };
    assert!(load(&|_, bytes| bytes).is_ok());
    let cases: [(Change<'_>, &str); 8] = [
        (&in_manifest("\"version\": 1", "\"version\": 12"), "update the program"),
        (&in_manifest("focus-brush project", "shopping list"), "shopping list"),
        (&in_manifest("\"active_camera\": 1", "\"active_camera\": 2"), "camera 2 of 2"),
        (&in_manifest("\"width\": 130", "\"width\": 131"), "focus.f32"),
        (&in_manifest("\"width\": 130", "\"width\": 4000000000"), "focus.f32"),
        (&in_manifest("\"yfov\": ", "\"yfov\": -"), "yfov"),
        (&|name, bytes| if name == "focus.f32" { bytes[8..].into() } else { bytes }, "focus.f32: is damaged"),
        // Much larger than it says: unpacking stops at the limit.
        (&|name, bytes| if name == "focus.f32" { vec![0; 64 << 20] } else { bytes }, "focus.f32: is larger"),
    ];
    for (change, expected) in cases {
        let error = load(change).unwrap_err();
        assert!(error.contains(expected), "{error} should contain {expected}");
    }
    // A field that a later program of the same version adds is let pass.
    load(&in_manifest("\"version\": 1", "\"version\": 1, \"mood\": \"good\"")).unwrap();
}

#[test]
fn the_old_file_survives_a_save_that_fails() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("work.fbrush");
    let good = document(folder.path());
    good.save(&file).unwrap();
    let mut bad = good.clone();
    bad.focus_map.as_mut().unwrap().set(3, 3, [f32::NAN, 0.0]);
    is_one_line(&bad.save(&file).unwrap_err().to_string(), &file);
    let bad = ProjectFile { active_camera: 7, ..good.clone() };
    assert!(bad.save(&file).is_err());
    assert!(matches!(good.save(&folder.path().join("no/such/work.fbrush")), Err(ProjectError::Write { .. })));
    assert!(matches!(good.save(folder.path()), Err(ProjectError::Write { .. })));
    assert_eq!(ProjectFile::load(&file).unwrap(), good);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "no temporary file is left");
}

#[test]
fn recovery_is_offered_while_it_is_newer() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("work.fbrush");
    let saved = document(folder.path());
    saved.save(&file).unwrap();
    let recovery = recovery_path_for(&file);
    assert_eq!(recovery, folder.path().join("work.fbrush.recovery"));
    assert_eq!(find_recovery(&recovery, Some(&file)), None);
    let unsaved = ProjectFile { active_camera: 0, ..saved.clone() };
    unsaved.save(&recovery).unwrap();
    assert_eq!(find_recovery(&recovery, Some(&file)), Some(unsaved.clone()));
    assert_eq!(find_recovery(&recovery, None), Some(unsaved));
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(10);
    std::fs::File::options().write(true).open(&file).unwrap().set_modified(later).unwrap();
    assert_eq!(find_recovery(&recovery, Some(&file)), None, "saved since");
    remove_recovery(&recovery).unwrap();
    remove_recovery(&recovery).unwrap();
    assert!(!recovery.exists());
    let unsaved = ["a/scene.glb", "b/scene.glb"].map(|scene| unsaved_recovery_path(Path::new(scene)));
    assert!(unsaved[0] != unsaved[1] && unsaved[0].to_string_lossy().contains("scene-"));
}
