//! Triangulation of faces of any number of corners.

/// The triangles of a face of any number of corners, assumed to be convex and flat: a fan about the first.
pub(crate) fn triangulate_fan<T: Copy>(corners: &[T]) -> impl Iterator<Item = [T; 3]> {
    corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]])
}
