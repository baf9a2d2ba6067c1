//! Damaged files of every kind: no panic, no long run, no excessive memory, and never a picture from outside the folder.
//!
//! Ten seeds a kind, each opened in some hundred forms: half of them with changed bytes, half with a changed structure (counts, indices,
//! units, fields and lines that are missing or twice). `CAPTURE_MUTANTS=10000` makes as many in all, in ten seconds of a processor's
//! time and a minute or more of a disk's; by default it is a tenth.

use crate::made::{Camera, FOCAL, PLY, SIZE, cameras, open, pictures_and_mesh};
use crate::mutation::{Random, damage};
use std::fs::{create_dir_all, read, write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The kinds of files.
const KINDS: usize = 6;
/// Seeds per kind.
const SEEDS: usize = 10;

/// The number of mutants of a seed.
fn mutants() -> usize {
    let all = std::env::var("CAPTURE_MUTANTS").ok().and_then(|all| all.parse().ok()).unwrap_or(1000);
    usize::div_ceil(all, KINDS * SEEDS)
}

/// Opens mutants of the files that `seed` writes into a folder with pictures and a mesh, and returns.
fn survive(seed: impl Fn(&Path, &[Camera], usize) -> Vec<PathBuf>) {
    let (mut opened, mut refused) = (0, 0);
    for index in 0..SEEDS {
        let names: Vec<String> = (0..1 + index % 3).map(|k| format!("{k}/picture {index}.jpg")).collect();
        let folder = tempfile::tempdir().unwrap();
        let all = cameras(&names.iter().map(String::as_str).collect::<Vec<_>>());
        pictures_and_mesh(folder.path(), &all);
        let files = seed(folder.path(), &all, index);
        let whole: Vec<Vec<u8>> = files.iter().map(|file| read(file).unwrap()).collect();
        open(folder.path()).unwrap_or_else(|error| panic!("seed {index}: {error}"));
        let mut random = Random(1 + index as u64);
        for number in 0..mutants() {
            let which = random.below(files.len());
            let mut bytes = whole[which].clone();
            match number % 2 {
                0 => damage(&mut bytes, &mut random),
                _ => restructure(&mut bytes, &mut random),
            }
            write(&files[which], &bytes).unwrap();
            let start = Instant::now();
            let result = open(folder.path());
            let took = start.elapsed();
            assert!(took < Duration::from_secs(5), "seed {index}, mutant {number}: {took:?}");
            match result {
                Ok(capture) => {
                    opened += 1;
                    let is_inside = |file: &PathBuf| {
                        file.canonicalize().unwrap().starts_with(folder.path().canonicalize().unwrap())
                    };
                    assert!(capture.views.iter().all(|view| is_inside(&view.picture)));
                    let (low, high) = capture.scene.bounds();
                    assert!(low.is_finite() && high.is_finite());
                }
                Err(error) => {
                    refused += 1;
                    let text = error.to_string();
                    let is_sentence = text.contains(": ") && text.ends_with(')') && !text.contains('\n');
                    assert!(
                        is_sentence && !text.contains("the decoder failed"),
                        "seed {index}, mutant {number}: {text}"
                    );
                }
            }
            write(&files[which], &whole[which]).unwrap();
        }
    }
    println!("{opened} opened, {refused} refused");
    assert!(opened > 0 && refused > 0, "{opened} opened, {refused} refused");
    if let Some(peak) = peak_memory() {
        assert!(peak < 1 << 30, "{} MiB", peak >> 20);
    }
}

/// The peak memory of this process, bytes, if the system reports it.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().trim_end_matches(" kB").parse::<u64>().ok()? << 10)
}

/// A random element.
fn pick<'a, T: ?Sized>(random: &mut Random, of: &[&'a T]) -> &'a T {
    of[random.below(of.len())]
}

/// Changes the content of a file but not its form: a number, a field, a line; in binary files a count.
pub fn restructure(bytes: &mut Vec<u8>, random: &mut Random) {
    const NUMBERS: [&str; 14] = [
        "0",
        "-1",
        "1",
        "nan",
        "-inf",
        "1e308",
        "1e-320",
        "2147483648",
        "4294967295",
        "18446744073709551615",
        "-9",
        "0,5",
        "1000000",
        "",
    ];
    const WORDS: [&str; 8] = ["null", "[]", "{}", "\"x\"", "../../x.jpg", "/etc/passwd", "<a>", "#"];
    // The text of a binary file is its header.
    let text_end =
        bytes.windows(11).position(|window| window == b"end_header\n").map_or(bytes.len(), |at| at + 11);
    let is_text = bytes[..text_end].iter().all(|byte| byte.is_ascii());
    if !is_text || (text_end < bytes.len() && random.below(2) == 0) {
        let start = if is_text { text_end } else { 0 };
        let at = start + random.below((bytes.len() - start).max(1));
        let value = pick::<[u8]>(
            random,
            &[&[0; 8], &[0xFF; 8], &[0, 0, 0, 0x80], &[1, 0, 0, 0], &[0, 0, 0, 0, 0, 0, 0xF0, 0x7F]],
        );
        match random.below(3) {
            0 => bytes.truncate(at),
            _ => bytes.iter_mut().skip(at).zip(value).for_each(|(byte, new)| *byte = *new),
        }
        return;
    }
    let rest = bytes.split_off(text_end);
    let text = String::from_utf8_lossy(bytes).into_owned();
    let mut lines: Vec<String> = text.split('\n').map(String::from).collect();
    let at = random.below(lines.len());
    match random.below(8) {
        0 => drop(lines.remove(at)),
        1 => lines.insert(at, lines[random.below(lines.len())].clone()),
        2 => lines.truncate(at),
        3 => {
            let other = random.below(lines.len());
            lines.swap(at, other);
        }
        // A field: the text between spaces, commas, quotes, brackets.
        change => {
            let line = &mut lines[at];
            let is_part = |c: char| c.is_whitespace() || ",\"[]{}<>:".contains(c);
            let fields: Vec<(usize, &str)> = line
                .split(is_part)
                .map(|field| (field.as_ptr() as usize - line.as_ptr() as usize, field))
                .filter(|(_, field)| !field.is_empty())
                .collect();
            if fields.is_empty() {
                line.push_str(pick(random, &WORDS));
            } else {
                let (start, field) = fields[random.below(fields.len())];
                let range = start..start + field.len();
                let new = match change {
                    4 | 5 => pick(random, &NUMBERS).to_owned(),
                    6 => pick(random, &WORDS).to_owned(),
                    _ => format!("{field} {field}"),
                };
                line.replace_range(range, &new);
            }
        }
    }
    *bytes = lines.join("\n").into_bytes();
    bytes.extend(rest);
}

/// Lenses of many models.
const LENSES: [&str; SEEDS] = [
    "SIMPLE_PINHOLE 60 40 50 30 20",
    "PINHOLE 60 40 50 50 30 20",
    "SIMPLE_RADIAL 60 40 50 30 20 -0.1",
    "RADIAL 60 40 50 30 20 -0.1 0.05",
    "OPENCV 60 40 50 50 30 20 -0.1 0.05 0.001 -0.002",
    "OPENCV_FISHEYE 60 40 50 50 30 20 -0.02 0.01 -0.003 0.0005",
    "FULL_OPENCV 60 40 50 50 30 20 0.1 0.03 0.002 -0.003 0.01 0.2 0.05 0.02",
    "FOV 60 40 50 50 30 20 0.5",
    "THIN_PRISM_FISHEYE 60 40 50 50 30 20 -0.02 0.01 0.002 -0.003 -0.003 0.0005 0.004 -0.002",
    "RAD_TAN_THIN_PRISM_FISHEYE 60 40 50 50 30 20 -0.02 0.01 0 0 0 0 0.002 -0.003 0.004 -0.001 -0.002 0.001",
];

#[test]
fn colmap_text() {
    survive(|folder, cameras, index| {
        let model = folder.join("sparse/0");
        crate::made::colmap_text(&model, cameras);
        write(model.join("cameras.txt"), format!("# Camera list\n7 {}\n", LENSES[index])).unwrap();
        ["cameras.txt", "images.txt"].map(|file| model.join(file)).to_vec()
    });
}

#[test]
fn colmap_binary() {
    survive(|folder, cameras, index| {
        let model = folder.join("sparse/0");
        create_dir_all(&model).unwrap();
        let numbers: Vec<f64> =
            LENSES[index].split(' ').skip(1).map(|field| field.parse().unwrap()).collect();
        let models = [0, 1, 2, 3, 4, 5, 6, 7, 10, 11u32];
        let mut bytes = [&1u64.to_le_bytes()[..], &7u32.to_le_bytes(), &models[index].to_le_bytes()].concat();
        numbers[..2].iter().for_each(|side| bytes.extend((*side as u64).to_le_bytes()));
        numbers[2..].iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        write(model.join("cameras.bin"), bytes).unwrap();
        let mut bytes = (cameras.len() as u64).to_le_bytes().to_vec();
        for (id, camera) in cameras.iter().enumerate() {
            let (q, t) = (camera.rotation, camera.rotation * -camera.center);
            bytes.extend((id as u32).to_le_bytes());
            [q.w, q.x, q.y, q.z, t.x, t.y, t.z].iter().for_each(|number| bytes.extend(number.to_le_bytes()));
            bytes.extend(
                [&7u32.to_le_bytes()[..], camera.name.as_bytes(), b"\0", &1u64.to_le_bytes(), &[0x3F; 24]]
                    .concat(),
            );
        }
        write(model.join("images.bin"), bytes).unwrap();
        ["cameras.bin", "images.bin"].map(|file| model.join(file)).to_vec()
    });
}

#[test]
fn ply() {
    survive(|folder, cameras, index| {
        crate::made::colmap_text(&folder.join("sparse"), cameras);
        let file = folder.join("mesh.ply");
        let skull =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/photogrammetry/skull/mesh.ply");
        match index {
            0 if skull.is_file() => drop(std::fs::copy(skull, &file).unwrap()),
            1..5 => {
                let (order, swap): (_, fn(&mut [u8])) =
                    if index % 2 == 0 { ("little", |_| {}) } else { ("big", |bytes| bytes.reverse()) };
                let head = format!(
                    "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\n\
                     property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
                     property list uchar int vertex_indices\nend_header\n"
                );
                let mut bytes = head.into_bytes();
                let mut push = |mut number: Vec<u8>| {
                    swap(&mut number);
                    bytes.extend(number);
                };
                for k in 0..4 {
                    [k as f32 * 0.2, (k % 2) as f32 * 0.3]
                        .iter()
                        .for_each(|number| push(number.to_le_bytes().to_vec()));
                    push((f64::from(k) * 0.1).to_le_bytes().to_vec());
                    (0..3).for_each(|channel| push(vec![10 * channel]));
                }
                for corners in [[0, 1, 2], [1, 2, 3i32]] {
                    push(vec![3]);
                    corners.iter().for_each(|corner| push(corner.to_le_bytes().to_vec()));
                }
                write(&file, bytes).unwrap();
            }
            _ => {
                let quads =
                    PLY.replace("3 2 3 0", "4 2 3 0 1").replace("property float x", "property double x");
                write(&file, if index % 2 == 0 { quads } else { PLY.into() }).unwrap();
            }
        }
        vec![file]
    });
}

#[test]
fn obj() {
    survive(|folder, cameras, index| {
        crate::made::colmap_text(&folder.join("sparse"), cameras);
        std::fs::remove_file(folder.join("mesh.ply")).unwrap();
        let color = if index % 2 == 0 { " 0.5 0.25 1" } else { "" };
        let (face, last) = match index % 5 {
            0 => ("f 1/1/1 2/1/1 3/1/1", "f -4 -1 -3"),
            1 => ("f 1//1 2//1 3//1", "f 1 2 3 4"),
            2 => ("f 1/1 2/1 3/1", "f 2 3 \\\n4"),
            3 => ("usemtl m\nf 1 2 3", "f 4 3 2 1"),
            _ => ("s 1\ng x\nf 1 2 3", "f -1 -2 -3 -4"),
        };
        let file = folder.join("model.obj");
        let vertices =
            format!("v -1 -0.5 -0.5{color}\nv 1 -0.5 -0.5{color}\nv 0 -0.5 1{color}\nv 0 1 0{color}\n");
        write(&file, format!("# seed\nmtllib a.mtl\n{vertices}vt 0 0\nvn 0 0 1\n{face}\n{last}\n")).unwrap();
        vec![file]
    });
}

#[test]
fn json() {
    survive(|folder, cameras, index| {
        let of_all = match index % 5 {
            0 => r#""fl_x": 50, "cx": 30, "cy": 20, "w": 60, "h": 40"#,
            1 => r#""camera_angle_x": 1.08"#,
            2 => {
                r#""camera_model": "OPENCV_FISHEYE", "fl_x": 50.5, "fl_y": 50, "w": 60, "h": 40, "k1": -0.02, "k4": 0.001"#
            }
            3 => {
                r#""camera_model": "OPENCV", "fl_x": 50, "w": 60.0, "h": 40.0, "k1": 0.1, "p1": 0.01, "applied_transform": [[1,0,0,0]]"#
            }
            _ => r#""fl_x": 50, "aabb_scale": 16, "is_fisheye": false"#,
        };
        let frames = cameras.iter().map(|camera| {
            let to_world = glam::DMat3::from_quat(camera.rotation.inverse());
            let (x, y, z) = (to_world.x_axis, -to_world.y_axis, -to_world.z_axis);
            let row = |k: usize| format!("[{}, {}, {}, {}]", x[k], y[k], z[k], camera.center[k]);
            let name = format!("images/{}", camera.name);
            let own = if index > 4 { ", \"fl_x\": 48, \"sharpness\": 12.5" } else { "" };
            let rows = [row(0), row(1), row(2)].join(",\n");
            format!(
                "{{\n\"file_path\": \"{name}\",\n\"transform_matrix\": [\n{rows},\n[0, 0, 0, 1]\n]{own}\n}}"
            )
        });
        let file = folder.join("transforms.json");
        let frames: Vec<String> = frames.collect();
        write(
            &file,
            format!("{{\n{},\n\"frames\": [\n{}\n]\n}}\n", of_all.replace(", ", ",\n"), frames.join(",\n")),
        )
        .unwrap();
        vec![file]
    });
}

#[test]
fn xml() {
    survive(|folder, cameras, index| {
        let terms = [
            "",
            "<cx>1</cx>",
            "<k1>-0.1</k1><k2>0.05</k2>",
            "<p1>0.01</p1><p3>0.1</p3>",
            "<b1>1</b1><b2>0.5</b2>",
        ][index % 5];
        let kind = if index == 7 { "fisheye" } else { "frame" };
        let [width, height] = SIZE;
        let cameras: String = cameras
            .iter()
            .enumerate()
            .map(|(id, camera)| {
                let axes = glam::DMat3::from_quat(camera.rotation.inverse());
                let pose = glam::DMat4::from_mat3_translation(axes, camera.center).transpose().to_cols_array();
                let numbers = pose.map(|entry| entry.to_string()).join(" ");
                let label = camera.name.replace(".jpg", "");
                format!("<camera id=\"{id}\" sensor_id=\"0\" label=\"{label}\">\n<transform>{numbers}</transform>\n</camera>\n")
            })
            .collect();
        let placed = match index % 3 {
            0 => "",
            1 => "<transform><scale>2</scale></transform>\n",
            _ => {
                "<transform>\n<rotation>1 0 0 0 1 0 0 0 1</rotation>\n<translation>0 0 0</translation>\n</transform>\n"
            }
        };
        let text = format!(
            "<?xml version=\"1.0\"?>\n<document version=\"1.5.0\">\n<chunk>\n<sensors>\n<sensor id=\"0\" label=\"s\" type=\"{kind}\">\n\
             <resolution width=\"{width}\" height=\"{height}\"/>\n<calibration>\n<f>{FOCAL}</f>\n{terms}\n</calibration>\n</sensor>\n</sensors>\n\
             <cameras>\n{cameras}</cameras>\n{placed}</chunk>\n</document>\n"
        );
        let file = folder.join("cameras.xml");
        write(&file, text).unwrap();
        vec![file]
    });
}
