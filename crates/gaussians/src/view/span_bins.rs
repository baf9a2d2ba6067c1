//! Splats by the places of a row that they span.

/// What spans more places than this is listed once, and not at each of them: no more than this is kept of anything.
const LONGEST: u32 = 8;

/// Splats in ascending order, by the places (rows of tiles, or tiles of a row) that they span.
pub(super) struct SpanBins {
    /// Where the list of each place starts in `short`; one more for the end.
    starts: Vec<u32>,
    /// Those that span few places.
    short: Vec<u32>,
    /// The others, with their first and last place.
    long: Vec<(u32, [u32; 2])>,
}

impl SpanBins {
    /// Of splats in ascending order with the first and the last place that each spans, among `places` places. A splat whose last place is before its first
    /// spans none.
    pub fn new(places: u32, spans: impl Iterator<Item = (u32, [u32; 2])> + Clone) -> Self {
        let is_short = |[first, last]: [u32; 2]| first <= last && last - first < LONGEST;
        let short = spans.clone().filter(|(_, span)| is_short(*span));
        let mut starts = vec![0; places as usize + 1];
        for (_, [first, last]) in short.clone() {
            starts[first as usize..=last as usize].iter_mut().for_each(|count| *count += 1);
        }
        let mut sum = 0;
        for start in &mut starts {
            let count = *start;
            *start = sum;
            sum += count;
        }
        let (mut lists, mut ends) = (vec![0; sum as usize], starts.clone());
        for (splat, [first, last]) in short {
            for end in &mut ends[first as usize..=last as usize] {
                lists[*end as usize] = splat;
                *end += 1;
            }
        }
        let is_long = |[first, last]: [u32; 2]| first <= last && last - first >= LONGEST;
        Self { starts, short: lists, long: spans.filter(|(_, span)| is_long(*span)).collect() }
    }

    /// The splats that span a place, in ascending order.
    pub fn at(&self, place: u32) -> impl Iterator<Item = u32> {
        let [start, end] = [place, place + 1].map(|place| self.starts[place as usize] as usize);
        let mut short = self.short[start..end].iter().copied().peekable();
        let is_met = move |(splat, [first, last]): &(u32, [u32; 2])| {
            (*first <= place && place <= *last).then_some(*splat)
        };
        let mut long = self.long.iter().filter_map(is_met).peekable();
        std::iter::from_fn(move || match (short.peek(), long.peek()) {
            (Some(a), Some(b)) if b < a => long.next(),
            (None, _) => long.next(),
            _ => short.next(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_place_has_what_spans_it_in_order() {
        let turn = |k: u32, step: f64| (f64::from(k) * step).fract();
        let span = |k: u32| {
            let first = (40.0 * turn(k, 0.618)) as u32;
            // Every fifth is long, every seventh spans nothing.
            let length = if k.is_multiple_of(5) { 30.0 } else { 4.0 } * turn(k, 0.732);
            match k.is_multiple_of(7) {
                true => [1, 0],
                false => [first, (first + length as u32).min(39)],
            }
        };
        let spans = (0..500).map(|k| (3 * k, span(k)));
        let bins = SpanBins::new(40, spans.clone());
        assert!(bins.long.len() > 20 && bins.short.len() > 200);
        for place in 0..40 {
            let is_met = |(_, [first, last]): &(u32, [u32; 2])| (*first..=*last).contains(&place);
            let expected: Vec<u32> = spans.clone().filter(is_met).map(|(splat, _)| splat).collect();
            assert_eq!(bins.at(place).collect::<Vec<_>>(), expected, "place {place}");
        }
        assert_eq!(SpanBins::new(3, std::iter::empty()).at(2).count(), 0);
    }
}
