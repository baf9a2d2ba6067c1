//! Files of every version ever written: each opens, or the program says what reads it.

pub mod projects;

use super::harness::archive::{Entry, zip};
use super::harness::made_files::{glb_of, put, scene, write_all};
use super::harness::made_splats;
use super::harness::promise::{Context, Promise, Verdict, Workplace, ended_as_documented};
use crate::chore::repository;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::path::Path;

/// Old files open.
pub const PROMISE: Promise = Promise {
    name: "old-files",
    sentence: "Old files open, or it says which version reads them",
    what_is_done: "a file of each version: projects 1 to 11 and that of the first demo, strokes 1 to 6, presets 1, \
                   light fields 1 to 9, focus maps 1, and of versions that do not exist yet",
    full: GOLDENS.len(),
    short: GOLDENS.len(),
    batch: GOLDENS.len(),
    at_once: 2,
    prepare,
    case: open,
};

fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    if folder.join("splats.salf").exists() {
        return Ok(());
    }
    write_all(folder, context)?;
    made_splats::write(folder)?;
    context.program.line(folder, "bake splats/a.splat --size 32x32 -o splats.salf").succeed()?;
    Ok(())
}

/// A file of a version, the command that reads it, and what the message contains if it cannot be read.
struct Golden {
    what: &'static str,
    version: u64,
    write: fn(&Workplace, u64) -> Verdict,
    command: &'static str,
    /// Empty if it opens.
    says: &'static str,
}

/// A version that no program has written yet.
const LATER: u64 = 99;
const UPDATE: &str = "update the program";

const fn project(version: u64) -> Golden {
    let command = "render p.fbrush --size 8x8 --backend cpu -o o.png";
    Golden { what: "a project", version, write: projects::write, command, says: "" }
}

const fn strokes(version: u64) -> Golden {
    let says = if version == LATER { UPDATE } else { "" };
    let command = "replay s.glb strokes.json -o o.fbrush";
    Golden { what: "strokes", version, write: write_strokes, command, says }
}

const fn light_field(version: u64) -> Golden {
    let says = if matches!(version, 6 | 8) { "" } else { "version" };
    Golden { what: "a light field", version, write: write_salf, command: "info l.salf", says }
}

const fn preset(version: u64) -> Golden {
    let says = if version == LATER { UPDATE } else { "" };
    let command = "render s.glb --lens lens.json --size 8x8 --backend cpu -o o.png";
    Golden { what: "a preset", version, write: write_preset, command, says }
}

const fn focus_map(version: u64, write: fn(&Workplace, u64) -> Verdict, command: &'static str) -> Golden {
    let says = if version == LATER { UPDATE } else { "" };
    Golden { what: "a focus map", version, write, command, says }
}

/// Renders with a focus map in OpenEXR.
const WITH_EXR: &str = "render s.glb --focus m.exr --size 8x8 --backend cpu -o o.png";
/// The same with one in PNG.
const WITH_PNG: &str = "render s.glb --focus m.png --size 8x8 --backend cpu -o o.png";

const GOLDENS: [Golden; 36] = [
    Golden {
        what: "the project of the first demo",
        version: 1,
        write: copy_demo,
        command: "info demo.fbrush",
        says: "",
    },
    project(1),
    project(2),
    project(3),
    project(4),
    project(5),
    project(6),
    project(7),
    project(8),
    project(9),
    project(10),
    project(11),
    Golden {
        what: "a project",
        version: LATER,
        write: write_later_project,
        command: "info p.fbrush",
        says: UPDATE,
    },
    strokes(1),
    strokes(2),
    strokes(3),
    strokes(4),
    strokes(5),
    strokes(6),
    strokes(LATER),
    light_field(1),
    light_field(2),
    light_field(3),
    light_field(4),
    light_field(5),
    light_field(6),
    light_field(8),
    light_field(LATER),
    Golden {
        what: "a light field of splats",
        version: 7,
        write: write_salf_of_splats,
        command: "info l.salf",
        says: "",
    },
    Golden {
        what: "a part",
        version: 9,
        write: write_later_part,
        command: "merge -o o.exr a.part",
        says: "version",
    },
    preset(1),
    preset(LATER),
    focus_map(1, write_exr_map, WITH_EXR),
    focus_map(LATER, write_exr_map, WITH_EXR),
    focus_map(1, write_png_map, WITH_PNG),
    focus_map(LATER, write_png_map, WITH_PNG),
];

fn open(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let Golden { what, version, write, command, says } = &GOLDENS[case % GOLDENS.len()];
    let what = |why: String| format!("{what} of version {version}: {why}");
    put(&place.own, "s.glb", glb_of(&scene()))?;
    write(place, *version)?;
    let run = context.program.line(&place.own, command).run();
    ended_as_documented(&run).map_err(what)?;
    match (run.code, says.is_empty()) {
        (Some(0), true) => Ok(()),
        (Some(3), false) if run.last_line().contains(says) => Ok(()),
        (code, _) => {
            Err(what(format!("{}: exit code {code:?}: {} (expected {says:?})", run.shown, run.last_line())))
        }
    }
}

fn copy_demo(place: &Workplace, _: u64) -> Verdict {
    for name in ["demo.fbrush", "demo.glb"] {
        let file = repository().join("assets/demo").join(name);
        let bytes = std::fs::read(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        put(&place.own, name, bytes)?;
    }
    Ok(())
}

fn write_later_project(place: &Workplace, version: u64) -> Verdict {
    let manifest = json!({"format": "focus-brush project", "version": version, "scene": {"path": "s.glb"}});
    put(&place.own, "p.fbrush", zip(&[Entry::plain("manifest.json", manifest.to_string().as_bytes())]))
}

fn write_later_part(place: &Workplace, version: u64) -> Verdict {
    let part = std::fs::read(place.prepared.join("tiles.tile1-of-2.part")).map_err(|e| e.to_string())?;
    put(&place.own, "a.part", [format!("focus-brush part {version}").as_bytes(), &part[18..]].concat())
}

/// The same stroke as each version writes it.
fn write_strokes(place: &Workplace, version: u64) -> Verdict {
    let mut stroke = super::harness::made_files::strokes()["strokes"][0].take();
    let file: Value = match version {
        1 => json!({"format": "focus-brush strokes", "version": 1, "strokes": [stroke]}),
        _ => {
            if version >= 5 {
                stroke["brush"]["target"]["gloss"] = json!(0.5);
            }
            let mut steps = vec![json!({"stroke": stroke})];
            if version >= 6 {
                let settings = json!({"reach": 4096, "softness": 0, "contrast": 0.06});
                steps.push(json!({"spread": {"layer": "Paint", "settings": settings}}));
            }
            json!({"format": "focus-brush strokes", "version": version, "steps": steps})
        }
    };
    put(&place.own, "strokes.json", file.to_string())
}

fn write_salf(place: &Workplace, version: u64) -> Verdict {
    let mut bytes = std::fs::read(place.prepared.join("l.salf")).map_err(|e| e.to_string())?;
    bytes[8] = version as u8;
    let end = bytes.len() - 32;
    let checksum = Sha256::digest(&bytes[..end]);
    bytes[end..].copy_from_slice(&checksum);
    put(&place.own, "l.salf", bytes)
}

/// The map that a project exports, as if by this version.
fn write_exr_map(place: &Workplace, version: u64) -> Verdict {
    const ATTRIBUTE: &[u8] = b"focusBrush.version\0double\0\x08\0\0\0";
    let mut bytes = std::fs::read(place.prepared.join("m.exr")).map_err(|e| e.to_string())?;
    let found = bytes.windows(ATTRIBUTE.len()).position(|window| window == ATTRIBUTE);
    let value = found.ok_or("the map has no version")? + ATTRIBUTE.len();
    bytes[value..value + 8].copy_from_slice(&(version as f64).to_le_bytes());
    put(&place.own, "m.exr", bytes)
}

fn write_png_map(place: &Workplace, version: u64) -> Verdict {
    let read = |name: &str| std::fs::read(place.prepared.join(name)).map_err(|e| format!("{name}: {e}"));
    put(&place.own, "m.png", read("m.png")?)?;
    let mut attributes: Value = serde_json::from_slice(&read("m.png.json")?).map_err(|e| e.to_string())?;
    attributes["version"] = json!(version);
    put(&place.own, "m.png.json", attributes.to_string())
}

fn write_salf_of_splats(place: &Workplace, _: u64) -> Verdict {
    for (from, to) in [("splats.salf", "l.salf"), ("splats/a.splat", "splats/a.splat")] {
        let bytes = std::fs::read(place.prepared.join(from)).map_err(|e| format!("{from}: {e}"))?;
        put(&place.own, to, bytes)?;
    }
    Ok(())
}

fn write_preset(place: &Workplace, version: u64) -> Verdict {
    let lens = json!({"focal_length": 0.085, "f_number": 1.4, "sensor_height": 0.024});
    put(
        &place.own,
        "lens.json",
        json!({"format": "focus-brush preset", "version": version, "name": "Lens", "lens": lens}).to_string(),
    )
}
