//! PLY as others write it.

use super::{by_channel, color, smallest_three, unit_byte};
use gaussians::{GaussianCloud, Splat};
use glam::Vec3;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Numbers {
    Ascii,
    BigEndianDoubles,
    LittleEndianFloats,
}

/// A standard file with its properties in another order, among others, after a table that is none of splats, with comments.
pub fn ply_in_other_order(cloud: &GaussianCloud, numbers: Numbers) -> Vec<u8> {
    let names = [
        "rot_0", "scale_1", "f_dc_2", "z", "extra", "opacity", "f_dc_0", "x", "scale_0", "rot_3", "y",
        "rot_1",
    ]
    .into_iter()
    .map(String::from)
    .chain(["scale_2", "f_dc_1", "rot_2"].map(String::from))
    .chain((0..cloud.coefficients(0).len()).rev().map(|k| format!("f_rest_{k}")))
    .collect::<Vec<_>>();
    let (format, data_type) = match numbers {
        Numbers::Ascii => ("ascii", "float"),
        Numbers::BigEndianDoubles => ("binary_big_endian", "double"),
        Numbers::LittleEndianFloats => ("binary_little_endian", "float32"),
    };
    let mut header = format!("ply\r\nformat {format} 1.0\r\ncomment of a tool\r\nobj_info of another\r\n");
    header += "element camera 2\r\nproperty uchar kind\r\nproperty list uchar int neighbours\r\n";
    header += &format!("element vertex {}\r\n", cloud.len());
    names.iter().for_each(|name| header += &format!("property {data_type} {name}\r\n"));
    header += "element face 0\r\nproperty list uchar int vertex_indices\r\nend_header\r\n";
    let mut bytes = header.into_bytes();
    bytes.extend(match numbers {
        Numbers::Ascii => b"7 2 11 12\n8 0\n".to_vec(),
        Numbers::BigEndianDoubles => vec![7, 2, 0, 0, 0, 11, 0, 0, 0, 12, 8, 0],
        Numbers::LittleEndianFloats => vec![7, 2, 11, 0, 0, 0, 12, 0, 0, 0, 8, 0],
    });
    for index in 0..cloud.len() {
        let (splat, rest) = (cloud.splat(index), by_channel(cloud, index));
        for name in &names {
            let value = property(&splat, &rest, name);
            match numbers {
                Numbers::Ascii => bytes.extend(format!("{value} ").into_bytes()),
                Numbers::BigEndianDoubles => bytes.extend(f64::from(value).to_be_bytes()),
                Numbers::LittleEndianFloats => bytes.extend(value.to_le_bytes()),
            }
        }
        if numbers == Numbers::Ascii {
            bytes.push(b'\n');
        }
    }
    bytes
}

fn property(splat: &Splat, rest: &[f32], name: &str) -> f32 {
    let q = splat.rotation;
    match name {
        "x" => splat.mean.x,
        "y" => splat.mean.y,
        "z" => splat.mean.z,
        "opacity" => Splat::logit_of_opacity(splat.opacity),
        "rot_0" => q.w,
        "rot_1" => q.x,
        "rot_2" => q.y,
        "rot_3" => q.z,
        "extra" => 99.0,
        _ => {
            let (kind, index) = name.rsplit_once('_').expect("a numbered name");
            let index: usize = index.parse().expect("a number");
            match kind {
                "scale" => splat.log_scale[index],
                "f_dc" => splat.base_color[index],
                _ => rest[index],
            }
        }
    }
}

/// A compressed file, with ranges of colours if `has_color_ranges`.
pub fn compressed_ply(cloud: &GaussianCloud, has_color_ranges: bool) -> Vec<u8> {
    let splats: Vec<Splat> = (0..cloud.len()).map(|index| cloud.splat(index)).collect();
    let chunks: Vec<&[Splat]> = splats.chunks(256).collect();
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement chunk {}\n", chunks.len());
    let colors: &[&str] = if has_color_ranges { &["r", "g", "b"] } else { &[] };
    for names in [&["x", "y", "z"][..], &["scale_x", "scale_y", "scale_z"], colors] {
        for end in ["min", "max"] {
            names.iter().for_each(|name| header += &format!("property float {end}_{name}\n"));
        }
    }
    header += &format!("element vertex {}\n", cloud.len());
    ["position", "rotation", "scale", "color"]
        .iter()
        .for_each(|name| header += &format!("property uint packed_{name}\n"));
    let rest = cloud.coefficients(0).len();
    if rest > 0 {
        header += &format!("element sh {}\n", cloud.len());
        (0..rest).for_each(|k| header += &format!("property uchar f_rest_{k}\n"));
    }
    let mut bytes = (header + "end_header\n").into_bytes();
    let ends = |values: &dyn Fn(&Splat) -> Vec3, chunk: &[Splat]| {
        let [mut least, mut most] = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        for splat in chunk {
            (least, most) = (least.min(values(splat)), most.max(values(splat)));
        }
        [least, most]
    };
    let mean = |splat: &Splat| splat.mean;
    let scale = |splat: &Splat| splat.log_scale;
    let color_range =
        |chunk: &[Splat]| if has_color_ranges { ends(&color, chunk) } else { [Vec3::ZERO, Vec3::ONE] };
    for chunk in &chunks {
        for range in [ends(&mean, chunk), ends(&scale, chunk), color_range(chunk)]
            .iter()
            .take(2 + usize::from(has_color_ranges))
        {
            bytes.extend(range.iter().flat_map(|end| end.to_array()).flat_map(f32::to_le_bytes));
        }
    }
    for chunk in &chunks {
        let (mean_range, scale_range, color_range) =
            (ends(&mean, chunk), ends(&scale, chunk), color_range(chunk));
        for splat in *chunk {
            let share = |value: Vec3, [least, most]: [Vec3; 2]| {
                (value - least) / (most - least).max(Vec3::splat(1e-9))
            };
            let bits = |share: f32, bits: u32| (share * ((1u32 << bits) - 1) as f32).round() as u32;
            let three = |share: Vec3| bits(share.x, 11) << 21 | bits(share.y, 10) << 11 | bits(share.z, 11);
            let (largest, others) = smallest_three(splat);
            let rotation =
                others.iter().fold(largest as u32, |packed, x| packed << 10 | bits((x + 1.0) / 2.0, 10));
            let rgb = share(color(splat), color_range).to_array().map(unit_byte);
            let color = u32::from_be_bytes([rgb[0], rgb[1], rgb[2], unit_byte(splat.opacity)]);
            let words = [
                three(share(splat.mean, mean_range)),
                rotation,
                three(share(splat.log_scale, scale_range)),
                color,
            ];
            bytes.extend(words.into_iter().flat_map(u32::to_le_bytes));
        }
    }
    for index in 0..cloud.len() {
        let quantised = |x: f32| ((x / 8.0 + 0.5) * 256.0).floor().clamp(0.0, 255.0) as u8;
        bytes.extend(by_channel(cloud, index).into_iter().map(quantised));
    }
    bytes
}
