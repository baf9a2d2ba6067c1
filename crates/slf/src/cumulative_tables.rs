//! Discrete distributions, sampled by inverting their cumulative sums in constant expected time.
//!
//! An index into the sums, a power of two of even buckets, tells between which of them a uniform number lies (Chen and
//! Asau 1974, the method of guide tables). Unlike Walker's aliases, the inversion is monotonic, so numbers that are spread
//! evenly are spread evenly over what is chosen.

/// Distributions over equally many items each.
#[derive(Debug)]
pub(crate) struct CumulativeTables {
    items: usize,
    /// Cumulative probabilities of each distribution; each starts with 0 and ends with 1.
    sums: Vec<f64>,
    buckets: usize,
    /// By distribution and bucket: how many sums are at most the bucket's lower end; and, at the end, all of them.
    guides: Vec<u32>,
}

/// Items to a bucket of the index, at least.
const ITEMS_PER_BUCKET: usize = 2;

impl CumulativeTables {
    /// One distribution for each `items` weights in turn, in proportion to them; even if all are 0. There must be at least
    /// one item.
    pub fn new(items: usize, weights: &[f64]) -> Self {
        assert!(items > 0 && weights.len().is_multiple_of(items), "whole distributions of at least one item");
        let buckets = (items / ITEMS_PER_BUCKET).max(1).next_power_of_two();
        let (mut sums, mut guides) = (Vec::new(), Vec::new());
        for weights in weights.chunks_exact(items) {
            let first = sums.len();
            push_cumulative_shares(&mut sums, weights);
            let sums = &sums[first..];
            let mut at = 0;
            for bucket in 0..buckets {
                // Exact, since their number is a power of two.
                let low = bucket as f64 / buckets as f64;
                at += sums[at..].iter().take_while(|&&sum| sum <= low).count();
                guides.push(at as u32);
            }
            guides.push(sums.len() as u32);
        }
        Self { items, sums, buckets, guides }
    }

    /// The item of a distribution whose interval of cumulative probability contains `u`, uniform in [0, 1), and the relative
    /// position within it.
    pub fn invert(&self, distribution: usize, u: f64) -> (usize, f64) {
        let guides = &self.guides[distribution * (self.buckets + 1)..][..self.buckets + 1];
        let bucket = ((u * self.buckets as f64) as usize).min(self.buckets - 1);
        let (first, last) = (guides[bucket] as usize, guides[bucket + 1] as usize);
        let sums = self.sums_of(distribution);
        let end = first + sums[first..last].partition_point(|&sum| sum <= u);
        let item = end.clamp(1, self.items) - 1;
        let (from, to) = (sums[item], sums[item + 1]);
        (item, if to > from { ((u - from) / (to - from)).clamp(0.0, 1.0) } else { 0.5 })
    }

    /// The probability of an item.
    pub fn probability(&self, distribution: usize, item: usize) -> f64 {
        let sums = self.sums_of(distribution);
        sums[item + 1] - sums[item]
    }

    fn sums_of(&self, distribution: usize) -> &[f64] {
        let ends = self.items + 1;
        &self.sums[distribution * ends..][..ends]
    }
}

/// Appends cumulative sums of weights, scaled to end at 1, after a 0. Even steps if all weights are 0.
fn push_cumulative_shares(sums: &mut Vec<f64>, weights: &[f64]) {
    let sum: f64 = weights.iter().sum();
    let total = if sum > 0.0 { sum } else { weights.len() as f64 };
    let mut sum_so_far = 0.0;
    sums.push(0.0);
    for weight in weights {
        sum_so_far += if sum > 0.0 { *weight } else { 1.0 };
        sums.push((sum_so_far / total).min(1.0));
    }
    *sums.last_mut().expect("just pushed") = 1.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bisection of all sums.
    fn bisect(tables: &CumulativeTables, distribution: usize, u: f64) -> usize {
        let sums = tables.sums_of(distribution);
        sums.partition_point(|&sum| sum <= u).clamp(1, tables.items) - 1
    }

    #[test]
    fn the_index_finds_what_bisection_finds() {
        for items in [1, 2, 3, 17, 64, 1000] {
            let even = vec![1.0; items];
            let dark = vec![0.0; items];
            let peak: Vec<f64> = (0..items).map(|k| if k == items / 2 { 1e9 } else { 1e-3 }).collect();
            let sparse: Vec<f64> =
                (0..items).map(|k| f64::from(u8::from(k % 5 == 1 || items == 1))).collect();
            let tables = CumulativeTables::new(items, &[even, dark, peak, sparse].concat());
            for distribution in 0..4 {
                let at_sums = tables.sums_of(distribution).iter().flat_map(|&sum| [sum.next_down(), sum]);
                let between = (0..5000).map(|k| f64::from(k) / 5000.0);
                for u in at_sums.chain(between).map(|u| u.clamp(0.0, 1.0f64.next_down())) {
                    let (item, within) = tables.invert(distribution, u);
                    assert_eq!(item, bisect(&tables, distribution, u), "{items} items, {u}");
                    assert!((0.0..=1.0).contains(&within));
                }
            }
        }
    }

    #[test]
    fn probabilities_are_those_of_the_weights() {
        let tables = CumulativeTables::new(4, &[1.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        let of = |distribution| (0..4).map(|item| tables.probability(distribution, item)).collect::<Vec<_>>();
        assert_eq!((of(0), of(1)), (vec![0.25, 0.0, 0.5, 0.25], vec![0.25; 4]));
        assert_eq!(tables.invert(0, 0.5), (2, 0.5));
    }
}
