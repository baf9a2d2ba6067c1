//! Random edits, undone and redone: every state comes back bit for bit.

use super::{build, example, verdict};
use crate::endure::made_files::{glb, picture, put, quad_bytes, write_inputs};
use crate::endure::old_files::projects;
use crate::endure::promise::{Context, Promise, Verdict, Workplace};
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
    picture(&folder.join("depth/a.jpg"), [12, 8])?;
    let depths = (0..96u8).flat_map(|i| (1.0 + f32::from(i % 12) / 6.0).to_le_bytes());
    put(folder, "depth/a_depth.pfm", b"Pf\n12 8\n-1.0\n".iter().copied().chain(depths).collect::<Vec<u8>>())?;
    projects::write(&Workplace { prepared: folder.into(), own: folder.into() }, 2)
}

fn edit(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let file = place.prepared.join(FILES[case % FILES.len()]);
    let seed = case.to_string();
    let arguments = [file.as_os_str(), seed.as_ref(), EDITS.as_ref()];
    verdict(&example("random_edits", context).with(&place.own, arguments).run())
}
