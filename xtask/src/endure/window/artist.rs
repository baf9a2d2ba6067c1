//! Somebody works in the window for hours: it stays quick, its memory stays, and nothing is left over.

use super::display::Display;
use super::frames::Second;
use super::open_window::OpenWindow;
use crate::endure::harness::made_files::{camera, glb_of, put, scene, write_inputs};
use crate::endure::harness::promise::{Context, Promise, Verdict, Workplace};
use crate::endure::harness::seeded::Seeded;
use serde_json::json;
use std::path::Path;
use std::time::{Duration, Instant};

/// The window stays.
pub const PROMISE: Promise = Promise {
    name: "window",
    sentence: "The window stays: in memory, in time, with nothing left over",
    what_is_done: "an artist's hours in the real window (paint, undo, redo, layers, lens, camera, bake, open, save, \
                   export; something every 10 s), eight times as fast: a quarter of an hour in 2 minutes, two hours in \
                   15 minutes. No job is left over; in two hours memory grows by 5 % at most from two thirds on, and no \
                   frame beside a bake takes over 250 ms",
    full: SITTINGS.len(),
    short: 1,
    batch: 1,
    at_once: 1,
    prepare,
    case: work,
};

/// How long each case lasts.
const SITTINGS: [Duration; 2] = [Duration::from_secs(120), Duration::from_secs(900)];
/// An action every 10 s of the artist's.
const ACTION: Duration = Duration::from_millis(1250);
/// A machine on which actions take longer than they should is given this much more time.
const LATEST: u32 = 2;
const SIZE: [u32; 2] = [1200, 760];
/// The middles of the paint view and the picture on the screen, side by side.
const PAINT_VIEW: [f64; 2] = [0.2, 0.51];
const PICTURE: [f64; 2] = [0.557, 0.51];
/// How often, and how long each time, a file is waited for.
const TRIES: usize = 12;
const WAIT: Duration = Duration::from_secs(10);
const MAX_GROWTH: f64 = 1.05;
const MAX_FRAME_MS: f64 = 250.0;

fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    super::check_programs()?;
    if folder.join("lit.fbrush").exists() {
        return Ok(());
    }
    write_inputs(folder)?;
    let mut lit = scene();
    lit["materials"][0]["extensions"] = json!({});
    put(folder, "lit.glb", glb_of(&lit))?;
    let mut camera = camera();
    (camera["width"], camera["height"]) = (json!(320), json!(320));
    put(folder, "cam.json", camera.to_string())?;
    if let Some(camera) = camera.as_object_mut() {
        camera.remove("background");
    }
    put(folder, "dark.json", camera.to_string())?;
    context.program.line(folder, "new s.glb --camera cam.json -o plain.fbrush").succeed()?;
    context.program.line(folder, "new lit.glb --camera dark.json -o lit.fbrush").succeed()?;
    Ok(())
}

fn work(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let sitting = SITTINGS[case % SITTINGS.len()];
    for name in ["s.glb", "lit.glb", "plain.fbrush", "lit.fbrush"] {
        let bytes = std::fs::read(place.prepared.join(name)).map_err(|e| format!("{name}: {e}"))?;
        put(&place.own, name, bytes)?;
    }
    let display = Display::start(SIZE)?;
    let command = context.program.with(&place.own, ["lit.fbrush", "--preview-size", "320"]);
    let data = place.own.join("data");
    let command = command.env("XDG_DATA_HOME", Some(data.as_os_str()));
    let mut artist = Artist {
        window: OpenWindow::open(command, &display, SIZE, &place.own)?,
        random: Seeded::new(case),
        folder: &place.own,
        exports: 0,
        opened: "lit",
    };
    artist.window.wait_until("a project is open", |window| window.title().starts_with("lit"))?;
    // Both views are large enough to be worked in.
    artist.window.press("ctrl+alt+2")?;
    let opened_at = artist.window.frames().last().map_or(0.0, |second| second.at);
    let start = Instant::now();
    let actions = (sitting.as_millis() / ACTION.as_millis()) as u32;
    let mut memory = Vec::new();
    for action in 0..actions {
        artist.act(action).map_err(|why| format!("action {action}: {why}"))?;
        if !artist.window.is_alive() {
            return Err(format!("action {action}: the window ended"));
        }
        memory.push((start.elapsed(), artist.window.memory()));
        std::thread::sleep((ACTION * (action + 1)).saturating_sub(start.elapsed()));
        if start.elapsed() > sitting * LATEST {
            return Err(format!(
                "only {action} of {actions} actions could be done in {} s",
                (sitting * LATEST).as_secs()
            ));
        }
    }
    let total = start.elapsed();
    artist.window.press("Escape")?;
    artist.window.settle().map_err(|why| format!("a job is left over: {why}"))?;
    let mut seconds = artist.window.frames();
    seconds.retain(|second| second.at > opened_at);
    artist.save()?;
    artist.window.press("ctrl+q")?;
    let status = artist.window.wait_for_end()?;
    if !status.success() {
        return Err(format!("the window ended with {status}"));
    }
    // A short run shares the machine with whatever else is at work, and ends before the undo history is full.
    let is_judged = case > 0;
    judge(&seconds, &memory, total, is_judged)
}

/// Prints what was measured and, in a long sitting, judges it.
fn judge(seconds: &[Second], memory: &[(Duration, u64)], total: Duration, is_judged: bool) -> Verdict {
    let beside_jobs = seconds.windows(2).filter(|pair| pair.iter().any(|second| second.jobs > 0));
    let beside_jobs: Vec<Second> = beside_jobs.map(|pair| pair[1]).collect();
    let slow: Vec<_> = beside_jobs.iter().filter(|second| second.longest_ms > MAX_FRAME_MS).collect();
    if beside_jobs.is_empty() {
        return Err("no frame was drawn beside a job".into());
    }
    let (early, late): (Vec<_>, Vec<_>) = memory.iter().partition(|(at, _)| *at < total * 2 / 3);
    let most =
        |part: &[(Duration, u64)]| part.iter().map(|(_, bytes)| *bytes).max().unwrap_or(0) as f64 / 1e6;
    let (early, late) = (most(&early), most(&late));
    println!(
        "  at most {early:.0} MB until two thirds, {late:.0} MB after; the longest frame beside a job took {:.0} ms",
        beside_jobs.iter().map(|second| second.longest_ms).fold(0.0, f64::max)
    );
    if !is_judged {
        return Ok(());
    }
    if let Some(worst) = slow.iter().max_by(|a, b| a.longest_ms.total_cmp(&b.longest_ms)) {
        return Err(format!(
            "a frame beside a job took {:.0} ms, {:.0} s after the start ({} of {} seconds had one over {MAX_FRAME_MS} ms)",
            worst.longest_ms,
            worst.at,
            slow.len(),
            beside_jobs.len()
        ));
    }
    match late <= early * MAX_GROWTH {
        true => Ok(()),
        false => Err(format!("memory grew from {early:.0} MB in the first two thirds to {late:.0} MB")),
    }
}

struct Artist<'a> {
    window: OpenWindow<'a>,
    random: Seeded,
    folder: &'a Path,
    exports: usize,
    opened: &'static str,
}

impl Artist<'_> {
    /// Does one thing.
    fn act(&mut self, action: u32) -> Verdict {
        // Rarer things at set times, so that each happens in every sitting.
        match action % 48 {
            20 => return self.open_other(),
            28 => return self.export(&["ctrl+shift+e"], "png"),
            36 => return self.export(&["ctrl+e", "Return"], "exr"),
            44 => return self.save(),
            12 => return self.window.press("F5"),
            4 => return self.run_command("camera from view"),
            _ => {}
        }
        let window = &self.window;
        match self.random.below(24) {
            0..=9 => self.stroke(PICTURE),
            10 | 11 => self.stroke(PAINT_VIEW),
            12..=14 => window.press("ctrl+z"),
            15 => window.press("ctrl+shift+z"),
            16 => window.press(["period", "comma", "bracketleft", "bracketright"][self.random.below(4)]),
            17 | 18 => {
                let from = self.near(PAINT_VIEW, 0.05);
                let to = self.near(PAINT_VIEW, 0.05);
                self.window.drag(2, &[from, to])
            }
            19 => window.press(["plus", "minus"][self.random.below(2)]),
            20 => window.press(["F7", "F9", "F4"][self.random.below(3)]),
            21 => window.press("ctrl+i"),
            22 => window.press("ctrl+shift+a"),
            _ => {
                self.window.press("ctrl+shift+n")?;
                self.stroke(PICTURE)?;
                self.window.press("ctrl+z ctrl+z")
            }
        }
    }

    /// A point not far from another one.
    fn near(&mut self, [x, y]: [f64; 2], by: f64) -> [f64; 2] {
        let mut random = || self.random.below(2001) as f64 / 1000.0 - 1.0;
        [x + by * random(), y + 1.5 * by * random()]
    }

    fn stroke(&mut self, middle: [f64; 2]) -> Verdict {
        let mut points = vec![self.near(middle, 0.1)];
        for _ in 0..8 {
            let last = points[points.len() - 1];
            points.push(self.near(last, 0.02));
        }
        // A key that chooses the brush, whatever tool came before.
        self.window.press("b").and_then(|()| self.window.drag(1, &points))
    }

    /// Runs a command of the palette.
    fn run_command(&mut self, name: &str) -> Verdict {
        self.window.press("ctrl+shift+p")?;
        pause(300);
        self.window.types(name)?;
        pause(200);
        self.window.press("Return")
    }

    /// Writes a picture to a path that is typed; again while the one on the screen is too coarse for that.
    fn export(&mut self, keys: &[&str], extension: &str) -> Verdict {
        self.exports += 1;
        let file = self.folder.join(format!("picture-{}.{extension}", self.exports));
        for _ in 0..TRIES {
            self.type_path(keys, &file)?;
            let start = Instant::now();
            while start.elapsed() < WAIT && self.window.is_alive() {
                if file.exists() {
                    return std::fs::remove_file(&file).map_err(|e| format!("{}: {e}", file.display()));
                }
                pause(100);
            }
        }
        Err(format!("no picture is exported by {keys:?}; the title is {:?}", self.window.title()))
    }

    /// Saves the project under its name; again if a key was lost to whatever had the keyboard.
    fn save(&mut self) -> Verdict {
        for _ in 0..TRIES {
            self.window.press("Escape")?;
            self.window.press("ctrl+s")?;
            let start = Instant::now();
            while start.elapsed() < WAIT && self.window.is_alive() {
                if !self.window.title().contains('*') {
                    return Ok(());
                }
                pause(100);
            }
        }
        Err(format!("it is not saved; the title is {:?}", self.window.title()))
    }

    /// Saves, and opens the other project.
    fn open_other(&mut self) -> Verdict {
        self.save()?;
        self.opened = if self.opened == "lit" { "plain" } else { "lit" };
        let file = self.folder.join(format!("{}.fbrush", self.opened));
        self.type_path(&["ctrl+o"], &file)?;
        let opened = self.opened;
        self.window.wait_until("the other project is open", |window| window.title().starts_with(opened))
    }

    /// Types a path into the dialog that opens by these keys, one after the other.
    fn type_path(&mut self, keys: &[&str], file: &Path) -> Verdict {
        self.window.press("Escape")?;
        for keys in keys {
            self.window.press(keys)?;
            pause(600);
        }
        self.window.press("ctrl+a")?;
        self.window.types(&file.display().to_string())?;
        pause(300);
        self.window.press("Return")
    }
}

fn pause(milliseconds: u64) {
    std::thread::sleep(Duration::from_millis(milliseconds));
}
