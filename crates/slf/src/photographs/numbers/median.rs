//! The middle of some values.

use std::cmp::Ordering;

/// The middle value by an order, of an even number the upper of two; `None` of nothing. The values end up in another order.
pub(crate) fn median<T: Copy>(values: &mut [T], order: fn(&T, &T) -> Ordering) -> Option<T> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, order).1)
}
