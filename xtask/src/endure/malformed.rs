//! Damaged files: each is refused or read, but never takes the program down.

use super::harness::made_files::{picture, picture_with_depth, put, write_all};
use super::harness::made_splats;
use super::harness::program::Limits;
use super::harness::promise::{Context, Promise, Verdict, Workplace, ended_as_documented};
use super::harness::seeded::Seeded;
use serde_json::json;
use std::path::Path;

/// Malformed input is refused.
pub const PROMISE: Promise = Promise {
    name: "malformed",
    sentence: "Malformed input is refused",
    what_is_done: "small valid files of every kind, changed at random places, opened by the command that reads them: \
                   no panic, signal or hang, at most 1 GiB, a documented exit code, one line of error",
    full: 100_000,
    short: 2_000,
    batch: 500,
    at_once: 2,
    prepare,
    case: open_damaged,
};

/// Processor time within which a command on a small file ends, s.
const TIME_S: u64 = 30;
const MEMORY: u64 = 1 << 30;

/// A file to be damaged, and the command that reads it: `@` is the folder of the intact files.
struct Readable {
    file: &'static str,
    command: &'static str,
}

const fn readable(file: &'static str, command: &'static str) -> Readable {
    Readable { file, command }
}

const READABLE: &[Readable] = &[
    readable("s.glb", "info s.glb"),
    readable("s.glb", "new s.glb -o o.fbrush"),
    readable("texture.gltf", "info texture.gltf"),
    readable("t.png", "compare t.png @/t.png"),
    readable("t.png", "info texture.gltf"),
    readable("a.jpg", "compare a.jpg @/t.png"),
    readable("a.webp", "compare a.webp @/t.png"),
    readable("r.exr", "compare r.exr @/r.exr"),
    readable("r.png", "compare r.png @/r.png"),
    readable("sky.hdr", "info @/s.glb --world sky.hdr"),
    readable("world.json", "info @/s.glb --world world.json"),
    readable("m.exr", "render @/l.salf --focus m.exr --backend cpu -o o.png"),
    readable("m.png", "render @/l.salf --focus m.png --backend cpu -o o.png"),
    readable("recipe.json", "render @/l.salf --focus recipe.json --backend cpu -o o.png"),
    readable("bokeh.json", "render @/l.salf --bokeh bokeh.json --backend cpu -o o.png"),
    readable(
        "lens.json",
        "render @/s.glb --camera @/cam.json --lens lens.json --size 8x8 --renderer truth --spp 1 -o o.png",
    ),
    readable("cam.json", "render @/s.glb --camera cam.json --size 8x8 --renderer truth --spp 1 -o o.png"),
    readable("strokes.json", "replay @/p.fbrush strokes.json -o o.fbrush"),
    readable("p.fbrush", "info p.fbrush"),
    readable("l.salf", "info l.salf"),
    readable("tiles.tile1-of-2.part", "merge -o o.exr tiles.tile1-of-2.part tiles.tile2-of-2.part"),
    readable("depth/a.jpg", "info depth/a.jpg"),
    readable("depth/a_depth.pfm", "info depth/a.jpg"),
    readable("nerf/transforms.json", "info nerf"),
    readable("nerf/mesh.ply", "info nerf"),
    readable("nerf/images/1.png", "info nerf"),
    readable("colmap/sparse/0/cameras.txt", "info colmap"),
    readable("colmap/sparse/0/images.txt", "info colmap"),
    readable("colmap/mesh.obj", "info colmap"),
    readable("bundler/bundle.out", "info bundler"),
    readable("views/parameters.cfg", "info views"),
    readable("splats/a.ply", "info splats/a.ply"),
    readable("splats/a.compressed.ply", "info splats/a.compressed.ply"),
    readable("splats/a.splat", "info splats/a.splat"),
    readable("splats/a2.spz", "info splats/a2.spz"),
    readable("splats/a4.spz", "info splats/a4.spz"),
    readable("splats/a.sog", "info splats/a.sog"),
    readable("splats/a.ksplat", "info splats/a.ksplat"),
    readable("splats/a.glb", "info splats/a.glb"),
];

/// Writes a small valid file of every kind.
pub(super) fn prepare(folder: &Path, context: &Context) -> Result<(), String> {
    if folder.join("views").exists() {
        return Ok(());
    }
    write_all(folder, context)?;
    write_captures(folder)?;
    made_splats::write(folder)?;
    for Readable { file, command } in READABLE {
        let run = context.program.line(folder, &command.replace("@/", "./")).run();
        ended_as_documented(&run)?;
        if !matches!(run.code, Some(0 | 4)) {
            eprintln!("note: the intact {file} is refused: {}", run.last_line());
        }
    }
    Ok(())
}

fn open_damaged(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let mut random = Seeded::new(case);
    let Readable { file, command } = &READABLE[case % READABLE.len()];
    copy_companions(file, place)?;
    let intact = std::fs::read(place.prepared.join(file)).map_err(|e| format!("{file}: {e}"))?;
    let damaged = damaged(&intact, &mut random);
    put(&place.own, file, &damaged)?;
    let limits = Limits { address_space: Some(4 << 30), cpu_s: Some(TIME_S), file_bytes: Some(1 << 28) };
    let run = context.program.line(&place.own, &command.replace("@/", "../prepared/")).limited(limits).run();
    let verdict = ended_as_documented(&run).and_then(|()| match run.peak_bytes {
        0..=MEMORY => Ok(()),
        peak => Err(format!("{}: took {} MiB", run.shown, peak >> 20)),
    });
    verdict.map_err(|why| format!("{file} damaged: {why} ({:.1} s)", run.cpu_s))
}

/// What lies beside a file that its reader also opens.
fn copy_companions(file: &str, place: &Workplace) -> Verdict {
    let companions: &[&str] = match file.split('/').next().unwrap_or_default() {
        "texture.gltf" => &["quad.bin", "t.png"],
        "t.png" => &["quad.bin", "texture.gltf"],
        "world.json" => &["sky.hdr"],
        "m.png" => &["m.png.json"],
        "p.fbrush" | "l.salf" => &["s.glb"],
        "tiles.tile1-of-2.part" => &["tiles.tile2-of-2.part"],
        "depth" => &["depth/a.jpg", "depth/a_depth.pfm"],
        "nerf" => &["nerf/transforms.json", "nerf/mesh.ply", "nerf/images/1.png", "nerf/images/2.png"],
        "colmap" => &[
            "colmap/sparse/0/cameras.txt",
            "colmap/sparse/0/images.txt",
            "colmap/sparse/0/points3D.txt",
            "colmap/mesh.obj",
            "colmap/images/1.png",
            "colmap/images/2.png",
        ],
        "bundler" => {
            &["bundler/bundle.out", "bundler/list.txt", "bundler/mesh.ply", "bundler/1.jpg", "bundler/2.jpg"]
        }
        "views" => &[
            "views/parameters.cfg",
            "views/input_Cam000.png",
            "views/input_Cam001.png",
            "views/input_Cam002.png",
            "views/input_Cam003.png",
        ],
        _ => &[],
    };
    for name in companions {
        let Ok(bytes) = std::fs::read(place.prepared.join(name)) else { continue };
        put(&place.own, name, bytes)?;
    }
    Ok(())
}

/// Numbers at which readers break.
const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1",
    "1e999",
    "-1e308",
    "1e-320",
    "NaN",
    "inf",
    "4294967295",
    "4294967296",
    "2147483648",
    "9223372036854775808",
    "18446744073709551616",
    "\"x\"",
];

/// One to four changes at random places.
fn damaged(intact: &[u8], random: &mut Seeded) -> Vec<u8> {
    let mut bytes = intact.to_vec();
    for _ in 0..=random.below(4) {
        if bytes.is_empty() {
            return bytes;
        }
        // Heads decide more than pixels: half of the changes go there.
        let reach = if random.below(2) == 0 { bytes.len() } else { bytes.len().min(400) };
        let at = random.below(reach);
        let end = (at + 1 + random.below(16)).min(bytes.len());
        match random.below(10) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.next() as u8,
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let again = bytes[at..end].to_vec();
                bytes.splice(at..at, again);
            }
            5 => bytes[at..end].fill(*random.one_of(&[0, 0xff, 0x80, 0x7f])),
            6 => {
                let number =
                    random.one_of(&[0, 1, u32::MAX, i32::MAX as u32, 1 << 31, 1 << 16]).to_le_bytes();
                for (byte, new) in bytes[at..].iter_mut().zip(number) {
                    *byte = new;
                }
            }
            7 => {
                let from = random.below(bytes.len());
                let part = bytes[from..(from + 64).min(bytes.len())].to_vec();
                bytes.splice(at..at, part);
            }
            _ => replace_number(&mut bytes, at, random),
        }
    }
    bytes
}

/// Replaces the next number written in digits by another.
fn replace_number(bytes: &mut Vec<u8>, at: usize, random: &mut Seeded) {
    let is_numeric = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'-' | b'.');
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit).map(|start| at + start) else { return };
    let end = bytes[start..].iter().position(|byte| !is_numeric(byte)).map_or(bytes.len(), |end| start + end);
    bytes.splice(start..end, random.one_of(&NUMBERS).bytes());
}

fn write_captures(folder: &Path) -> Result<(), String> {
    let photographs = |sub: &str, names: [&str; 2]| {
        put(folder, &format!("{sub}/readme.txt"), "")?;
        names.iter().try_for_each(|name| picture(&folder.join(sub).join(name), [16, 16]))
    };
    photographs("nerf/images", ["1.png", "2.png"])?;
    let frame = |name: &str, x: f64| {
        json!({"file_path": format!("images/{name}"),
            "transform_matrix": [[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]})
    };
    let transforms = json!({"w": 16, "h": 16, "fl_x": 16, "fl_y": 16, "cx": 8, "cy": 8, "camera_model": "PINHOLE",
        "frames": [frame("1.png", -0.2), frame("2.png", 0.2)]});
    put(folder, "nerf/transforms.json", transforms.to_string())?;
    put(folder, "nerf/mesh.ply", PLY)?;

    photographs("colmap/images", ["1.png", "2.png"])?;
    put(
        folder,
        "colmap/sparse/0/cameras.txt",
        "1 PINHOLE 16 16 16 16 8 8\n2 OPENCV 16 16 16 16 8 8 0.01 0 0 0\n",
    )?;
    put(folder, "colmap/sparse/0/images.txt", "1 0 1 0 0 0.2 0 3 1 1.png\n\n2 0 1 0 0 -0.2 0 3 2 2.png\n\n")?;
    put(folder, "colmap/sparse/0/points3D.txt", "1 0 0 0 128 128 128 0.5 1 0 2 0\n")?;
    put(folder, "colmap/mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n")?;

    photographs("bundler", ["1.jpg", "2.jpg"])?;
    let camera = |x: f64| format!("16 0 0\n1 0 0\n0 1 0\n0 0 1\n{x} 0 -3\n");
    put(folder, "bundler/bundle.out", format!("# Bundle file v0.3\n2 0\n{}{}", camera(0.2), camera(-0.2)))?;
    put(folder, "bundler/list.txt", "1.jpg\n2.jpg\n")?;
    put(folder, "bundler/mesh.ply", PLY)?;

    put(folder, "depth/readme.txt", "")?;
    picture_with_depth(&folder.join("depth"), [12, 8])?;

    put(folder, "views/readme.txt", "")?;
    for view in 0..4 {
        picture(&folder.join(format!("views/input_Cam{view:03}.png")), [16, 16])?;
    }
    put(
        folder,
        "views/parameters.cfg",
        "[intrinsics]\nfocal_length_mm = 100\nimage_resolution_x_px = 16\n\
        image_resolution_y_px = 16\nsensor_size_mm = 35\nfstop = 2.8\n[extrinsics]\nnum_cams_x = 2\nnum_cams_y = 2\n\
        baseline_mm = 50\nfocus_distance_m = 3\n[meta]\nscene = x\n",
    )
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 2\nproperty list uchar int vertex_indices\nend_header\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n3 0 1 2\n3 0 2 3\n";
