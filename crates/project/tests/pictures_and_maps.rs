//! Pictures, focus maps and their comparison.

mod damage;
mod shared_data;

use damage::{damage, is_one_line};
use focus::{FocusImage, FocusMap};
use lens::{Exposure, FocusOffset, Picture};
use project::{
    FocusMapFile, Layer, LinearPicture, PictureOptions, WorldFile, compare, error_maps, read_picture,
    write_error_map, write_focus_map, write_picture, write_rgb,
};
use scene::{Environment, EnvironmentMap, Scene};
use shared_data::shared;
use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;

/// Deterministic numbers in [0, 1).
fn noise(count: usize, mut seed: u32) -> Vec<f32> {
    let mut next = || {
        seed = seed.wrapping_mul(1664525).wrapping_add(1013904223);
        (seed >> 8) as f32 / (1 << 24) as f32
    };
    (0..count).map(|_| next()).collect()
}

fn picture() -> Picture {
    let (width, height) = (37, 29);
    let values = noise(width * height * 4, 1);
    let radiance = values.chunks_exact(4).map(|v| [v[0] * 3.0, v[1] * 1e4, v[2] - 0.1]).collect();
    let coverage = values.chunks_exact(4).map(|v| v[3] + 0.5).collect();
    Picture { width: width as u32, height: height as u32, radiance, coverage, colour_coverage: None }
}

#[test]
fn exr_keeps_every_bit_and_its_layers() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("picture.exr");
    let picture = picture();
    let depth = Layer { name: "depth".into(), values: noise(37 * 29, 2) };
    let layers = [Layer::coverage(&picture), depth.clone()];
    for exposure in [Exposure::Conserve, Exposure::Normalise] {
        let options = PictureOptions { exposure, ..PictureOptions::default() };
        assert_eq!(write_picture(&file, &picture, &layers, &options).unwrap(), std::slice::from_ref(&file));
        let read = read_picture(&file).unwrap();
        assert_eq!(read.rgb, picture.exposed(exposure));
        assert_eq!(read.layers["coverage"], picture.coverage);
        assert_eq!(read.layers["depth"], depth.values);
    }
    let half = PictureOptions { half: true, exposure: Exposure::Conserve, ..PictureOptions::default() };
    write_picture(&file, &picture, &[], &half).unwrap();
    let read = read_picture(&file).unwrap();
    for (a, b) in read.rgb.iter().flatten().zip(picture.radiance.iter().flatten()) {
        assert!((a - b).abs() <= b.abs() / 2048.0 + 1e-7, "{a} {b}");
    }
    damage(&file, read_picture);
}

#[test]
fn png_is_srgb_and_its_layers_lie_beside_it() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("picture.png");
    let mut picture = Picture::black(3, 1);
    picture.radiance = vec![[0.0, 1.0, 9.0], [-1.0, 0.0031308, f32::NAN], [0.2140411, 0.5, 1.0]];
    picture.coverage = vec![1.0, 2.0, 0.5];
    let options = PictureOptions { exposure: Exposure::Conserve, ..PictureOptions::default() };
    let files = write_picture(&file, &picture, &[Layer::coverage(&picture)], &options).unwrap();
    assert_eq!(files, [file.clone(), folder.path().join("picture.coverage.exr")]);
    let stored = image::open(&file).unwrap().into_rgb8();
    assert_eq!(stored.as_raw(), &[0, 255, 255, 0, 10, 0, 127, 188, 255]);
    // 0.5 → 188 → back within half a step.
    let read = read_picture(&file).unwrap();
    assert!((read.rgb[2][1] - 0.5).abs() < 4e-3, "{}", read.rgb[2][1]);
    let coverage = read_picture(&files[1]).unwrap();
    assert_eq!(coverage.rgb, [[1.0; 3], [2.0; 3], [0.5; 3]]);
    damage(&file, read_picture);

    let deep = image::ImageBuffer::<image::Rgb<u16>, _>::from_raw(1, 1, vec![0u16, 32768, 65535]).unwrap();
    deep.save(&file).unwrap();
    let read = read_picture(&file).unwrap().rgb[0];
    assert!(read[0] == 0.0 && read[2] == 1.0 && (read[1] - 0.214_05).abs() < 1e-4, "{read:?}");
    assert!(write_rgb(&folder.path().join("x.tiff"), 1, 1, &[[0.0; 3]]).is_err());
}

fn map() -> FocusMapFile {
    let values = noise(33 * 21 * 2, 3);
    let mut texels: Vec<[f32; 2]> = values.chunks_exact(2).map(|v| [v[0] * 1.99, v[1]]).collect();
    texels[0] = [1.0, 0.0];
    texels[1] = [1.0, 1.0];
    FocusMapFile {
        image: FocusImage { width: 33, height: 21, texels, gloss: None },
        background: Some(FocusOffset::new(0.1, 0.7)),
        atlas_hash: Some("0123abcd".to_string()),
        warnings: Vec::new(),
    }
}

#[test]
fn exr_focus_maps_come_back_to_the_bit() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("focus.exr");
    for map in [map(), FocusMapFile { background: None, atlas_hash: None, ..map() }] {
        assert!(write_focus_map(&file, &map).unwrap().is_empty());
        assert_eq!(FocusMapFile::read(&file).unwrap(), map);
    }
    damage(&file, FocusMapFile::read);
    // What is outside [0, 2) stays as it is.
    let mut wide = map();
    wide.image.texels[5] = [-7.5, 0.5];
    write_focus_map(&file, &wide).unwrap();
    assert_eq!(FocusMapFile::read(&file).unwrap(), wide);
}

#[test]
fn png_focus_maps_keep_the_standard_exactly() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("focus.png");
    let map = map();
    assert!(write_focus_map(&file, &map).unwrap().is_empty());
    let read = FocusMapFile::read(&file).unwrap();
    assert_eq!((&read.atlas_hash, read.background), (&map.atlas_hash, map.background));
    assert_eq!(read.image.texels[..2], [[1.0, 0.0], [1.0, 1.0]]);
    for (a, b) in read.image.texels.iter().zip(&map.image.texels) {
        assert!((a[0] - b[0]).abs() <= 0.5001 / 32768.0 && (a[1] - b[1]).abs() <= 0.5001 / 65535.0);
    }
    // What was read is written to the same bytes.
    let bytes = std::fs::read(&file).unwrap();
    write_focus_map(&file, &read).unwrap();
    assert_eq!(std::fs::read(&file).unwrap(), bytes);
    let stored = image::open(&file).unwrap();
    assert_eq!(stored.as_rgb16().unwrap().get_pixel(0, 0).0, [32768, 0, 0]);
    assert_eq!(damage(&file, FocusMapFile::read), 0, "every chunk has a checksum");
    // Without its sidecar it is a map in the mesh's UVs.
    std::fs::remove_file(folder.path().join("focus.png.json")).unwrap();
    assert_eq!(FocusMapFile::read(&file).unwrap().atlas_hash, None);

    let mut wide = map;
    wide.image.texels[7] = [2.5, 0.0];
    wide.image.texels[8] = [-0.5, 0.0];
    let warnings = write_focus_map(&file, &wide).unwrap();
    assert!(warnings.len() == 1 && warnings[0].contains("2 texels"), "{warnings:?}");
    let read = FocusMapFile::read(&file).unwrap();
    assert_eq!(read.image.texels[7][0], 65535.0 / 32768.0);
    assert_eq!(read.image.texels[8][0], 0.0);
}

#[test]
fn gloss_survives_an_exr_and_its_loss_in_a_png_is_reported() {
    let folder = TempDir::new().unwrap();
    let [exr, png] = ["focus.exr", "focus.png"].map(|name| folder.path().join(name));
    let mut glossy = map();
    glossy.image.gloss = Some(noise(33 * 21, 5));
    glossy.background = Some(FocusOffset::new(0.1, 0.7).with_gloss(0.25));
    assert!(write_focus_map(&exr, &glossy).unwrap().is_empty());
    assert_eq!(FocusMapFile::read(&exr).unwrap(), glossy);
    let warnings = write_focus_map(&png, &glossy).unwrap();
    assert!(warnings.len() == 1 && warnings[0].contains("gloss"), "{warnings:?}");
    write_focus_map(&png, &map()).unwrap();
    let without = std::fs::read(&png).unwrap();
    write_focus_map(&png, &glossy).unwrap();
    assert_eq!(std::fs::read(&png).unwrap(), without, "the rest is as it was");

    // Where nothing says anything of it, neither does the file.
    let says = |file: &std::path::Path| {
        std::fs::read(file).unwrap().windows(5).any(|word| word.eq_ignore_ascii_case(b"gloss"))
    };
    assert!(says(&exr));
    write_focus_map(&exr, &map()).unwrap();
    assert!(!says(&exr));

    glossy.image.gloss.as_mut().unwrap()[35] = 1.5;
    write_focus_map(&exr, &glossy).unwrap();
    let error = FocusMapFile::read(&exr).unwrap_err().to_string();
    is_one_line(&error, &exr);
    assert!(error.contains("texel (2, 1) has gloss = 1.5"), "{error}");
}

#[test]
fn unusable_focus_maps_are_errors() {
    let folder = TempDir::new().unwrap();
    let eight_bit = folder.path().join("eight.png");
    image::RgbImage::new(2, 2).save(&eight_bit).unwrap();
    let error = FocusMapFile::read(&eight_bit).unwrap_err().to_string();
    is_one_line(&error, &eight_bit);
    assert!(error.contains("16"));
    let bad = folder.path().join("bad.exr");
    let mut map = map();
    map.image.texels[34] = [f32::NAN, 0.0];
    write_focus_map(&bad, &map).unwrap();
    let error = FocusMapFile::read(&bad).unwrap_err().to_string();
    is_one_line(&error, &bad);
    assert!(error.contains("texel (1, 1)"), "{error}");
}

#[test]
fn a_map_is_accepted_only_for_its_own_atlas() {
    let atlas = |hash: &str, width| atlas::Atlas {
        hash: hash.to_string(),
        ..atlas::Atlas::new([width, 21], Vec::new(), Vec::new(), &[], 1.0)
    };
    let file = std::path::Path::new("focus.exr");
    let map = map();
    let painted: FocusMap = map.clone().into_atlas_map(file, &atlas("0123abcd", 33)).unwrap();
    assert_eq!(FocusMapFile::from_atlas_map(&painted, &atlas("0123abcd", 33)), map);
    is_one_line(&map.clone().into_atlas_map(file, &atlas("other", 33)).unwrap_err().to_string(), file);
    is_one_line(&map.into_atlas_map(file, &atlas("0123abcd", 34)).unwrap_err().to_string(), file);
}

fn linear(rgb: Vec<[f32; 3]>, width: u32) -> LinearPicture {
    LinearPicture { width, height: rgb.len() as u32 / width, rgb, ..LinearPicture::default() }
}

#[test]
fn differences_in_closed_form() {
    let a = linear(vec![[0.5; 3]; 64 * 64], 64);
    let b = linear(vec![[0.4; 3]; 64 * 64], 64);
    let found = compare(&a, &b).unwrap();
    let near = |x: f64, y: f64| assert!((x - y).abs() < 1e-6, "{x} for {y}");
    near(found.rmse, 0.1);
    near(found.psnr, 20.0);
    near(found.rel_mse, 0.01 / 0.17);
    near(found.signed_mean_error, 0.25);
    near(found.largest_difference, 0.1);
    assert!(found.flip > 0.02 && found.flip < 0.3, "{}", found.flip);
    near(compare(&b, &a).unwrap().signed_mean_error, -0.2);

    let equal = compare(&a, &a).unwrap();
    assert_eq!([equal.rmse, equal.flip, equal.signed_mean_error], [0.0; 3]);
    assert_eq!(equal.psnr, 200.0);

    // Beyond 1 only the unclipped figures differ.
    let [bright, brighter] = [3.0, 5.0].map(|v| linear(vec![[v; 3]; 64 * 64], 64));
    let found = compare(&brighter, &bright).unwrap();
    assert_eq!([found.rmse, found.rmse_unclipped, found.flip], [0.0, 2.0, 0.0]);

    // Black on white is as far as pictures can be apart.
    let [black, white] = [0.0, 1.0].map(|v| linear(vec![[v; 3]; 64 * 64], 64));
    let found = compare(&black, &white).unwrap();
    assert!(found.psnr == 0.0 && found.flip > 0.9, "{found:?}");
    assert!(compare(&a, &linear(vec![[0.5; 3]; 64 * 63], 64)).is_err());

    // One number of one pixel is enough.
    let mut broken = a.clone();
    broken.rgb[77][1] = f32::NAN;
    let found = compare(&broken, &a).unwrap();
    assert_eq!(found.undefined_pixels, 1);
    assert!(found.flip.is_nan());
    assert!(found.rmse.is_nan() && found.psnr.is_nan() && found.largest_difference.is_nan());
}

#[test]
fn a_shift_by_one_pixel_shows() {
    let checker = |shift: u32| {
        let cell = |i: u32| (((i % 64 + shift) / 4) + i / 64 / 4) % 2;
        linear((0..64 * 64).map(|i| [cell(i) as f32; 3]).collect(), 64)
    };
    let (a, b) = (checker(0), checker(1));
    let found = compare(&a, &b).unwrap();
    assert!((found.rmse - 0.5).abs() < 0.01 && found.flip > 0.05, "{found:?}");
    let maps = error_maps(&a, &b).unwrap();
    let differing = maps.difference.iter().filter(|d| **d != [0.0; 3]).count();
    assert_eq!(differing, 64 * 64 / 4);
    let mean = maps.flip.iter().sum::<f32>() / maps.flip.len() as f32;
    assert!((mean as f64 - found.flip).abs() < 1e-3);
}

#[test]
fn error_maps_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let [exr, png, bmp] = ["map.exr", "map.png", "map.bmp"].map(|name| folder.path().join(name));
    // The right half differs, the left is equal.
    let halves =
        |right: f32| linear((0..64 * 64).map(|i| [if i % 64 < 32 { 0.5 } else { right }; 3]).collect(), 64);
    let (a, b) = (halves(1.0), halves(0.0));
    write_error_map(&exr, &a, &b).unwrap();
    let read = read_picture(&exr).unwrap();
    let maps = error_maps(&a, &b).unwrap();
    assert_eq!((read.rgb, &read.layers["flip"]), (maps.difference, &maps.flip));

    write_error_map(&png, &a, &b).unwrap();
    let read = read_picture(&png).unwrap();
    let (alike, apart) = (read.rgb[32 * 64 + 4], read.rgb[32 * 64 + 60]);
    assert!(alike.iter().all(|c| *c < 0.01), "magma begins black: {alike:?}");
    // Near its end magma is pale yellow.
    assert!(apart[0] > 0.8 && apart[1] > 0.5 && apart[2] < apart[1], "{apart:?}");

    assert!(write_error_map(&bmp, &a, &b).is_err() && !bmp.exists());
    assert!(write_error_map(&png, &a, &linear(vec![[0.5; 3]; 64 * 63], 64)).is_err());
}

#[test]
fn reference_pictures_are_read() {
    if let Some(folder) = shared("data/dof-reference/helmet_cake") {
        let [near, far] =
            ["dof_near.exr", "dof_far.exr"].map(|name| read_picture(&folder.join(name)).unwrap());
        assert_eq!([near.width, near.height], [512, 384]);
        let found = compare(&near, &far).unwrap();
        println!("near against far focus: {found:?}");
        assert!((10.0..40.0).contains(&found.psnr) && found.flip > 0.01);
    }
    if let Some(folder) = shared("data/hdr") {
        let sky = read_picture(&folder.join("royal_esplanade_1k.hdr")).unwrap();
        assert_eq!([sky.width, sky.height], [1024, 512]);
        assert!(sky.rgb.iter().flatten().any(|&c| c > 1.0));
    }
}

/// The map of an environment's file, and the warnings about it.
fn environment(file: &Path) -> (Arc<EnvironmentMap>, Vec<String>) {
    let (world, warnings) = WorldFile::from_environment_file(file).load(&Scene::default()).unwrap();
    match world.environment {
        Environment::Map(map) => (map, warnings),
        Environment::Uniform(_) => panic!("no map"),
    }
}

#[test]
fn skies_are_the_same_however_they_are_coded() {
    let Some(folder) = shared("cases/field2/13-hdr-heads-and-codings") else { return };
    let (base, _) = environment(&folder.join("base.hdr"));
    for sky in ["rgbe.hdr", "plusy.hdr"] {
        let (map, warnings) = environment(&folder.join(sky));
        assert!(map.texels == base.texels && warnings.is_empty(), "{sky}: {warnings:?}");
    }
    let (map, _) = environment(&folder.join("flat22.hdr"));
    let differ: Vec<usize> = (0..base.texels.len()).filter(|k| map.texels[*k] != base.texels[*k]).collect();
    assert!(differ.len() <= 1, "only the pixel that looks like a coding may differ: {differ:?}");
}

#[test]
fn skies_with_faults_shine_all_the_same() {
    let Some(folder) = shared("cases/field2/14-exr-skies-with-faults") else { return };
    let (base, warnings) = environment(&folder.join("base.exr"));
    assert!(warnings.is_empty(), "{warnings:?}");
    for (sky, value, told) in [
        ("inf.exr", 65504.0, "as 65504, the largest half"),
        ("nan.exr", 0.0, "not a number"),
        ("neg.exr", 0.0, "negative"),
    ] {
        let (map, warnings) = environment(&folder.join(sky));
        assert!(warnings.len() == 1 && warnings[0].contains(told), "{sky}: {warnings:?}");
        let is_near = |a: f32, b: f32| (a - b).abs() <= 2e-3 * b.abs();
        let differ =
            map.texels.iter().flatten().zip(base.texels.iter().flatten()).filter(|(a, b)| !is_near(**a, **b));
        let differ: Vec<_> = differ.map(|(a, _)| *a).collect();
        assert!(differ.iter().all(|channel| *channel == value), "{sky}: {differ:?}");
        assert!(map.texels.iter().flatten().any(|channel| *channel == value), "{sky}");
    }
}
