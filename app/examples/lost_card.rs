//! Destroys the graphics device at a random moment of a session's work, and compares with a session without a card.
//!
//! ```text
//! lost_card --find
//! lost_card SCENE FOLDER CASE
//! ```
//!
//! `--find` says whether there is a card: exit code 5 without one. Otherwise prints a line for what differs, and then
//! ends with exit code 1. Pictures are exported into FOLDER.

use document::StrokePoint;
use glam::DVec2;
use graphics_card::{BackendChoice, Gpu};
use lens::{FocusOffset, Picture};
use session::{Command, Event, Session, SessionOptions};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// More than anything takes on these small scenes.
const PATIENCE: Duration = Duration::from_secs(120);

fn main() -> ExitCode {
    atlas::child::run_if_child();
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let number = |text: &std::ffi::OsString| text.to_str()?.parse::<u64>().ok();
    match &arguments[..] {
        [find] if find == "--find" => match card() {
            Ok(_) => ExitCode::SUCCESS,
            Err(why) => {
                eprintln!("error: {why}");
                ExitCode::from(5)
            }
        },
        [scene, folder, case] if number(case).is_some() => {
            match play(Path::new(scene), Path::new(folder), number(case).unwrap_or(0)) {
                Ok(what) => {
                    println!("{what}");
                    ExitCode::SUCCESS
                }
                Err(what) => {
                    println!("violation: {what}");
                    ExitCode::FAILURE
                }
            }
        }
        _ => {
            eprintln!("error: usage: lost_card --find, or lost_card SCENE FOLDER CASE");
            ExitCode::from(2)
        }
    }
}

/// A device of its own.
fn card() -> Result<Gpu, String> {
    let found = Gpu::open(BackendChoice::Gpu, None).map_err(|e| e.to_string())?;
    found.ok_or_else(|| "there is no graphics card".into())
}

/// What is done, in this order.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Work {
    Open,
    Paint,
    Undo,
    Redo,
    Bake,
    Lens,
    Export,
    PaintMore,
}

const WORK: [Work; 8] =
    [Work::Open, Work::Paint, Work::Undo, Work::Redo, Work::Bake, Work::Lens, Work::Export, Work::PaintMore];

/// What a session has after some work.
struct Outcome {
    map: focus::FocusMap,
    picture: Arc<Picture>,
}

/// A session at work, and what it told the user.
struct AtWork {
    session: Session,
    told: Vec<String>,
    export: PathBuf,
}

impl AtWork {
    fn new(gpu: Option<Gpu>, export: PathBuf) -> Result<Self, String> {
        let options = SessionOptions { preview_size: 96, gpu, ..SessionOptions::default() };
        Ok(Self { session: Session::new(options).map_err(|e| e.to_string())?, told: Vec::new(), export })
    }

    fn apply(&mut self, command: Command) -> Result<(), String> {
        self.session.apply(command).map_err(|e| e.to_string())
    }

    /// Does some work and waits for its end.
    fn work(&mut self, work: Work, scene: &Path) -> Result<(), String> {
        match work {
            Work::Open => self.apply(Command::Open(scene.into()))?,
            Work::Paint => self.paint(0.3)?,
            Work::PaintMore => self.paint(0.6)?,
            Work::Undo => self.apply(Command::Undo)?,
            Work::Redo => self.apply(Command::Redo)?,
            Work::Bake => self.apply(Command::Bake)?,
            Work::Lens => {
                let distance = document::CameraEdit::FocusDistance(2.2);
                self.apply(Command::EditCamera(distance))?;
                self.apply(Command::FinishEdit)?;
            }
            Work::Export => self.apply(Command::ExportPicture(self.export.clone(), Default::default()))?,
        }
        self.settle()
    }

    fn paint(&mut self, height: f64) -> Result<(), String> {
        let brush = self.session.document().map(|document| document.brush.clone()).unwrap_or_default();
        let target = FocusOffset::new(1.3, 1.0);
        self.apply(Command::SetBrush(focus::Brush { radius: 0.2, target, ..brush }))?;
        for k in 0..8 {
            let position = DVec2::new(0.3 + 0.05 * f64::from(k), height);
            let ray = self.session.picture_ray(position).ok_or("nothing is open")?;
            let point = StrokePoint::from_ray(ray);
            self.apply(if k == 0 { Command::BeginStroke(point) } else { Command::ExtendStroke(point) })?;
            // The time between two reports of a pen, in which the picture follows.
            std::thread::sleep(Duration::from_millis(4));
            self.poll()?;
        }
        self.apply(Command::CommitStroke)
    }

    fn poll(&mut self) -> Result<(), String> {
        for event in self.session.poll() {
            match event {
                Event::Notice(text) => self.told.push(text),
                Event::Failed(text) => return Err(text),
                _ => {}
            }
        }
        Ok(())
    }

    fn settle(&mut self) -> Result<(), String> {
        let start = Instant::now();
        self.poll()?;
        while !self.session.is_settled() {
            if start.elapsed() > PATIENCE {
                return Err(format!("it never settles: {:?}", self.session.jobs()));
            }
            std::thread::sleep(Duration::from_millis(1));
            self.poll()?;
        }
        self.poll()
    }

    fn result(&self) -> Result<Outcome, String> {
        let document = self.session.document().ok_or("nothing is open")?;
        let picture = self.session.preview().and_then(|preview| preview.picture.fetch());
        Ok(Outcome { map: document.map.clone(), picture: picture.ok_or("there is no picture")? })
    }
}

/// Plays a case. Returns what was done.
fn play(scene: &Path, folder: &Path, case: u64) -> Result<String, String> {
    let mut random = case.wrapping_mul(0xD1B5_4A32_D192_ED03) ^ 0x9E37_79B9_7F4A_7C15;
    let mut unit = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as f64 / (1u64 << 31) as f64
    };
    let lost_in = WORK[case as usize % WORK.len()];
    let share = unit();

    // On the processor, which also says how long things take here.
    let mut expected = AtWork::new(None, folder.join("expected.exr"))?;
    let mut results = Vec::new();
    for work in WORK {
        expected.work(work, scene).map_err(|what| format!("without a card: {work:?}: {what}"))?;
        results.push(expected.result()?);
    }
    // On a card, once undisturbed to measure and once until it is lost.
    let moment = {
        let mut measured = AtWork::new(Some(card()?), folder.join("measured.exr"))?;
        let mut moment = Duration::ZERO;
        for work in WORK {
            let start = Instant::now();
            measured.work(work, scene).map_err(|what| format!("with a card: {work:?}: {what}"))?;
            if work == lost_in {
                moment = start.elapsed().mul_f64(share);
                break;
            }
        }
        moment
    };
    let gpu = card()?;
    let mut session = AtWork::new(Some(gpu.clone()), folder.join("exported.exr"))?;
    let what = |work: Work, what: String| {
        let milliseconds = moment.as_secs_f64() * 1e3;
        format!("the card was lost {milliseconds:.2} ms after the start of {lost_in:?}: {work:?}: {what}")
    };
    for (work, expected) in WORK.into_iter().zip(&results) {
        let done = match work == lost_in {
            false => session.work(work, scene),
            true => std::thread::scope(|scope| {
                scope.spawn(|| {
                    std::thread::sleep(moment);
                    gpu.destroy();
                });
                session.work(work, scene)
            }),
        };
        done.map_err(|text| what(work, text))?;
        if work == lost_in {
            // It may be lost after the last picture, which is drawn again then.
            session.settle().map_err(|text| what(work, text))?;
        }
        match session.result() {
            Ok(found) if found.map != expected.map => return Err(what(work, "the paint differs".into())),
            Ok(found) if found.picture != expected.picture => {
                return Err(what(work, "the picture differs".into()));
            }
            Ok(_) => {}
            Err(text) => return Err(what(work, text)),
        }
    }
    let of_loss = session.told.iter().filter(|text| text.contains("was lost")).count();
    if of_loss != 1 {
        return Err(what(Work::PaintMore, format!("the loss was told {of_loss} times: {:?}", session.told)));
    }
    let read = |name: &str| std::fs::read(folder.join(name)).map_err(|e| format!("{name}: {e}"));
    if read("exported.exr")? != read("expected.exr")? {
        return Err(what(Work::Export, "the exported picture differs".into()));
    }
    Ok(format!("lost {:.2} ms after the start of {lost_in:?}", moment.as_secs_f64() * 1e3))
}
