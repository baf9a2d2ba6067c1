//! `.ksplat`.

use super::{by_channel, rgba};
use gaussians::GaussianCloud;
use glam::Vec3;
use half::f16;

/// Splats of a bucket.
const BUCKET: usize = 32;
/// Sides of the block about a bucket's centre.
const BLOCK: f32 = 8.0;
const COEFFICIENT_RANGE: [f32; 2] = [-0.5, 0.5];

/// A file of two sections, at a level of compression from 0 to 2.
pub fn ksplat(cloud: &GaussianCloud, level: u16) -> Vec<u8> {
    let mut bytes = vec![0; 4096];
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
    put(0, &[0, 1]);
    put(4, &2u32.to_le_bytes());
    put(8, &2u32.to_le_bytes());
    put(12, &(cloud.len() as u32).to_le_bytes());
    put(16, &(cloud.len() as u32).to_le_bytes());
    put(20, &level.to_le_bytes());
    put(36, &COEFFICIENT_RANGE[0].to_le_bytes());
    put(40, &COEFFICIENT_RANGE[1].to_le_bytes());
    let half = cloud.len() / 2;
    let sections = [0..half, half..cloud.len()];
    let mut contents = Vec::new();
    for section in sections {
        let (full, rest) = (section.len() / BUCKET, section.len() % BUCKET);
        let buckets = full + usize::from(rest > 0);
        let mut header = vec![0; 1024];
        let mut put = |at: usize, value: &[u8]| header[at..at + value.len()].copy_from_slice(value);
        let numbers = [
            (0, section.len()),
            (4, section.len()),
            (8, BUCKET),
            (12, buckets),
            (32, full),
            (36, buckets - full),
        ];
        numbers.iter().for_each(|(at, number)| put(*at, &(*number as u32).to_le_bytes()));
        put(16, &BLOCK.to_le_bytes());
        put(20, &12u16.to_le_bytes());
        put(24, &(if level == 0 { 1u32 } else { 32767 }).to_le_bytes());
        put(40, &(cloud.degree() as u16).to_le_bytes());
        bytes.extend(header);
        if rest > 0 {
            contents.extend((rest as u32).to_le_bytes());
        }
        let splats: Vec<usize> = section.collect();
        let centers: Vec<Vec3> = splats.chunks(BUCKET).map(|bucket| cloud.splat(bucket[0]).mean).collect();
        contents.extend(centers.iter().flat_map(|center| center.to_array()).flat_map(f32::to_le_bytes));
        for (index, splat) in splats.iter().enumerate() {
            contents.extend(encode(cloud, *splat, centers[index / BUCKET], level));
        }
    }
    bytes.extend(contents);
    bytes
}

fn encode(cloud: &GaussianCloud, index: usize, center: Vec3, level: u16) -> Vec<u8> {
    let splat = cloud.splat(index);
    let q = splat.rotation;
    let numbers = splat.log_scale.exp().to_array().into_iter().chain([q.w, q.x, q.y, q.z]);
    let mut bytes = Vec::new();
    if level == 0 {
        bytes.extend(splat.mean.to_array().into_iter().chain(numbers).flat_map(f32::to_le_bytes));
    } else {
        let offset = (splat.mean - center) / (BLOCK / 2.0 / 32767.0) + 32767.0;
        bytes.extend(offset.to_array().into_iter().flat_map(|x| (x.round() as u16).to_le_bytes()));
        bytes.extend(numbers.flat_map(|x| f16::from_f32(x).to_le_bytes()));
    }
    bytes.extend(rgba(&splat));
    let by_channel = by_channel(cloud, index);
    let count = by_channel.len() / 3;
    let mut first = 0;
    for degree in 1..=cloud.degree() as usize {
        for channel in 0..3 {
            for order in 0..2 * degree + 1 {
                let x = by_channel[channel * count + first + order];
                match level {
                    0 => bytes.extend(x.to_le_bytes()),
                    1 => bytes.extend(f16::from_f32(x).to_le_bytes()),
                    _ => {
                        let [least, most] = COEFFICIENT_RANGE;
                        bytes.push(((x - least) / (most - least) * 255.0).round().clamp(0.0, 255.0) as u8);
                    }
                }
            }
        }
        first += 2 * degree + 1;
    }
    bytes
}
