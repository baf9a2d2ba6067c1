//! The split does not show: frames, tiles and light fields from any number of threads, in any order.

use super::harness::made_files::write_all;
use super::harness::promise::{Context, Promise, Verdict, Workplace};
use super::harness::seeded::Seeded;
use std::path::Path;

/// Any split, order, number of threads: the same bytes.
pub const PROMISE: Promise = Promise {
    name: "same-bytes",
    sentence: "Any split, order, number of threads: the same bytes",
    what_is_done: "frames in shards, tiles in shards merged in any order, and light fields, with 1, 2 and 7 threads, \
                   compared with one run on one thread",
    full: 100,
    short: 8,
    batch: 10,
    at_once: 2,
    prepare,
    case: split,
};

const THREADS: [&str; 3] = ["1", "2", "7"];
const FRAMES: &str = "render @/p.fbrush --frames 1-4 --size 40x24 --backend cpu";
const PICTURE: &str = "render @/p.fbrush --size 80x48 --backend cpu";
const BAKE: &str = "bake @/p.fbrush --size 80x48";

fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    if folder.join("../whole/whole.salf").exists() {
        return Ok(());
    }
    write_all(folder, context)?;
    // Beside the folders of the cases: a light field names its scene relative to itself.
    let whole = folder.join("../whole");
    std::fs::create_dir_all(&whole).map_err(|e| e.to_string())?;
    for (command, output) in [(FRAMES, "whole.####.exr"), (PICTURE, "whole.exr"), (BAKE, "whole.salf")] {
        let line = format!("{} -o {output}", command.replace("@/", "../prepared/"));
        context.program.line(&whole, &line).env("RAYON_NUM_THREADS", Some("1".as_ref())).succeed()?;
    }
    Ok(())
}

fn split(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let mut random = Seeded::new(case);
    let folder = &place.own;
    let run = |line: String, threads: &str| {
        let command = context.program.line(folder, &line.replace("@/", "../prepared/"));
        command.env("RAYON_NUM_THREADS", Some(threads.as_ref())).succeed()
    };
    match case % 3 {
        0 => {
            // Shards, the last first or the first first.
            let count = 1 + random.below(4);
            for shard in turned((1..=count).collect(), &mut random) {
                run(
                    format!("{FRAMES} --shard {shard}/{count} -o f.####.exr"),
                    random.one_of::<&str>(&THREADS),
                )?;
            }
            (1..=4).try_for_each(|frame| {
                same(place, &format!("f.{frame:04}.exr"), &format!("whole.{frame:04}.exr"))
            })
        }
        1 => {
            let grid = *random.one_of(&["2x2", "3x1", "1x2", "3x2"]);
            let count = 1 + random.below(3);
            for shard in turned((1..=count).collect(), &mut random) {
                run(
                    format!("{PICTURE} --tiles {grid} --shard {shard}/{count} -o t.exr"),
                    random.one_of::<&str>(&THREADS),
                )?;
            }
            if count > 1 || !folder.join("t.exr").exists() {
                let entries = std::fs::read_dir(folder).map_err(|e| e.to_string())?;
                let names = entries.filter_map(|entry| {
                    entry.ok().map(|entry| entry.file_name().to_string_lossy().into_owned())
                });
                let mut parts: Vec<_> = names.filter(|name| name.ends_with(".part")).collect();
                parts.sort();
                let parts = turned(parts, &mut random).join(" ");
                run(format!("merge -o t.exr {parts}"), random.one_of::<&str>(&THREADS))?;
            }
            same(place, "t.exr", "whole.exr")
        }
        _ => {
            run(format!("{BAKE} -o b.salf"), random.one_of::<&str>(&THREADS))?;
            same(place, "b.salf", "whole.salf")
        }
    }
}

/// In another order: a rotation, perhaps reversed.
fn turned<T>(mut items: Vec<T>, random: &mut Seeded) -> Vec<T> {
    let by = random.below(items.len());
    items.rotate_left(by);
    if random.below(2) == 1 {
        items.reverse();
    }
    items
}

fn same(place: &Workplace, file: &str, whole: &str) -> Verdict {
    let read = |path: &Path| std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()));
    let (ours, theirs) = (read(&place.own.join(file))?, read(&place.prepared.join("../whole").join(whole))?);
    match ours.iter().zip(&theirs).position(|(a, b)| a != b) {
        None if ours.len() == theirs.len() => Ok(()),
        at => {
            Err(format!("{file} differs from {whole} at byte {}", at.unwrap_or(ours.len().min(theirs.len()))))
        }
    }
}
