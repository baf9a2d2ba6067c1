//! `docs/reference/salf.md` says what a `.salf` file is: another program that was written by it (`tests/salf/read_salf.py`) finds in our
//! files what our own reader finds, sample by sample, and draws the same picture.

mod tiny_glb;

use document::Input;
use glam::{DMat4, DVec3};
use lens::{Aperture, ApertureMask, ApertureShape, Camera, FocusOffset};
use light::LitScene;
use progress::Unwatched;
use render::{RenderOptions, render_input, write_salf};
use salf::{Salf, SalfFile, Sample, Visibility};
use scene::{AlphaMode, Material, Scalar, Workflow};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;
use tempfile::TempDir;
use trace::Tracer;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Whether there is a Python 3; says so if not.
fn python_is_there() -> bool {
    let is_there =
        Command::new("python3").arg("--version").output().is_ok_and(|found| found.status.success());
    if !is_there {
        eprintln!("SKIPPED: there is no python3: nothing but our own program has read a .salf file");
    }
    is_there
}

/// Runs a script of `tests/salf`.
fn script(name: &str, arguments: &[&Path]) -> Output {
    let script = Path::new(ROOT).join("tests/salf").join(name);
    Command::new("python3").arg(script).args(arguments).output().unwrap()
}

/// What a script that must succeed writes to stdout.
fn said(output: Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn summary(file: &Path) -> Value {
    serde_json::from_str(&said(script("read_salf.py", &[file]))).unwrap()
}

fn lines(file: &Path) -> Vec<Value> {
    let lines = said(script("read_salf.py", &[file, Path::new("--samples")]));
    lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// What the script says of a file that it must refuse: one line, which names the file and ends with the cure.
fn refusal(file: &Path) -> String {
    let output = script("read_salf.py", &[file]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(3), 0), "{error}");
    let line = error.strip_suffix('\n').unwrap();
    let starts_as_it_should = line.starts_with(&format!("error: {}: ", file.display()));
    assert!(starts_as_it_should && line.ends_with(')') && !line.contains('\n'), "{error}");
    line.into()
}

/// Numbers that were written as doubles, as our own reader holds them.
fn floats<const N: usize>(value: &Value) -> [f32; N] {
    let values: Vec<_> = value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap() as f32).collect();
    values.try_into().unwrap()
}

/// A sample of our own reader is, bit for bit, what the script says.
fn assert_same(ours: &Sample, theirs: &Value) {
    let number = |name: &str| theirs[name].as_f64().unwrap() as f32;
    assert_eq!(ours.center.to_array(), floats(&theirs["center"]), "{theirs}");
    assert_eq!(ours.half_size.to_array(), floats(&theirs["half_size"]), "{theirs}");
    assert_eq!((ours.inverse_depth, ours.weight), (number("inverse_depth"), number("weight")), "{theirs}");
    assert_eq!(ours.tilt.to_array(), floats(&theirs["tilt"]), "{theirs}");
    assert_eq!(ours.radiance.to_array(), floats(&theirs["radiance"]), "{theirs}");
    match ours.surface {
        None => assert!(theirs["triangle"].is_null() && theirs["barycentric"].is_null(), "{theirs}"),
        Some(point) => {
            assert_eq!(Some(u64::from(point.triangle)), theirs["triangle"].as_u64());
            let barycentric = floats(&theirs["barycentric"]);
            assert_eq!(point.barycentric.as_vec2().to_array(), barycentric, "{theirs}");
        }
    }
    assert_eq!(Some(ours.is_carried), theirs["is_carried"].as_bool(), "{theirs}");
    match &ours.visibility {
        Visibility::Open => assert!(theirs["seen"].is_null(), "{theirs}"),
        Visibility::Cells { words } => {
            let side = Visibility::side_of(words);
            let rows =
                (0..side).map(|row| format!("{:0width$x}", Visibility::row(words, row), width = side / 4));
            assert_eq!(Value::from_iter(rows), theirs["seen"]);
        }
    }
}

/// A light field and the file that it was written to, beside its scene.
struct Baked {
    folder: TempDir,
    salf: Arc<Salf>,
}

impl Baked {
    fn path(&self) -> PathBuf {
        self.folder.path().join("quads.salf")
    }

    /// Bakes the small scene for a camera that may be changed first.
    fn of(change: impl FnOnce(&mut Camera)) -> Self {
        Self::of_materials(change, |_| ())
    }

    /// The same where its materials are changed, too.
    fn of_materials(change: impl FnOnce(&mut Camera), materials: impl FnOnce(&mut [Material])) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("quads.glb");
        tiny_glb::write(&scene);
        Self::of_file(folder, &scene, change, materials)
    }

    /// Bakes a file in a folder.
    fn of_file(
        folder: TempDir,
        scene: &Path,
        change: impl FnOnce(&mut Camera),
        materials: impl FnOnce(&mut [Material]),
    ) -> Self {
        let input = Input::open(scene, &Default::default(), &Unwatched).unwrap();
        let lens = Camera { aperture_radius: 0.1, sensor_height: 0.1, ..input.camera.clone() };
        let mut camera = Camera { width: 60, height: 40, background: Some([0.1, 0.05, 0.2]), ..lens };
        change(&mut camera);
        let focus = focus::Focus::constant(input.scene.clone(), FocusOffset::STANDARD);
        let mut changed = (*input.scene).clone();
        materials(&mut changed.materials);
        let lit = LitScene::new(Arc::new(Tracer::new(changed.into())), input.light, &input.resources);
        let salf = Arc::new(RenderOptions::default().bake(&lit, &camera, &focus, &Unwatched).unwrap());
        let baked = Self { folder, salf };
        write_salf(&baked.path(), scene, &input.scene, &baked.salf).unwrap();
        baked
    }

    /// From the front, nearly focused on the wall, through a polygon.
    fn from_the_front() -> Self {
        Self::of(|camera| {
            camera.focus_distance = 3.6;
            let shape = ApertureShape::Polygon { blades: 5, rotation: 0.3, roundness: 0.2 };
            camera.aperture = Aperture { shape, ratio: 1.3 };
        })
    }

    /// From the front, the card half there and the wall a mirror.
    fn of_glass_and_gloss() -> Self {
        let scalar = |factor| Scalar { factor, texture: None };
        let change = |materials: &mut [Material]| {
            let [wall, card, ..] = materials else { panic!("two materials") };
            (card.alpha, card.base_color.w) = (AlphaMode::Blend, 0.4);
            wall.unlit = false;
            wall.workflow = Workflow::MetallicRoughness { metallic: scalar(0.9), roughness: scalar(0.1) };
        };
        Self::of_materials(|camera| camera.focus_distance = 1.0, change)
    }

    /// Three walls of splats behind each other, with gaps.
    fn of_splats() -> Self {
        let splat = |k: u16| {
            let [x, y] = [k % 10, k / 10 % 10].map(|step| 0.08 * f32::from(step) - 0.36);
            let floats = [x, y, 2.0 + f32::from(k / 100), 0.04, 0.03, 0.01];
            let color = [k, 3 * k, 5 * k, 230].map(|value| value as u8);
            floats.into_iter().flat_map(f32::to_le_bytes).chain(color).chain([255, 128, 128, 128])
        };
        let folder = tempfile::tempdir().unwrap();
        let scan = folder.path().join("scan.splat");
        std::fs::write(&scan, (0..300).flat_map(splat).collect::<Vec<_>>()).unwrap();
        let camera = |camera: &mut Camera| (camera.focus_distance, camera.aperture_radius) = (2.0, 0.05);
        Self::of_file(folder, &scan, camera, |_| ())
    }

    /// From the left, in the card's plane: the card is edge-on, the sky behind it is seen.
    fn from_the_side() -> Self {
        Self::of(|camera| {
            let axes = DMat4::from_cols_array_2d(&[
                [0.0, 0.0, 1.0, 0.0],
                [0.0, 1.0, 0.0, 0.0],
                [-1.0, 0.0, 0.0, 0.0],
                [0.0, 0.0, 0.0, 1.0],
            ]);
            camera.camera_to_world = DMat4::from_translation(DVec3::new(-3.0, 0.0, -2.0)) * axes;
            (camera.focus_distance, camera.aperture_radius) = (f64::INFINITY, 0.3);
        })
    }
}

/// Our own mean of the samples' radiance, each with its weight.
fn mean_radiance(salf: &Salf, weight: impl Fn(&Sample) -> f64) -> [f64; 3] {
    let (mut sum, mut total) = (DVec3::ZERO, 0.0);
    for sample in salf.samples.iter() {
        sum += sample.radiance.as_dvec3() * weight(&sample);
        total += weight(&sample);
    }
    (sum / total).to_array()
}

fn assert_close(ours: [f64; 3], theirs: &Value) {
    for (ours, theirs) in ours.iter().zip(theirs.as_array().unwrap()) {
        assert!((theirs.as_f64().unwrap() / ours - 1.0).abs() <= 1e-9, "{ours} {theirs}");
    }
}

/// The same file with some bytes changed, and sound again.
fn resealed(file: &Path, change: impl FnOnce(&mut Vec<u8>)) {
    let mut bytes = std::fs::read(file).unwrap();
    bytes.truncate(bytes.len() - 32);
    change(&mut bytes);
    let checksum = Sha256::digest(&bytes);
    bytes.extend(checksum);
    std::fs::write(file, bytes).unwrap();
}

/// The indented block of a page that begins with `start`.
fn block_of_page<'a>(page: &'a str, start: &str) -> Vec<&'a str> {
    let from_there = page.lines().skip_while(|line| !line.starts_with(&format!("    {start}")));
    from_there.map_while(|line| line.strip_prefix("    ")).collect()
}

/// The example's file, into `folder`, and what the page says that it holds.
fn example(folder: &Path) -> (PathBuf, Vec<Value>) {
    let page = std::fs::read_to_string(Path::new(ROOT).join("docs/reference/salf.md")).unwrap();
    let digits = block_of_page(&page, "464253414c46").concat();
    let byte = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).unwrap();
    let file = folder.join("example.salf");
    std::fs::write(&file, (0..digits.len()).step_by(2).map(byte).collect::<Vec<_>>()).unwrap();
    let told =
        block_of_page(&page, "{\"form\"").iter().map(|line| serde_json::from_str(line).unwrap()).collect();
    (file, told)
}

#[test]
fn the_example_of_the_page_is_what_the_page_says() {
    let folder = tempfile::tempdir().unwrap();
    let (file, told) = example(folder.path());
    let bytes = std::fs::read(&file).unwrap();
    let read = SalfFile::read(bytes.as_slice()).unwrap();
    let samples = read.salf.samples.to_vec();
    assert_eq!((samples.len(), told.len()), (4, 4));
    samples.iter().zip(&told).for_each(|(ours, told)| assert_same(ours, told));
    let mut written = Vec::new();
    read.write(&mut written).unwrap();
    assert!(written == bytes, "it is as we write it");
    if python_is_there() {
        assert_eq!(lines(&file), told);
    }
}

#[test]
fn a_reader_by_the_page_finds_every_sample_as_we_do() {
    if !python_is_there() {
        return;
    }
    for (baked, forms, side) in [
        (Baked::from_the_front(), ["whole_cell", "part_of_cell", "part_of_quadrant"], 8),
        (Baked::from_the_side(), ["whole_cell", "part_of_cell", "patch"], 16),
        (Baked::of_glass_and_gloss(), ["whole_cell", "part_of_cell", "part_of_quadrant"], 16),
        (Baked::of_splats(), ["splat", "splat", "splat"], 16),
    ] {
        let found = lines(&baked.path());
        assert_eq!(found.len(), baked.salf.samples.len());
        baked.salf.samples.iter().zip(&found).for_each(|(ours, theirs)| assert_same(&ours, theirs));

        let summary = summary(&baked.path());
        for form in forms {
            assert!(summary["forms"][form].as_u64().unwrap() > 0, "{form}: {summary}");
        }
        let of_side = |theirs: &&Value| theirs["seen"].as_array().is_some_and(|rows| rows.len() == side);
        assert!(found.iter().filter(of_side).count() > 10, "{side} cells a side: {summary}");
        let statistics = baked.salf.statistics();
        let count = |name: &str| summary[name].as_u64().unwrap() as usize;
        assert_eq!((count("open"), count("partly_occluded")), (statistics.open, statistics.partial));
        assert_eq!(
            (count("background"), count("margin_px")),
            (statistics.background, baked.salf.margin_px as usize)
        );
        assert_close(mean_radiance(&baked.salf, |_| 1.0), &summary["mean_radiance"]);
        let by_weight = mean_radiance(&baked.salf, |sample| sample.weight.max(0.0).into());
        assert_close(by_weight, &summary["mean_radiance_by_weight"]);
        let inverse_depths =
            || baked.salf.samples.iter().map(|s| s.inverse_depth).filter(|&inverse| inverse > 0.0);
        let nearest = 1.0 / f64::from(inverse_depths().fold(0.0, f32::max));
        let farthest = 1.0 / f64::from(inverse_depths().fold(f32::INFINITY, f32::min));
        assert_eq!(
            (summary["nearest_depth"].as_f64(), summary["farthest_depth"].as_f64()),
            (Some(nearest), Some(farthest))
        );
    }
}

#[test]
fn a_reader_by_the_page_knows_all_apertures_and_samples_that_are_not_packed() {
    if !python_is_there() {
        return;
    }
    let baked = Baked::from_the_side();
    let mask =
        ApertureMask { width: 2, height: 1, transmission: vec![0.25, 1.0], file: "blende ü.png".into() };
    for (shape, name) in [
        (ApertureShape::Disc, "disc"),
        (ApertureShape::Square, "square"),
        (ApertureShape::Mask(mask.into()), "mask"),
    ] {
        let camera = Camera { aperture: Aperture { shape, ratio: 0.7 }, ..baked.salf.camera.clone() };
        let samples = baked.salf.samples.changed(|sample| sample.radiance *= 1.5);
        let file = SalfFile {
            source: "a/ü.glb".into(),
            triangles: 6,
            salf: Arc::new(Salf::with_samples(camera, samples)),
        };
        file.write(std::fs::File::create(baked.path()).unwrap()).unwrap();
        let summary = summary(&baked.path());
        let aperture = &summary["camera"]["aperture"];
        assert_eq!((aperture["shape"].as_str(), aperture["ratio"].as_f64()), (Some(name), Some(0.7)));
        assert_eq!(
            (&summary["source"], &summary["camera"]["focus_distance"]),
            (&"a/ü.glb".into(), &"inf".into())
        );
        if name == "mask" {
            assert_eq!((&aperture["file"], &aperture["columns"]), (&"blende ü.png".into(), &2.into()));
        }
        assert_eq!(summary["forms"]["loose"], file.salf.samples.len());
        let found = lines(&baked.path());
        file.salf.samples.iter().zip(&found).for_each(|(ours, theirs)| assert_same(&ours, theirs));
    }
}

/// Where the counts begin of a file whose aperture is a polygon.
fn counts_at(source: &str) -> usize {
    let camera = 8 + 8 * (4 + 2 + 3 + 16 + 1) + 1 + 4 + 16;
    8 + 4 + 4 + source.len() + 4 + camera + 4
}

#[test]
fn another_colour_is_another_mean() {
    if !python_is_there() {
        return;
    }
    let baked = Baked::from_the_front();
    let before = summary(&baked.path());
    let blocks = before["blocks"].as_u64().unwrap() as usize;
    let first_record = counts_at("quads.glb") + 7 * 8 + 28 * blocks;
    let red = |bytes: &mut Vec<u8>| bytes[first_record + 11] ^= 0x80;

    let mut unsealed = std::fs::read(baked.path()).unwrap();
    red(&mut unsealed);
    let damaged = baked.folder.path().join("damaged.salf");
    std::fs::write(&damaged, unsealed).unwrap();
    assert!(refusal(&damaged).contains("checksum"));

    resealed(&baked.path(), red);
    let after = summary(&baked.path());
    assert_ne!(before["mean_radiance"][0], after["mean_radiance"][0]);
    assert_eq!(before["mean_radiance"][1], after["mean_radiance"][1], "green is as it was");
    let ours = SalfFile::read(std::fs::File::open(baked.path()).unwrap()).unwrap();
    assert_close(mean_radiance(&ours.salf, |_| 1.0), &after["mean_radiance"]);
}

#[test]
fn a_malformed_file_is_told_in_one_line() {
    if !python_is_there() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = example(folder.path());
    let good = std::fs::read(&file).unwrap();
    let refused = |bytes: &[u8], why: &str| {
        std::fs::write(&file, bytes).unwrap();
        let line = refusal(&file);
        assert!(line.contains(why), "{line}");
    };
    refused(b"PNG", "not a .salf file");
    refused(&good[..8], "cut short");
    refused(&good[..200], "cut short");
    refused(&good[..good.len() - 1], "cut short");
    refused(&[&good[..], &[0]].concat(), "more bytes");
    // What a checksum does not tell: place and value, by what is wrong then.
    for (at, value, why) in [
        (8, 5, "version 5"),
        (8, 10, "version 10"),
        (12, 0xFF, "picture without a size"),
        (14, 0xFF, "a text of"),
        (24, 1, "triangle"),
        (28 + 2, 0xFF, "picture without a size"),
        (28 + 216, 9, "aperture shape 9"),
        (249 + 4, 1, "more samples than there can be"),
        (249 + 3, 0x7F, "cut short"),
        (249 + 48 + 3, 0x7F, "cut short"),
        (305 + 3, 0x7F, "block 0"),
        (333 + 1, 0x07, "a splat in a version without them"),
        (333 + 2, 9, "block 0"),
        (333 + 10, 0xFF, "depth that is not finite"),
        (401, 0, "block 0"),
        (416 + 44, 2, "triangle"),
    ] {
        std::fs::write(&file, &good).unwrap();
        resealed(&file, |bytes| bytes[at] = value);
        let line = refusal(&file);
        assert!(line.contains(why), "byte {at}: {line}");
        assert!(
            SalfFile::read(std::fs::read(&file).unwrap().as_slice()).is_err(),
            "byte {at}: we refuse it, too"
        );
    }
    assert!(refusal(&folder.path().join("none.salf")).contains("No such file"));
}

/// A PFM picture's radiance, row 0 on top.
fn read_pfm(file: &Path, [width, height]: [usize; 2]) -> Vec<[f32; 3]> {
    let bytes = std::fs::read(file).unwrap();
    let pixels = bytes.strip_prefix(format!("PF\n{width} {height}\n-1.0\n").as_bytes()).unwrap();
    let floats: Vec<_> = pixels.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    let rows = floats.chunks_exact(3 * width).rev();
    rows.flat_map(|row| row.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]])).collect()
}

/// −10 log₁₀ of the mean square error.
fn psnr(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let square = |(a, b): (&f32, &f32)| f64::from(a - b).powi(2);
    let sum: f64 = a.as_flattened().iter().zip(b.as_flattened()).map(square).sum();
    -10.0 * (sum / (3 * a.len()) as f64).log10()
}

/// The standard picture that the page's sum makes of a file.
fn drawn_by_the_page(baked: &Baked) -> Vec<[f32; 3]> {
    let pfm = baked.folder.path().join("standard.pfm");
    said(script("salf_picture.py", &[&baked.path(), &pfm]));
    read_pfm(&pfm, [baked.salf.camera.width as usize, baked.salf.camera.height as usize])
}

#[test]
fn the_sum_of_the_page_is_our_picture() {
    if !python_is_there() {
        return;
    }
    let baked = Baked::from_the_front();
    let drawn = drawn_by_the_page(&baked);
    let input = Input::open(&baked.path(), &Default::default(), &Unwatched).unwrap();
    let focus = focus::Focus::constant(input.scene.clone(), FocusOffset::STANDARD);
    let ours = |camera: &Camera| {
        let options = RenderOptions::default();
        render_input(&input, camera, &focus, &options, &Unwatched).unwrap().picture.radiance
    };
    let standard = ours(&input.camera);
    // Partly occluded samples share what is left at outlines, which the page's sum does not; 47 dB.
    let same = psnr(&drawn, &standard);
    assert!(same > 40.0, "{same} dB");
    // Negative controls: another lens, and samples that are taken to see all, make other pictures.
    let other = psnr(&drawn, &ours(&Camera { focus_distance: 2.0, ..input.camera.clone() }));
    assert!(other < same - 6.0, "{other} dB");
    let open = |sample: &mut Sample| sample.visibility = Visibility::Open;
    let blind = Salf { samples: baked.salf.samples.changed(open), ..(*baked.salf).clone() };
    write_salf(&baked.path(), &input.scene.path, &input.scene, &Arc::new(blind)).unwrap();
    let blind = psnr(&drawn_by_the_page(&baked), &standard);
    assert!(blind < same - 6.0, "{blind} dB");
    eprintln!(
        "the page's sum is {same:.1} dB from our picture, another lens's {other:.1} dB, blind {blind:.1} dB"
    );
}
