//! After a change, no picture that is shown is farther from the exact one than the picture before it.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;

use document::CameraEdit;
use glam::{DMat4, DVec3, Vec3};
use nv_flip::{FlipImageRgb8, FlipPool};
use render::Display;
use scene::{Backdrop, World};
use session::{Command, Event, PreviewKind, Quality, Session, SessionOptions};
use std::path::Path;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(300);

/// How much farther from the exact picture the next stage may be, dB.
const TOLERANCE_DB: f64 = 0.3;

/// The same in FLIP.
const TOLERANCE_FLIP: f32 = 0.005;

/// What was on the screen.
struct Stage {
    name: String,
    size: [u32; 2],
    pixels: Vec<[u8; 4]>,
}

/// What is on the screen.
fn shown(session: &Session, name: String) -> Stage {
    Stage { name, size: session.screen().size(), pixels: session.screen().pixels().to_vec() }
}

/// Applies a command; returns what was shown before, and everything that is until the picture is fine, in order.
fn stages_after(session: &mut Session, command: Command) -> Vec<Stage> {
    let (start, mut last) = (Instant::now(), session.preview().map_or(0, |preview| preview.id));
    let mut stages = vec![shown(session, "what stood".into())];
    session.apply(command).unwrap();
    session.apply(Command::FinishEdit).unwrap();
    loop {
        assert!(start.elapsed() < PATIENCE, "no fine picture comes");
        session.poll();
        let Some(preview) = session.preview().filter(|preview| preview.id > last) else {
            if session.is_settled() {
                return stages;
            }
            std::thread::sleep(Duration::from_millis(1));
            continue;
        };
        last = preview.id;
        let kind = match preview.kind {
            PreviewKind::Pinhole => "pinhole",
            PreviewKind::Defocused => "defocused",
            PreviewKind::Splat | PreviewKind::Update => "blurred",
        };
        let quality = if preview.quality > Quality::Coarse { "fine" } else { "coarse" };
        let name = format!("{quality} {kind} {} × {}", preview.camera.width, preview.camera.height);
        stages.push(shown(session, name));
    }
}

/// What the screen showed in so many columns and rows, RGB by pixel: enlarged bilinearly, as the window does.
fn enlarged(stage: &Stage, [width, height]: [u32; 2]) -> Vec<u8> {
    let place = |at: u32, own: u32, size: u32| {
        ((f64::from(at) + 0.5) * f64::from(own) / f64::from(size) - 0.5).clamp(0.0, f64::from(own - 1))
    };
    let mut bytes = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let (u, v) = (place(x, stage.size[0], width), place(y, stage.size[1], height));
            for channel in 0..3 {
                let at = |column: f64, row: f64| {
                    let column = (column as u32).min(stage.size[0] - 1);
                    let row = (row as u32).min(stage.size[1] - 1);
                    f64::from(stage.pixels[(row * stage.size[0] + column) as usize][channel])
                };
                let lerp = |a: f64, b: f64, share: f64| a + (b - a) * share;
                let along = |row: f64| lerp(at(u.floor(), row), at(u.floor() + 1.0, row), u.fract());
                bytes.push(lerp(along(v.floor()), along(v.floor() + 1.0), v.fract()).round() as u8);
            }
        }
    }
    bytes
}

/// How far what the screen showed was from the last picture: PSNR in dB, and FLIP.
fn distance(stage: &Stage, last: &Stage) -> (f64, f32) {
    let [width, height] = last.size;
    let [shown, exact] = [stage, last].map(|stage| enlarged(stage, last.size));
    let square = |(a, b): (&u8, &u8)| (f64::from(*a) - f64::from(*b)).powi(2);
    let mean = shown.iter().zip(&exact).map(square).sum::<f64>() / (shown.len() as f64 * 255.0 * 255.0);
    let [shown, exact] = [shown, exact].map(|bytes| FlipImageRgb8::with_data(width, height, &bytes));
    let map = nv_flip::flip(exact, shown, nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    (-10.0 * mean.log10(), FlipPool::from_image(&map).mean())
}

/// Moves the camera, takes that back, changes the world's brightness and its backdrop, opens the aperture by a stop, and racks the focus.
fn check(scene: &Path, preview_size: u32) {
    let mut session = Session::new(SessionOptions { preview_size, ..SessionOptions::default() }).unwrap();
    session.apply(Command::Open(scene.into())).unwrap();
    for event in at_work::settle(&mut session) {
        // As the window does.
        if let Event::GlareDetected(stops) = event {
            let display = Display { stops, ..session.display() };
            session.apply(Command::SetDisplay(display)).unwrap();
        }
    }
    let document = session.document().unwrap();
    let camera = document.camera.clone();
    let aside = DVec3::new(0.06, 0.02, 0.0) * camera.focus_distance.min(10.0);
    let moved = camera.camera_to_world * DMat4::from_translation(aside);
    let background = camera.background.map(|color| DVec3::from_array(color).as_vec3());
    let world = World::from_scene(document.scene(), background);
    let brighter = World { strength: 1.5 * world.strength, ..world.clone() };
    let backdrop = World { backdrop: Backdrop::Color(Vec3::new(0.2, 0.3, 0.5)), ..brighter.clone() };
    // A view that was left is no picture of the new one; nor is a draft in few pixels always nearer than what is hardly blurred.
    let is_large = preview_size >= 480;
    let wider = CameraEdit::ApertureRadius(camera.aperture_radius * 1.42);
    let racked = CameraEdit::FocusDistance(camera.focus_distance * 1.15);
    // With whether the picture that stood counts.
    let changes = [
        ("a move", Command::EditCamera(CameraEdit::Pose(moved)), false),
        ("its undo", Command::Undo, false),
        ("a brighter world", Command::SetWorld(Some(brighter)), true),
        ("another backdrop", Command::SetWorld(Some(backdrop)), true),
        ("a wider aperture", Command::EditCamera(wider), is_large),
        ("a rack", Command::EditCamera(racked), is_large),
    ];
    for (change, command, counts_standing) in changes {
        let stages = stages_after(&mut session, command);
        let Some((last, before)) = stages.split_last() else {
            println!("{}: {change}: nothing to draw", scene.display());
            continue;
        };
        let (mut best_psnr, mut best_flip) = (0.0, 1.0f32);
        for stage in &before[usize::from(!counts_standing)..] {
            let (psnr, flip) = distance(stage, last);
            println!("{}: {change}: {}: {psnr:.1} dB, FLIP {flip:.4}", scene.display(), stage.name);
            let name = &stage.name;
            assert!(
                psnr > best_psnr - TOLERANCE_DB,
                "{change}: {name} has {psnr:.2} dB after {best_psnr:.2}"
            );
            assert!(
                flip < best_flip + TOLERANCE_FLIP,
                "{change}: {name} has FLIP {flip:.4} after {best_flip:.4}"
            );
            (best_psnr, best_flip) = (f64::max(best_psnr, psnr), best_flip.min(flip));
        }
    }
}

#[test]
fn the_demo_only_gets_better() {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/demo");
    let folder = tempfile::tempdir().unwrap();
    for name in ["demo.fbrush", "demo.glb"] {
        std::fs::copy(demo.join(name), folder.path().join(name)).unwrap();
    }
    check(&folder.path().join("demo.fbrush"), 640);
}

#[test]
fn scenes_of_others_only_get_better() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/gltf");
    let scenes = [
        "Fox.glb",
        "FlightHelmet/FlightHelmet.gltf",
        "vr-gallery.glb",
        // Lamps of its own and the world light it.
        "portal.glb",
        // What is ten times as bright as white stands before black.
        "DepthOfFieldExample.glb",
    ];
    for scene in scenes {
        let file = data.join(scene);
        if !file.is_file() {
            eprintln!("SKIPPED: {} is not there", file.display());
            continue;
        }
        check(&file, 240);
    }
}
