//! Saving under failing system calls: afterwards the old file or the complete new one is there.

use super::harness::made_files::{glb_of, picture_with_depth, put, scene, write_all};
use super::harness::program::{Limits, Run};
use super::harness::promise::{Context, Promise, Verdict, Workplace, ended_as_documented};
use super::harness::system_calls::{Call, check_strace, traced};
use serde_json::{Value, json};
use std::path::Path;

/// Saving destroys nothing.
pub const PROMISE: Promise = Promise {
    name: "faults",
    sentence: "Saving destroys nothing: old file or new file, never neither",
    what_is_done: "every open, write, sync, rename and link of every writer of the command line made to fail in turn by \
                   strace (ENOSPC, EIO, EACCES), and short writes by a limit on the size of files",
    full: 500,
    short: 60,
    batch: 20,
    at_once: 2,
    prepare,
    case: fail_once,
};

const CALLS: &str =
    "openat,write,pwrite64,writev,fsync,fdatasync,rename,renameat,renameat2,link,linkat,ftruncate,fallocate";
const ERRORS: [&str; 3] = ["ENOSPC", "EIO", "EACCES"];
/// What is there before the program writes.
const OLD: &[u8] = b"what was there before";

/// A command that writes files in `out`; `@` is the folder of inputs.
struct Writer {
    command: &'static str,
    outputs: &'static [&'static str],
    /// Whether the outputs are in the cache, which a failure may leave as it was.
    is_cache: bool,
}

const fn writer(command: &'static str, outputs: &'static [&'static str]) -> Writer {
    Writer { command, outputs, is_cache: false }
}

const WRITERS: &[Writer] = &[
    writer("new @/s.glb --camera @/cam.json -o out/p.fbrush", &["p.fbrush"]),
    writer("replay @/p.fbrush @/strokes.json -o out/p.fbrush", &["p.fbrush"]),
    writer("keys @/p.fbrush --f-number 4@1 -o out/p.fbrush", &["p.fbrush"]),
    writer("import @/depth/a.jpg -o out/p.fbrush", &["p.fbrush"]),
    writer("render @/l.salf --backend cpu -o out/o.png", &["o.png"]),
    writer("render @/l.salf --backend cpu -o out/o.exr --aov coverage,coc,depth", &["o.exr"]),
    writer("render @/l.salf --backend cpu -o out/o.png --aov depth", &["o.png", "o.depth.exr"]),
    writer("bake @/s.glb --camera @/cam.json -o out/l.salf", &["l.salf"]),
    writer("export @/p.fbrush --glb out/o.glb", &["o.glb"]),
    writer("export @/p.fbrush --focus-map out/m.exr", &["m.exr"]),
    writer("export @/p.fbrush --focus-map out/m.png", &["m.png", "m.png.json"]),
    writer("export @/p.fbrush --layers out/layers.exr", &["layers.exr"]),
    writer("unwrap @/s.glb -o out/o.glb", &["o.glb"]),
    writer("thumbnail @/l.salf -o out/t.png", &["t.png"]),
    writer("compare @/r.exr @/r.png --error-map out/e.png", &["e.png"]),
    writer(
        "render @/s.glb --camera @/cam.json --size 64x64 --backend cpu --tiles 2x1 --shard 1/2 -o out/t.exr",
        &["t.tile1-of-2.part"],
    ),
    writer("merge -o out/o.exr @/tiles.tile1-of-2.part @/tiles.tile2-of-2.part", &["o.exr"]),
    writer(
        "render @/s.glb --camera @/cam.json --frames 1-2 --backend cpu -o out/f.####.png",
        &["f.0001.png", "f.0002.png"],
    ),
    Writer {
        command: "render @/lit.glb --camera @/cam.json --size 8x8 --backend cpu -o out/lit.png",
        outputs: &["lit.png"],
        is_cache: true,
    },
];

fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    check_strace()?;
    if folder.join("plan.json").exists() {
        return Ok(());
    }
    write_all(folder, context)?;
    let mut lit = scene();
    lit["materials"][0]["extensions"] = json!({});
    put(folder, "lit.glb", glb_of(&lit))?;
    put(folder, "depth/readme.txt", "")?;
    picture_with_depth(&folder.join("depth"), [12, 8])?;
    let mut plan = Vec::new();
    for (number, writer) in WRITERS.iter().enumerate() {
        let own = folder.join(format!("../clean-{number}"));
        std::fs::create_dir_all(&own).map_err(|e| e.to_string())?;
        let place = Workplace { prepared: folder.to_owned(), own };
        let (run, calls) = write_traced(writer, None, &place, context)?;
        if run.code != Some(0) {
            eprintln!("note: a writer is left out: {}: {}", run.shown, run.last_line());
            continue;
        }
        for output in writer.outputs {
            let bytes = std::fs::read(place.own.join("out").join(output))
                .map_err(|e| format!("{}: {output}: {e}", run.shown))?;
            if bytes == OLD {
                return Err(format!("{}: {output} is not written", run.shown));
            }
            put(folder, &format!("new/{number}/{output}"), bytes)?;
        }
        plan.extend(faults_of(number, writer, &calls));
    }
    put(folder, "plan.json", Value::Array(plan).to_string())
}

/// The faults of a writer: each call on its outputs with each error, and files that may not grow beyond a size.
fn faults_of(number: usize, writer: &Writer, calls: &[Call]) -> Vec<Value> {
    let touched = if writer.is_cache { "/cache/" } else { "/out" };
    let is_reading = |call: &Call| {
        call.name == "openat"
            && !call.arguments.contains("O_CREAT")
            && !call.arguments.contains("O_DIRECTORY")
    };
    let concerns = |call: &&Call| {
        (call.arguments.contains(touched) || call.result.contains(touched)) && !is_reading(call)
    };
    let mut faults = Vec::new();
    for call in calls.iter().filter(concerns) {
        faults.extend(ERRORS.map(|error| json!({"writer": number, "inject": format!("{}:error={error}:when={}", call.name, call.nth)})));
    }
    faults.extend([0, 1, 100].map(|bytes| json!({"writer": number, "file_bytes": bytes})));
    faults
}

fn fail_once(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let plan = std::fs::read(place.prepared.join("plan.json")).map_err(|e| e.to_string())?;
    let plan: Vec<Value> = serde_json::from_slice(&plan).map_err(|e| e.to_string())?;
    // Steps over the plan that meet every writer soon; the number is prime, so all faults have their turn.
    let fault = &plan[case * 7919 % plan.len()];
    let number = fault["writer"].as_u64().and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
    let writer = &WRITERS[number];
    let (run, calls) = write_traced(writer, Some(fault), place, context)?;
    let what = |why: String| format!("{}, {}: {why}", run.shown, described(fault, &calls));
    // A number that also meets a thread's messages takes its error away: the files alone are judged then.
    let is_mute = calls.iter().any(|call| call.injected && call.arguments.starts_with("2<"));
    if !is_mute {
        ended_as_documented(&run).map_err(&what)?;
    }
    let mut replaced = 0;
    for output in writer.outputs {
        let found =
            std::fs::read(place.own.join("out").join(output)).map_err(|e| what(format!("{output}: {e}")))?;
        let new = std::fs::read(place.prepared.join(format!("new/{number}/{output}")))
            .map_err(|e| e.to_string())?;
        match found {
            found if found == new => replaced += 1,
            found if found == OLD => {}
            // A frame is there before it is marked as finished.
            found if same_picture(&found, &new) && run.code != Some(0) => {}
            found => return Err(what(format!("{output} is neither old nor new: {} bytes", found.len()))),
        }
    }
    if run.code == Some(0) && replaced < writer.outputs.len() {
        return Err(what("exit code 0 although an output was not written".into()));
    }
    let unlinks_failed = calls.iter().any(|call| call.injected && call.name.starts_with("unlink"));
    match left_over(&place.own.join("out"), writer) {
        Some(name) if !unlinks_failed => Err(what(format!("{name} is left over"))),
        _ => Ok(()),
    }
}

/// Runs a writer over old files under strace; its home and cache are its own.
fn write_traced(
    writer: &Writer,
    fault: Option<&Value>,
    place: &Workplace,
    context: &Context,
) -> Result<(Run, Vec<Call>), String> {
    for output in writer.outputs {
        put(&place.own, &format!("out/{output}"), OLD)?;
    }
    let cache = place.own.join("cache");
    let command = context.program.line(&place.own, &writer.command.replace("@/", "../prepared/"));
    let command =
        command.env("XDG_CACHE_HOME", Some(cache.as_os_str())).env("RAYON_NUM_THREADS", Some("1".as_ref()));
    let injection = fault.and_then(|fault| fault["inject"].as_str());
    let file_bytes = fault.and_then(|fault| fault["file_bytes"].as_u64());
    match file_bytes {
        // strace's own log must not be limited: the limit alone, with the signal that would end the program ignored.
        Some(_) => {
            let ignoring = ["sh", "-c", "trap '' XFSZ; exec \"$@\"", "sh"].map(Into::into);
            let limits = Limits { file_bytes, ..Limits::default() };
            Ok((command.through(ignoring).limited(limits).run(), Vec::new()))
        }
        None => traced(command, CALLS, injection, &place.own),
    }
}

/// Whether two files are pictures of the same pixels.
fn same_picture(a: &[u8], b: &[u8]) -> bool {
    matches!((image::load_from_memory(a), image::load_from_memory(b)), (Ok(a), Ok(b)) if a == b)
}

fn described(fault: &Value, calls: &[Call]) -> String {
    match fault["inject"].as_str() {
        Some(inject) => {
            let hit =
                calls.iter().find(|call| call.injected).map_or("nothing", |call| call.arguments.as_str());
            format!("with {inject} (hit {})", hit.chars().take(120).collect::<String>())
        }
        None => format!("with files of at most {} bytes", fault["file_bytes"]),
    }
}

/// A file in the output folder that is not an output.
fn left_over(folder: &Path, writer: &Writer) -> Option<String> {
    let entries = std::fs::read_dir(folder).ok()?;
    let names =
        entries.filter_map(|entry| entry.ok().map(|entry| entry.file_name().to_string_lossy().into_owned()));
    names.into_iter().find(|name| !writer.outputs.contains(&name.as_str()))
}
