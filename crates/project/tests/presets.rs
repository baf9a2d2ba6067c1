//! Presets: saved, found, renamed, deleted, brought from elsewhere; and what is no preset.

use focus::{Brush, BrushMode};
use glam::DVec2;
use lens::{Aperture, ApertureMask, ApertureShape, Camera, FocusOffset};
use project::{LensPreset, Preset, PresetContent, PresetKind, PresetLibrary};
use std::sync::Arc;

fn brush() -> Brush {
    Brush {
        radius: 7.0,
        hardness: 0.25,
        flow: 0.5,
        mode: BrushMode::Add,
        target: FocusOffset::new(1.25, 0.5),
        mirror: [true, false, false],
        drawn_falloff: focus::Curve::new([[0.0, 1.0], [0.5, 0.25], [1.0, 0.0]]),
        ..Brush::default()
    }
}

#[test]
fn a_preset_is_saved_listed_renamed_and_deleted_but_never_lost() {
    let folder = tempfile::tempdir().unwrap();
    let mut shelf = PresetLibrary::open(Some(folder.path().join("presets")));
    let shipped = shelf.entries_of_kind(PresetKind::Brush).count();
    assert!(shipped >= 10 && shelf.entries_of_kind(PresetKind::Brush).all(|entry| entry.file.is_none()));

    let preset = Preset::new(" Ärmel/../x ", PresetContent::Brush(Box::new(brush()))).unwrap();
    assert_eq!(preset.name, "Ärmel/../x");
    let file = shelf.save(&preset).unwrap();
    assert_eq!(file.parent().unwrap(), folder.path().join("presets/brush"), "whatever its name is");
    assert_eq!(shelf.entries_of_kind(PresetKind::Brush).count(), shipped + 1);
    // Size and symmetry stay those of the brush in hand.
    let current = Brush { radius: 0.3, ..Brush::default() };
    let mut wanted = Brush { radius: 0.3, mirror: [false; 3], ..brush() };
    assert_eq!(
        shelf.find(PresetKind::Brush, "Ärmel/../x").unwrap().apply_to_brush(&current),
        Some(wanted.clone())
    );
    // Saved again it takes its own place; one of another kind has another.
    wanted.strength = 0.5;
    let again = Preset::new("Ärmel/../x", PresetContent::Brush(Box::new(wanted))).unwrap();
    assert_eq!(shelf.save(&again).unwrap(), file);
    let lens = PresetContent::Lens(LensPreset::from_camera(&Camera::default()));
    shelf.save(&Preset::new("Ärmel/../x", lens).unwrap()).unwrap();
    assert_eq!(
        shelf.find(PresetKind::Brush, "Ärmel/../x").unwrap().apply_to_brush(&current).unwrap().strength,
        0.5
    );

    assert!(shelf.rename(&file, "Soft sharp").is_err(), "the name of a shipped one");
    assert!(shelf.rename(&file, "  ").is_err());
    shelf.rename(&file, "Mine").unwrap();
    assert!(shelf.find(PresetKind::Brush, "Ärmel/../x").is_none());
    let kept = shelf.delete(&file).unwrap();
    assert!(kept.is_file() && !file.exists());
    assert_eq!(shelf.entries_of_kind(PresetKind::Brush).count(), shipped);
    // And back.
    assert_eq!(shelf.import(&kept).unwrap().name, "Mine");
    assert_eq!(shelf.entries_of_kind(PresetKind::Brush).count(), shipped + 1);
}

#[test]
fn a_mask_travels_within_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let transmission: Vec<f32> = (0..24).map(|k| (k * 10) as f32 / 255.0).collect();
    let mask = ApertureMask { width: 6, height: 4, transmission, file: "cat.png".into() };
    let aperture = Aperture { shape: ApertureShape::Mask(Arc::new(mask)), ratio: 1.5 };
    let preset = Preset::new("Cat", PresetContent::Bokeh(aperture.clone())).unwrap();
    let file = folder.path().join("cat.json");
    preset.write(&file).unwrap();
    let read = Preset::read(&file).unwrap();
    assert_eq!(read, preset);
    assert_eq!(read.apply_to_camera(&Camera::default()).unwrap().unwrap().aperture, aperture);
    // Large ones are averaged.
    let large = ApertureMask {
        width: 2048,
        height: 1024,
        transmission: (0..2048 * 1024).map(|k| f32::from(k % 2048 < 1024)).collect(),
        file: String::new(),
    };
    let large =
        Preset::new("Half", PresetContent::Bokeh(ApertureShape::Mask(Arc::new(large)).into())).unwrap();
    large.write(&file).unwrap();
    let PresetContent::Bokeh(read) = Preset::read(&file).unwrap().content else { panic!("a bokeh") };
    let ApertureShape::Mask(mask) = &read.shape else { panic!("a mask") };
    assert_eq!((mask.width, mask.height), (512, 512));
    assert_eq!([-0.5, 0.5].map(|u| read.transmission(DVec2::new(u, 0.3))), [1.0, 0.0]);
}

#[test]
fn what_is_no_preset_is_refused_by_name_and_place_and_hides_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("odd.json");
    let head = r#""format": "focus-brush preset", "version": 1, "name": "x""#;
    let cases = [
        ("{", "JSON"),
        ("[]", "object"),
        (r#"{"name": "x", "lens": {}}"#, "is no preset"),
        (r#"{"format": "focus-brush preset", "version": 9, "name": "x"}"#, "version 9"),
        (r#"{"format": "focus-brush preset", "name": "x"}"#, "one of brush, lens and bokeh"),
        (&format!(r#"{{{head}, "brush": {{}}, "bokeh": {{}}}}"#), "one of brush, lens and bokeh"),
        (&format!(r#"{{{head}, "lens": {{"focal_length": 0.05, "sensor_height": 0.024}}}}"#), "f_number"),
        (
            &format!(r#"{{{head}, "lens": {{"focal_length": -1, "f_number": 2, "sensor_height": 1}}}}"#),
            "lens.focal_length: is -1",
        ),
        (&format!(r#"{{{head}, "brush": {{"radius": 1}}}}"#), "brush.radius: belongs to the scene"),
        (&format!(r#"{{{head}, "brush": {{"hardnes": 1}}}}"#), "hardnes"),
        (&format!(r#"{{{head}, "brush": {{"hardness": 7}}}}"#), "hardness must be in [0, 1]"),
        (&format!(r#"{{{head}, "bokeh": {{"shape": "polygon", "blades": 1}}}}"#), "blades"),
        (&format!(r#"{{{head}, "bokeh": {{"shape": "mask", "mask": "none.png"}}}}"#), "none.png"),
        (&format!(r#"{{{head}, "bokeh": {{"shape": "mask", "mask": {{"rows": ["ff", "f"]}}}}}}"#), "rows"),
        (&format!(r#"{{{head}, "bokeh": {{"shape": "mask", "mask": {{"rows": ["00", "00"]}}}}}}"#), "mask"),
        (&format!(r#"{{{head}, "bokeh": {{"shape": "mask", "mask": {{"rows": []}}}}}}"#), "mask"),
        (r#"{"format": "focus-brush preset", "name": " ", "bokeh": {}}"#, "name"),
    ];
    for (text, place) in cases {
        std::fs::write(&file, text).unwrap();
        let error = Preset::read(&file).unwrap_err().to_string();
        let names_file = error.contains("odd.json") || place == "none.png";
        assert!(names_file && error.contains(place) && error.contains('('), "{text}: {error}");
        assert!(!error.contains('\n'), "{error}");
    }
    // On the shelf it is listed with what is wrong, beside the others.
    let own = folder.path().join("presets/bokeh");
    std::fs::create_dir_all(&own).unwrap();
    std::fs::copy(&file, own.join("odd.json")).unwrap();
    let shelf = PresetLibrary::open(Some(folder.path().join("presets")));
    let odd = shelf.entries_of_kind(PresetKind::Bokeh).last().unwrap();
    assert_eq!(odd.name(), "odd");
    assert!(odd.preset.as_ref().unwrap_err().contains("odd.json"));
    assert!(shelf.find(PresetKind::Bokeh, "Heart").is_some());
    // Without a folder there are the shipped ones, and nothing can be saved.
    let mut nowhere = PresetLibrary::open(None);
    let lens = PresetContent::Lens(LensPreset::from_camera(&Camera::default()));
    assert!(nowhere.save(&Preset::new("x", lens).unwrap()).is_err());
    assert!(nowhere.entries_of_kind(PresetKind::Lens).count() >= 10);
}
