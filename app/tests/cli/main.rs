//! The command line, end to end, on a small generated scene.

#[path = "../../../crates/session/tests/tiny_glb/mod.rs"]
mod tiny_glb;
mod workplace;

use project::{ProjectFile, read_picture};
use serde_json::Value;
use workplace::Workplace;

const SHOT: &str = "--camera camera.json --focus recipe.json";

#[test]
fn a_scene_is_told_about_rendered_and_kept_in_a_variant() {
    let place = Workplace::new();
    std::fs::write(place.path("varied.glb"), tiny_glb::varied(&tiny_glb::QUADS)).unwrap();
    let told = place.json("info varied.glb --json");
    let (known, chosen) = (&told["scene"]["variants"], &told["scene"]["variant"]);
    assert_eq!((known, chosen), (&serde_json::json!(["Blue", "Green", "As painted"]), &Value::Null));
    let lines = place.done("info varied.glb --variant Green");
    assert!(lines.contains("\"Blue\", \"Green\", \"As painted\" (chosen: \"Green\")"), "{lines}");
    assert!(!place.done("info quads.glb").contains("variants"));

    // The card fills the picture's middle, left.
    let card = |input: &str| {
        place.done(&format!("render {input} --camera camera.json -o out.exr"));
        let picture = read_picture(&place.path("out.exr")).unwrap();
        let color = picture.rgb[(picture.height / 2 * picture.width + picture.width * 3 / 8) as usize];
        let names = color.into_iter().zip(["red", "green", "blue"]);
        names.max_by(|a, b| a.0.total_cmp(&b.0)).map_or("", |(_, name)| name)
    };
    assert_eq!((card("varied.glb"), card("varied.glb --variant Blue")), ("red", "blue"));
    // A recipe by materials lists the visible ones.
    std::fs::write(place.path("blue.json"), r#"{"materials": {"blue paint": {"t": 1.2, "anchor": 1}}}"#)
        .unwrap();
    place.done("new varied.glb --variant Blue --focus blue.json --camera camera.json -o blue.fbrush");
    let project = ProjectFile::load(&place.path("blue.fbrush")).unwrap();
    assert_eq!(project.variant.as_deref(), Some("Blue"));
    assert!(project.focus_map.is_some_and(|map| map.to_rows().contains(&[1.2, 1.0])));
    assert_eq!(place.json("info blue.fbrush --json")["scene"]["variant"], "Blue");
    assert_eq!((card("blue.fbrush"), card("blue.fbrush --variant Green")), ("blue", "green"));
    place.done("bake varied.glb --variant Blue --camera camera.json -o blue.salf");
    assert_eq!(card("blue.salf"), "blue");
    place.fails(
        "render varied.glb --variant Pink -o x.exr",
        3,
        &["varied.glb", "\"Pink\"", "\"As painted\""],
    );
    place.fails("bake blue.fbrush --variant Pink -o x.salf", 3, &["varied.glb", "\"Pink\"", "\"Green\""]);
    place.fails("new quads.glb --variant Blue -o x.fbrush", 3, &["quads.glb", "\"Blue\"", "no variants"]);
    place.fails("info varied.glb --variant Pink", 3, &["varied.glb", "\"Pink\""]);
    place.fails("report varied.glb --variant Pink --quick -o x", 3, &["varied.glb", "\"Pink\""]);
}

#[test]
fn a_scene_is_lit_by_what_it_brings_unless_a_world_is_given() {
    let place = Workplace::new();
    std::fs::write(place.path("lit.glb"), tiny_glb::lit(&tiny_glb::QUADS[1..])).unwrap();
    assert_eq!(
        place.json("info lit.glb --json")["scene"]["image_based_light"],
        "image-based light six colours"
    );
    assert!(place.done("info lit.glb").contains("lit by       image-based light six colours"));
    std::fs::write(place.path("red.json"), r#"{"environment": [1, 0, 0]}"#).unwrap();
    std::fs::write(
        place.path("own.json"),
        r#"{"environment": "scene", "strength": 2, "rotation": 3.14159265}"#,
    )
    .unwrap();
    let corner = |world: &str| {
        place.done(&format!("render lit.glb --camera camera.json {world} -o out.exr"));
        read_picture(&place.path("out.exr")).unwrap().rgb[0]
    };
    // The camera faces −Z, where the environment is blue; rotated by half a turn, it sees the green of +Z.
    for (world, expected) in
        [("", [0.0, 0.0, 2.0]), ("--world red.json", [1.0, 0.0, 0.0]), ("--world own.json", [0.0, 4.0, 0.0])]
    {
        let seen = corner(world);
        assert!(seen.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.05), "{world}: {seen:?}");
    }
    place.fails("render quads.glb --world own.json -o x.exr", 3, &["quads.glb", "EXT_lights_image_based"]);
}

#[test]
fn a_sky_is_the_same_however_it_is_coded() {
    let place = Workplace::new();
    // Halves of other colours, the upper one with a bright texel, uncoded.
    let pixel =
        |x: usize, y: usize| [200, 100 + 100 * (y / 8) as u8, 2, if (x, y) == (20, 3) { 134 } else { 129 }];
    let sky = |head: &str, rows: &mut dyn Iterator<Item = usize>| -> Vec<u8> {
        head.bytes().chain(rows.flat_map(|y| (0..32).flat_map(move |x| pixel(x, y)))).collect()
    };
    let write = |name: &str, bytes: Vec<u8>| std::fs::write(place.path(name), bytes).unwrap();
    write("base.hdr", sky("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n", &mut (0..16)));
    write("rgbe.hdr", sky("#?RGBE\r\nGAMMA=1\r\n\r\n-Y 16 +X 32\r\n", &mut (0..16)));
    write("up.hdr", sky("#?RADIANCE\nEXPOSURE=1.0\n\n+Y 16 +X 32\n", &mut (0..16).rev()));
    let picture = |sky: &str| {
        place.done(&format!("render quads.glb --camera camera.json --world {sky} -o out.exr"));
        std::fs::read(place.path("out.exr")).unwrap()
    };
    let base = picture("base.hdr");
    assert!(picture("rgbe.hdr") == base && picture("up.hdr") == base);
    write("cut.hdr", sky("#?RADIANCE\n\n-Y 16 +X 32\n", &mut (0..15)));
    place.fails("render quads.glb --world cut.hdr -o x.exr", 3, &["cut.hdr", "scanline 16 of 16 is cut off"]);
}

#[test]
fn faults_of_a_sky_are_told() {
    let place = Workplace::new();
    let skies = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/cases/field2/14-exr-skies-with-faults");
    if !std::path::Path::new(skies).exists() {
        eprintln!("SKIPPED: {skies} is not there");
        return;
    }
    for (sky, told) in [("inf", "as 65504, the largest half"), ("nan", "not a number"), ("neg", "negative")] {
        let output =
            place.run(&format!("render quads.glb --camera camera.json --world {skies}/{sky}.exr -o out.exr"));
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{errors}");
        let warnings: Vec<_> = errors.lines().filter(|line| line.starts_with("warning: ")).collect();
        assert!(warnings.len() == 1 && warnings[0].contains(told), "{sky}: {errors}");
        assert!(warnings[0].contains(&format!("{sky}.exr: ")), "{errors}");
    }
}

#[test]
fn splat_and_truth_agree_and_the_blur_by_depth_does_not() {
    let place = Workplace::new();
    let report = place.json(&format!("render quads.glb {SHOT} -o splat.exr --json"));
    assert_eq!((report["width"].as_u64(), report["height"].as_u64()), (Some(96), Some(64)));
    assert!(report["salf"]["open_samples"].as_u64().unwrap() > 1000, "{report}");
    assert!(report["seconds"]["bake"].as_f64().unwrap() > 0.0, "{report}");
    place.done(&format!("render quads.glb {SHOT} --renderer truth --spp 256 -o truth.exr"));
    place.done(&format!("render quads.glb {SHOT} --renderer blur -o blur.exr"));
    let splat = place.psnr("splat.exr", "truth.exr");
    assert!(splat > 36.0, "splat against truth: {splat} dB");
    let blur = place.psnr("blur.exr", "truth.exr");
    assert!(blur < splat - 6.0, "the baseline cannot see behind the card: {blur} dB");
    // Negative control: another focus gives another picture.
    place.done("render quads.glb --camera camera.json -o unpainted.exr");
    let unpainted = place.psnr("unpainted.exr", "truth.exr");
    assert!(unpainted < splat - 6.0, "{unpainted} dB");
    assert_eq!(place.psnr("splat.exr", "splat.exr"), 200.0);
}

#[test]
fn more_cells_a_pixel_are_closer_to_the_truth() {
    let place = Workplace::new();
    place.done(&format!("render quads.glb {SHOT} --renderer truth --spp 1024 -o truth.exr"));
    let errors = [("", 1), ("--cells 2", 2), ("--tolerance 0", 3), ("--tolerance 0 --cells 1", 1)].map(
        |(how, cells)| {
            let report = place.json(&format!("render quads.glb {SHOT} {how} -o splat.exr --json"));
            assert_eq!(report["cells_a_side"].as_u64(), Some(cells), "{how}");
            assert_eq!(report["width"].as_u64(), Some(96));
            (place.psnr("splat.exr", "truth.exr"), report["salf"]["bytes"].as_u64().unwrap())
        },
    );
    let [(usual, usual_bytes), (twice, twice_bytes), (exact, _), (exact_once, _)] = errors;
    assert!(twice > usual + 3.0 && exact > exact_once + 3.0, "{errors:?}");
    assert!((2 * usual_bytes..6 * usual_bytes).contains(&twice_bytes), "{errors:?}");
    place.fails("render quads.glb --size 10000x10 --cells 2 -o x.exr", 3, &["cells", "width"]);
}

#[test]
fn baselines_draw_and_fall_short() {
    let place = Workplace::new();
    place.done(&format!("render quads.glb {SHOT} --renderer truth --spp 256 -o truth.exr"));
    place.done(&format!("render quads.glb {SHOT} -o splat.exr"));
    let splat = place.psnr("splat.exr", "truth.exr");
    for (baseline, knob) in [
        ("layers --layers 16", "layers"),
        ("views --views 3", "views_a_side"),
        ("scatter --rays 8", "rays_a_sample"),
    ] {
        let report = place.json(&format!("render quads.glb {SHOT} --renderer {baseline} -o base.exr --json"));
        let name = baseline.split(' ').next();
        assert_eq!(report["renderer"].as_str(), name);
        assert!(report[knob].as_u64().unwrap() >= 3, "{report}");
        let found = place.psnr("base.exr", "truth.exr");
        assert!((12.0..splat - 1.0).contains(&found), "{baseline}: {found} dB, the splat {splat} dB");
    }
    // More of it is better: ghosts vanish, noise goes.
    for (few, many) in [("views --views 3", "views --views 16"), ("scatter --rays 8", "scatter --rays 256")] {
        let [few, many] = [few, many].map(|baseline| {
            place.done(&format!("render quads.glb {SHOT} --renderer {baseline} -o base.exr"));
            place.psnr("base.exr", "truth.exr")
        });
        assert!(many > few + 2.0, "{few} dB, {many} dB");
    }
    // A baked light field can be scattered as it can be splatted.
    place.done(&format!("bake quads.glb {SHOT} -o quads.salf"));
    place.done("render quads.salf --focus recipe.json --renderer scatter --rays 8 -o baked.exr");
    place.done(&format!("render quads.glb {SHOT} --renderer scatter --rays 8 -o direct.exr"));
    assert_eq!(place.psnr("baked.exr", "direct.exr"), 200.0);
    place.fails("render quads.glb --renderer layers --layers 0 -o x.exr", 2, &["--layers"]);
    place.fails("render quads.glb --renderer views --views 65 -o x.exr", 2, &["--views"]);
}

#[test]
fn estimators_agree_within_their_errors_and_not_with_another_blur() {
    let place = Workplace::new();
    let render = |camera: &str, estimator: &str, file: &str| {
        place.done(&format!(
            "render quads.glb --camera {camera} --focus recipe.json --renderer truth --estimator {estimator} --spp 256 \
             --exposure conserve --aov stderr,coverage -o {file}"
        ));
    };
    render("camera.json", "sensor", "sensor.exr");
    render("camera.json", "surface", "surface.exr");
    let found = place.json("compare sensor.exr surface.exr --z-test --json");
    for key in ["z_agree", "z_agree_luminance"] {
        assert!(found[key].as_f64().unwrap() >= 0.995, "{found}");
    }
    assert!(found["z_agree_pixels"].as_f64().unwrap() > 0.98, "{found}");
    // Negative control: an aperture a tenth larger.
    let mut camera: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(place.path("camera.json")).unwrap()).unwrap();
    camera["aperture_radius"] = (camera["aperture_radius"].as_f64().unwrap() * 1.1).into();
    std::fs::write(place.path("wider.json"), camera.to_string()).unwrap();
    render("wider.json", "sensor", "wider.exr");
    let found = place.json("compare wider.exr sensor.exr --z-test --json");
    for key in ["z_agree", "z_agree_luminance"] {
        assert!(found[key].as_f64().unwrap() < 0.985, "{found}");
    }
    place.done("render quads.glb --camera camera.json --renderer blur -o blur.exr");
    place.fails("compare blur.exr blur.exr --z-test", 3, &["--aov stderr"]);
}

#[test]
fn comparisons_are_stable_and_show_where() {
    let place = Workplace::new();
    place.done("render quads.glb --camera camera.json --renderer blur -o a.exr");
    place.done(&format!("render quads.glb {SHOT} --renderer blur -o b.exr"));
    let found = place.json("compare a.exr b.exr --error-map map.png --json");
    // The interface for scripts: exactly these keys.
    let keys: std::collections::BTreeSet<_> = found.as_object().unwrap().keys().map(String::as_str).collect();
    let expected = [
        "flip",
        "height",
        "largest_difference",
        "psnr",
        "rel_mse",
        "rmse",
        "rmse_unclipped",
        "signed_mean_error",
        "signed_mean_error_clipped",
        "undefined_pixels",
        "width",
    ];
    assert_eq!(keys, expected.into());
    assert!(expected.iter().all(|key| found[key].is_number()), "{found}");
    assert_eq!(place.done("compare a.exr b.exr --json"), place.done("compare a.exr b.exr --json"));
    let map = read_picture(&place.path("map.png")).unwrap();
    assert_eq!((map.width, map.height), (96, 64));
    place.done("compare a.exr b.exr --error-map map.exr");
    let map = read_picture(&place.path("map.exr")).unwrap();
    let mean = map.layers["flip"].iter().map(|&f| f64::from(f)).sum::<f64>() / (96.0 * 64.0);
    assert!((mean - found["flip"].as_f64().unwrap()).abs() < 1e-3 && mean > 0.01, "{mean}");
    place.fails("compare a.exr b.exr --error-map map.bmp", 2, &["map.bmp"]);
    place.fails("compare a.exr b.exr --error-map none/map.png", 3, &["none/map.png"]);
}

#[test]
fn pictures_come_along() {
    let place = Workplace::new();
    place.done(&format!("render quads.glb {SHOT} --aov coverage,coc,depth,t --exposure conserve -o all.exr"));
    let picture = read_picture(&place.path("all.exr")).unwrap();
    let layer = |name: &str, x: usize, y: usize| picture.layers[name][y * 96 + x];
    // The card is 0.4 left of the middle at depth 2: 96 px are 2·tan(0.3)·2·1.5 wide there.
    let card = (48.0 - 0.4 / (2.0 * 0.3f64.tan() * 2.0 * 1.5) * 96.0) as usize;
    assert!((layer("depth.Z", card, 32) - 2.0).abs() < 1e-5);
    assert!((layer("depth.Z", 90, 60) - 4.0).abs() < 1e-5);
    assert_eq!((layer("t", card, 32), layer("anchor", card, 32)), (1.2, 1.0));
    assert_eq!(layer("coc", 90, 60), 0.0, "the wall is painted sharp");
    // A·(t − 1)/d/tanθ half-heights, d = h/(2·tanθ): far defocus is positive.
    let expected = 0.2 * 0.2 / (0.1 / (2.0 * 0.3f64.tan())) / 0.3f64.tan() * 32.0;
    assert!((layer("coc", card, 32) as f64 - expected).abs() < 1e-3, "{}", layer("coc", card, 32));
    assert!(picture.layers["coverage"].iter().all(|c| c.is_finite() && *c >= 0.0));

    place.done(&format!("render quads.glb {SHOT} --aov depth --size 48x32 -o small.png"));
    assert_eq!(read_picture(&place.path("small.png")).unwrap().width, 48);
    assert!(place.path("small.depth.exr").is_file());
}

#[test]
fn a_light_field_renders_as_its_scene_does() {
    let place = Workplace::new();
    let report = place.json(&format!("bake quads.glb {SHOT} -o quads.salf --json"));
    assert!(report["file_bytes"].as_u64().unwrap() > 10_000, "{report}");
    place.done(&format!("render quads.glb {SHOT} -o direct.exr"));
    place.done("render quads.salf --focus recipe.json -o baked.exr");
    assert_eq!(place.psnr("direct.exr", "baked.exr"), 200.0);
    let info = place.json("info quads.salf --json");
    assert_eq!(info["kind"], "light field");
    let kinds = |info: &Value| info["modelled"]["kinds"].as_array().unwrap().clone();
    let of = |kinds: &[Value], kind: &str| kinds.iter().find(|row| row["kind"] == kind).unwrap().clone();
    let visible = of(&kinds(&info), "visible");
    assert_eq!(visible["samples"], info["salf"]["samples"]);
    assert!(visible["texels"].is_null(), "a scene is not unwrapped unasked: {visible}");
    let baked = kinds(&place.json("info quads.glb --bake --json"));
    let texels = |kind| of(&baked, kind)["texels"].as_u64().unwrap();
    assert!(texels("exist") > texels("visible") && texels("partly occluded") > 0, "{baked:?}");
    assert_eq!(texels("open") + texels("partly occluded"), texels("visible"));
    assert!(place.done("info quads.glb --bake").contains("dense form"));
    place.fails("render quads.salf --cells 2 -o x.exr", 3, &["quads.salf", "--cells"]);
    let exact = place.json("render quads.salf --tolerance 0 -o x.exr --json");
    assert_eq!(exact["cells_a_side"].as_u64(), Some(1));
    place.fails("render quads.salf --size 10x10 -o x.exr", 3, &["quads.salf", "96 × 64"]);
    let mut bytes = std::fs::read(place.path("quads.salf")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(place.path("quads.salf"), bytes).unwrap();
    place.fails("render quads.salf -o x.exr", 3, &["quads.salf", "damaged"]);
}

#[test]
fn a_project_renders_and_exports_what_was_painted() {
    let place = Workplace::new();
    place.paint("quads.fbrush");
    place.done("render quads.fbrush -o project.exr");
    place.done(&format!("render quads.glb {SHOT} -o recipe.exr"));
    let same = place.psnr("project.exr", "recipe.exr");
    assert!(same > 50.0, "the painted map is the recipe: {same} dB");
    place.done("export quads.fbrush --focus-map map.exr --glb out.glb --layers layers.exr");
    // Written with the atlas, read again with the project's own atlas.
    place.done("render quads.fbrush --focus map.exr -o map_back.exr");
    assert_eq!(place.psnr("project.exr", "map_back.exr"), 200.0);
    assert!(read_picture(&place.path("layers.exr")).unwrap().layers.contains_key("coc"));
    let unwrapped = scene::load(&place.path("out.glb"), &Default::default(), &progress::Unwatched).unwrap();
    assert!(unwrapped.parts.iter().all(|part| part.has_uv[1]));
    let info = place.json("info quads.fbrush --json");
    assert_eq!(info["project"]["scene_state"], "same");
    // One output fails, the other is written.
    place.fails("export quads.fbrush --focus-map again.png --glb none/out.glb", 4, &["none/out.glb"]);
    assert!(place.path("again.png").is_file());
    std::fs::remove_file(place.path("quads.glb")).unwrap();
    place.fails("render quads.fbrush -o x.exr", 3, &["quads.fbrush", "quads.glb", "missing"]);
}

#[test]
fn scenes_are_unwrapped_and_told_about() {
    let place = Workplace::new();
    let report = place.json("unwrap quads.glb -o out.glb --side 256 --ignore-uv --json");
    assert!(report["charts"].as_u64().unwrap() >= 3, "{report}");
    assert!(report["width"].as_u64().unwrap() <= 256);
    let info = place.json("info out.glb --json");
    assert_eq!(info["mesh"]["triangles"], 6);
    let text = place.done("info quads.glb");
    assert!(text.contains("6 triangles") && text.contains("\"front\""), "{text}");

    // A file with nothing to render is valid.
    std::fs::write(place.path("empty.glb"), tiny_glb::glb(&[])).unwrap();
    assert!(place.done("info empty.glb").contains("no triangle"));
    place.fails("render empty.glb -o x.exr", 3, &["empty.glb", "no triangle"]);
}

#[test]
fn the_card_makes_the_picture_of_the_processor() {
    let place = Workplace::new();
    let adapters = place.json("doctor --json")["adapters"].as_array().unwrap().len();
    if adapters == 0 {
        eprintln!("SKIPPED: no graphics adapter");
        place.fails("render quads.glb -o x.exr --backend gpu", 5, &["GPU"]);
        return;
    }
    let made = place.json("render quads.glb -o gpu.exr --size 64x48 --backend gpu --json");
    assert_eq!(made["backend"], "gpu");
    let made = place.json("render quads.glb -o cpu.exr --size 64x48 --backend cpu --json");
    assert_eq!(made["backend"], "cpu");
    let [gpu, cpu] = ["gpu.exr", "cpu.exr"].map(|file| std::fs::read(place.path(file)).unwrap());
    assert!(gpu == cpu, "the same bytes");
}

#[test]
fn mistakes_are_one_line_and_the_right_code() {
    let place = Workplace::new();
    place.fails("render", 2, &["--help"]);
    place.fails("render quads.glb -o x.exr --renderer magic", 2, &["magic"]);
    place.fails("render quads.glb -o x.exr --aov z", 2, &["coverage"]);
    place.fails("render quads.glb -o x.bmp", 2, &["x.bmp"]);
    place.fails("export quads.glb", 2, &[]);
    place.fails("render quads.glb -o x.exr --adapter no-such-card", 5, &["GPU", "no-such-card"]);
    place.fails("render quads.glb -o x.exr --backend gpu --renderer truth", 5, &["GPU", "truth"]);
    place.fails("render none.glb -o x.exr", 3, &["none.glb"]);
    place.fails("info none.txt", 3, &["none.txt"]);
    place.fails("none.glb", 3, &["none.glb"]);
    place.fails("render quads.glb -o none/x.exr", 3, &["none/x.exr", "folder"]);
    place.fails("render quads.glb --camera side -o x.exr", 3, &["side", "front"]);
    place.fails("render quads.glb --focus none.json -o x.exr", 3, &["none.json"]);
    std::fs::write(place.path("typo.json"), r#"{"nodes": {"crad": {"t": 1.1, "anchor": 0}}}"#).unwrap();
    place.fails("render quads.glb --focus typo.json -o x.exr", 3, &["typo.json", "crad", "card"]);
    std::fs::write(place.path("bad.json"), r#"{"width": 0}"#).unwrap();
    place.fails("render quads.glb --camera bad.json -o x.exr", 3, &["bad.json", "width"]);
    std::fs::write(place.path("broken.glb"), b"glTF\x02\0\0\0\xff\xff\xff\xff").unwrap();
    place.fails("render broken.glb -o x.exr", 3, &["broken.glb"]);
    place.fails("info broken.glb", 3, &["broken.glb"]);
    place.done("render quads.glb --size 16x16 -o a.png");
    place.done("render quads.glb --size 16x12 -o b.png");
    place.fails("compare a.png b.png", 3, &["16 × 12"]);
    assert!(!place.path("x.exr").exists(), "what fails leaves no file");
}

#[test]
fn lenses_and_bokeh_are_presets_by_name_or_file() {
    let place = Workplace::new();
    let listed = place.json("presets --json");
    let names = |kind: &str| -> Vec<String> {
        let list = listed[kind].as_array().unwrap().iter();
        list.map(|entry| entry["name"].as_str().unwrap().to_string()).collect()
    };
    assert!(names("bokeh").contains(&"Star".to_string()) && names("lens").len() >= 10);
    assert!(place.done("presets").lines().any(|line| line.trim() == "Heart"));
    let lens = r#"{"format": "focus-brush preset", "version": 1, "name": "mine",
        "lens": {"focal_length": 0.3, "f_number": 1.5, "sensor_height": 0.1}}"#;
    std::fs::write(place.path("lens.json"), lens).unwrap();
    let render = "render quads.glb --camera camera.json --exposure conserve -o";
    place.done(&format!("{render} own.exr"));
    place.done(&format!("{render} star.exr --lens lens.json --bokeh Star"));
    // The lens preset has its own field of view, and blurs the wall accordingly.
    let camera = project::read_camera(&place.path("camera.json"), &lens::Camera::default()).unwrap();
    let preset = project::Preset::read(&place.path("lens.json")).unwrap();
    let with = preset.apply_to_camera(&camera).unwrap().unwrap();
    project::write_camera(&place.path("with.json"), &with).unwrap();
    place.done("render quads.glb --camera with.json --exposure conserve --bokeh Star -o same.exr");
    let [star, same, own] =
        ["star.exr", "same.exr", "own.exr"].map(|name| read_picture(&place.path(name)).unwrap());
    assert_eq!(star.rgb, same.rgb);
    assert_ne!(star.rgb, own.rgb);
    place.fails(&format!("{render} x.exr --bokeh Stair"), 3, &["Stair", "focus-brush presets"]);
    place.fails(&format!("{render} x.exr --bokeh lens.json"), 3, &["lens.json", "is a preset of lens"]);
    place.fails(&format!("{render} x.exr --lens none.json"), 3, &["none.json"]);
}

#[test]
fn the_doctor_and_the_help_answer() {
    let place = Workplace::new();
    let report = place.json("doctor --json");
    assert!(report["threads"].as_u64().unwrap() >= 1);
    assert!(report["adapters"].is_array() && report["missing_libraries"].is_array());
    assert!(place.done("doctor").contains("command line works"));
    let said = place.run("doctor").stderr;
    assert!(said.is_empty(), "where no desktop is: {}", String::from_utf8_lossy(&said));
    assert!(place.done("--help").contains("Exit codes"));
    assert!(place.done("render --help").contains("--renderer"));
    assert!(place.done("--version").starts_with("focus-brush "));
}

#[test]
fn the_same_seed_gives_the_same_bits_and_standard_coverage_is_one() {
    let place = Workplace::new();
    for name in ["one.exr", "two.exr"] {
        let seed = "--renderer truth --spp 16 --seed 7";
        place.done(&format!("render quads.glb --camera camera.json {seed} --aov coverage -o {name}"));
    }
    assert_eq!(std::fs::read(place.path("one.exr")).unwrap(), std::fs::read(place.path("two.exr")).unwrap());
    place.done("render quads.glb --camera camera.json --aov coverage -o standard.exr");
    let coverage = &read_picture(&place.path("standard.exr")).unwrap().layers["coverage"];
    let off = coverage.iter().filter(|c| (*c - 1.0).abs() > 0.005).count();
    assert!(off * 100 <= coverage.len(), "coverage is off in {off} of {} pixels", coverage.len());
}

#[test]
fn a_report_is_complete_and_goes_on_where_it_was() {
    const KEYS: [&str; 13] = [
        "scene",
        "focus",
        "renderer",
        "knob",
        "value",
        "seconds",
        "bytes",
        "rmse",
        "relmse",
        "psnr",
        "flip",
        "mean_error",
        "reference_psnr",
    ];
    let place = Workplace::new();
    let command = format!("report quads.glb {SHOT} --size 64x36 --quick --spp 64 -o out --json");
    let first = place.json(&command);
    let read = |name: &str| std::fs::read_to_string(place.path("out").join(name)).unwrap();
    let records: Vec<Value> = serde_json::from_str(&read("report.json")).unwrap();
    assert_eq!(first["measurements"].as_u64(), Some(records.len() as u64));
    assert!(first["new"].as_u64().unwrap() > 10, "{first}");
    for record in &records {
        assert!(KEYS.iter().all(|key| !record[key].is_null()), "{record}");
        assert!(
            record["seconds"].as_f64().unwrap() > 0.0 && record["bytes"].as_u64().unwrap() > 0,
            "{record}"
        );
    }
    let psnr = |focus: &str, renderer: &str, value: f64| {
        let is_it = |r: &&Value| r["focus"] == focus && r["renderer"] == renderer && r["value"] == value;
        records.iter().find(is_it).unwrap()["psnr"].as_f64().unwrap()
    };
    for focus in ["standard", "painted"] {
        assert!(psnr(focus, "truth", 64.0) > psnr(focus, "truth", 4.0), "more rays, less error");
        assert!(psnr(focus, "splat", 2.0) > psnr(focus, "blur", 0.0), "the baseline is worse");
    }

    let csv = read("report.csv");
    assert_eq!(csv.lines().count(), records.len() + 1);
    assert!(csv.starts_with(&KEYS.join(",")), "{csv}");
    let page = read("report.html");
    assert!(page.contains("<svg") && page.contains("data:image/png;base64,") && page.contains("dense form"));
    for outside in ["http:", "https:", "<script", "<link", "@import", "src=\"/", "url("] {
        assert!(!page.contains(outside), "the page stands alone: {outside}");
    }
    assert!(!page.contains("NaN"), "no number is missing");
    assert!(read("report.md").contains("## At equal error"));
    let about: Value = serde_json::from_str(&read("about.json")).unwrap();
    assert!(about["machine"]["cores"].as_u64().unwrap() >= 1, "{about}");

    // A second run measures nothing again; only a lost measurement is repeated.
    let again = place.json(&command);
    assert_eq!((&again["new"], &again["measurements"]), (&Value::from(0), &first["measurements"]));
    assert_eq!(serde_json::from_str::<Vec<Value>>(&read("report.json")).unwrap(), records);
    let kept = std::fs::read_dir(place.path("out/measurements")).unwrap().map(|entry| entry.unwrap().path());
    let lost = kept
        .into_iter()
        .find(|file| file.to_string_lossy().contains("blur") && file.extension() == Some("json".as_ref()));
    std::fs::remove_file(lost.unwrap()).unwrap();
    assert!((1..=2).contains(&place.json(&command)["new"].as_u64().unwrap()));
    // Another size is another picture.
    let other = place.json(&command.replace("64x36", "48x27"));
    assert_eq!(other["new"], first["new"]);
    place.fails("report none.glb -o out2", 3, &["none.glb"]);
}

#[test]
fn strokes_are_replayed_onto_a_new_project() {
    let place = Workplace::new();
    place.done("new quads.glb --camera camera.json --focus recipe.json -o quads.fbrush");
    place.fails("new quads.glb -o quads.json", 2, &[".fbrush"]);
    let project = ProjectFile::load(&place.path("quads.fbrush")).unwrap();
    assert!(project.focus_map.is_some() && project.cameras[0].camera.width == 96);
    let camera = &project.cameras[0].camera;
    let view = focus::ViewFrame::from_camera(camera);
    let brush = focus::Brush { radius: 0.3, target: lens::FocusOffset::new(1.4, 0.5), ..Default::default() };
    let points = (0..20).map(|k| [0.3 + 0.02 * k as f64, 0.5, 1.0]).collect();
    let stroke = project::RecordedStroke { layer: "Paint".into(), brush, view: view.into(), points };
    let recorded = |stroke: &project::RecordedStroke| [project::RecordedStep::Stroke(stroke.clone())];
    project::write_strokes(&place.path("strokes.json"), &recorded(&stroke)).unwrap();
    let told = place.json("replay quads.fbrush strokes.json -o painted.fbrush --json");
    assert_eq!((told["painted"].as_u64(), told["points"].as_u64()), (Some(1), Some(20)));
    let painted = ProjectFile::load(&place.path("painted.fbrush")).unwrap();
    assert_ne!(painted.focus_map, project.focus_map);
    place.done("replay quads.fbrush strokes.json -o again.fbrush");
    let again = ProjectFile::load(&place.path("again.fbrush")).unwrap();
    assert_eq!(again.focus_map, painted.focus_map);
    place.fails("replay quads.fbrush strokes.json -o painted.json", 2, &[".fbrush"]);
    let lost = project::RecordedStroke { layer: "nowhere".into(), ..stroke };
    project::write_strokes(&place.path("lost.json"), &recorded(&lost)).unwrap();
    place.fails("replay quads.fbrush lost.json -o x.fbrush", 3, &["lost.json", "step 1", "nowhere"]);
}

#[test]
fn file_managers_see_what_is_in_a_file() {
    let place = Workplace::new();
    let project = place.paint("painted.fbrush");
    place.fails("thumbnail painted.fbrush -o small.png", 3, &["painted.fbrush", "without a picture"]);
    let shown = project::Thumbnail::from_linear(640, 320, vec![[0.25, 0.5, 1.0]; 640 * 320]);
    let saved = ProjectFile { thumbnail: Some(shown), ..ProjectFile::load(&project).unwrap() };
    saved.save(&project).unwrap();
    // They choose any file name.
    place.done("thumbnail painted.fbrush --size 128 -o small");
    std::fs::rename(place.path("small"), place.path("small.png")).unwrap();
    let small = read_picture(&place.path("small.png")).unwrap();
    assert_eq!((small.width, small.height), (107, 54));
    assert!(small.rgb.iter().all(|rgb| (rgb[1] - 0.5).abs() < 0.01), "{:?}", small.rgb[0]);
    // A light field is rendered although its scene is missing.
    place.done(&format!("render quads.glb {SHOT} -o whole.png"));
    place.done("bake quads.glb --camera camera.json -o field.salf");
    std::fs::rename(place.path("quads.glb"), place.path("away.glb")).unwrap();
    place.done("thumbnail field.salf --size 512 -o field.png");
    let (whole, field) =
        (read_picture(&place.path("whole.png")).unwrap(), read_picture(&place.path("field.png")).unwrap());
    assert_eq!((whole.width, whole.height), (field.width, field.height));
    assert!(field.rgb.iter().any(|rgb| rgb[0] > 0.1), "it shows something");
    place.fails("thumbnail away.glb -o x.png", 3, &["away.glb", "no thumbnail"]);
    place.fails("thumbnail nothing.fbrush -o x.png", 3, &["nothing.fbrush"]);
}
