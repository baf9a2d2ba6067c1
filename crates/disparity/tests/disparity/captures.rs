//! The figures for light fields of `shared/data`, printed: `cargo test -p disparity -- --ignored --nocapture`.
//!
//! With DISPARITY_PICTURES=FOLDER the maps are written there as pictures.

use crate::field::Field;
use crate::score::score;
use crate::still_life::StillLife;
use disparity::{DisparityMap, DisparityRequest, estimate_disparities};
use progress::Unwatched;
use std::path::{Path, PathBuf};

fn data(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/lightfield").join(name);
    if !folder.is_dir() {
        eprintln!("SKIPPED: {} does not exist", folder.display());
        return None;
    }
    Some(folder)
}

fn read(files: Vec<(PathBuf, [f64; 2])>) -> Field {
    let mut field = Field { width: 0, height: 0, pictures: Vec::new(), positions: Vec::new() };
    for (file, position) in files {
        let picture = image::open(&file).expect("a picture").to_rgb8();
        (field.width, field.height) = (picture.width() as usize, picture.height() as usize);
        field.pictures.push(picture.pixels().map(|p| p.0.map(|v| f32::from(v) / 255.0)).collect());
        field.positions.push(position);
    }
    field
}

/// A PFM of one channel, rows from the top.
fn pfm(file: &Path) -> Vec<f32> {
    let bytes = std::fs::read(file).expect("a file");
    let header: Vec<usize> =
        bytes.iter().enumerate().filter(|(_, b)| b.is_ascii_whitespace()).map(|(i, _)| i).take(4).collect();
    let width: usize = std::str::from_utf8(&bytes[header[0] + 1..header[1]]).unwrap().parse().unwrap();
    let values: Vec<f32> =
        bytes[header[3] + 1..].chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    values.chunks(width).rev().flatten().copied().collect()
}

fn show(name: &str, map: &DisparityMap, field: &Field) {
    let Some(folder) = std::env::var_os("DISPARITY_PICTURES").map(PathBuf::from) else { return };
    let fold = |start: f32, f: fn(f32, f32) -> f32| map.disparity.iter().copied().fold(start, f);
    let (low, high) = (fold(f32::MAX, f32::min), fold(f32::MIN, f32::max));
    let (w, h) = (map.width as u32, map.height as u32);
    let picture = image::RgbImage::from_fn(3 * w, h, |x, y| {
        let at = (y * w + x % w) as usize;
        image::Rgb(match x / w {
            0 => field.pictures[map.view][at].map(|v| (255.0 * v) as u8),
            1 => [(255.0 * (map.disparity[at] - low) / (high - low)) as u8; 3],
            _ => [(255.0 * map.confidence[at]) as u8; 3],
        })
    });
    picture.save(folder.join(format!("{name}.png"))).expect("written");
}

fn measure(name: &str, field: &Field, others: &[[f64; 2]]) -> Vec<DisparityMap> {
    let request = DisparityRequest {
        reference: field.at([0.0, 0.0]),
        others: others.iter().map(|p| field.at(*p)).collect(),
        range: None,
    };
    let start = std::time::Instant::now();
    let maps = estimate_disparities(&field.views(), &request, &Unwatched).expect("disparities");
    eprintln!("{name}: {:.2} s for {} maps", start.elapsed().as_secs_f32(), maps.len());
    for (k, map) in maps.iter().enumerate() {
        let mut sorted = map.disparity.clone();
        sorted.sort_unstable_by(f32::total_cmp);
        eprintln!(
            "{name}: view {}: disparities {:.3} … {:.3}",
            map.view,
            sorted[0],
            sorted[sorted.len() - 1]
        );
        show(&format!("{name}_{k}"), map, field);
    }
    maps
}

#[test]
#[ignore = "prints figures; a minute"]
fn helmet_and_cake() {
    let Some(folder) = data("synthetic_helmet_cake_9x9") else { return };
    let place = |i: usize| [(i % 9) as f64 - 4.0, (i / 9) as f64 - 4.0];
    let field = read((0..81).map(|i| (folder.join(format!("input_Cam{i:03}.png")), place(i))).collect());
    let maps = measure("helmet_cake", &field, &[[-4.0, -4.0], [4.0, 0.0]]);
    let score = score(&maps[0].disparity, &pfm(&folder.join("gt_disp_lowres.pfm")));
    eprintln!("helmet_cake: {score}");
    assert!(score.bad_007 < 8.0, "{score}");
}

#[test]
#[ignore = "prints figures; a minute"]
fn still_life_of_wide_baseline() {
    let Some(folder) = data("hci_stillLife_3x3") else { return };
    let file = |i: usize| folder.join(format!("lf/{:02}_{:02}.png", i / 3, i % 3));
    let field = read((0..9).map(|i| (file(i), [(i % 3) as f64 - 1.0, (i / 3) as f64 - 1.0])).collect());
    let maps = measure("still_life", &field, &[[-1.0, -1.0]]);
    let bytes = std::fs::read(folder.join("depth.bin")).expect("depth");
    let depth = bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()));
    let truth: Vec<f32> = depth.map(|z| 614.4 * 9.375 / z - 288.0).collect();
    eprintln!("still_life: {}", score(&maps[0].disparity, &truth));
}

#[test]
#[ignore = "prints figures; a minute"]
fn kitchen_in_a_row() {
    let Some(folder) = data("hci_kitchen_row") else { return };
    let files = (36..45).map(|i| (folder.join(format!("input_Cam{i:03}.png")), [i as f64 - 40.0, 0.0]));
    measure("kitchen", &read(files.collect()), &[[4.0, 0.0]]);
}

#[test]
#[ignore = "prints figures; minutes, most of them for the rays"]
fn own_still_life_of_512() {
    let life = StillLife { size: 512, parallax: 1.2, noise: 0.008, samples: 2 };
    let mut field =
        Field { width: 512, height: 512, pictures: Vec::new(), positions: crate::field::grid(4, 4) };
    let mut truths = Vec::new();
    for position in field.positions.clone() {
        let photograph = life.photograph(position);
        field.pictures.push(photograph.rgb);
        if [[0.0, 0.0], [-4.0, -4.0], [4.0, 4.0]].contains(&position) {
            truths.push((position, photograph.disparity));
        }
    }
    let maps = measure("own", &field, &[[-4.0, -4.0], [4.0, 4.0]]);
    for map in maps {
        let truth = &truths.iter().find(|(p, _)| *p == field.positions[map.view]).expect("a truth").1;
        eprintln!("own: view {}: {}", map.view, score(&map.disparity, truth));
    }
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        eprintln!("own: {}", status.lines().find(|l| l.starts_with("VmHWM")).unwrap_or_default());
    }
}
