//! How far down an atlas is filled, column by column, and where an outline comes to rest in it.

use crate::packing::chart_outline::ChartOutline;

/// How far down each column is filled.
pub(crate) struct Skyline {
    rows: Vec<u32>,
    /// Columns up to the last one used.
    pub width_used: u32,
    /// Rows up to the last one used.
    pub height: u32,
}

impl Skyline {
    /// An empty atlas that is `width` texels wide.
    pub fn new(width: u32) -> Self {
        Self { rows: vec![0; width as usize], width_used: 1, height: 1 }
    }

    /// Column, row and index of the outline that ends highest up; among equals the one with the smallest gap.
    pub fn best_position(&self, outlines: &[ChartOutline]) -> Option<(u32, u32, usize)> {
        let mut best = None;
        let mut best_score = (u32::MAX, u64::MAX);
        for (turn, outline) in outlines.iter().enumerate() {
            let Some(last) = self.rows.len().checked_sub(outline.columns.len()) else { continue };
            // A wide chart gains nothing from trying every column.
            let step = (outline.columns.len() / 16).max(1);
            for x in (0..=last).step_by(step) {
                let limit = best_score.0.saturating_sub(outline.height);
                let Some((y, gap)) = self.resting_height(outline, x, limit) else { continue };
                let score = (y + outline.height, gap);
                if score < best_score {
                    best_score = score;
                    best = Some((x as u32, y, turn));
                }
            }
        }
        best
    }

    /// The row at which an outline comes to rest and the gap under it, if the row is at most `limit`.
    fn resting_height(&self, outline: &ChartOutline, x: usize, limit: u32) -> Option<(u32, u64)> {
        let mut y = 0;
        let rows = &self.rows[x..x + outline.columns.len()];
        for (&filled, &(low, high)) in rows.iter().zip(&outline.columns) {
            if low < high {
                y = y.max(filled.saturating_sub(low));
                if y > limit {
                    return None;
                }
            }
        }
        let gap = |(&filled, &(low, high)): (&u32, &(u32, u32))| {
            if low < high { u64::from(y + low - filled) } else { 0 }
        };
        Some((y, rows.iter().zip(&outline.columns).map(gap).sum()))
    }

    /// Fills the area under an outline whose upper left texel is in column `x` and row `y`.
    pub fn place(&mut self, outline: &ChartOutline, x: u32, y: u32) {
        for (filled, &(low, high)) in self.rows[x as usize..].iter_mut().zip(&outline.columns) {
            if low < high {
                *filled = (*filled).max(y + high);
            }
        }
        self.width_used = self.width_used.max(x + outline.width());
        self.height = self.height.max(y + outline.height);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_rests_on_what_is_there() {
        let mut skyline = Skyline::new(4);
        let low = ChartOutline { columns: vec![(0, 1); 2], height: 1 };
        let hook = ChartOutline { columns: vec![(2, 3), (2, 3), (0, 3)], height: 3 };
        skyline.place(&low, 0, 0);
        // Its arm reaches over the low one, its leg goes down beside it.
        assert_eq!(skyline.best_position(std::slice::from_ref(&hook)), Some((0, 0, 0)));
        skyline.place(&hook, 0, 0);
        assert_eq!((skyline.width_used, skyline.height), (3, 3));
        assert_eq!(skyline.best_position(&[low]), Some((0, 3, 0)));
        assert_eq!(skyline.best_position(&[ChartOutline { columns: vec![(0, 1); 5], height: 1 }]), None);
    }
}
