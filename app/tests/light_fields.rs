//! Light fields and pictures with depth, end to end: synthetic views of a card in front of a wall.

mod card_light_field;
mod program;

use card_light_field::{CARD, SIZE, STEPS, Scene, WALL, glossy, pfm, pixel, pixel_at, shown, view};
use program::{done, run};
use project::read_picture;
use serde_json::Value;
use std::path::Path;

/// The picture through a disc of radius `reach` steps that is focused on a disparity: the mean of many views.
fn truth(reach: f64, focus: f64) -> Vec<[f64; 3]> {
    truth_of(shown, reach, focus)
}

fn truth_of(scene: Scene, reach: f64, focus: f64) -> Vec<[f64; 3]> {
    let side = 15;
    let at = |k: i32| reach * f64::from(2 * k - side + 1) / f64::from(side);
    let points = (0..side * side).map(|k| [at(k % side), at(k / side)]);
    let points: Vec<_> = points.filter(|[u, v]| u * u + v * v <= reach * reach).collect();
    let places = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let mean = |(x, y): (u32, u32)| {
        let mut sum = [0.0; 3];
        for &[u, v] in &points {
            for k in 0..4u32 {
                let at = |at: u32, k: u32, u: f64| f64::from(at) + (f64::from(k) + 0.5) / 2.0 - focus * u;
                let (color, _) = scene(at(x, k % 2, u), at(y, k / 2, v), [u, v]);
                (0..3).for_each(|c| sum[c] += color[c] / (4.0 * points.len() as f64));
            }
        }
        sum
    };
    places.map(mean).collect()
}

/// Peak signal-to-noise ratio of a written picture, dB.
fn psnr(file: &Path, truth: &[[f64; 3]]) -> f64 {
    let picture = read_picture(file).unwrap();
    assert_eq!([picture.width, picture.height], SIZE);
    let off = |(a, b): (&[f32; 3], &[f64; 3])| (0..3).map(|c| (f64::from(a[c]) - b[c]).powi(2)).sum::<f64>();
    -10.0 * (picture.rgb.iter().zip(truth).map(off).sum::<f64>() / (3 * truth.len()) as f64).log10()
}

/// The distance of a disparity, derived from the project's camera and the disparities of two known distances.
fn distance(disparity: f64) -> f64 {
    // The nearest is one unit away, the farthest five.
    let share = (disparity - WALL) / (CARD - WALL);
    1.0 / (0.2 + 0.8 * share)
}

#[test]
fn a_light_field_is_refocused_as_a_lens_would() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    card_light_field::write(&folder.join("card"));
    done(folder, "import card -o card.fbrush");
    let info: Value = serde_json::from_str(&done(folder, "info card.fbrush --json")).unwrap();
    assert_eq!(info["project"]["scene_state"], "same");
    // The aperture extends to the outermost views, in the corners.
    let reach = f64::from(STEPS) * 2f64.sqrt();
    for disparity in [CARD, 0.4, WALL] {
        let camera = format!("{{\"focus_distance\": {}}}", distance(disparity));
        std::fs::write(folder.join("camera.json"), camera).unwrap();
        done(folder, "render card.fbrush --camera camera.json -o lens.exr --backend cpu");
        let found = psnr(&folder.join("lens.exr"), &truth(reach, disparity));
        assert!(found > 36.0, "focused on {disparity}: {found} dB");
        // Negative control: with another focus the picture differs.
        let other = psnr(&folder.join("lens.exr"), &truth(reach, disparity + 0.5));
        assert!(other < found - 3.0, "{other} of {found} dB");
    }
    // The middle view is the picture through a pinhole, without invented parts.
    done(folder, "render card.fbrush --aperture-radius 0 -o pinhole.exr --aov seen --backend cpu");
    let middle: Vec<_> = (0..SIZE[0] * SIZE[1]).map(|n| pixel(n % SIZE[0], n / SIZE[0], [0.0; 2])).collect();
    let found = psnr(&folder.join("pinhole.exr"), &middle);
    assert!(found > 45.0, "{found} dB");
}

#[test]
fn a_picture_and_its_depth_are_refocused() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    view([0.0; 2]).save(folder.join("card.png")).unwrap();
    pfm(&folder.join("card.pfm"), distance);
    done(folder, "import card.png --depth card.pfm -o card.fbrush");
    let focal_px = 0.5 * 96.0 / (0.5 * 0.6911f64).tan();
    // As far as a disparity of one step of this length.
    let baseline = (CARD - WALL) / (0.8 * focal_px);
    for disparity in [CARD, WALL] {
        let radius = 2.0 * baseline;
        let camera =
            format!("{{\"focus_distance\": {}, \"aperture_radius\": {radius}}}", distance(disparity));
        std::fs::write(folder.join("camera.json"), camera).unwrap();
        done(folder, "render card.fbrush --camera camera.json -o lens.exr --backend cpu");
        // Hidden surfaces are invented, so the error is larger than with views.
        let found = psnr(&folder.join("lens.exr"), &truth(2.0, disparity));
        assert!(found > 30.0, "focused on {disparity}: {found} dB");
    }
    // A relative map has no metric range.
    let gray = image::GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let (_, disparity) = shown(f64::from(x) + 0.5, f64::from(y) + 0.5, [0.0; 2]);
        image::Luma([if disparity == CARD { 255 } else { 30 }])
    });
    gray.save(folder.join("gray.png")).unwrap();
    let output = run(folder, "import card.png --depth gray.png -o gray.fbrush");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{errors}");
    assert!(errors.contains("--near"), "{errors}");
    done(folder, "import card.png --depth gray.png --near white -o gray.fbrush");
}

#[test]
fn no_scale_or_offset_of_disparities_changes_the_picture() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    std::fs::write(folder.join("painted.json"), r#"{"default": {"t": 0.7, "anchor": 0.3}}"#).unwrap();
    // By default, views are focused on disparity 0.
    std::fs::write(folder.join("camera.json"), r#"{"focus_distance": 1.6, "aperture_radius": 0.05}"#)
        .unwrap();
    view([0.0; 2]).save(folder.join("card.png")).unwrap();
    let rendered = |capture: &str, options: &str| {
        done(folder, &format!("import {capture} -o moved.fbrush"));
        done(folder, &format!("render moved.fbrush {options} -o moved.exr --backend cpu"));
        read_picture(&folder.join("moved.exr")).unwrap().rgb
    };
    let rmse = |a: &[[f32; 3]], b: &[[f32; 3]]| {
        let off =
            |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>();
        (a.iter().zip(b).map(off).sum::<f64>() / (3 * a.len()) as f64).sqrt()
    };
    // With views: the pictures are displaced, too, by a few pixels at most.
    let moves = [(1.0, 0.0), (0.1, 0.3), (10.0, -3.0), (1.0, 3.0), (3.0, -3.0)];
    for options in ["--camera camera.json", "--camera camera.json --focus painted.json"] {
        let mut plain = Vec::new();
        for (scale, offset) in moves {
            card_light_field::write_moved(&folder.join("card"), scale, offset);
            let found = rendered("card", options);
            if plain.is_empty() {
                plain = found;
                continue;
            }
            let off = rmse(&plain, &found);
            assert!(off < 0.005, "{off} for {scale} {offset} {options}");
        }
        // With only one picture and its disparities.
        let mut plain = Vec::new();
        for (scale, offset) in [(1.0, 0.0), (0.1, 3.0), (10.0, -3.0), (0.1, -3.0), (10.0, 3.0)] {
            pfm(&folder.join("disparity.pfm"), |disparity| scale * disparity + offset);
            let found = rendered("card.png --disparity disparity.pfm", options);
            if plain.is_empty() {
                plain = found;
                continue;
            }
            let off = rmse(&plain, &found);
            assert!(off < 0.005, "{off} of one picture for {scale} {offset} {options}");
        }
        // Negative control: other disparities give another picture.
        pfm(&folder.join("disparity.pfm"), |disparity| -disparity);
        assert!(rmse(&plain, &rendered("card.png --disparity disparity.pfm", options)) > 0.005);
    }
}

#[test]
fn disparities_found_in_views_are_compared_with_those_that_came_along() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("card");
    card_light_field::write(&folder);
    let error = |folder: &Path| {
        let input = document::Input::open(folder, &Default::default(), &progress::Unwatched).unwrap();
        input.disparity_error(&progress::Unwatched).unwrap()
    };
    let told = error(&folder).expect("they came along");
    assert!(told.bad_007 < 0.12 && told.bad_003 >= told.bad_007, "{told:?}");
    // Negative control: a map that is wrong everywhere.
    pfm(&folder.join("disparity.pfm"), |disparity| disparity + 0.1);
    assert!(error(&folder).unwrap().bad_007 > 0.8);
    // Without views.
    std::fs::remove_file(folder.join("disparity.pfm")).unwrap();
    assert_eq!(error(&folder), None);
}

#[test]
fn two_eyes_see_what_they_fixate_at_one_place() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    card_light_field::write(&folder.join("card"));
    done(folder, "import card -o card.fbrush");
    let reach = f64::from(STEPS) * 2f64.sqrt();
    let eyes = 0.6;
    // On the card, and on the wall beside it.
    for (x, y, fixated) in [(40, 30, CARD), (80, 60, WALL)] {
        let stereo = format!("--stereo sidebyside --eyes {eyes} --fixate {x},{y}");
        done(folder, &format!("render card.fbrush {stereo} -o pair.exr --backend cpu"));
        let pair = read_picture(&folder.join("pair.exr")).unwrap();
        assert_eq!([pair.width, pair.height], [2 * SIZE[0], SIZE[1]]);
        // Each eye's picture is the view from its position, shifted so that the fixated point stays in place.
        for (eye, side) in [(0, -1.0), (1, 1.0)] {
            let from = side * eyes * reach;
            let mut squares = 0.0;
            for row in 0..SIZE[1] {
                for column in 0..SIZE[0] {
                    let at = f64::from(column) + 0.5 - fixated * from;
                    let (color, _) = shown(at, f64::from(row) + 0.5, [from, 0.0]);
                    let found = pair.rgb[(row * 2 * SIZE[0] + eye * SIZE[0] + column) as usize];
                    squares += (0..3).map(|c| (f64::from(found[c]) - color[c]).powi(2)).sum::<f64>();
                }
            }
            let psnr = -10.0 * (squares / f64::from(3 * SIZE[0] * SIZE[1])).log10();
            assert!(psnr > 26.0, "eye {eye} on {fixated}: {psnr} dB");
        }
        // Nothing is missing at the sides.
        assert!(pair.rgb.iter().all(|rgb| rgb[1] > 0.02 || rgb[0] > 0.02));
    }
    done(folder, "render card.fbrush --stereo anaglyph -o red-cyan.png --backend cpu");
    let output = run(folder, "render card.fbrush --stereo sidebyside --eyes 1.2 -o x.png");
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Real light fields in the folder beside the checkout.
const DATA: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/lightfield/synthetic_helmet_cake_9x9");

#[test]
fn a_map_that_is_coded_by_colour_is_decoded_by_the_views() {
    let data = Path::new(DATA);
    if !data.is_dir() {
        eprintln!("SKIPPED: {} is not there", data.display());
        return;
    }
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    std::fs::create_dir(folder.join("views")).unwrap();
    for entry in std::fs::read_dir(data).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_some_and(|extension| extension == "png") {
            std::fs::copy(&file, folder.join("views").join(file.file_name().unwrap())).unwrap();
        }
    }
    // Its disparities, rows from the bottom, as hues of a non-linear mapping, compressed.
    let pfm = std::fs::read(data.join("gt_disp_lowres.pfm")).unwrap();
    let numbers = &pfm[pfm.len() - 4 * 256 * 256..];
    let disparity = |x: u32, y: u32| {
        let at = 4 * ((255 - y) * 256 + x) as usize;
        f32::from_le_bytes(numbers[at..at + 4].try_into().unwrap())
    };
    let all = (0..256 * 256).map(|pixel| disparity(pixel % 256, pixel / 256));
    let [low, high] = all.fold([f32::MAX, f32::MIN], |[low, high], d| [low.min(d), high.max(d)]);
    let coded = image::RgbImage::from_fn(256, 256, |x, y| {
        let share = ((disparity(x, y) - low) / (high - low)).powf(1.5);
        let hue = |middle: f32| ((1.5 - (4.0 * share - middle).abs()).clamp(0.0, 1.0) * 255.0) as u8;
        image::Rgb([hue(3.0), hue(2.0), hue(1.0)])
    });
    let mut bytes = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 85).encode_image(&coded).unwrap();
    std::fs::write(folder.join("coded.jpg"), bytes).unwrap();
    let truth = data.join("gt_disp_lowres.pfm");
    done(folder, &format!("import views --disparity {} -o told.fbrush", truth.display()));
    done(folder, "import views --disparity coded.jpg -o coded.fbrush");
    for name in ["told", "coded"] {
        done(folder, &format!("render {name}.fbrush -o {name}.exr --backend cpu"));
    }
    let [told, coded] = ["told.exr", "coded.exr"].map(|name| read_picture(&folder.join(name)).unwrap());
    let off = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>();
    let squares: f64 = told.rgb.iter().zip(&coded.rgb).map(off).sum();
    let psnr = -10.0 * (squares / (3 * told.rgb.len()) as f64).log10();
    assert!(psnr > 35.0, "{psnr} dB");
    // Negative control: a view is not a disparity map.
    let output = run(folder, "import views --disparity views/input_Cam000.png -o wrong.fbrush");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{errors}");
    assert!(errors.contains("residual"), "{errors}");
}

#[test]
fn views_are_looked_through_and_compared_with() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    card_light_field::write(&folder.join("card"));
    done(folder, "import card -o card.fbrush");
    // The middle view, one at the end of a row, and one in a corner.
    for (name, [u, v]) in [("02_02", [0, 0]), ("02_04", [2, 0]), ("00_00", [-2, -2])] {
        let taken: Vec<[f64; 3]> =
            (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| pixel(x, y, [u.into(), v.into()]))).collect();
        done(folder, &format!("export card.fbrush --photo {name}=taken.exr"));
        assert!(psnr(&folder.join("taken.exr"), &taken) > 50.0, "{name}: 8 bits of it");
        done(folder, &format!("render card.fbrush --camera photo:{name} -o seen.exr"));
        let seen = psnr(&folder.join("seen.exr"), &taken);
        assert!(seen > 30.0, "{name}: {seen}");
        // Not with the camera of the middle view.
        done(folder, "render card.fbrush --aperture-radius 0 -o middle.exr");
        let middle = psnr(&folder.join("middle.exr"), &taken);
        assert!([u, v] == [0, 0] || middle < seen - 6.0, "{name}: {middle} {seen}");
    }
    let errors =
        String::from_utf8(run(folder, "render card.fbrush --camera photo:none -o x.exr").stderr).unwrap();
    assert!(errors.contains("no photograph is called \"none\""), "{errors}");
}

#[test]
fn gloss_moves_with_the_aperture() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    card_light_field::write_of(glossy, &folder.join("card"));
    done(folder, "import card -o card.fbrush");
    let taken = |[u, v]: [f64; 2]| -> Vec<[f64; 3]> {
        let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
        pixels.map(|(x, y)| pixel_at(glossy, x.into(), y.into(), [u, v])).collect()
    };
    // On the card, away from its edges, where the highlight passes.
    let on_card = |file: &str, truth: &[[f64; 3]], [u, v]: [f64; 2]| {
        let picture = read_picture(&folder.join(file)).unwrap();
        let (mut sum, mut count) = (0.0, 0.0);
        for (number, (found, wanted)) in picture.rgb.iter().zip(truth).enumerate() {
            let at = [number as u32 % SIZE[0], number as u32 / SIZE[0]];
            let [x, y] = [(at[0], u), (at[1], v)].map(|(at, view)| f64::from(at) + 0.5 + CARD * view);
            if (34.0..58.0).contains(&x) && (24.0..48.0).contains(&y) {
                sum += (0..3).map(|c| (f64::from(found[c]) - wanted[c]).powi(2)).sum::<f64>();
                count += 3.0;
            }
        }
        -10.0 * f64::log10(sum / count)
    };
    // Through the pinholes of views: the middle one and others equal the input. Ray tracing gives the same
    // light.
    for (name, at, least) in
        [("02_02", [0.0; 2], 45.0), ("02_04", [2.0, 0.0], 35.0), ("00_00", [-2.0; 2], 33.0)]
    {
        let truth = taken(at);
        for renderer in ["--backend cpu", "--renderer truth --spp 16"] {
            done(folder, &format!("render card.fbrush --camera photo:{name} {renderer} -o seen.exr"));
            let seen = on_card("seen.exr", &truth, at);
            assert!(seen > least, "{name} {renderer}: {seen} dB");
        }
        // Negative control: the highlight where the middle view has it.
        let still = |x: f64, y: f64, [u, v]: [f64; 2]| glossy(x + CARD * u, y + CARD * v, [0.0; 2]);
        let moved = (0..SIZE[0] * SIZE[1])
            .map(|n| still(f64::from(n % SIZE[0]) + 0.5, f64::from(n / SIZE[0]) + 0.5, at).0);
        let off = moved.zip(&truth).map(|(a, b)| (a[0] - b[0]).powi(2)).sum::<f64>();
        assert!(at == [0.0; 2] || off > 1.0, "{off}");
    }
    // In focus, the card has its mean brightness over the aperture; also if it is painted sharp.
    let reach = f64::from(STEPS);
    let (radius, lens) = (truth_of(glossy, reach, CARD), distance(CARD));
    let info: Value = serde_json::from_str(&done(folder, "info card.fbrush --json")).unwrap();
    let widest = info["camera"]["aperture_radius"].as_f64().unwrap();
    // The default aperture extends to the corners; this one to the ends of rows.
    let aperture = widest / 2f64.sqrt();
    let camera = |focus: f64| format!("{{\"focus_distance\": {focus}, \"aperture_radius\": {aperture}}}");
    std::fs::write(folder.join("near.json"), camera(lens)).unwrap();
    std::fs::write(folder.join("far.json"), camera(distance(WALL))).unwrap();
    std::fs::write(folder.join("sharp.json"), r#"{"default": {"t": 1, "anchor": 1}}"#).unwrap();
    for options in ["--camera near.json", "--camera far.json --focus sharp.json"] {
        done(folder, &format!("render card.fbrush {options} --backend cpu -o lens.exr"));
        let seen = on_card("lens.exr", &radius, [0.0; 2]);
        assert!(seen > 38.0, "{options}: {seen} dB");
    }
}
