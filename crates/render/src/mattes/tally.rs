//! Counting and ranking the things that each pixel shows.

use project::RankedCoverage;
use rayon::prelude::*;

/// Shares up to this size may be left out of the mattes.
const NEGLIGIBLE: f32 = 1e-5;

/// Maximum number of ranks.
const MAX_RANKS: usize = 32;

/// A thing's share of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    pub column: u32,
    pub thing: u32,
    pub share: f32,
}

/// The things of each pixel, ranked by share.
pub(crate) struct Ranking {
    /// Entries of each row, by column and then by descending share.
    pub rows: Vec<Vec<Entry>>,
    /// Number of ranks needed.
    pub needed: usize,
    /// The largest share left out of a pixel; 0 if negligible.
    pub left_out: f32,
}

/// Accumulates the shares of things of one kind.
pub(crate) struct Tally {
    width: usize,
    /// Entries of each row, in any order.
    rows: Vec<Vec<Entry>>,
}

impl Tally {
    /// An empty tally of a picture of this width and height, px.
    pub fn new([width, height]: [u32; 2]) -> Self {
        Self { width: width as usize, rows: vec![Vec::new(); height as usize] }
    }

    /// Adds the shares of all pixels, row by row; `owner` is the thing of a column and row. Negative shares, from undershooting
    /// images, are ignored.
    pub fn add(&mut self, shares: impl Iterator<Item = f32>, owner: impl Fn(usize, usize) -> Option<u32>) {
        for (pixel, share) in shares.enumerate().filter(|(_, share)| *share > 0.0) {
            let (x, y) = (pixel % self.width, pixel / self.width);
            if let Some(thing) = owner(x, y) {
                self.rows[y].push(Entry { column: x as u32, thing, share });
            }
        }
    }

    /// The things of each pixel by rank, with shares scaled to sum to alpha (at least one rank), and the largest share left out of a
    /// pixel (0 if negligible).
    pub fn ranks(self, alpha: &[f32]) -> (Vec<Vec<RankedCoverage>>, f32) {
        let width = self.width;
        let Ranking { rows, needed, left_out } = self.ranking(alpha);
        (ranks_of(rows.iter().map(Vec::as_slice), width, needed.max(1)), left_out)
    }

    /// [`Self::ranks`] as lists of entries.
    pub fn ranking(self, alpha: &[f32]) -> Ranking {
        let width = self.width;
        // Entries of a pixel are adjacent, by descending share.
        let ranked = self.rows.into_par_iter().enumerate().map(|(y, mut row)| {
            row.sort_by(|a, b| {
                a.column.cmp(&b.column).then(b.share.total_cmp(&a.share)).then(a.thing.cmp(&b.thing))
            });
            let (mut needed, mut left_out) = (0, 0.0f32);
            for pixel in row.chunk_by_mut(|a, b| a.column == b.column) {
                let sum: f32 = pixel.iter().map(|entry| entry.share).sum();
                let scale = alpha[y * width + pixel[0].column as usize] / sum;
                let mut rest = 0.0;
                let mut needed_here = 0;
                for (rank, entry) in pixel.iter_mut().enumerate().rev() {
                    entry.share *= scale;
                    rest += entry.share;
                    if needed_here == 0 && rest > NEGLIGIBLE {
                        needed_here = rank + 1;
                    }
                }
                if needed_here > MAX_RANKS {
                    left_out = left_out.max(pixel[MAX_RANKS..].iter().map(|entry| entry.share).sum());
                }
                needed = needed.max(needed_here.min(MAX_RANKS));
            }
            (row, needed, left_out)
        });
        let rows: Vec<_> = ranked.collect();
        let needed = rows.iter().map(|(_, needed, _)| *needed).max().unwrap_or(0);
        let left_out = rows.iter().map(|(.., left_out)| *left_out).fold(0.0, f32::max);
        Ranking { rows: rows.into_iter().map(|(row, ..)| row).collect(), needed, left_out }
    }
}

/// Converts ranked entries of rows of `width` pixels to `count` ranks.
pub(crate) fn ranks_of<'a>(
    rows: impl ExactSizeIterator<Item = &'a [Entry]>,
    width: usize,
    count: usize,
) -> Vec<Vec<RankedCoverage>> {
    let mut ranks = vec![vec![RankedCoverage::NONE; width * rows.len()]; count];
    for (y, row) in rows.enumerate() {
        for pixel in row.chunk_by(|a, b| a.column == b.column) {
            for (entry, rank) in pixel.iter().zip(&mut ranks) {
                rank[y * width + entry.column as usize] =
                    RankedCoverage { name_index: Some(entry.thing), share: entry.share };
            }
        }
    }
    ranks
}

/// A warning if things were left out of the ranks.
pub(crate) fn left_out_warning(plural_name: &str, left_out: f32) -> Option<String> {
    (left_out > 0.0).then(|| {
        format!(
            "some pixels show more {plural_name} than Cryptomatte has ranks for: up to {:.2} % of a pixel is in no matte",
            100.0 * left_out
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_ranked_and_sum_to_alpha() {
        let mut tally = Tally::new([2, 1]);
        tally.add([0.2, 1.0].into_iter(), |_, _| Some(7));
        tally.add([0.61, -0.1].into_iter(), |_, _| Some(3));
        tally.add([0.2, 1e-7].into_iter(), |_, _| Some(5));
        tally.add([0.5, 0.5].into_iter(), |_, _| None);
        let (ranks, left_out) = tally.ranks(&[1.0, 0.75]);
        let of = |pixel: usize| {
            ranks.iter().map(|rank| (rank[pixel].name_index, rank[pixel].share)).collect::<Vec<_>>()
        };
        assert_eq!((ranks.len(), left_out), (3, 0.0));
        assert_eq!(of(0).iter().map(|(thing, _)| *thing).collect::<Vec<_>>(), [Some(3), Some(5), Some(7)]);
        assert!((of(0).iter().map(|(_, share)| share).sum::<f32>() - 1.0).abs() < 1e-6);
        assert_eq!(of(1)[0].0, Some(7));
        assert!((of(1)[0].1 - 0.75).abs() < 1e-6, "{:?}", of(1));
    }

    #[test]
    fn what_shows_nothing_has_a_rank_of_nothing() {
        assert_eq!(Tally::new([3, 2]).ranks(&[0.0; 6]), (vec![vec![RankedCoverage::NONE; 6]], 0.0));
    }

    #[test]
    fn what_has_no_rank_is_told() {
        let mut tally = Tally::new([1, 1]);
        (0..40).for_each(|thing| tally.add([0.025].into_iter(), |_, _| Some(thing)));
        let (ranks, left_out) = tally.ranks(&[1.0]);
        assert_eq!(ranks.len(), MAX_RANKS);
        assert!((left_out - 0.2).abs() < 1e-5, "{left_out}");
    }
}
