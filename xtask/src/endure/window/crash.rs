//! The program is killed while somebody paints in its window: what was painted is there when it is started again.

use super::display::Display;
use super::open_window::OpenWindow;
use crate::endure::harness::made_files::{put, write_inputs};
use crate::endure::harness::program::Invocation;
use crate::endure::harness::promise::{Context, Promise, Verdict, Workplace};
use crate::endure::harness::seeded::Seeded;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A crash loses at most 30 s.
pub const PROMISE: Promise = Promise {
    name: "crash",
    sentence: "A crash loses at most 30 s",
    what_is_done: "SIGKILL at a random moment of painting in the real window, every second time just when unsaved work \
                   is being kept, on a project or on a scene that was never saved; opened again and saved, every \
                   stroke that was older is there. Every tenth time as installed, else with an interval of 2 s",
    full: 200,
    short: 5,
    batch: 5,
    at_once: 1,
    prepare,
    case: kill_while_painting,
};

const SIZE: [u32; 2] = [1000, 640];
/// The middle of the picture on the screen, and how far from it the wall is painted on.
const MIDDLE: [f64; 2] = [0.511, 0.516];
const REACH: [f64; 2] = [0.1, 0.16];
/// Places on the wall, one for each stroke.
const GRID: [usize; 2] = [7, 6];
/// Steps of the brush's blur from one end to the other: strokes that can be told apart.
const MAX_STROKES: usize = 39;
/// Texels of one value that are a stroke, not a seam.
const MIN_TEXELS: usize = 100;

/// What is promised, and how much of it the program waits.
struct Interval {
    /// What is given to the program; `None`: as installed.
    delay_s: Option<&'static str>,
    /// At most this much is lost.
    may_lose: Duration,
    /// Shortest and longest time of painting, ms.
    painting_ms: [usize; 2],
}

const AS_INSTALLED: Interval =
    Interval { delay_s: None, may_lose: Duration::from_secs(30), painting_ms: [32_000, 52_000] };
/// Twice the delay, as with the program's own, and a little for a slow machine.
const SHORTENED: Interval =
    Interval { delay_s: Some("2"), may_lose: Duration::from_secs(6), painting_ms: [7_000, 16_000] };

fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    super::check_programs()?;
    if folder.join("p.fbrush").exists() {
        return Ok(());
    }
    write_inputs(folder)?;
    let mut camera = crate::endure::harness::made_files::camera();
    (camera["width"], camera["height"]) = (json!(128), json!(128));
    put(folder, "cam.json", camera.to_string())?;
    // A first stroke, in a corner of the wall, that leaves its brush behind: small, and blurred as near as can be.
    let stroke = json!({"layer": "Paint",
        "brush": {"radius": 0.08, "hardness": 1.0, "mode": "set", "target": {"t": 0.2, "anchor": 1}},
        "view": {"camera_to_world": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 3, 1], "yfov": 0.8, "aspect": 1.0},
        "points": [[0.18, 0.18, 1.0]]});
    let strokes = json!({"format": "focus-brush strokes", "version": 2, "steps": [{"stroke": stroke}]});
    put(folder, "brush.json", strokes.to_string())?;
    context.program.line(folder, "new s.glb --camera cam.json -o p.fbrush").succeed()?;
    Ok(())
}

fn kill_while_painting(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let mut random = Seeded::new(case);
    let interval = if case % 10 == 4 { &AS_INSTALLED } else { &SHORTENED };
    let is_project = case % 3 != 2;
    let folder = place.own.join("work");
    for name in ["s.glb", "p.fbrush"] {
        let bytes = std::fs::read(place.prepared.join(name)).map_err(|e| format!("{name}: {e}"))?;
        put(&folder, name, bytes)?;
    }
    let file = if is_project { "p.fbrush" } else { "s.glb" };
    let display = Display::start(SIZE)?;
    let command = |arguments: &[&str]| {
        let command = in_own_home(context.program.with(&folder, arguments), &place.own);
        command.env("FOCUS_BRUSH_RECOVERY_DELAY", interval.delay_s.map(str::as_ref))
    };
    let [shortest, longest] = interval.painting_ms;
    let painting = Duration::from_millis((shortest + random.below(longest - shortest)) as u64);
    let recovery_folder =
        if is_project { folder.clone() } else { place.own.join("data/focus-brush/recovery") };
    let waits_for_file = case % 2 == 1;

    let replayed = command(&[file, "--replay", "../../prepared/brush.json"]);
    let mut window = OpenWindow::open(replayed, &display, SIZE, &place.own)?;
    window.wait_until("the first stroke is painted", |window| window.title().contains('*'))?;
    let start = Instant::now();
    let killed = AtomicBool::new(false);
    let (strokes, killed_at) = std::thread::scope(|scope| {
        let killer = scope.spawn(|| {
            let watched = waits_for_file.then_some((start + interval.may_lose, &*recovery_folder));
            wait_for_moment(start + painting, watched);
            let at = Instant::now();
            let sent = Command::new("kill").args(["-KILL", &window.process_id().to_string()]).status();
            killed.store(true, Ordering::Relaxed);
            sent.map(|_| at)
        });
        let strokes = paint(&window, painting, &killed);
        (strokes, killer.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    });
    let killed_at = killed_at.map_err(|e| format!("kill: {e}"))?;
    window.kill();
    drop(window);
    let strokes = strokes?;
    let old = strokes.iter().filter(|ended| **ended + interval.may_lose <= killed_at).count();

    // Started again, saved, closed.
    let project = if is_project { "p.fbrush" } else { "s.fbrush" };
    let mut window = OpenWindow::open(command(&[file]), &display, SIZE, &place.own)?;
    window.wait_until("the file is open", |window| window.title().starts_with(&project[..1]))?;
    window.settle()?;
    let is_restored = window.title().contains('*');
    if is_restored {
        window.press("ctrl+s")?;
        if !is_project {
            std::thread::sleep(Duration::from_secs(1));
            window.press("Return")?;
        }
        window.wait_until("it is saved", |window| !window.title().contains('*'))?;
    }
    window.press("ctrl+q")?;
    window.wait_for_end()?;
    let seconds = |duration: Duration| format!("{:.1} s", duration.as_secs_f64());
    let what = format!(
        "{file} killed after {} of painting{}",
        seconds(killed_at - start),
        if waits_for_file { ", while unsaved work was being kept" } else { "" }
    );
    let there = match is_restored || is_project {
        true => strokes_of(&folder, project, context)?,
        false => 0,
    };
    // The first stroke was painted before the clock started.
    let expected = old + usize::from(start + interval.may_lose <= killed_at);
    if there > strokes.len() + 2 {
        return Err(format!("{what}: {there} strokes are there, but {} were painted", strokes.len() + 1));
    }
    if there < expected {
        let first_lost = strokes.get(there.saturating_sub(1)).map(|ended| seconds(killed_at - *ended));
        return Err(format!(
            "{what}: {there} strokes are there of {}, {expected} of which were older than {}; the first that is lost \
             was painted {} before",
            strokes.len() + 1,
            seconds(interval.may_lose),
            first_lost.unwrap_or_default()
        ));
    }
    match leftover(&folder) {
        Some(name) => Err(format!("{what}: {name} is left over after saving and closing")),
        None => Ok(()),
    }
}

/// All that the program remembers in a folder of the case.
fn in_own_home(command: Invocation, own: &Path) -> Invocation {
    let folders: [(&str, PathBuf); 4] = [
        ("HOME", own.join("home")),
        ("XDG_DATA_HOME", own.join("data")),
        ("XDG_CACHE_HOME", own.join("cache")),
        ("XDG_CONFIG_HOME", own.join("config")),
    ];
    folders.iter().fold(command, |command, (name, folder)| command.env(name, Some(folder.as_os_str())))
}

/// Waits until a time or, from another time on, until a file appears in a folder.
fn wait_for_moment(end: Instant, watched: Option<(Instant, &Path)>) {
    let names = |folder: &Path| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| (entry.file_name(), entry.metadata().and_then(|data| data.modified()).ok()))
    };
    let sleep = |until: Instant| std::thread::sleep(until.saturating_duration_since(Instant::now()));
    let Some((since, folder)) = watched else { return sleep(end) };
    sleep(since);
    let before: Vec<_> = names(folder).collect();
    while Instant::now() < end && names(folder).all(|name| before.contains(&name)) {
        std::thread::sleep(Duration::from_micros(300));
    }
}

/// Paints strokes, each at a place of its own with a blur of its own, until the program was killed. Returns when each
/// ended.
fn paint(window: &OpenWindow<'_>, painting: Duration, killed: &AtomicBool) -> Result<Vec<Instant>, String> {
    let pace = painting / MAX_STROKES as u32;
    let mut strokes = Vec::new();
    let start = Instant::now();
    while !killed.load(Ordering::Relaxed) && start.elapsed() < painting + Duration::from_secs(5) {
        if strokes.len() < MAX_STROKES {
            let began = Instant::now();
            let [columns, rows] = GRID;
            let place = [strokes.len() % columns, strokes.len() / columns];
            let at = |k: usize, count: usize| {
                MIDDLE[k] + REACH[k] * (2.0 * place[k] as f64 / (count - 1) as f64 - 1.0)
            };
            let [x, y] = [at(0, columns), at(1, rows)];
            let drawn = window
                .hover([x, y])
                .and_then(|()| window.press("period"))
                .and_then(|()| window.drag(1, &[[x, y], [x + 0.001, y], [x + 0.002, y]]));
            match drawn {
                Ok(()) => strokes.push(Instant::now()),
                // The window may be gone.
                Err(_) if killed.load(Ordering::Relaxed) => break,
                Err(why) => return Err(why),
            }
            std::thread::sleep(pace.saturating_sub(began.elapsed()));
        } else {
            std::thread::sleep(Duration::from_millis(20));
        }
    }
    Ok(strokes)
}

/// How many strokes a project has: values other than the ordinary lens's that enough texels share.
fn strokes_of(folder: &Path, project: &str, context: &Context) -> Result<usize, String> {
    context.program.with(folder, ["export", project, "--focus-map", "map.png"]).succeed()?;
    let map = image::open(folder.join("map.png")).map_err(|e| format!("map.png: {e}"))?.into_rgb16();
    let mut texels = BTreeMap::<[u16; 2], usize>::new();
    for pixel in map.pixels() {
        *texels.entry([pixel[0], pixel[1]]).or_default() += 1;
    }
    let is_stroke = |(value, count): (&[u16; 2], &usize)| value[1] == u16::MAX && *count >= MIN_TEXELS;
    Ok(texels.iter().filter(|entry| is_stroke(*entry)).count())
}

/// A recovery file that should be gone.
fn leftover(folder: &Path) -> Option<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.find(|name| name.ends_with(".recovery") && !name.starts_with('.'))
}
