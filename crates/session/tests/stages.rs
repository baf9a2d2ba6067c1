//! After a change, no picture that is shown is farther from the exact one than the picture before it.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;

use document::CameraEdit;
use glam::{DMat4, DVec3, Vec3};
use scene::{Backdrop, World};
use session::{Command, PreviewKind, Quality, Session, SessionOptions};
use std::path::Path;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(300);

/// How much farther from the exact picture the next stage may be, dB.
const TOLERANCE_DB: f64 = 0.3;

/// What was on the screen.
struct Stage {
    name: String,
    size: [u32; 2],
    pixels: Vec<[u8; 4]>,
}

/// Applies a command; returns everything that is shown until the picture is fine, in order.
fn stages_after(session: &mut Session, command: Command) -> Vec<Stage> {
    let (start, mut last) = (Instant::now(), session.preview().map_or(0, |preview| preview.id));
    session.apply(command).unwrap();
    session.apply(Command::FinishEdit).unwrap();
    let mut stages = Vec::new();
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
        let kind = if preview.kind == PreviewKind::Pinhole { "pinhole" } else { "blurred" };
        let quality = if preview.quality > Quality::Coarse { "fine" } else { "coarse" };
        let name = format!("{quality} {kind} {} × {}", preview.camera.width, preview.camera.height);
        stages.push(Stage {
            name,
            size: session.screen().size(),
            pixels: session.screen().pixels().to_vec(),
        });
    }
}

/// A stage's value, enlarged bilinearly as the window does.
fn value(stage: &Stage, [x, y]: [u32; 2], size: [u32; 2], channel: usize) -> f64 {
    let place = |at: u32, own: u32, size: u32| {
        ((f64::from(at) + 0.5) * f64::from(own) / f64::from(size) - 0.5).clamp(0.0, f64::from(own - 1))
    };
    let (u, v) = (place(x, stage.size[0], size[0]), place(y, stage.size[1], size[1]));
    let at = |column: f64, row: f64| {
        let column = (column as u32).min(stage.size[0] - 1);
        let row = (row as u32).min(stage.size[1] - 1);
        f64::from(stage.pixels[(row * stage.size[0] + column) as usize][channel])
    };
    let lerp = |a: f64, b: f64, share: f64| a + (b - a) * share;
    let along = |row: f64| lerp(at(u.floor(), row), at(u.floor() + 1.0, row), u.fract());
    lerp(along(v.floor()), along(v.floor() + 1.0), v.fract())
}

/// PSNR of what the screen showed, dB.
fn psnr(stage: &Stage, last: &Stage) -> f64 {
    let [width, height] = last.size;
    let mut sum = 0.0;
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let exact = f64::from(last.pixels[(y * width + x) as usize][channel]);
                sum += (value(stage, [x, y], last.size, channel) - exact).powi(2);
            }
        }
    }
    -10.0 * (sum / (f64::from(width * height) * 3.0 * 255.0 * 255.0)).log10()
}

/// Moves the camera, takes that back, changes the backdrop, and opens the aperture by a stop.
fn check(scene: &Path, preview_size: u32) {
    let mut session = Session::new(SessionOptions { preview_size, ..SessionOptions::default() }).unwrap();
    session.apply(Command::Open(scene.into())).unwrap();
    at_work::settle(&mut session);
    let document = session.document().unwrap();
    let camera = document.camera.clone();
    let aside = DVec3::new(0.06, 0.02, 0.0) * camera.focus_distance.min(10.0);
    let moved = camera.camera_to_world * DMat4::from_translation(aside);
    let background = camera.background.map(|color| DVec3::from_array(color).as_vec3());
    let world = World::from_scene(document.scene(), background);
    let backdrop = World { backdrop: Backdrop::Color(Vec3::new(0.2, 0.3, 0.5)), ..world };
    let changes = [
        ("a move", Command::EditCamera(CameraEdit::Pose(moved))),
        ("its undo", Command::Undo),
        ("another backdrop", Command::SetWorld(Some(backdrop))),
        ("a wider aperture", Command::EditCamera(CameraEdit::ApertureRadius(camera.aperture_radius * 1.42))),
    ];
    for (change, command) in changes {
        let stages = stages_after(&mut session, command);
        let Some((last, before)) = stages.split_last() else {
            println!("{}: {change}: nothing to draw", scene.display());
            continue;
        };
        let mut least = 0.0;
        for stage in before {
            let db = psnr(stage, last);
            println!("{}: {change}: {}: {db:.1} dB", scene.display(), stage.name);
            assert!(db > least - TOLERANCE_DB, "{change}: {} has {db:.2} dB after {least:.2}", stage.name);
            least = f64::max(least, db);
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
    check(&folder.path().join("demo.fbrush"), 480);
}

#[test]
fn scenes_of_others_only_get_better() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/gltf");
    for scene in ["Fox.glb", "FlightHelmet/FlightHelmet.gltf", "vr-gallery.glb", "portal.glb"] {
        let file = data.join(scene);
        if !file.is_file() {
            eprintln!("SKIPPED: {} is not there", file.display());
            continue;
        }
        check(&file, 240);
    }
}
