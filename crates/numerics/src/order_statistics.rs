//! Medians and quantiles.
//!
//! The total order puts positive NaN above all numbers. A few NaN among many values therefore shift a median, but do
//! not turn it into NaN; callers for whom a single NaN is an error have to look for it themselves.

use crate::real::Real;

/// The value of rank `rank` in ascending order, 0 the smallest; `None` if there are not so many values.
///
/// Takes linear time. The values end up in another order.
pub fn order_statistic<T: Real>(values: &mut [T], rank: usize) -> Option<T> {
    (rank < values.len()).then(|| *values.select_nth_unstable_by(rank, T::total_order).1)
}

/// The median: the middle value, of an even number the upper of the two in the middle (rank ⌊n/2⌋); `None` of none.
///
/// It is always one of the values. Takes linear time; the values end up in another order.
pub fn upper_median<T: Real>(values: &mut [T]) -> Option<T> {
    order_statistic(values, values.len() / 2)
}

/// The median: the middle value, of an even number the mean of the two in the middle; `None` of none.
///
/// Sorts the values.
pub fn median<T: Real>(values: &mut [T]) -> Option<T> {
    values.sort_by(T::total_order);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        n if n % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / T::from_f64(2.0)),
    }
}

/// The quantile of `share` in \[0, 1\]: 0 is the smallest value, 0.5 the upper median, 1 the largest; `None` of none.
///
/// It is always one of the values: that of rank share · (n − 1), rounded to the nearest, halves upwards. Shares
/// beyond the range count as its ends. Sorts the values.
pub fn quantile<T: Real>(values: &mut [T], share: f64) -> Option<T> {
    values.sort_by(T::total_order);
    quantile_of_sorted(values, share)
}

/// As [`quantile`], of values that are ascending already.
pub fn quantile_of_sorted<T: Real>(ascending: &[T], share: f64) -> Option<T> {
    of_rank(ascending, share, f64::round)
}

/// As [`quantile_of_sorted`], but the rank share · (n − 1) is rounded up: at least this share of the values is at or
/// below the result, which suits limits that are to be kept, such as response times.
pub fn upper_quantile_of_sorted<T: Real>(ascending: &[T], share: f64) -> Option<T> {
    of_rank(ascending, share, f64::ceil)
}

fn of_rank<T: Real>(ascending: &[T], share: f64, whole: fn(f64) -> f64) -> Option<T> {
    let last = ascending.len().checked_sub(1)?;
    ascending.get(whole(share.clamp(0.0, 1.0) * last as f64) as usize).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All orders of a few values (Heap's algorithm).
    fn permutations(values: &[f64]) -> Vec<Vec<f64>> {
        fn heap(k: usize, values: &mut Vec<f64>, all: &mut Vec<Vec<f64>>) {
            if k <= 1 {
                all.push(values.clone());
                return;
            }
            for i in 0..k {
                heap(k - 1, values, all);
                values.swap(if k.is_multiple_of(2) { i } else { 0 }, k - 1);
            }
        }
        let mut all = Vec::new();
        heap(values.len(), &mut values.to_vec(), &mut all);
        all
    }

    #[test]
    fn medians_do_not_depend_on_the_order() {
        for mut values in permutations(&[3.0, 1.0, 2.0, 5.0, 4.0]) {
            assert_eq!(upper_median(&mut values.clone()), Some(3.0));
            assert_eq!(median(&mut values), Some(3.0));
        }
        for mut values in permutations(&[4.0, 1.0, 2.0, 3.0]) {
            assert_eq!(upper_median(&mut values.clone()), Some(3.0));
            assert_eq!(median(&mut values), Some(2.5));
        }
        assert_eq!(upper_median(&mut [1.0f32, 2.0]), Some(2.0));
        assert_eq!(upper_median(&mut [7.0f32]), Some(7.0));
    }

    #[test]
    fn nothing_has_no_median() {
        let none: &mut [f64] = &mut [];
        assert_eq!(upper_median(none), None);
        assert_eq!(median(none), None);
        assert_eq!(quantile(none, 0.5), None);
        assert_eq!(upper_quantile_of_sorted(none, 0.0), None);
        assert_eq!(order_statistic(none, 0), None);
        assert_eq!(order_statistic(&mut [1.0], 1), None);
    }

    #[test]
    fn nan_and_infinities_have_a_place_in_the_order() {
        assert_eq!(upper_median(&mut [f64::NAN, 1.0, 2.0]), Some(2.0));
        assert_eq!(upper_median(&mut [-f64::NAN, 1.0, 2.0]), Some(1.0));
        assert!(upper_median(&mut [f32::NAN, f32::NAN, 2.0]).unwrap().is_nan());
        assert_eq!(median(&mut [f64::INFINITY, f64::NEG_INFINITY, 0.5]), Some(0.5));
        assert!(median(&mut [f64::INFINITY, f64::NEG_INFINITY]).unwrap().is_nan());
        assert!(upper_median(&mut [0.0f32, -0.0]).unwrap().is_sign_positive());
        assert!(order_statistic(&mut [0.0f32, -0.0], 0).unwrap().is_sign_negative());
    }

    #[test]
    fn the_largest_numbers_have_a_middle() {
        // Their sum overflows, as documented: the mean of the two.
        assert_eq!(median(&mut [f64::MAX, f64::MAX]), Some(f64::INFINITY));
        assert_eq!(upper_median(&mut [f64::MAX, f64::MAX]), Some(f64::MAX));
        let tiny = f32::from_bits(1);
        assert_eq!(upper_median(&mut [tiny, 0.0, tiny]), Some(tiny));
    }

    #[test]
    fn every_rank_is_that_of_the_sorted_values() {
        let values: Vec<f64> = (0..101).map(|k| f64::from(k * 37 % 101)).collect();
        for rank in 0..101 {
            assert_eq!(order_statistic(&mut values.clone(), rank), Some(rank as f64));
        }
    }

    #[test]
    fn quantiles_round_to_the_nearest_rank_or_up() {
        let mut values = [30.0, 0.0, 20.0, 10.0];
        for (share, nearest, up) in [
            (0.0, 0.0, 0.0),
            (0.1, 0.0, 10.0),
            (0.5, 20.0, 20.0),
            (0.67, 20.0, 30.0),
            (1.0, 30.0, 30.0),
            (-3.0, 0.0, 0.0),
            (7.0, 30.0, 30.0),
        ] {
            assert_eq!(quantile(&mut values, share), Some(nearest), "{share}");
            assert_eq!(upper_quantile_of_sorted(&values, share), Some(up), "{share}");
        }
        assert_eq!(quantile(&mut values, f64::NAN), Some(0.0));
    }

    #[test]
    fn the_middle_quantile_is_the_upper_median() {
        for count in 1..40 {
            let mut values: Vec<f64> = (0..count).map(|k| f64::from(k * 17 % count)).collect();
            assert_eq!(quantile(&mut values.clone(), 0.5), upper_median(&mut values), "{count}");
        }
    }
}
