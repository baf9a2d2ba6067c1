//! SPZ.

use super::unit_byte;
use flate2::Compression;
use flate2::write::GzEncoder;
use gaussians::GaussianCloud;
use glam::Vec3;
use half::f16;
use std::io::Write;

/// Which SPZ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpzVersion {
    One,
    Two,
    Three,
    Four,
}

const FRACTIONAL_BITS: u8 = 12;

/// A file; flags say that it is antialiased. Axes are those of SPZ: y and z of the cloud are turned.
pub fn spz(cloud: &GaussianCloud, version: SpzVersion) -> Vec<u8> {
    match version {
        SpzVersion::Four => frames(cloud),
        _ => gzipped(&spz_payload(cloud, version)),
    }
}

/// What a file of version 1 to 3 compresses.
pub fn spz_payload(cloud: &GaussianCloud, version: SpzVersion) -> Vec<u8> {
    let mut bytes = beginning(cloud, version, 0);
    attributes(cloud, version).into_iter().for_each(|attribute| bytes.extend(attribute));
    bytes
}

pub fn gzipped(payload: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(payload).and_then(|()| encoder.finish()).expect("memory can be written")
}

fn beginning(cloud: &GaussianCloud, version: SpzVersion, last: u8) -> Vec<u8> {
    let mut bytes = b"NGSP".to_vec();
    bytes.extend((version as u32 + 1).to_le_bytes());
    bytes.extend((cloud.len() as u32).to_le_bytes());
    bytes.extend([cloud.degree() as u8, FRACTIONAL_BITS, 1, last]);
    bytes
}

fn attributes(cloud: &GaussianCloud, version: SpzVersion) -> [Vec<u8>; 6] {
    let mut attributes: [Vec<u8>; 6] = Default::default();
    let [means, opacities, colors, scales, rotations, coefficients] = &mut attributes;
    for index in 0..cloud.len() {
        let splat = cloud.splat(index);
        for x in splat.mean.to_array() {
            match version {
                SpzVersion::One => means.extend(f16::from_f32(x).to_le_bytes()),
                _ => means
                    .extend(&((x * f32::from(1u16 << FRACTIONAL_BITS)).round() as i32).to_le_bytes()[..3]),
            }
        }
        opacities.push(unit_byte(splat.opacity));
        colors.extend((splat.base_color * 0.15 + 0.5).to_array().map(unit_byte));
        let log = |s: f32| ((s + 10.0) * 16.0).round().clamp(0.0, 255.0) as u8;
        scales.extend(splat.log_scale.to_array().map(log));
        let q = splat.rotation;
        if matches!(version, SpzVersion::One | SpzVersion::Two) {
            let xyz = Vec3::new(q.x, q.y, q.z) * q.w.signum();
            rotations.extend(xyz.to_array().map(|x| (x * 127.5 + 127.5).round().clamp(0.0, 255.0) as u8));
        } else {
            let xyzw = q.to_array();
            let largest = (0..4).max_by(|a, b| xyzw[*a].abs().total_cmp(&xyzw[*b].abs())).expect("four");
            let others = (0..4).filter(|k| *k != largest).map(|k| xyzw[k] * xyzw[largest].signum());
            let pack = |packed: u32, x: f32| {
                packed << 10
                    | u32::from(x < 0.0) << 9
                    | (x.abs() * std::f32::consts::SQRT_2 * 511.0).round().min(511.0) as u32
            };
            rotations.extend(others.fold(largest as u32, pack).to_le_bytes());
        }
        let byte = |x: f32| (x * 128.0 + 128.0).round().clamp(0.0, 255.0) as u8;
        coefficients.extend(cloud.coefficients(index).iter().map(|x| byte(x.to_f32())));
    }
    attributes
}

/// Version 4, with an extension that names right, down, forward as the axes, as those of the cloud are.
fn frames(cloud: &GaussianCloud) -> Vec<u8> {
    let attributes: Vec<Vec<u8>> =
        attributes(cloud, SpzVersion::Four).into_iter().filter(|attribute| !attribute.is_empty()).collect();
    let mut bytes = beginning(cloud, SpzVersion::Four, attributes.len() as u8);
    bytes[14] |= 2;
    let extension: Vec<u8> = [0xADBE_0003u32, 4, 6].into_iter().flat_map(u32::to_le_bytes).collect();
    bytes.extend((32 + extension.len() as u32).to_le_bytes());
    bytes.resize(32, 0);
    bytes.extend(extension);
    let frames: Vec<Vec<u8>> = attributes.iter().map(|attribute| zstd_frame(attribute)).collect();
    for (attribute, frame) in attributes.iter().zip(&frames) {
        bytes.extend((frame.len() as u64).to_le_bytes());
        bytes.extend((attribute.len() as u64).to_le_bytes());
    }
    frames.into_iter().for_each(|frame| bytes.extend(frame));
    bytes
}

/// A zstd frame of uncompressed blocks (RFC 8878).
fn zstd_frame(content: &[u8]) -> Vec<u8> {
    const BLOCK: usize = 100_000;
    // A single segment, its size in four bytes.
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0b1010_0000];
    frame.extend((content.len() as u32).to_le_bytes());
    let blocks = content.chunks(BLOCK);
    let last = blocks.len() - 1;
    for (index, block) in blocks.enumerate() {
        let header = (block.len() as u32) << 3 | u32::from(index == last);
        frame.extend(&header.to_le_bytes()[..3]);
        frame.extend(block);
    }
    frame
}
