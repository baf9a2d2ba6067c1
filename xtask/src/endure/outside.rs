//! Hostile names in files that name files: nothing outside the input's folder is opened for them.

use super::harness::made_files::{camera, picture, put, quad_bytes, scene, scene_with_texture, write_inputs};
use super::harness::promise::{Context, Promise, Verdict, Workplace, ended_as_documented};
use super::harness::system_calls::{check_strace, traced};
use serde_json::json;
use std::collections::BTreeSet;
use std::path::Path;

/// No file outside the input's folder is opened.
pub const PROMISE: Promise = Promise {
    name: "outside",
    sentence: "No file outside the input's folder is opened",
    what_is_done: "hostile names (.., absolute, links, file://, devices, UNC) in every format that names files, by \
                   strace: none is opened that the run of the harmless twin does not open",
    full: NAMINGS.len() * FORMS.len(),
    short: 20,
    batch: 20,
    at_once: 2,
    prepare: |_, _| check_strace(),
    case: compare_with_twin,
};

/// A format that names files: writes an input into `in/` that names this one, and says how it is opened.
struct Naming {
    what: &'static str,
    harmless: &'static str,
    command: &'static str,
    write: fn(&Path, &str) -> Result<(), String>,
}

const NAMINGS: &[Naming] = &[
    Naming {
        what: "a texture of glTF",
        harmless: "t.png",
        command: "new in/s.gltf -o o.fbrush",
        write: |to, name| {
            let mut scene = scene_with_texture(name, None);
            scene["buffers"][0]["uri"] = json!("quad.bin");
            put(to, "quad.bin", quad_bytes())?;
            put(to, "s.gltf", scene.to_string())
        },
    },
    Naming {
        what: "a buffer of glTF",
        harmless: "quad.bin",
        command: "info in/s.gltf",
        write: |to, name| {
            let mut scene = scene();
            scene["buffers"][0]["uri"] = json!(name);
            put(to, "quad.bin", quad_bytes())?;
            put(to, "s.gltf", scene.to_string())
        },
    },
    Naming {
        what: "radiance of a material",
        harmless: "t.png",
        command: "info in/s.gltf --bake",
        write: |to, name| {
            let mut scene = scene();
            scene["buffers"][0]["uri"] = json!("quad.bin");
            scene["materials"][0]["extras"] =
                json!({"focus_brush": {"version": 1, "radiance": {"uri": name, "texCoord": 0}}});
            put(to, "quad.bin", quad_bytes())?;
            put(to, "s.gltf", scene.to_string())
        },
    },
    Naming {
        what: "the sky of a world",
        harmless: "sky.hdr",
        command: "info in/s.glb --world in/world.json",
        write: |to, name| put(to, "world.json", json!({"environment": name}).to_string()),
    },
    Naming {
        what: "the mask of a camera",
        harmless: "t.png",
        command: "render in/s.glb --camera in/cam.json --backend cpu -o o.png",
        write: |to, name| {
            let mut camera = camera();
            camera["aperture"] = json!({"shape": "mask", "mask": name, "ratio": 1.0});
            put(to, "cam.json", camera.to_string())
        },
    },
    Naming {
        what: "the mask of a preset",
        harmless: "t.png",
        command: "render in/s.glb --camera in/cam.json --bokeh in/b.json --backend cpu -o o.png",
        write: |to, name| {
            put(
                to,
                "b.json",
                json!({"format": "focus-brush preset", "version": 1, "name": "B",
            "bokeh": {"shape": "mask", "ratio": 1, "mask": name}})
                .to_string(),
            )
        },
    },
    Naming {
        what: "the map of a recipe",
        harmless: "t.png",
        command: "render in/s.glb --camera in/cam.json --focus in/r.json --backend cpu -o o.png",
        write: |to, name| put(to, "r.json", json!({"nodes": {"wall": {"map": name}}}).to_string()),
    },
    Naming {
        what: "a photograph of transforms.json",
        harmless: "t.png",
        command: "info in --json",
        write: |to, name| {
            let frame = |name: &str, x: f64| {
                json!({"file_path": name,
            "transform_matrix": [[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]})
            };
            let transforms = json!({"w": 12, "h": 8, "fl_x": 12, "fl_y": 12, "cx": 6, "cy": 4,
            "frames": [frame(name, 0.1), frame("a.jpg", -0.1)]});
            put(to, "mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n")?;
            put(to, "transforms.json", transforms.to_string())
        },
    },
    Naming {
        what: "a photograph of COLMAP",
        harmless: "t.png",
        command: "info in --json",
        write: |to, name| {
            put(to, "sparse/cameras.txt", "1 PINHOLE 12 8 12 12 6 4\n")?;
            put(
                to,
                "sparse/images.txt",
                format!("1 0 1 0 0 0.2 0 3 1 {name}\n\n2 0 1 0 0 -0.2 0 3 1 a.jpg\n\n"),
            )?;
            put(to, "sparse/points3D.txt", "")?;
            put(to, "mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n")
        },
    },
    Naming {
        what: "a photograph of Bundler",
        harmless: "a.jpg",
        command: "info in --json",
        write: |to, name| {
            let camera = |x: f64| format!("16 0 0\n1 0 0\n0 1 0\n0 0 1\n{x} 0 -3\n");
            put(to, "bundle.out", format!("# Bundle file v0.3\n2 0\n{}{}", camera(0.2), camera(-0.2)))?;
            put(to, "list.txt", format!("{name}\nt.png\n"))?;
            put(to, "mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n")
        },
    },
    Naming {
        what: "a photograph of VisualSFM",
        harmless: "a.jpg",
        command: "info in --json",
        write: |to, name| {
            put(
                to,
                "model.nvm",
                format!("NVM_V3\n\n2\n{name}\t16 1 0 0 0 0.2 0 3 0 0\nt.png\t16 1 0 0 0 -0.2 0 3 0 0\n\n0\n"),
            )?;
            put(to, "mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n")
        },
    },
    Naming {
        what: "a photograph of Metashape",
        harmless: "t.png",
        command: "info in --json",
        write: |to, name| {
            let camera = |id: usize, name: &str| {
                format!(
                    "<camera id=\"{id}\" sensor_id=\"0\" label=\"{name}\">\
            <transform>1 0 0 0.{id} 0 -1 0 0 0 0 -1 3 0 0 0 1</transform></camera>"
                )
            };
            put(
                to,
                "cameras.xml",
                format!(
                    "<?xml version=\"1.0\"?><document version=\"1.5.0\"><chunk><sensors>\
            <sensor id=\"0\" type=\"frame\"><resolution width=\"12\" height=\"8\"/><calibration type=\"frame\" class=\"adjusted\">\
            <resolution width=\"12\" height=\"8\"/><f>12</f></calibration></sensor></sensors><cameras>{}{}</cameras></chunk></document>",
                    camera(0, name),
                    camera(1, "a.jpg")
                ),
            )?;
            put(to, "mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n")
        },
    },
];

/// Hostile forms of a name; `~` is the absolute folder above the input's, `?` the name itself.
const FORMS: [&str; 13] = [
    "../?",
    "~/?",
    "file://~/?",
    "sub/../../?",
    "..\\?",
    "%2e%2e/?",
    "file:../?",
    "link-?",
    "sub-link/?",
    "/dev/zero",
    "\\\\server\\share\\?",
    "//server/share/?",
    "/proc/self/environ",
];

fn compare_with_twin(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let naming = &NAMINGS[case % NAMINGS.len()];
    let form = FORMS[(case / NAMINGS.len() + case * 5) % FORMS.len()];
    let mut opened = Vec::new();
    let above = place.own.join("hostile");
    let hostile = form.replace('~', &above.to_string_lossy()).replace('?', naming.harmless);
    for (folder, name) in [("harmless", naming.harmless), ("hostile", hostile.as_str())] {
        let folder = place.own.join(folder);
        write_surroundings(&folder, naming.harmless)?;
        (naming.write)(&folder.join("in"), name)?;
        let command = context.program.line(&folder, naming.command);
        let (run, calls) = traced(command, "openat,open,openat2", None, &folder)?;
        ended_as_documented(&run).map_err(|why| format!("{} named {name}: {why}", naming.what))?;
        let own = format!("{}/", folder.join("in").display());
        let output = format!("{}/o.", folder.display());
        let hidden = format!("{}/.o.", folder.display());
        if folder.ends_with("harmless")
            && !calls.iter().any(|call| call.result.contains(&format!("{own}{name}>")))
        {
            return Err(format!(
                "{}: the command does not open what is named, so nothing was tried",
                naming.what
            ));
        }
        let paths = calls.iter().filter_map(|call| {
            call.result.split_once('<').map(|(_, path)| path.trim_end_matches('>').to_owned())
        });
        let outside = paths.filter(|path| {
            !is_unnamed(path)
                && !format!("{path}/").starts_with(&own)
                && !path.starts_with(&output)
                && !path.starts_with(&hidden)
        });
        opened.push(outside.map(|path| normal(&path, &folder)).collect::<BTreeSet<String>>());
    }
    let only_hostile: Vec<_> = opened[1].difference(&opened[0]).collect();
    match only_hostile.is_empty() {
        true => Ok(()),
        false => Err(format!(
            "{} named {hostile}: opens {only_hostile:?} (focus-brush {})",
            naming.what, naming.command
        )),
    }
}

/// Whether a path is Linux's description of a file without a name, which an output is until it is complete.
fn is_unnamed(path: &str) -> bool {
    let name = path.rsplit('/').next().unwrap_or_default();
    name.starts_with('#') && name.ends_with("(deleted)")
}

/// The inputs in `in`, and above it the files that hostile names mean.
fn write_surroundings(folder: &Path, secret: &str) -> Result<(), String> {
    let inside = folder.join("in");
    put(folder, "in/sub/readme.txt", "")?;
    write_inputs(&inside)?;
    put(folder, "outside/readme.txt", "")?;
    match secret {
        "quad.bin" => put(folder, secret, quad_bytes())?,
        name => picture(&folder.join(name), [12, 8])?,
    }
    let bytes = std::fs::read(folder.join(secret)).map_err(|e| e.to_string())?;
    put(folder, &format!("outside/{secret}"), bytes)?;
    let link = |target: &str, name: &str| {
        std::os::unix::fs::symlink(target, inside.join(name)).map_err(|e| e.to_string())
    };
    link(&format!("../{secret}"), &format!("link-{secret}"))?;
    link("../outside", "sub-link")
}

/// A path without what differs between two runs.
fn normal(path: &str, folder: &Path) -> String {
    let path = path.replace(&*folder.to_string_lossy(), "FOLDER");
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let is_proc = path.starts_with("/proc/");
    let parts = path.split('/').map(|part| if is_proc && digits(part) { "self" } else { part });
    parts.collect::<Vec<_>>().join("/")
}
