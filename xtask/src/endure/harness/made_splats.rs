//! Eight Gaussian splats in each format that the program reads.

use super::archive::{Entry, zip};
use super::made_files::{glb, put};
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder};
use serde_json::{Map, json};
use std::path::Path;

const COUNT: u8 = 8;
/// Logarithm of the size along each axis.
const LOG_SCALE: [f32; 3] = [-2.0, -2.5, -3.0];
/// Colour of degree 0 and opacity, and a rotation near none (w x y z), as bytes.
const RGBA: [u8; 4] = [200, 120, 60, 230];
const ROTATION: [u8; 4] = [250, 140, 130, 125];

/// Writes them into the folder `splats`.
pub fn write(folder: &Path) -> Result<(), String> {
    let put = |name: &str, bytes: Vec<u8>| put(folder, &format!("splats/{name}"), bytes);
    put("a.ply", ply())?;
    put("a.compressed.ply", compressed_ply())?;
    put("a.splat", splat())?;
    put("a2.spz", gzip(&[spz_head(2, 0), spz_attributes().concat()].concat()))?;
    put("a4.spz", spz_frames())?;
    put("a.sog", sog()?)?;
    put("a.ksplat", ksplat())?;
    put("a.glb", gltf())
}

/// On a helix that goes away from the camera.
fn means() -> impl Iterator<Item = [f32; 3]> {
    (0..COUNT).map(|index| {
        let turn = f32::from(index) * 0.8;
        [turn.cos(), turn.sin(), -f32::from(index) / 4.0]
    })
}

fn floats(values: impl IntoIterator<Item = f32>) -> Vec<u8> {
    values.into_iter().flat_map(f32::to_le_bytes).collect()
}

/// The standard file, of degree 1.
fn ply() -> Vec<u8> {
    let names = "x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3";
    let rest = (0..9).map(|k| format!("f_rest_{k}"));
    let mut file = format!("ply\nformat binary_little_endian 1.0\nelement vertex {COUNT}\n");
    for name in names.split(' ').map(str::to_owned).chain(rest) {
        file += &format!("property float {name}\n");
    }
    let mut bytes = (file + "end_header\n").into_bytes();
    for mean in means() {
        let others = [1.0, 0.5, -0.5, 2.0].into_iter().chain(LOG_SCALE).chain([1.0, 0.1, 0.2, 0.0]);
        bytes.extend(floats(mean.into_iter().chain(others).chain((0..9).map(|k| 0.02 * k as f32))));
    }
    bytes
}

/// PlayCanvas' compressed PLY: one chunk.
fn compressed_ply() -> Vec<u8> {
    let ends = "min_x min_y min_z max_x max_y max_z min_scale_x min_scale_y min_scale_z max_scale_x max_scale_y \
        max_scale_z min_r min_g min_b max_r max_g max_b";
    let mut head = String::from("ply\nformat binary_little_endian 1.0\nelement chunk 1\n");
    ends.split_whitespace().for_each(|name| head += &format!("property float {name}\n"));
    head += &format!("element vertex {COUNT}\n");
    for name in ["position", "rotation", "scale", "color"] {
        head += &format!("property uint packed_{name}\n");
    }
    let mut bytes = (head + "end_header\n").into_bytes();
    bytes.extend(floats([-1.0, -1.0, -2.0, 1.0, 1.0, 0.0, -4.0, -4.0, -4.0, -1.0, -1.0, -1.0]));
    bytes.extend(floats([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]));
    for [x, y, z] in means() {
        let unit = |value: f32, steps: f32| (value.clamp(0.0, 1.0) * steps) as u32;
        let position = unit((x + 1.0) / 2.0, 2047.0) << 21
            | unit((y + 1.0) / 2.0, 1023.0) << 11
            | unit((z + 2.0) / 2.0, 2047.0);
        let words =
            [position, 512 << 20 | 520 << 10 | 530, 700 << 21 | 300 << 11 | 500, u32::from_be_bytes(RGBA)];
        bytes.extend(words.into_iter().flat_map(u32::to_le_bytes));
    }
    bytes
}

fn splat() -> Vec<u8> {
    let record = |mean: [f32; 3]| {
        [floats(mean), floats(LOG_SCALE.map(f32::exp)), RGBA.to_vec(), ROTATION.to_vec()].concat()
    };
    means().flat_map(record).collect()
}

/// The head of an SPZ of degree 0; `last` is its last byte.
fn spz_head(version: u32, last: u8) -> Vec<u8> {
    let mut head = b"NGSP".to_vec();
    head.extend([version, u32::from(COUNT)].into_iter().flat_map(u32::to_le_bytes));
    head.extend([0, SPZ_FRACTIONAL_BITS, 0, last]);
    head
}

const SPZ_FRACTIONAL_BITS: u8 = 12;

/// Means, opacities, colours, sizes, rotations as in version 2.
fn spz_attributes() -> [Vec<u8>; 5] {
    let fixed = |x: f32| ((x * f32::from(1u16 << SPZ_FRACTIONAL_BITS)) as i32).to_le_bytes();
    let repeated = |bytes: &[u8]| bytes.repeat(usize::from(COUNT));
    [
        means().flatten().flat_map(|x| fixed(x)[..3].to_vec()).collect(),
        repeated(&RGBA[3..]),
        repeated(&RGBA[..3]),
        repeated(&LOG_SCALE.map(|scale| ((scale + 10.0) * 16.0) as u8)),
        repeated(&ROTATION[1..]),
    ]
}

/// SPZ 4: a zstd frame for each attribute, their sizes before them.
fn spz_frames() -> Vec<u8> {
    let mut attributes = spz_attributes();
    // The index of the largest component, then three times sign and nine bits.
    attributes[4] = (3u32 << 30 | 40 << 20 | 20 << 10 | 520).to_le_bytes().repeat(usize::from(COUNT));
    let mut bytes = spz_head(4, attributes.len() as u8);
    bytes.extend(32u32.to_le_bytes());
    bytes.resize(32, 0);
    let frames = attributes.each_ref().map(|attribute| zstd_frame(attribute));
    for (attribute, frame) in attributes.iter().zip(&frames) {
        bytes.extend([frame.len() as u64, attribute.len() as u64].into_iter().flat_map(u64::to_le_bytes));
    }
    [bytes, frames.concat()].concat()
}

/// A zstd frame with one block as it is (RFC 8878).
fn zstd_frame(content: &[u8]) -> Vec<u8> {
    let length = content.len() as u32;
    // A single segment, its size in four bytes; then the last block and its size in three.
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0b1010_0000];
    frame.extend(length.to_le_bytes());
    frame.extend(&(length << 3 | 1).to_le_bytes()[..3]);
    frame.extend(content);
    frame
}

/// A gzip file with one block as it is (RFC 1952).
fn gzip(content: &[u8]) -> Vec<u8> {
    let length = content.len() as u16;
    let mut file = vec![0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255, 1];
    file.extend([length, !length].into_iter().flat_map(u16::to_le_bytes));
    file.extend(content);
    file.extend([crc32fast::hash(content), content.len() as u32].into_iter().flat_map(u32::to_le_bytes));
    file
}

/// SOG 2: four by four pixels, half of them used.
fn sog() -> Result<Vec<u8>, String> {
    let shares = || means().map(|mean| mean.map(|x| (((x + 2.0) / 4.0).clamp(0.0, 1.0) * 65535.0) as u16));
    let bytes = |part: usize| shares().map(move |share| share.map(|x| x.to_le_bytes()[part]));
    let codebook: Vec<f32> = (0..256).map(|k| -4.0 + k as f32 / 64.0).collect();
    let meta = json!({
        "version": 2, "count": COUNT,
        "means": {"mins": [-2, -2, -2], "maxs": [2, 2, 2], "files": ["means_l.webp", "means_u.webp"]},
        "scales": {"codebook": codebook, "files": ["scales.webp"]},
        "quats": {"files": ["quats.webp"]},
        "sh0": {"codebook": codebook, "files": ["sh0.webp"]}});
    let constant = |rgba: [u8; 4]| webp(vec![rgba; usize::from(COUNT)]);
    let opaque = |part: usize| webp(bytes(part).map(|[x, y, z]| [x, y, z, 255]).collect());
    let pictures = [
        ("means_l.webp", opaque(0)?),
        ("means_u.webp", opaque(1)?),
        ("scales.webp", constant([120, 100, 80, 255])?),
        ("quats.webp", constant([128, 140, 130, 252])?),
        ("sh0.webp", constant(RGBA)?),
    ];
    let meta = Entry::plain("meta.json", meta.to_string().as_bytes());
    let pictures = pictures.iter().map(|(name, bytes)| Entry::plain(name, bytes));
    Ok(zip(&std::iter::once(meta).chain(pictures).collect::<Vec<_>>()))
}

fn webp(mut pixels: Vec<[u8; 4]>) -> Result<Vec<u8>, String> {
    pixels.resize(16, [0; 4]);
    let mut bytes = Vec::new();
    let encoder = WebPEncoder::new_lossless(&mut bytes);
    let written = encoder.write_image(pixels.as_flattened(), 4, 4, ExtendedColorType::Rgba8);
    written.map_err(|error| error.to_string()).map(|()| bytes)
}

/// A file of one section with one full bucket, of degree 0, as floats.
fn ksplat() -> Vec<u8> {
    let mut bytes = vec![0; 4096 + 1024];
    let mut put = |at: usize, value: u32| bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
    let count = u32::from(COUNT);
    // The version; sections that may be and that are; splats that may be and that are.
    [(0, 0x100), (4, 1), (8, 1), (12, count), (16, count)].into_iter().for_each(|(at, value)| put(at, value));
    // The section: splats that may be and that are, splats of a bucket, buckets, the block's side, bytes of a bucket, full buckets.
    let section =
        [(0, count), (4, count), (8, count), (12, 1), (16, 8f32.to_bits()), (20, 12), (24, 1), (32, 1)];
    section.into_iter().for_each(|(at, value)| put(4096 + at, value));
    bytes.extend(floats([0.0; 3]));
    for mean in means() {
        bytes.extend(floats(mean.into_iter().chain(LOG_SCALE.map(f32::exp)).chain([1.0, 0.1, 0.2, 0.0])));
        bytes.extend(RGBA);
    }
    bytes
}

/// `KHR_gaussian_splatting` of degree 0.
fn gltf() -> Vec<u8> {
    let repeated =
        |values: &[f32]| floats(values.iter().copied().cycle().take(values.len() * usize::from(COUNT)));
    let attributes = [
        ("POSITION", "VEC3", floats(means().flatten())),
        ("KHR_gaussian_splatting:ROTATION", "VEC4", repeated(&[0.0, 0.0, 0.0, 1.0])),
        ("KHR_gaussian_splatting:SCALE", "VEC3", repeated(&LOG_SCALE.map(f32::exp))),
        ("KHR_gaussian_splatting:OPACITY", "SCALAR", repeated(&[0.9])),
        ("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", "VEC3", repeated(&[1.0, 0.5, -0.5])),
    ];
    let (mut buffer, mut views, mut accessors, mut names) = (Vec::new(), Vec::new(), Vec::new(), Map::new());
    for (index, (name, kind, bytes)) in attributes.into_iter().enumerate() {
        views.push(json!({"buffer": 0, "byteOffset": buffer.len(), "byteLength": bytes.len()}));
        accessors.push(json!({"bufferView": index, "componentType": 5126, "count": COUNT, "type": kind}));
        names.insert(name.into(), index.into());
        buffer.extend(bytes);
    }
    accessors[0]["min"] = json!([-1.0, -1.0, -2.0]);
    accessors[0]["max"] = json!([1.0, 1.0, 0.0]);
    let splatting = json!({"kernel": "ellipse", "colorSpace": "srgb_rec709_display"});
    let scene = json!({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "extensionsUsed": ["KHR_gaussian_splatting"],
        "meshes": [{"primitives": [{"mode": 0, "attributes": names,
            "extensions": {"KHR_gaussian_splatting": splatting}}]}],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": buffer.len()}]});
    glb(&scene.to_string(), &buffer)
}
