//! Poor surroundings: the program does its work without them, or says in a line what it lacks.

use super::harness::made_files::write_all;
use super::harness::program::Invocation;
use super::harness::promise::{Context, Promise, Verdict, Workplace, ended_as_documented};
use std::ffi::OsStr;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

/// Without card, display, home, cache: it says what it does.
pub const PROMISE: Promise = Promise {
    name: "surroundings",
    sentence: "Without card, display, home, cache: it says what it does",
    what_is_done: "no display, no Vulkan driver, a display that is not there, no home, a home that is a file, an \
                   unusable cache, an output folder that is missing, a file or read-only, no environment at all, no \
                   temporary folder, few open files",
    full: 12,
    short: 12,
    batch: 12,
    at_once: 2,
    prepare: |folder, context| {
        if folder.join("tiles.tile2-of-2.part").exists() { Ok(()) } else { write_all(folder, context) }
    },
    case: try_without,
};

/// Surroundings, a command in them, and how it is to end.
struct Surroundings {
    what: &'static str,
    command: &'static str,
    lacking: fn(Invocation, &Path) -> Invocation,
    code: i32,
    /// A word of what is said, if the work is not done.
    says: &'static str,
}

const RENDER: &str = "render @/s.glb --camera @/cam.json -o o.png";

const ALL: [Surroundings; 12] = [
    Surroundings { what: "no display", command: "@/s.glb", lacking: |c, _| c, code: 3, says: "DISPLAY" },
    Surroundings {
        what: "a display that is not there",
        command: "@/s.glb",
        lacking: |c, _| set(c, "DISPLAY", ":987"),
        code: 3,
        says: "no window",
    },
    Surroundings { what: "no driver", command: RENDER, lacking: without_card, code: 0, says: "" },
    Surroundings {
        what: "no driver, but a card is wanted",
        command: "render @/s.glb --camera @/cam.json --backend gpu -o o.png",
        lacking: without_card,
        code: 5,
        says: "",
    },
    Surroundings {
        what: "no home",
        command: RENDER,
        lacking: |c, _| {
            ["HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"].iter().fold(c, |c, name| c.env(name, None))
        },
        code: 0,
        says: "",
    },
    Surroundings {
        what: "a home that is a file",
        command: RENDER,
        lacking: |c, own| home(c, &own.join("a-file")),
        code: 0,
        says: "",
    },
    Surroundings {
        what: "presets of a home that is a file",
        command: "presets",
        lacking: |c, own| home(c, &own.join("a-file")),
        code: 0,
        says: "",
    },
    Surroundings {
        what: "an output folder that is missing",
        command: "render @/s.glb --camera @/cam.json --backend cpu -o none/o.png",
        lacking: |c, _| c,
        code: 3,
        says: "none",
    },
    Surroundings {
        what: "an output folder that is a file",
        command: "render @/s.glb --camera @/cam.json --backend cpu -o a-file/o.png",
        lacking: |c, _| c,
        code: 3,
        says: "a-file",
    },
    Surroundings {
        what: "an output folder in which nothing can be made",
        command: "render @/s.glb --camera @/cam.json --backend cpu -o /proc/o.png",
        lacking: |c, _| c,
        code: 3,
        says: "/proc",
    },
    Surroundings {
        what: "a cache in which nothing can be made",
        command: RENDER,
        lacking: |c, _| home(c, Path::new("/proc")),
        code: 0,
        says: "",
    },
    Surroundings {
        what: "no temporary folder, no path, no language",
        command: RENDER,
        lacking: |c, _| {
            ["PATH", "LANG", "LC_ALL", "USER"]
                .iter()
                .fold(set(c, "TMPDIR", "/none"), |c, name| c.env(name, None))
        },
        code: 0,
        says: "",
    },
];

fn set(command: Invocation, name: &str, value: impl AsRef<OsStr>) -> Invocation {
    command.env(name, Some(value.as_ref()))
}

fn without_card(command: Invocation, _: &Path) -> Invocation {
    set(set(command, "VK_ICD_FILENAMES", "/none.json"), "VK_DRIVER_FILES", "/none.json")
}

fn home(command: Invocation, home: &Path) -> Invocation {
    let folders = ["HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME"];
    folders.iter().fold(command, |command, name| set(command, name, home.join(name)))
}

fn try_without(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let Surroundings { what, command, lacking, code, says } = &ALL[case % ALL.len()];
    std::fs::write(place.own.join("a-file"), "").map_err(|e| e.to_string())?;
    let read_only = std::fs::Permissions::from_mode(0o444);
    std::fs::set_permissions(place.own.join("a-file"), read_only).map_err(|e| e.to_string())?;
    let command = context.program.line(&place.own, &command.replace("@/", "../prepared/"));
    let run = lacking(command, &place.own).run();
    ended_as_documented(&run).map_err(|why| format!("{what}: {why}"))?;
    if run.code != Some(*code) {
        return Err(format!(
            "{what}: {}: exit code {:?}, not {code}: {}",
            run.shown,
            run.code,
            run.last_line()
        ));
    }
    if *code != 0 && !run.stderr.contains(says) {
        return Err(format!("{what}: {}: does not say {says:?}: {}", run.shown, run.last_line()));
    }
    if *code == 0 && run.shown.contains("render") && !place.own.join("o.png").exists() {
        return Err(format!("{what}: {}: exit code 0 without a picture", run.shown));
    }
    Ok(())
}
