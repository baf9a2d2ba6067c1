//! A section of a `.ksplat`.

use super::super::bytes::{Bytes, f32_at, u16_at, u32_at};
use super::super::quaternion::from_wxyz;
use super::header::{Header, Level};
use crate::cloud::Splat;
use crate::cloud::harmonics::coefficient_count;
use glam::Vec3;
use half::f16;

/// The highest degree that the format has a number for.
const MAX_DEGREE: u32 = 3;

/// Splats that are packed alike.
pub(super) struct Section<'a> {
    level: Level,
    coefficient_range: [f32; 2],
    count: u64,
    degree: u32,
    /// Bytes of a splat.
    each: usize,
    splats: &'a [u8],
    /// The bucket's centre of each splat, at level 1 and 2.
    buckets: Buckets<'a>,
    /// Zero of the 16 bits of a mean, and their unit.
    mean_zero: f32,
    mean_unit: f32,
}

/// Centres that means are relative to.
struct Buckets<'a> {
    centers: &'a [u8],
    /// The first splat of each bucket.
    starts: Vec<u64>,
}

impl<'a> Section<'a> {
    /// Bytes of a splat of degree 0.
    pub fn least_bytes_each(level: Level) -> u64 {
        match level {
            Level::Floats => 44,
            Level::Halves | Level::Bytes => 24,
        }
    }

    /// The section of a header of 1,024 bytes, whose data are next in `rest`; `None` if they are not there or contradict themselves.
    pub fn new(header: &Header, section: &[u8], rest: &mut Bytes<'a>) -> Option<Self> {
        let number = |at: usize| u64::from(u32_at(section, at));
        let [count, max_count, capacity, buckets] = [0, 4, 8, 12].map(number);
        let block_size = f32_at(section, 16);
        let bytes_per_bucket = u64::from(u16_at(section, 20));
        let [full, partial] = [32, 36].map(number);
        let degree = u32::from(u16_at(section, 40));
        if degree > MAX_DEGREE || count > max_count || full + partial > buckets {
            return None;
        }
        let mean_zero = match u32_at(section, 24) {
            0 if header.level == Level::Floats => 1,
            0 => 32767,
            zero => zero,
        };
        let coefficient_bytes = match header.level {
            Level::Floats => 4,
            Level::Halves => 2,
            Level::Bytes => 1,
        };
        let each =
            Self::least_bytes_each(header.level) + 3 * coefficient_count(degree) as u64 * coefficient_bytes;
        let partial_lengths = rest.take(partial * 4)?;
        let centers = rest.take(buckets.checked_mul(bytes_per_bucket)?)?;
        let splats = rest.take(max_count.checked_mul(each)?)?;
        let buckets = match header.level {
            Level::Floats => Buckets { centers: &[], starts: Vec::new() },
            _ if bytes_per_bucket != 12 => return None,
            _ => Buckets::new(centers, partial_lengths, full, capacity, count)?,
        };
        Some(Self {
            level: header.level,
            coefficient_range: header.coefficient_range,
            count,
            degree,
            each: each as usize,
            splats,
            buckets,
            mean_zero: mean_zero as f32,
            mean_unit: block_size / 2.0 / mean_zero as f32,
        })
    }

    pub fn count(&self) -> u64 {
        self.count
    }

    pub fn degree(&self) -> u32 {
        self.degree
    }

    /// A splat; its coefficients beyond degree 0 go to the beginning of `coefficients`.
    pub fn decode(&self, index: usize, coefficients: &mut [f32]) -> Splat {
        let row = &self.splats[index * self.each..(index + 1) * self.each];
        let float = |at: usize| f32_at(row, at);
        let half = |at: usize| f16::from_bits(u16_at(row, at)).to_f32();
        let three = |at: usize, size: usize, number: &dyn Fn(usize) -> f32| {
            Vec3::new(number(at), number(at + size), number(at + 2 * size))
        };
        let (mean, scale, rotation, color_at) = match self.level {
            Level::Floats => (three(0, 4, &float), three(12, 4, &float), [24, 28, 32, 36].map(float), 40),
            Level::Halves | Level::Bytes => {
                let offset = three(0, 2, &|at| f32::from(u16_at(row, at)));
                let mean = (offset - self.mean_zero) * self.mean_unit + self.buckets.center(index);
                (mean, three(6, 2, &half), [12, 14, 16, 18].map(half), 20)
            }
        };
        self.decode_coefficients(&row[color_at + 4..], coefficients);
        let unit = |channel: usize| f32::from(row[color_at + channel]) / 255.0;
        Splat {
            mean,
            rotation: from_wxyz(rotation.map(f64::from)),
            log_scale: scale.map(f32::ln),
            opacity: unit(3),
            base_color: Vec3::new(unit(0), unit(1), unit(2)).map(Splat::base_of_color),
        }
    }

    /// Coefficients as they are in the file: of each degree all of red, then green, then blue.
    fn decode_coefficients(&self, bytes: &[u8], coefficients: &mut [f32]) {
        let [least, most] = self.coefficient_range;
        let number = |index: usize| match self.level {
            Level::Floats => f32_at(bytes, 4 * index),
            Level::Halves => f16::from_bits(u16_at(bytes, 2 * index)).to_f32(),
            Level::Bytes => least + (most - least) * f32::from(bytes[index]) / 255.0,
        };
        let mut at = 0;
        for degree in 1..=self.degree {
            let (first, orders) = (coefficient_count(degree - 1), 2 * degree as usize + 1);
            for channel in 0..3 {
                for order in 0..orders {
                    coefficients[3 * (first + order) + channel] = number(at);
                    at += 1;
                }
            }
        }
    }
}

impl<'a> Buckets<'a> {
    /// Buckets for `count` splats: `full` ones of `capacity`, then those whose lengths are given; `None` if they have no room for all.
    fn new(centers: &'a [u8], lengths: &[u8], full: u64, capacity: u64, count: u64) -> Option<Self> {
        let mut starts: Vec<u64> = Vec::new();
        let mut next = 0u64;
        let lengths = lengths.chunks_exact(4).map(|bytes| u64::from(u32_at(bytes, 0)));
        // There are centres for all of them, so that their number is one that the file justifies.
        for length in std::iter::repeat_n(capacity, full as usize).chain(lengths) {
            starts.push(next);
            next = next.checked_add(length)?;
        }
        (next >= count).then_some(Self { centers, starts })
    }

    fn center(&self, splat: usize) -> Vec3 {
        let bucket = self.starts.partition_point(|start| *start <= splat as u64).saturating_sub(1);
        let at = |axis: usize| f32_at(self.centers, 12 * bucket + 4 * axis);
        Vec3::new(at(0), at(1), at(2))
    }
}
