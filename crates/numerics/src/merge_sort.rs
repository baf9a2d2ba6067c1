//! C's `qsort`, the same on every system.
//!
//! C libraries sort in different ways, so that elements that compare as equal end up in different orders. xatlas even compares with 0 and 1
//! alone, which GNU's merge sort (until 2.36 and from 2.39 on) puts right and Windows' quicksort does not: its atlases differed from system
//! to system. As with the [elementary functions](crate::elementary_functions), the linker takes this one. It is GNU's: the halves are
//! sorted, then merged, the first of two that compare as equal first.
#![allow(unsafe_code, reason = "a name without decoration is what makes the linker take a function")]

use std::ffi::{c_int, c_void};

/// Whether two elements are in order (≤ 0) or not.
type Compare = extern "C" fn(*const c_void, *const c_void) -> c_int;

#[unsafe(no_mangle)]
unsafe extern "C" fn qsort(elements: *mut c_void, count: usize, size: usize, compare: Compare) {
    let mut merged = Vec::new();
    // SAFETY: the caller gives `count` elements of `size` bytes, as in the C library.
    unsafe { sort(elements.cast(), count, size, compare, &mut merged) }
}

/// Sorts `count` elements of `size` bytes; `merged` is reused.
///
/// # Safety
/// They are there, nobody else uses them, and they may be moved.
unsafe fn sort(elements: *mut u8, count: usize, size: usize, compare: Compare, merged: &mut Vec<u8>) {
    if count < 2 {
        return;
    }
    let half = count / 2;
    // SAFETY: both halves lie within the elements, and so does every place below: each of the two ends where its half does.
    unsafe {
        let (mut first, mut second) = (elements, elements.add(half * size));
        let [first_end, second_end] = [second, elements.add(count * size)];
        sort(first, half, size, compare, merged);
        sort(second, count - half, size, compare, merged);
        merged.clear();
        while first < first_end && second < second_end {
            let next = if compare(first.cast(), second.cast()) <= 0 { &mut first } else { &mut second };
            merged.extend_from_slice(std::slice::from_raw_parts(*next, size));
            *next = next.add(size);
        }
        // What is left of the second half is in its place.
        let left = first_end.offset_from_unsigned(first);
        merged.extend_from_slice(std::slice::from_raw_parts(first, left));
        elements.copy_from_nonoverlapping(merged.as_ptr(), merged.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sorts pairs of a key and a place by their keys.
    fn sorted(mut pairs: Vec<[u32; 2]>, compare: Compare) -> Vec<[u32; 2]> {
        // SAFETY: the vector's elements are there, and nobody else uses them.
        unsafe { qsort(pairs.as_mut_ptr().cast(), pairs.len(), 8, compare) }
        pairs
    }

    fn keys(a: *const c_void, b: *const c_void) -> [u32; 2] {
        // SAFETY: `sorted` gives places of pairs.
        unsafe { [*a.cast(), *b.cast()] }
    }

    extern "C" fn three_way(a: *const c_void, b: *const c_void) -> c_int {
        let [a, b] = keys(a, b);
        a.cmp(&b) as c_int
    }

    /// As xatlas does it.
    extern "C" fn is_greater(a: *const c_void, b: *const c_void) -> c_int {
        let [a, b] = keys(a, b);
        c_int::from(b < a)
    }

    #[test]
    fn pairs_are_sorted_and_equal_ones_stay_in_order() {
        for count in (0..40).chain([1000]) {
            let pairs: Vec<_> = (0..count).map(|place| [place * 7919 % 31, place]).collect();
            let mut expected = pairs.clone();
            expected.sort();
            assert_eq!(sorted(pairs.clone(), three_way), expected);
            assert_eq!(sorted(pairs, is_greater), expected, "only 0 and 1");
        }
    }
}
