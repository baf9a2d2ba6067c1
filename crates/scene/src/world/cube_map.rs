//! An environment on the faces of a cube, and its conversion to an equirectangular map.

use super::EnvironmentMap;
use glam::{DQuat, DVec2, DVec3, Vec3};

/// Radiance from every direction, on the faces of a cube seen from its centre.
///
/// | face | looks toward | columns go toward | rows go toward |
/// | --- | --- | --- | --- |
/// | 0, 1 | +X, −X | +Z, −Z | −Y |
/// | 2, 3 | +Y, −Y | −X | +Z, −Z |
/// | 4, 5 | +Z, −Z | −X, +X | −Y |
///
/// Within a face radiance is bilinear between texel centres; beyond the outermost ones it is constant.
pub(crate) struct CubeMap {
    /// Columns and rows of a face.
    pub side: u32,
    /// Linear RGB radiance, row by row.
    pub faces: [Vec<[f32; 3]>; 6],
}

/// For each face: viewing direction, direction of its columns, direction of its rows.
const AXES: [[DVec3; 3]; 6] = [
    [DVec3::X, DVec3::Z, DVec3::NEG_Y],
    [DVec3::NEG_X, DVec3::NEG_Z, DVec3::NEG_Y],
    [DVec3::Y, DVec3::NEG_X, DVec3::Z],
    [DVec3::NEG_Y, DVec3::NEG_X, DVec3::NEG_Z],
    [DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y],
    [DVec3::NEG_Z, DVec3::X, DVec3::NEG_Y],
];

/// An equirectangular map is as wide as four faces, but no narrower than this, so that edges between small faces stay
/// sharp.
const MIN_WIDTH: u32 = 256;
/// And no wider than this: 4096 × 2048 texels are 100 MB.
const MAX_WIDTH: u32 = 4096;
/// Minimum number of samples per side of each of its texels.
const MIN_SAMPLES_PER_SIDE: u32 = 2;

impl CubeMap {
    /// Width of the equirectangular map of a cube of this side.
    fn equirectangular_width(side: u32) -> u32 {
        side.saturating_mul(4).clamp(MIN_WIDTH, MAX_WIDTH)
    }

    /// Samples per side of a texel of that map, such that every texel of the cube counts.
    fn samples_per_side(side: u32) -> u32 {
        MIN_SAMPLES_PER_SIDE * side.saturating_mul(4).div_ceil(Self::equirectangular_width(side)).max(1)
    }

    /// Number of texels of the equirectangular map of a cube of this side, and number of lookups to compute it.
    pub fn conversion_cost(side: u32) -> [u64; 2] {
        let width = u64::from(Self::equirectangular_width(side));
        let texels = width * width / 2;
        [texels, texels * u64::from(Self::samples_per_side(side)).pow(2)]
    }

    /// The radiance (linear RGB) from a direction of any length but 0, in the environment's axes.
    pub fn radiance(&self, direction: DVec3) -> Vec3 {
        let size = direction.abs();
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let face = 2 * axis + usize::from(direction[axis] < 0.0);
        let [forward, right, down] = AXES[face];
        let across = DVec2::new(direction.dot(right), direction.dot(down)) / direction.dot(forward);
        let last = f64::from(self.side) - 1.0;
        let at = ((across + 1.0) * (0.5 * f64::from(self.side)) - 0.5).clamp(DVec2::ZERO, DVec2::splat(last));
        let low = at.floor();
        let share = (at - low).as_vec2();
        let (x, y) = (low.x as usize, low.y as usize);
        let (side, next) = (self.side as usize, |k: usize| (k + 1).min(self.side as usize - 1));
        let texel = |x: usize, y: usize| Vec3::from_array(self.faces[face][y * side + x]);
        let row = |y: usize| texel(x, y).lerp(texel(next(x), y), share.x);
        row(y).lerp(row(next(y)), share.y)
    }

    /// The equirectangular map, rotated by `rotation` (unit): the radiance of direction d moves to `rotation` · d.
    pub fn to_equirectangular(&self, name: String, rotation: DQuat) -> EnvironmentMap {
        let width = Self::equirectangular_width(self.side);
        let mut map = EnvironmentMap { name, width, height: width / 2, texels: Vec::new() };
        let places = Self::samples_per_side(self.side);
        let unturned = rotation.conjugate();
        let mean = |x: u32, y: u32| {
            let mut sum = Vec3::ZERO;
            for k in 0..places * places {
                let inner = DVec2::new(f64::from(k % places), f64::from(k / places)) + 0.5;
                let at = DVec2::new(f64::from(x), f64::from(y)) + inner / f64::from(places);
                sum += self.radiance(unturned * map.direction_at(at));
            }
            (sum / (places * places) as f32).to_array()
        };
        let cells = (0..map.height).flat_map(|y| (0..width).map(move |x| (x, y)));
        map.texels = cells.map(|(x, y)| mean(x, y)).collect();
        map
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// The direction of every texel's centre, as its colour.
    fn directions(side: u32) -> CubeMap {
        let texel = |[forward, right, down]: [DVec3; 3], k: u32| {
            let place = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(side) - 1.0;
            let direction = forward + right * place(k % side) + down * place(k / side);
            direction.normalize().as_vec3().to_array()
        };
        CubeMap { side, faces: AXES.map(|axes| (0..side * side).map(|k| texel(axes, k)).collect()) }
    }

    #[test]
    fn faces_are_oriented_as_seen_from_inside() {
        for [forward, right, down] in AXES {
            // Whoever looks forward with down below has forward × up at the right.
            assert_eq!(forward.cross(-down), right);
        }
    }

    #[test]
    fn radiance_is_that_of_its_direction() {
        let cube = directions(64);
        let map = directions(64).to_equirectangular("directions".into(), DQuat::IDENTITY);
        assert_eq!((map.width, map.height), (256, 128));
        for k in 0..500 {
            let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / 500.0;
            let (sin, cos) = (f64::from(k) * 2.4).sin_cos();
            let direction = DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
            let off = (cube.radiance(direction).as_dvec3() - direction).length();
            assert!(off < 0.02, "{direction}: {off}");
            let off = (map.radiance(direction).as_dvec3() - direction).length();
            assert!(off < 0.03, "{direction} laid out: {off}");
        }
    }

    #[test]
    fn a_rotation_moves_the_radiance_with_it() {
        let turn = DQuat::from_rotation_y(FRAC_PI_2) * DQuat::from_rotation_x(0.3);
        let map = directions(64).to_equirectangular("turned".into(), turn);
        for from in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.5, 0.7, -0.2).normalize()] {
            let seen = map.radiance(turn * from).as_dvec3();
            assert!((seen - from).length() < 0.03, "{from}: {seen}");
        }
        // About +Y it is the world's own rotation: counter-clockwise seen from above.
        let quarter = DQuat::from_rotation_y(FRAC_PI_2);
        assert!((quarter * DVec3::Z - DVec3::X).length() < 1e-12);
    }

    #[test]
    fn large_cubes_are_averaged_and_small_ones_keep_their_edges() {
        assert_eq!([1, 64, 1024, 8192].map(CubeMap::equirectangular_width), [256, 256, 4096, 4096]);
        assert_eq!([1, 64, 1024, 8192].map(CubeMap::samples_per_side), [2, 2, 2, 16]);
        let colors: [[f32; 3]; 6] = std::array::from_fn(|k| [k as f32, 0.0, 0.0]);
        let cube = CubeMap { side: 1, faces: colors.map(|color| vec![color]) };
        let map = cube.to_equirectangular("six".into(), DQuat::IDENTITY);
        for (face, [forward, right, _]) in AXES.into_iter().enumerate() {
            assert_eq!(map.radiance(forward).x, face as f32);
            assert_eq!(map.radiance((forward + 0.9 * right).normalize()).x, face as f32);
        }
    }
}
