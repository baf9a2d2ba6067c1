//! The order of splats along Morton's curve: splats that are near in space are near in it.

use super::gaussian_cloud::GaussianCloud;
use glam::Vec3;
use rayon::prelude::*;

/// Binary digits of a place along each axis.
const DIGITS: u32 = 21;

impl GaussianCloud {
    /// The indices of all splats along Morton's curve through the box of their means; of those at one place in the order of the file. It does not depend
    /// on where the cloud stands.
    pub fn morton_order(&self) -> Vec<u32> {
        let means = self.means();
        let (low, high) = means.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), mean| {
            (low.min(*mean), high.max(*mean))
        });
        let side = (high.as_dvec3() - low.as_dvec3()).max_element();
        let scale = if side > 0.0 { f64::from((1u32 << DIGITS) - 1) / side } else { 0.0 };
        let code = |index: u32| {
            let place = (means[index as usize].as_dvec3() - low.as_dvec3()) * scale;
            // Within [0, 2²¹).
            let [x, y, z] = place.to_array().map(|p| spread(p as u64));
            x | y << 1 | z << 2
        };
        let mut order: Vec<(u64, u32)> =
            (0..means.len() as u32).into_par_iter().map(|index| (code(index), index)).collect();
        order.par_sort_unstable();
        order.into_iter().map(|(_, index)| index).collect()
    }
}

/// The digits of a number of 21 digits, two zeros between each and the next.
fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{CloudBuilder, CloudTraits, Splat};
    use glam::Quat;

    #[test]
    fn digits_are_spread() {
        for x in [0u64, 1, 0b1011, 0x1f_ffff, 0x15_5555] {
            let expected = (0..21).map(|k| (x >> k & 1) << (3 * k)).sum::<u64>();
            assert_eq!(spread(x), expected);
        }
    }

    #[test]
    fn octants_follow_each_other() {
        let mut builder = CloudBuilder::new(0, 8);
        let corner = |k: u32| Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32);
        let files_order = [5, 0, 7, 2, 1, 6, 3, 4];
        for k in files_order {
            builder.push(
                Splat {
                    mean: corner(k),
                    rotation: Quat::IDENTITY,
                    log_scale: Vec3::ZERO,
                    opacity: 1.0,
                    base_color: Vec3::ZERO,
                },
                &[],
            );
        }
        let order = builder.finish(CloudTraits::default()).morton_order();
        let corners: Vec<u32> = order.iter().map(|index| files_order[*index as usize]).collect();
        assert_eq!(corners, [0, 1, 2, 3, 4, 5, 6, 7]);
    }
}
