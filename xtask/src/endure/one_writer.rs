//! Races of two programs on one file: one of them wins, the other is as it would be alone or says so.

use super::harness::made_files::{glb_of, put, scene, write_all};
use super::harness::program::Run;
use super::harness::promise::{Context, Promise, Verdict, Workplace, ended_as_documented};
use super::harness::seeded::Seeded;
use serde_json::json;
use std::path::Path;
use std::time::Duration;

/// One writer a file.
pub const PROMISE: Promise = Promise {
    name: "one-writer",
    sentence: "One writer a file",
    what_is_done: "two programs started at once, or one shortly after the other, on a project, a picture, a light \
                   field, a part, a project that the other reads, and a cache: what is there is one's complete file",
    full: 100,
    short: 8,
    batch: 10,
    at_once: 1,
    prepare,
    case: race,
};

/// Two commands and the file over which they race; `@` is the folder of inputs.
struct Race {
    commands: [&'static str; 2],
    file: &'static str,
}

const RACES: [Race; 6] = [
    Race {
        commands: [
            "new @/s.glb --camera @/cam.json -o o.fbrush",
            "replay @/p.fbrush @/strokes.json -o o.fbrush",
        ],
        file: "o.fbrush",
    },
    Race {
        commands: [
            "render @/l.salf --backend cpu -o o.exr",
            "render @/l.salf --focus @/recipe.json --backend cpu -o o.exr",
        ],
        file: "o.exr",
    },
    Race {
        commands: [
            "bake @/s.glb --camera @/cam.json -o o.salf",
            "bake @/s.glb --camera @/cam.json --size 16x16 -o o.salf",
        ],
        file: "o.salf",
    },
    Race {
        commands: ["keys o.fbrush --f-number 4@1 -o o.fbrush", "keys o.fbrush --f-number 8@2 -o o.fbrush"],
        file: "o.fbrush",
    },
    Race {
        commands: ["keys o.fbrush --f-number 4@1 -o o.fbrush", "render o.fbrush --backend cpu -o o.png"],
        file: "o.png",
    },
    Race {
        commands: ["render @/lit.glb --camera @/cam.json --size 8x8 --backend cpu -o o.png"; 2],
        file: "o.png",
    },
];

fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    if folder.join("lit.glb").exists() {
        return Ok(());
    }
    write_all(folder, context)?;
    let mut lit = scene();
    lit["materials"][0]["extensions"] = json!({});
    put(folder, "lit.glb", glb_of(&lit))
}

fn race(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let Race { commands, file } = &RACES[case % RACES.len()];
    let mut random = Seeded::new(case);
    // What each writes alone, from the same start.
    let mut alone = Vec::new();
    for command in commands {
        let folder = place.own.join("alone");
        start_from_a_project(&folder, place)?;
        command_in(&folder, command, context).succeed()?;
        alone.push(std::fs::read(folder.join(file)).unwrap_or_default());
        std::fs::remove_dir_all(&folder).map_err(|e| e.to_string())?;
    }
    let folder = place.own.join("raced");
    start_from_a_project(&folder, place)?;
    let delay = Duration::from_millis(random.below(60) as u64);
    let [first, second] = commands;
    let runs: [Run; 2] = std::thread::scope(|scope| {
        let other = scope.spawn(|| command_in(&folder, second, context).run());
        std::thread::sleep(if random.below(2) == 0 { Duration::ZERO } else { delay });
        let run = command_in(&folder, first, context).run();
        [run, other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))]
    });
    for run in &runs {
        ended_as_documented(run)?;
    }
    let raced = std::fs::read(folder.join(file)).map_err(|e| format!("{file}: {e}"))?;
    let is_complete = alone.contains(&raced) || is_serial(commands, file, &raced, place, context)?;
    if !is_complete {
        return Err(format!("{} beside {}: {file} is neither's", runs[0].shown, runs[1].shown));
    }
    if runs.iter().all(|run| run.code != Some(0)) {
        return Err(format!(
            "{} beside {}: neither was done: {}",
            runs[0].shown,
            runs[1].shown,
            runs[0].last_line()
        ));
    }
    let entries = std::fs::read_dir(&folder).map_err(|e| e.to_string())?;
    let mut names =
        entries.filter_map(|entry| entry.ok().map(|entry| entry.file_name().to_string_lossy().into_owned()));
    match names.find(|name| name.starts_with(".o.")) {
        Some(name) => Err(format!("{} beside {}: {name} is left over", runs[0].shown, runs[1].shown)),
        None => Ok(()),
    }
}

/// Whether the file is what one command makes after the other.
fn is_serial(
    commands: &[&str; 2],
    file: &str,
    raced: &[u8],
    place: &Workplace,
    context: &Context,
) -> Result<bool, String> {
    for order in [[0, 1], [1, 0]] {
        let folder = place.own.join("serial");
        start_from_a_project(&folder, place)?;
        for command in order {
            command_in(&folder, commands[command], context).succeed()?;
        }
        let bytes = std::fs::read(folder.join(file)).unwrap_or_default();
        std::fs::remove_dir_all(&folder).map_err(|e| e.to_string())?;
        if bytes == raced {
            return Ok(true);
        }
    }
    Ok(false)
}

fn start_from_a_project(folder: &Path, place: &Workplace) -> Verdict {
    for name in ["s.glb", "p.fbrush"] {
        let bytes = std::fs::read(place.prepared.join(name)).map_err(|e| format!("{name}: {e}"))?;
        put(folder, if name == "p.fbrush" { "o.fbrush" } else { name }, bytes)?;
    }
    Ok(())
}

fn command_in(folder: &Path, command: &str, context: &Context) -> super::harness::program::Invocation {
    let cache = folder.join("cache");
    context
        .program
        .line(folder, &command.replace("@/", "../../prepared/"))
        .env("XDG_CACHE_HOME", Some(cache.as_os_str()))
}
