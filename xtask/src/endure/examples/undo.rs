//! Random edits, undone and redone: every state comes back bit for bit.

use super::{build, example, verdict};
use crate::endure::harness::made_files::{glb, picture_with_depth, put, quad_bytes, write_inputs};
use crate::endure::harness::program::Limits;
use crate::endure::harness::promise::{Context, Promise, Verdict, Workplace};
use crate::endure::old_files::projects;
use crate::endure::same_bits::scenes::walls;
use std::path::Path;

/// Undo is exact.
pub const PROMISE: Promise = Promise {
    name: "undo",
    sentence: "Undo is exact",
    what_is_done: "10,000 random edits in 100 sequences (strokes of every mode, gradients, fills, selections, layers, \
                   lens, keys, variants, repaired depth), more than half of them undone and redone: every state is \
                   compared bit for bit",
    full: 100,
    short: 3,
    batch: 10,
    at_once: 2,
    prepare,
    case: edit,
};

/// Edits of a sequence.
const EDITS: &str = "100";
/// Processor time of all threads within which a sequence ends, s.
const TIME_S: u64 = 480;
/// What is edited, in turn; the project has layers.
const FILES: [&str; 4] = ["walls.glb", "depth/a.jpg", "p.fbrush", "walls.glb"];

fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    build("random_edits", context)?;
    if folder.join("p.fbrush").exists() {
        return Ok(());
    }
    write_inputs(folder)?;
    put(folder, "walls.glb", glb(&walls().to_string(), &quad_bytes()))?;
    put(folder, "depth/readme.txt", "")?;
    picture_with_depth(&folder.join("depth"), [12, 8])?;
    projects::write(&Workplace { prepared: folder.into(), own: folder.into() }, 2)
}

fn edit(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let file = place.prepared.join(FILES[case % FILES.len()]);
    let seed = case.to_string();
    let arguments = [file.as_os_str(), seed.as_ref(), EDITS.as_ref()];
    let limits = Limits { cpu_s: Some(TIME_S), ..Limits::default() };
    verdict(&example("random_edits", context).with(&place.own, arguments).limited(limits).run())
}
