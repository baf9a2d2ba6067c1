//! Bombs: small files that ask for far more than they are.

mod bomb;
mod captures;
mod documents;
mod pictures;
mod scenes;

use super::harness::program::Limits;
use super::harness::promise::{Context, Promise, Verdict, Workplace, ended_as_documented, nothing};

/// Bombs are refused at once.
pub const PROMISE: Promise = Promise {
    name: "bombs",
    sentence: "Bombs are refused within 2 s and 1 GiB",
    what_is_done: "files made by code that claim or expand to far more than they are: dimensions, counts, depth of \
                   JSON, ZIPs, KTX2 levels, meshopt, Draco, frames, tiles, heads; processor time and memory measured",
    full: 41,
    short: 40,
    batch: 40,
    at_once: 2,
    prepare: nothing,
    case: explode,
};

/// Processor time, s.
const TIME_S: f64 = 2.0;
/// Resident memory, bytes.
const MEMORY: u64 = 1 << 30;
/// Address space: the memory, and what the idle program maps.
const ADDRESS_SPACE: u64 = MEMORY + (2 << 30);

fn all() -> impl Iterator<Item = &'static bomb::Bomb> {
    pictures::BOMBS.iter().chain(scenes::BOMBS).chain(documents::BOMBS).chain(captures::BOMBS)
}

fn explode(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let bomb = all().nth(case % all().count()).ok_or("there is no bomb")?;
    (bomb.write)(&place.own)?;
    let limits = Limits { address_space: Some(ADDRESS_SPACE), cpu_s: Some(20), file_bytes: Some(1 << 28) };
    let run = context.program.line(&place.own, bomb.command).limited(limits).run();
    let what = |why: String| Err(format!("{}: {why}", bomb.name));
    if let Err(why) = ended_as_documented(&run) {
        return what(format!("{why} ({:.1} s, {} MiB)", run.cpu_s, run.peak_bytes >> 20));
    }
    if run.cpu_s > TIME_S || run.peak_bytes > MEMORY {
        return what(format!("{} took {:.1} s and {} MiB", run.shown, run.cpu_s, run.peak_bytes >> 20));
    }
    match run.code {
        Some(2 | 3) => Ok(()),
        // A part of a scene that cannot be used is left out, which is said.
        Some(0) if run.stderr.contains("warning:") => Ok(()),
        code => what(format!("{}: not refused (exit code {code:?}): {}", run.shown, run.last_line())),
    }
}

#[cfg(test)]
mod tests {
    use super::all;

    #[test]
    fn there_are_as_many_bombs_as_are_counted() {
        assert_eq!(all().count(), super::PROMISE.full);
    }
}
