//! Triangles of strips.

/// The triangles of a row of strips, which −1 divides: of each three corners in a row one, every other one turned over. Triangles of two equal
/// corners, by which programs join strips, are left out. Where indices are stored without a sign, −1 is 2³² − 1.
pub(crate) fn strip_triangles(corners: &[i64]) -> impl Iterator<Item = [i64; 3]> {
    corners.split(|corner| [-1, i64::from(u32::MAX)].contains(corner)).flat_map(|strip| {
        strip.windows(3).enumerate().filter_map(|(k, window)| {
            let [a, b, c] = [window[0], window[1], window[2]];
            let triangle = if k.is_multiple_of(2) { [a, b, c] } else { [b, a, c] };
            (a != b && b != c && a != c).then_some(triangle)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_other_triangle_is_turned_over() {
        let triangles = |corners: &[i64]| strip_triangles(corners).collect::<Vec<_>>();
        assert_eq!(triangles(&[0, 1, 2, 3, 4]), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        // A strip begins anew, however long the one before it was.
        assert_eq!(triangles(&[0, 1, 2, 3, -1, 4, 5, 6]), [[0, 1, 2], [2, 1, 3], [4, 5, 6]]);
        assert_eq!(triangles(&[0, 1, 2, 0xFFFF_FFFF, 4, 5, 6]), [[0, 1, 2], [4, 5, 6]]);
        assert_eq!(triangles(&[-1, -1, 0, 1, -1, 2, 3, 4, -1]), [[2, 3, 4]]);
        // Two strips in one, joined by triangles without area.
        assert_eq!(triangles(&[0, 1, 2, 3, 3, 4, 4, 5, 6]), [[0, 1, 2], [2, 1, 3], [4, 5, 6]]);
        assert!(triangles(&[]).is_empty());
    }
}
