//! Work in parallel of which a fair sample is done at any time.

use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Maps `rows` by `work` in parallel, and reports the share that is done. The results are in order; the work is not: at any time, what is
/// done is a fair sample of all, so that it tells how long the rest will take.
///
/// # Errors
/// [`Cancelled`] if `progress` asks to stop.
pub fn map_rows<T: Sync, R: Send>(
    rows: &[T],
    progress: &dyn Progress,
    work: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, Cancelled> {
    let done = AtomicUsize::new(0);
    let mapped: Result<Vec<(usize, R)>, Cancelled> = spread_order(rows.len())
        .into_par_iter()
        .map(|index| {
            progress.check()?;
            let result = work(&rows[index]);
            progress.check()?;
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / rows.len() as f32);
            Ok((index, result))
        })
        .collect();
    let mut mapped = mapped?;
    mapped.sort_unstable_by_key(|(index, _)| *index);
    Ok(mapped.into_iter().map(|(_, result)| result).collect())
}

/// The numbers below `count`, every run of them spread evenly: steps of the golden section.
fn spread_order(count: usize) -> Vec<usize> {
    let golden = (count as f64 / std::f64::consts::GOLDEN_RATIO).round() as usize;
    let step = (golden.max(1)..).find(|&step| gcd(step, count) == 1).unwrap_or(1);
    (0..count).map(|k| k * step % count).collect()
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_spread_and_results_are_in_order() {
        let rows: Vec<u32> = (0..997).collect();
        let doubled = map_rows(&rows, &progress::Unwatched, |row| 2 * row).unwrap();
        assert!(doubled.into_iter().eq((0..997).map(|row| 2 * row)));
        for count in [0, 1, 2, 3, 10, 4034] {
            let mut order = spread_order(count);
            // The first quarter is a sample of all: about as many below the middle as above.
            let low = order[..count / 4].iter().filter(|&&index| index < count / 2).count();
            assert!((2 * low).abs_diff(count / 4) <= 4, "{count}: {low}");
            order.sort_unstable();
            assert!(order.into_iter().eq(0..count));
        }
    }
}
