//! How views that are numbered row by row are laid out, where no file says so.

/// The most columns or rows; Stanford's have 17, gantries some more.
pub(super) const MAX_SIDE: u32 = 128;

/// A grid and the number of its first view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NumberedGrid {
    pub columns: u32,
    pub rows: u32,
    pub first: u32,
}

impl NumberedGrid {
    /// The grid of stated size: its first view is number 0, or 1 if there is a last number that only fits then.
    pub fn stated([columns, rows]: [u32; 2], numbers: &[u32]) -> Self {
        let counts_from_one = !numbers.contains(&0) && numbers.contains(&(columns * rows));
        Self { columns, rows, first: u32::from(counts_from_one) }
    }

    /// The only plausible grid of views with these numbers, in ascending order; otherwise what makes them ambiguous.
    ///
    /// A square, if their first and last number are its first and last, counted from 0 or 1 (or from anywhere if there is no gap), or if
    /// they are its middle row or another set that is symmetric to its centre, such as a cross, or if they fill half of it up to its
    /// last number. A single row, if their count is prime.
    ///
    /// # Errors
    /// What makes the numbers ambiguous, as text.
    pub fn inferred(numbers: &[u32]) -> Result<Self, String> {
        let [low, .., high] = *numbers else { return Err("there are fewer than two".into()) };
        let (low_wide, high_wide, views) = (u64::from(low), u64::from(high), numbers.len() as u64);
        let max_side = u64::from(MAX_SIDE);
        let square = |count: u64, first: u32| {
            let side = count.isqrt();
            ((2..=max_side).contains(&side) && side * side == count).then_some(Self {
                columns: side as u32,
                rows: side as u32,
                first,
            })
        };
        let has_no_gap = high_wide - low_wide + 1 == views;
        let mirrored = || numbers.iter().rev().map(|number| low_wide + high_wide - u64::from(*number));
        let is_symmetric = || numbers.iter().copied().map(u64::from).eq(mirrored());
        // A run of numbers is symmetric to anything; only a whole row means something.
        let is_row_or_cross = |grid: &Self| match has_no_gap {
            true => views == u64::from(grid.columns) && views % 2 == 1,
            false => is_symmetric(),
        };
        let is_half_full = |grid: &Self| 2 * views >= u64::from(grid.columns * grid.rows);
        let found = match low {
            0 => square(high_wide + 1, 0),
            1 => square(high_wide, 1).or_else(|| square(high_wide + 2, 0).filter(is_row_or_cross)),
            _ => square(low_wide + high_wide + 1, 0)
                .or_else(|| square(low_wide + high_wide - 1, 1))
                .filter(is_row_or_cross)
                .or_else(|| square(views, low).filter(|_| has_no_gap))
                .or_else(|| square(high_wide + 1, 0).filter(is_half_full))
                .or_else(|| square(high_wide, 1).filter(is_half_full)),
        };
        if let Some(grid) = found {
            return Ok(grid);
        }
        let first = if has_no_gap { low } else { low.min(1) };
        let count = high_wide - u64::from(first) + 1;
        if count > max_side * max_side {
            return Err(format!("{count} are more than a light field has"));
        }
        let divisors: Vec<u64> = (1..=count).filter(|divisor| count.is_multiple_of(*divisor)).collect();
        if 2 * views < count {
            return Err("too few of them to tell the grid".into());
        }
        if divisors.len() == 2 && count <= max_side {
            return Ok(Self { columns: count as u32, rows: 1, first });
        }
        let inner = divisors.iter().rev().filter(|columns| **columns > 1 && **columns < count);
        let mut grids: Vec<String> =
            inner.map(|columns| format!("{columns} × {}", count / columns)).collect();
        grids
            .extend(square(count + 1, 0).map(|grid| format!("{} × {} without one", grid.columns, grid.rows)));
        Err(format!("they could be {} or one row", grids.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(numbers: impl IntoIterator<Item = u32>) -> Option<(u32, u32, u32)> {
        let numbers: Vec<u32> = numbers.into_iter().collect();
        NumberedGrid::inferred(&numbers).ok().map(|grid| (grid.columns, grid.rows, grid.first))
    }

    #[test]
    fn squares() {
        for side in 2..18 {
            assert_eq!(grid(0..side * side), Some((side, side, 0)));
            assert_eq!(grid(1..=side * side), Some((side, side, 1)));
            let cross = |k: u32| k / side == side / 2 || k % side == side / 2;
            if side % 2 == 1 {
                assert_eq!(grid((0..side * side).filter(|k| cross(*k))), Some((side, side, 0)), "{side}");
                let ones = (0..side * side).filter(|k| cross(*k)).map(|k| k + 1);
                assert_eq!(grid(ones), Some((side, side, 1)), "{side}");
                let middle_row = side * (side / 2)..side * (side / 2 + 1);
                assert_eq!(grid(middle_row.clone()), Some((side, side, 0)), "{side}");
                assert_eq!(grid(middle_row.map(|k| k + 1)), Some((side, side, 1)), "{side}");
            }
        }
        assert_eq!(grid(100..125), Some((5, 5, 100)));
    }

    #[test]
    fn gaps() {
        for missing in 1..24 {
            assert_eq!(grid((0..25).filter(|k| *k != missing)), Some((5, 5, 0)), "{missing}");
            assert_eq!(grid((1..26).filter(|k| *k != missing + 1)), Some((5, 5, 1)), "{missing}");
        }
        // The first two are missing.
        assert_eq!((grid(2..25), grid(3..26)), (Some((5, 5, 0)), Some((5, 5, 1))));
        // The last or the first is missing, or none.
        assert_eq!((grid(0..24), grid(1..25)), (None, None));
        assert_eq!(grid([0, 1, 2, 4, 5, 6]), Some((7, 1, 0)));
    }

    #[test]
    fn what_is_ambiguous_is_not_guessed() {
        assert_eq!(grid(0..2), Some((2, 1, 0)));
        assert_eq!(grid(0..13), Some((13, 1, 0)));
        for count in [6, 8, 12, 15, 24, 26, 35, 80] {
            assert_eq!(grid(0..count), None, "{count}");
        }
        let numbers: Vec<u32> = (0..15).collect();
        let why = |numbers: &[u32]| NumberedGrid::inferred(numbers).unwrap_err();
        assert_eq!(why(&numbers), "they could be 5 × 3, 3 × 5, 4 × 4 without one or one row");
        assert_eq!(why(&[37, 38, 39, 45]), "too few of them to tell the grid");
        assert!(
            why(&[0, 1, u32::MAX - 1]).contains("more than a light field has"),
            "{}",
            why(&[0, 1, u32::MAX - 1])
        );
    }

    #[test]
    fn a_stated_grid_may_count_from_one() {
        let stated = |numbers: &[u32]| NumberedGrid::stated([3, 2], numbers).first;
        assert_eq!(stated(&[0, 1, 2, 3, 4, 5]), 0);
        assert_eq!(stated(&[1, 2, 3, 4, 5, 6]), 1);
        assert_eq!(stated(&[1, 2, 5]), 0);
        assert_eq!(stated(&[0, 6]), 0);
    }
}
