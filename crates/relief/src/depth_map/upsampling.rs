//! Coarse depth maps at the size of their picture, guided by its colours.
//!
//! Among four numbers of the map those count most where the picture has the pixel's colour (Kopf et al., *Joint bilateral upsampling*,
//! 2007), so that edges of depth lie on edges of the picture and not on the map's pixels.

use rayon::prelude::*;

/// Difference of colours (square roots of light) with a weight of e⁻¹.
const COLOR: f32 = 0.08;

/// The map at the size of its picture (linear RGB). NaNs do not count; where all four numbers are NaN, so is the
/// result.
pub fn upsample(
    [columns, rows]: [usize; 2],
    values: &[f32],
    [width, height]: [usize; 2],
    picture: &[[f32; 3]],
) -> Vec<f32> {
    if [columns, rows] == [width, height] {
        return values.to_vec();
    }
    let scale = [columns as f32 / width as f32, rows as f32 / height as f32];
    let root = |color: [f32; 3]| color.map(|c| c.max(0.0).sqrt());
    // The picture's colour at the centre of each number of the map.
    let guide: Vec<[f32; 3]> = (0..columns * rows)
        .into_par_iter()
        .map(|place| {
            let x = ((place % columns) as f32 + 0.5) / scale[0];
            let y = ((place / columns) as f32 + 0.5) / scale[1];
            root(picture[(y as usize).min(height - 1) * width + (x as usize).min(width - 1)])
        })
        .collect();
    (0..width * height)
        .into_par_iter()
        .map(|cell| {
            let place = [
                ((cell % width) as f32 + 0.5) * scale[0] - 0.5,
                ((cell / width) as f32 + 0.5) * scale[1] - 0.5,
            ];
            let [left, above] = place.map(f32::floor);
            let [right, below] = [place[0] - left, place[1] - above];
            let own = root(picture[cell]);
            let (mut sum, mut weights) = (0.0, 0.0);
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let x = (left as isize + dx).clamp(0, columns as isize - 1) as usize;
                let y = (above as isize + dy).clamp(0, rows as isize - 1) as usize;
                let value = values[y * columns + x];
                if value.is_nan() {
                    continue;
                }
                let far: f32 = (0..3).map(|c| (guide[y * columns + x][c] - own[c]).powi(2)).sum();
                let across = if dx == 0 { 1.0 - right } else { right };
                let down = if dy == 0 { 1.0 - below } else { below };
                // The nearest numbers have a minimum weight in any colour.
                let weight = (across * down).max(1e-3) * (-far / (COLOR * COLOR)).exp().max(1e-6);
                sum += value * weight;
                weights += weight;
            }
            sum / weights
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_lie_where_the_picture_has_them() {
        // Four times as fine; the picture's edge is at column 10, the map's at its nearest.
        let picture: Vec<[f32; 3]> =
            (0..16 * 4).map(|cell| [if cell % 16 < 10 { 0.1 } else { 0.8 }; 3]).collect();
        let map = [0.0, 0.0, 1.0, 1.0];
        let fine = upsample([4, 1], &map, [16, 4], &picture);
        for (x, value) in fine.iter().enumerate().take(16) {
            assert!((value - f32::from(u8::from(x >= 10))).abs() < 0.05 || x == 9, "{x}: {value}");
        }
        let unknown = upsample([2, 1], &[f32::NAN, 3.0], [8, 1], &[[0.5; 3]; 8]);
        assert!(unknown[0].is_nan() && (unknown[7] - 3.0).abs() < 1e-5, "{unknown:?}");
        assert_eq!(upsample([2, 1], &[1.0, 2.0], [2, 1], &[[0.0; 3]; 2]), [1.0, 2.0]);
    }
}
