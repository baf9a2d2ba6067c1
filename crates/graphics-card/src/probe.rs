//! Whether a card rounds as the processor does.
//!
//! Vulkan asks that sums and products of floats be the nearest ones, and leaves open what is done halfway between two. The splat places
//! nodes and resolves lines by such: a card that does otherwise would not sum the same bits.

use crate::{Bound, Commands, Gpu, Lost, Pass, bind_group_layout, constants, shader_module};
use wgpu::BufferUsages;

/// Threads of the pass.
const ALL_THREADS: usize = 1024;

/// Threads of a workgroup of it.
const THREADS: u32 = 64;

/// Floats are rounded to integers within this much of 0.
const LARGEST_ROUNDED: f32 = (1u32 << 29) as f32;

impl Gpu {
    /// Whether it adds, multiplies and rounds floats as the processor does, on a few thousand of them.
    pub(crate) fn rounds_alike(&self) -> Result<bool, Lost> {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let numbers = numbers();
        let input = self.buffer("numbers", numbers.len(), usage)?;
        let results = self.buffer("results", numbers.len(), usage)?;
        let zero = self.buffer("zero", 4, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?;
        self.write(&input, bytemuck::cast_slice(&numbers));
        self.write(&zero, &[0; 4]);
        let device = self.device();
        let source = [&constants!(THREADS, LARGEST_ROUNDED), include_str!("probe.wgsl")].join("\n");
        let layout = bind_group_layout(device, [(0, Bound::Read), (1, Bound::Write), (2, Bound::Uniform)]);
        let pass = Pass::new(&shader_module(device, "probe", source), &layout, "probe", &[]);
        let bound = self.bind(&layout, [(0, &input), (1, &results), (2, &zero)]);
        let mut work = Commands::new(self);
        work.dispatch(&pass, &bound, [ALL_THREADS as u32 / THREADS, 1]);
        work.submit();
        Ok(self.read(&results, 0..4 * numbers.len() as u64)? == expected(&numbers))
    }
}

/// What the processor makes of them.
fn expected(numbers: &[f32]) -> Vec<u32> {
    let of = |&[a, b, c]: &[f32; 3]| {
        let rounded = c.clamp(-LARGEST_ROUNDED, LARGEST_ROUNDED).round_ties_even() as i32;
        [(a * b + c).to_bits(), (a - b * c).to_bits(), rounded as u32]
    };
    numbers.as_chunks().0.iter().flat_map(of).collect()
}

/// Three for each thread: of many sizes and either sign; halves; and products and sums that lie halfway between two floats.
fn numbers() -> Vec<f32> {
    let random = |k: u32| {
        let mixed = (k ^ k >> 15).wrapping_mul(0x2C1B_3C6D);
        let mixed = (mixed ^ mixed >> 12).wrapping_mul(0x297A_2D39);
        mixed ^ mixed >> 15
    };
    let number = |k: u32| {
        let bits = random(3 * k + 1);
        match k % 7 {
            // Whole numbers and halves.
            0 => (bits % 4096) as f32 / 2.0 - 1024.0,
            // One of 24 bits, and one that makes its last count half.
            1 => (0x80_0001 + bits % 0x7F_FFFE) as f32,
            2 => 1.5,
            // From 2⁻¹⁵ to 2¹⁶.
            _ => f32::from_bits((112 + bits % 32) << 23 | bits >> 9 | (bits & 1) << 31),
        }
    };
    (0..3 * ALL_THREADS as u32).map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_roundings_are_told_from_the_processors() {
        let numbers = numbers();
        let expected = expected(&numbers);
        let with = |of: fn(&[f32; 3]) -> u32, at: usize| {
            let others = numbers.as_chunks().0.iter().map(of);
            others.zip(expected.chunks(3)).filter(|(other, expected)| *other != expected[at]).count()
        };
        let as_one = |[a, b, c]: &[f32; 3]| a.mul_add(*b, *c).to_bits();
        let toward_zero = |[a, b, c]: &[f32; 3]| {
            let cut = |x: f64| {
                let nearest = x as f32;
                let is_beyond = f64::from(nearest).abs() > x.abs();
                f32::from_bits(nearest.to_bits() - u32::from(is_beyond))
            };
            cut(f64::from(cut(f64::from(*a) * f64::from(*b))) + f64::from(*c)).to_bits()
        };
        let away_from_half = |[_, _, c]: &[f32; 3]| c.round() as i32 as u32;
        let found = [with(as_one, 0), with(toward_zero, 0), with(away_from_half, 2)];
        assert!(found.iter().all(|&count| count > 20), "{found:?}");
    }
}
