//! Single pixels that belong to no surface: replaced by their surroundings.

use numerics::upper_median;

/// The least number of the eight neighbours of the same surface: even a line one pixel wide has two.
const MIN_COMPANIONS: usize = 2;

/// Replaces every disparity that fewer than two neighbours share to within `same` by the median of its neighbours.
pub fn remove_specks(disparity: &[f32], width: usize, same: f32) -> Vec<f32> {
    let height = disparity.len() / width;
    let mut cleaned = disparity.to_vec();
    for y in 0..height {
        for x in 0..width {
            let own = disparity[y * width + x];
            let rows = y.saturating_sub(1)..(y + 2).min(height);
            let columns = x.saturating_sub(1)..(x + 2).min(width);
            let around = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
            let mut values = [0.0; 8];
            let mut count = 0;
            for (column, row) in around.filter(|place| *place != (x, y)) {
                values[count] = disparity[row * width + column];
                count += 1;
            }
            let values = &mut values[..count];
            if values.iter().filter(|value| (**value - own).abs() <= same).count() < MIN_COMPANIONS {
                cleaned[y * width + x] = upper_median(values).unwrap_or(own);
            }
        }
    }
    cleaned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speck_is_removed_and_a_line_stays() {
        let (width, height) = (9, 7);
        let line: Vec<f32> = (0..width * height).map(|i| if i % width == 6 { 2.0 } else { 0.0 }).collect();
        assert_eq!(remove_specks(&line, width, 0.1)[10..50], line[10..50]);
        let mut speck = line.clone();
        speck[3 * width + 3] = -5.0;
        assert_eq!(remove_specks(&speck, width, 0.1)[10..50], line[10..50]);
    }
}
