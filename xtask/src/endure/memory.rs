//! A limit on memory: the program stops with one line, and nothing half written.

use super::harness::made_files::write_all;
use super::harness::program::Limits;
use super::harness::promise::{Context, Promise, Verdict, Workplace, ended_as_documented};
use std::path::Path;

/// Memory has a limit.
pub const PROMISE: Promise = Promise {
    name: "memory",
    sentence: "Memory has a limit",
    what_is_done: "ten commands with an address space from 1.2 × the idle program's in steps: done, or one line, exit \
                   code 75 and nothing half written",
    full: 200,
    short: 20,
    batch: 20,
    at_once: 2,
    prepare,
    case: run_short_of_memory,
};

const COMMANDS: [&str; 10] = [
    "info @/s.glb",
    "new @/s.glb --camera @/cam.json -o o.fbrush",
    "replay @/p.fbrush @/strokes.json -o o.fbrush",
    "unwrap @/s.glb -o o.glb",
    "bake @/s.glb --camera @/cam.json --size 256x256 -o o.salf",
    "render @/s.glb --camera @/cam.json --size 512x512 --backend cpu -o o.exr",
    "render @/l.salf --backend cpu -o o.png",
    "export @/p.fbrush --focus-map o.exr",
    "merge -o o.exr @/tiles.tile1-of-2.part @/tiles.tile2-of-2.part",
    "compare @/r.exr @/r.png --error-map o.png",
];
/// Steps of the limit: 1.2, 1.3, … times what the idle program maps.
const STEPS: usize = 20;

fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    if folder.join("idle").exists() {
        return Ok(());
    }
    write_all(folder, context)?;
    for (number, command) in COMMANDS.iter().enumerate() {
        let clean = folder.join(format!("../clean-{number}"));
        std::fs::create_dir_all(&clean).map_err(|e| e.to_string())?;
        context.program.line(&clean, &command.replace("@/", "../prepared/")).succeed()?;
    }
    std::fs::write(folder.join("idle"), idle_mebibytes(folder, context).to_string())
        .map_err(|e| e.to_string())
}

/// The smallest address space, MiB, in which the program still starts its threads and prints its version of things.
fn idle_mebibytes(folder: &Path, context: &Context) -> u64 {
    let runs_in = |mebibytes: u64| {
        let limits = Limits { address_space: Some(mebibytes << 20), ..Limits::default() };
        context.program.line(folder, "presets").limited(limits).run().code == Some(0)
    };
    (32..4096).step_by(16).find(|&mebibytes| runs_in(mebibytes)).unwrap_or(4096)
}

fn run_short_of_memory(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let number = case % COMMANDS.len();
    let step =
        if case < 2 * COMMANDS.len() { case / COMMANDS.len() * 3 } else { case / COMMANDS.len() } % STEPS;
    let idle = std::fs::read_to_string(place.prepared.join("idle")).map_err(|e| e.to_string())?;
    let idle: u64 = idle.parse().map_err(|_| "the idle program was not measured")?;
    let mebibytes = idle * (12 + step as u64) / 10;
    let limits = Limits { address_space: Some(mebibytes << 20), cpu_s: Some(120), file_bytes: None };
    let command = COMMANDS[number].replace("@/", "../prepared/");
    let run = context.program.line(&place.own, &command).limited(limits).run();
    let what = |why: String| format!("in {mebibytes} MiB (idle {idle}): {why}");
    ended_as_documented(&run).map_err(what)?;
    if !matches!(run.code, Some(0 | 75)) {
        return Err(what(format!("{}: exit code {:?}, not 75: {}", run.shown, run.code, run.last_line())));
    }
    let clean = place.prepared.join(format!("../clean-{number}"));
    let entries = std::fs::read_dir(&place.own).map_err(|e| e.to_string())?;
    for name in entries.filter_map(|entry| entry.ok().map(|entry| entry.file_name())) {
        let (ours, whole) = (std::fs::read(place.own.join(&name)), std::fs::read(clean.join(&name)));
        if !matches!((ours, whole), (Ok(ours), Ok(whole)) if ours == whole) {
            return Err(what(format!(
                "{}: {} is half written or left over",
                run.shown,
                name.to_string_lossy()
            )));
        }
    }
    match run.code == Some(0)
        && command.contains(" o.")
        && std::fs::read_dir(&place.own).is_ok_and(|mut all| all.next().is_none())
    {
        true => Err(what(format!("{}: exit code 0 without its file", run.shown))),
        false => Ok(()),
    }
}
