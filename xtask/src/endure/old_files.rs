//! Files of every version ever written: each opens, or the program says what reads it.

pub mod projects;

use super::archive::{Entry, zip};
use super::made_files::{glb_of, put, scene, write_all};
use super::promise::{Context, Promise, Verdict, Workplace, ended_as_documented};
use crate::chore::repository;
use serde_json::{Value, json};

/// Old files open.
pub const PROMISE: Promise = Promise {
    name: "old-files",
    sentence: "Old files open, or it says which version reads them",
    what_is_done: "a file of each version: projects 1 to 8 and that of the first demo, strokes 1 to 5, presets 1, light \
                   fields 1 to 6, and of versions that do not exist yet",
    full: GOLDENS.len(),
    short: GOLDENS.len(),
    batch: GOLDENS.len(),
    at_once: 2,
    prepare: |folder, context| {
        if folder.join("tiles.tile2-of-2.part").exists() { Ok(()) } else { write_all(folder, context) }
    },
    case: open,
};

/// A file of a version, the command that reads it, and what is said if it cannot be read.
struct Golden {
    what: &'static str,
    write: fn(&Workplace) -> Result<(), String>,
    command: &'static str,
    /// Empty if it opens.
    says: &'static str,
}

const REPLAY: &str = "replay s.glb strokes.json -o o.fbrush";

const OPEN: &str = "render p.fbrush --size 8x8 --backend cpu -o o.png";

const GOLDENS: [Golden; 25] = [
    Golden { what: "the project of the first demo", write: demo, command: "info demo.fbrush", says: "" },
    Golden {
        what: "a project of version 1",
        write: |place| projects::write(place, 1),
        command: OPEN,
        says: "",
    },
    Golden {
        what: "a project of version 2",
        write: |place| projects::write(place, 2),
        command: OPEN,
        says: "",
    },
    Golden {
        what: "a project of version 3",
        write: |place| projects::write(place, 3),
        command: OPEN,
        says: "",
    },
    Golden {
        what: "a project of version 4",
        write: |place| projects::write(place, 4),
        command: OPEN,
        says: "",
    },
    Golden {
        what: "a project of version 5",
        write: |place| projects::write(place, 5),
        command: OPEN,
        says: "",
    },
    Golden {
        what: "a project of version 6",
        write: |place| projects::write(place, 6),
        command: OPEN,
        says: "",
    },
    Golden {
        what: "a project of version 7",
        write: |place| projects::write(place, 7),
        command: OPEN,
        says: "",
    },
    Golden {
        what: "a project of version 8",
        write: |place| projects::write(place, 8),
        command: OPEN,
        says: "",
    },
    Golden {
        what: "a project of a later version",
        write: |place| {
            let manifest =
                json!({"format": "focus-brush project", "version": 99, "scene": {"path": "s.glb"}})
                    .to_string();
            put(&place.own, "p.fbrush", zip(&[Entry::plain("manifest.json", manifest.as_bytes())]))
        },
        command: "info p.fbrush",
        says: "update the program",
    },
    Golden { what: "strokes of version 1", write: |place| strokes(place, 1), command: REPLAY, says: "" },
    Golden { what: "strokes of version 2", write: |place| strokes(place, 2), command: REPLAY, says: "" },
    Golden { what: "strokes of version 3", write: |place| strokes(place, 3), command: REPLAY, says: "" },
    Golden { what: "strokes of version 4", write: |place| strokes(place, 4), command: REPLAY, says: "" },
    Golden { what: "strokes of version 5", write: |place| strokes(place, 5), command: REPLAY, says: "" },
    Golden {
        what: "strokes of a later version",
        write: |place| strokes(place, 99),
        command: REPLAY,
        says: "update the program",
    },
    Golden {
        what: "a light field of version 1",
        write: |place| salf(place, 1),
        command: "info l.salf",
        says: "version",
    },
    Golden {
        what: "a light field of version 2",
        write: |place| salf(place, 2),
        command: "info l.salf",
        says: "version",
    },
    Golden {
        what: "a light field of version 3",
        write: |place| salf(place, 3),
        command: "info l.salf",
        says: "version",
    },
    Golden {
        what: "a light field of version 4",
        write: |place| salf(place, 4),
        command: "info l.salf",
        says: "version",
    },
    Golden {
        what: "a light field of version 5",
        write: |place| salf(place, 5),
        command: "info l.salf",
        says: "version",
    },
    Golden {
        what: "a light field of version 6",
        write: |place| salf(place, 6),
        command: "info l.salf",
        says: "",
    },
    Golden {
        what: "a part of a later version",
        write: |place| {
            let part =
                std::fs::read(place.prepared.join("tiles.tile1-of-2.part")).map_err(|e| e.to_string())?;
            put(&place.own, "a.part", [b"focus-brush part 9", &part[18..]].concat())
        },
        command: "merge -o o.exr a.part",
        says: "version",
    },
    Golden {
        what: "a preset of version 1",
        write: |place| preset(place, 1),
        command: "render s.glb --lens lens.json --size 8x8 --backend cpu -o o.png",
        says: "",
    },
    Golden {
        what: "a preset of a later version",
        write: |place| preset(place, 99),
        command: "render s.glb --lens lens.json --size 8x8 --backend cpu -o o.png",
        says: "update the program",
    },
];

fn open(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let Golden { what, write, command, says } = &GOLDENS[case % GOLDENS.len()];
    put(&place.own, "s.glb", glb_of(&scene()))?;
    write(place)?;
    let run = context.program.line(&place.own, command).run();
    ended_as_documented(&run).map_err(|why| format!("{what}: {why}"))?;
    match (run.code, says.is_empty()) {
        (Some(0), true) => Ok(()),
        (Some(3), false) if run.last_line().contains(says) => Ok(()),
        (code, _) => {
            Err(format!("{what}: {}: exit code {code:?}: {} (expected {says:?})", run.shown, run.last_line()))
        }
    }
}

fn demo(place: &Workplace) -> Verdict {
    for name in ["demo.fbrush", "demo.glb"] {
        let file = repository().join("assets/demo").join(name);
        let bytes = std::fs::read(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        put(&place.own, name, bytes)?;
    }
    Ok(())
}

/// The same stroke as each version writes it.
fn strokes(place: &Workplace, version: u64) -> Verdict {
    let mut stroke = super::made_files::strokes()["strokes"][0].take();
    let file: Value = match version {
        1 => json!({"format": "focus-brush strokes", "version": 1, "strokes": [stroke]}),
        _ => {
            if version >= 5 {
                stroke["brush"]["target"]["gloss"] = json!(0.5);
            }
            json!({"format": "focus-brush strokes", "version": version, "steps": [{"stroke": stroke}]})
        }
    };
    put(&place.own, "strokes.json", file.to_string())
}

fn salf(place: &Workplace, version: u8) -> Verdict {
    let mut bytes = std::fs::read(place.prepared.join("l.salf")).map_err(|e| e.to_string())?;
    bytes[8] = version;
    put(&place.own, "l.salf", bytes)
}

fn preset(place: &Workplace, version: u64) -> Verdict {
    let lens = json!({"focal_length": 0.085, "f_number": 1.4, "sensor_height": 0.024});
    put(
        &place.own,
        "lens.json",
        json!({"format": "focus-brush preset", "version": version, "name": "Lens", "lens": lens}).to_string(),
    )
}
