//! The graphics card goes away at a random moment: the session goes on with the same picture, and no paint is lost.

use super::{build, example, verdict};
use crate::endure::harness::made_files::{glb_of, put, scene, write_inputs};
use crate::endure::harness::promise::{Context, Promise, Verdict, Workplace};
use serde_json::json;
use std::path::Path;

/// A lost card loses nothing.
pub const PROMISE: Promise = Promise {
    name: "lost-card",
    sentence: "A lost card loses nothing",
    what_is_done: "the graphics device destroyed at a random moment of opening, painting, baking, undoing or \
                   exporting: paint, picture and exported file are those of the processor, and it is said once",
    full: 100,
    short: 3,
    batch: 10,
    at_once: 1,
    prepare,
    case: lose,
};

/// Exit code of the example where there is no card.
const NO_CARD: i32 = 5;

fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    build("lost_card", context)?;
    if folder.join("cam.json").exists() {
        return Ok(());
    }
    let run = example("lost_card", context).with(folder, ["--find"]).run();
    if run.code == Some(NO_CARD) {
        return Err(run.last_line().trim_start_matches("error: ").to_owned());
    }
    let mut lit = scene();
    lit["materials"][0]["extensions"] = json!({});
    put(folder, "lit.glb", glb_of(&lit))?;
    write_inputs(folder)
}

fn lose(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let file = place.prepared.join(["s.glb", "lit.glb"][case % 2]);
    let number = case.to_string();
    let arguments = [file.as_os_str(), place.own.as_os_str(), number.as_ref()];
    verdict(&example("lost_card", context).with(&place.own, arguments).run())
}
