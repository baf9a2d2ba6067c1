//! Damaged light fields and pictures with depth: no panic, no long run, no excessive memory.
//!
//! Ten seeds a kind, half of the mutants with changed bytes, half with a changed structure; `CAPTURE_MUTANTS=10000` makes as many of *each*
//! kind, by default it is a hundredth of that.

use crate::made_light::{
    PARAMETERS, SIDE, attributes, disparity_pfm, dynamic_depth_jpeg, dynamic_depth_xmp, encoded, exr,
    gdepth_jpeg, gdepth_xmp, jpeg, levels_png, levels8, pfm, put, save, view,
};
use crate::mutants::{peak_memory, restructure};
use crate::mutation::{Random, damage};
use capture::{
    CaptureError, DepthPictureOptions, LightFieldOptions, NearEnd, detect_capture_kind, open_depth_picture,
    open_light_field,
};
use image::{DynamicImage, ImageFormat, RgbImage};
use progress::Unwatched;
use scene::LoadOptions;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Seeds per kind.
const SEEDS: usize = 10;

/// The number of mutants of a seed.
fn mutants() -> usize {
    let all = std::env::var("CAPTURE_MUTANTS").ok().and_then(|all| all.parse().ok()).unwrap_or(100);
    usize::div_ceil(all, SEEDS)
}

/// Opens mutants of the files that `seed` writes into a folder and gives back, by `open`.
fn survive(seed: impl Fn(&Path, usize) -> Vec<PathBuf>, open: impl Fn(&Path) -> Result<(), CaptureError>) {
    let (mut opened, mut refused, mut longest) = (0, 0, Duration::ZERO);
    for index in 0..SEEDS {
        let folder = tempfile::tempdir().unwrap();
        let files = seed(folder.path(), index);
        let whole: Vec<Vec<u8>> = files.iter().map(|file| std::fs::read(file).unwrap()).collect();
        open(folder.path()).unwrap_or_else(|error| panic!("seed {index}: {error}"));
        let mut random = Random(1 + index as u64);
        for number in 0..mutants() {
            let which = random.below(files.len());
            let mut bytes = whole[which].clone();
            match number % 2 {
                0 => damage(&mut bytes, &mut random),
                _ => restructure(&mut bytes, &mut random),
            }
            put(&files[which], &bytes);
            let start = Instant::now();
            let result = open(folder.path());
            let took = start.elapsed();
            longest = longest.max(took);
            assert!(took < Duration::from_secs(5), "seed {index}, mutant {number}: {took:?}");
            match result {
                Ok(()) => opened += 1,
                Err(error) => {
                    refused += 1;
                    let text = error.to_string();
                    assert!(
                        text.contains(": ") && text.ends_with(')') && !text.contains('\n'),
                        "seed {index}, mutant {number}: {text}"
                    );
                }
            }
            put(&files[which], &whole[which]);
        }
    }
    println!("{opened} opened, {refused} refused, {longest:?} at most, {:?} bytes", peak_memory());
    assert!(opened > 0 && refused > 0, "{opened} opened, {refused} refused");
    if let Some(peak) = peak_memory() {
        assert!(peak < 1 << 30, "{} MiB", peak >> 20);
    }
}

/// Opens a light field of a folder or of the picture in it that is a mosaic, and reads one of its pictures.
fn light_field(folder: &Path) -> Result<(), CaptureError> {
    let mosaic = folder.join("mosaic.png");
    let path = if mosaic.exists() { &mosaic } else { folder };
    let _ = detect_capture_kind(path);
    let pitch = mosaic.exists().then_some([4, 4]);
    let options = LightFieldOptions { pitch, ..LightFieldOptions::default() };
    let field = open_light_field(path, &options, &Unwatched)?;
    assert!(field.views.len() >= 2 && field.views.iter().all(|view| view.position.is_finite()));
    if let Some(disparity) = &field.disparity {
        assert!(
            disparity.map.values.len() == (disparity.map.width * disparity.map.height) as usize
                && disparity.map.range().is_some()
        );
    }
    field.views[0].picture.photograph(&LoadOptions::default()).map(drop)
}

/// Opens the picture with depth `a.jpg` or `a.exr`, and reads it.
fn depth_picture(folder: &Path) -> Result<(), CaptureError> {
    let file =
        ["a.jpg", "a.exr"].map(|name| folder.join(name)).into_iter().find(|file| file.exists()).unwrap();
    let _ = detect_capture_kind(&file);
    let options = DepthPictureOptions {
        near: folder.join("near").exists().then_some(NearEnd::White),
        ..DepthPictureOptions::default()
    };
    let picture = open_depth_picture(&file, &options)?;
    assert!(picture.depth.values.len() == (picture.depth.width * picture.depth.height) as usize);
    picture.picture.photograph(&LoadOptions::default()).map(drop)
}

/// Two by two small views.
fn small_views(folder: &Path) {
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let small = DynamicImage::from(view(f64::from(x), f64::from(y))).crop_imm(16, 16, 32, 32).into_rgb8();
        save(&small, &folder.join(format!("{y}_{x}.png")));
    }
}

#[test]
fn pfm_disparities() {
    survive(
        |folder, index| {
            small_views(folder);
            let file = folder.join("disp.pfm");
            let bytes = match index % 3 {
                0 => disparity_pfm(),
                1 => pfm(7, 5, |x, y| x as f32 - y as f32),
                _ => [b"PF\n3 2 1.0\n".to_vec(), [1.5f32; 18].map(f32::to_be_bytes).concat()].concat(),
            };
            put(&file, bytes);
            vec![file]
        },
        light_field,
    );
}

#[test]
fn exrs_with_depth() {
    survive(
        |folder, index| {
            let file = folder.join("a.exr");
            let (layer, depth) =
                [("", "Z"), ("ViewLayer.Combined.", "ViewLayer.Depth.Z"), ("Image.", "Depth.V")][index % 3];
            let names = ["R", "G", "B"].map(|channel| format!("{layer}{channel}"));
            let color = |x: usize, y: usize| (x * y) as f32;
            exr(
                &file,
                8 + index,
                9,
                &[
                    (&names[0], &color),
                    (&names[1], &color),
                    (&names[2], &color),
                    (depth, &|x, _| 1.0 + x as f32),
                ],
            );
            vec![file]
        },
        depth_picture,
    );
}

#[test]
fn gdepth() {
    survive(
        |folder, index| {
            let file = folder.join("a.jpg");
            let format = ["RangeInverse", "RangeLinear"][index % 2];
            let depth =
                if index % 3 == 0 { levels_png(20, 15) } else { encoded(levels8(20, 15), ImageFormat::Jpeg) };
            let original = jpeg(40, 30, 99);
            let original = (index % 4 == 0).then_some(&original[..]);
            let piece = (index % 5 > 1 || original.is_some()).then_some(200 * index + 150);
            put(&file, gdepth_jpeg(&gdepth_xmp(format, "0.5", "8"), &depth, original, piece));
            vec![file]
        },
        depth_picture,
    );
}

#[test]
fn dynamic_depth() {
    survive(
        |folder, index| {
            let file = folder.join("a.jpg");
            let depth =
                if index % 3 == 0 { levels_png(20, 15) } else { encoded(levels8(20, 15), ImageFormat::Jpeg) };
            let original = jpeg(80, 60, 99);
            let things: [(&str, &[u8]); 2] =
                [("android/original_image", &original), ("android/depthmap", &depth)];
            let units = ["Meters", "Diopters"][index % 2];
            let between: &[u8] = if index % 4 == 1 { b"between" } else { b"" };
            let gdepth_xmp = dynamic_depth_xmp("RangeInverse", "0.5", "8", units);
            put(&file, dynamic_depth_jpeg(&gdepth_xmp, &things[usize::from(index > 4)..], between, b""));
            vec![file]
        },
        depth_picture,
    );
}

#[test]
fn parameters() {
    survive(
        |folder, index| {
            for k in 0..2 + index % 3 {
                let small = DynamicImage::from(view(k as f64, 0.0)).crop_imm(16, 16, 32, 32).into_rgb8();
                save(&small, &folder.join(format!("input_Cam{k:03}.png")));
            }
            let file = folder.join("parameters.cfg");
            put(&file, PARAMETERS);
            put(&folder.join("gt_depth_lowres.pfm"), pfm(4, 4, |x, _| 1.0 + x as f32));
            vec![file]
        },
        light_field,
    );
}

#[test]
fn attributes_and_depths() {
    survive(
        |folder, index| {
            small_views(folder);
            let side = 3 + index as u32;
            let files = ["attributes.dat", "depth.bin"].map(|name| folder.join(name));
            let text = attributes(side);
            put(&files[0], if index % 2 == 0 { text } else { text.replace("9.375 //", "0 //") });
            put(
                &files[1],
                (0..side * side).flat_map(|k| (19.0 + k as f32).to_le_bytes()).collect::<Vec<u8>>(),
            );
            files.to_vec()
        },
        light_field,
    );
}

#[test]
fn lists_of_views() {
    survive(
        |folder, index| {
            small_views(folder);
            let names = ["0_0.png", "0_1.png", "1_0.png", "1_1.png"];
            let views: Vec<String> = names[..2 + index % 3]
                .iter()
                .enumerate()
                .map(|(k, name)| {
                    format!("{{\n\"file\": \"{name}\",\n\"position\": [{}, {}]\n}}", k as f64 * 0.5, index)
                })
                .collect();
            let file = folder.join("views.json");
            let rest = [",\n\"reference\": \"0_1.png\"", ",\n\"disparity\": \"map.pfm\"", ""][index % 3];
            put(&folder.join("map.pfm"), pfm(4, 4, |x, _| x as f32));
            put(&file, format!("{{\n\"views\": [\n{}\n]{rest}\n}}\n", views.join(",\n")));
            vec![file]
        },
        light_field,
    );
}

#[test]
fn mosaics() {
    survive(
        |folder, index| {
            let file = folder.join("mosaic.png");
            let whole: RgbImage = view(0.0, index as f64);
            let whole = DynamicImage::from(whole).crop_imm(0, 0, SIDE - index as u32, SIDE);
            let whole = match index % 3 {
                0 => whole,
                1 => whole.into_rgba16().into(),
                _ => whole.into_luma8().into(),
            };
            put(&file, encoded(whole, ImageFormat::Png));
            vec![file]
        },
        light_field,
    );
}

#[test]
fn grey_depths_beside_a_picture() {
    survive(
        |folder, index| {
            put(&folder.join("a.jpg"), jpeg(40, 30, 90));
            put(&folder.join("near"), "");
            let file = folder.join("a_depth.png");
            put(
                &file,
                if index % 2 == 0 { levels_png(20, 15) } else { encoded(levels8(20, 15), ImageFormat::Png) },
            );
            vec![file, folder.join("a.jpg")]
        },
        depth_picture,
    );
}
