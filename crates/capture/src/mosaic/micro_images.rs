//! From views to the mosaic of their micro-images: the inverse of reading one.

/// The mosaic of the pixels of views: pixel (x, y) of the view of column u and row v is at (x·columns + u, y·rows + v).
///
/// `views` are `columns` × `rows` views, row by row, each of `size[0]` × `size[1]` pixels, row by row; the mosaic has `size[0]`·columns ×
/// `size[1]`·rows pixels.
///
/// # Panics
/// If the number of views, or the number of pixels in one, is different.
pub fn micro_images<P: Copy>([columns, rows]: [u32; 2], size: [u32; 2], views: &[&[P]]) -> Vec<P> {
    let [columns, rows, width, height] = [columns, rows, size[0], size[1]].map(|side| side as usize);
    assert_eq!(views.len(), columns * rows, "a view a column and row");
    assert!(views.iter().all(|view| view.len() == width * height), "all pixels of each view");
    let mut mosaic = Vec::with_capacity(columns * rows * width * height);
    for (y, v) in (0..height).flat_map(|y| (0..rows).map(move |v| (y, v))) {
        for (x, u) in (0..width).flat_map(|x| (0..columns).map(move |u| (x, u))) {
            mosaic.push(views[v * columns + u][y * width + x]);
        }
    }
    mosaic
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_the_same_place_of_other_views() {
        // Three columns and two rows of views of 2 × 1 pixels: a pixel holds x, u and v.
        let views: Vec<Vec<[u32; 3]>> =
            (0..2).flat_map(|v| (0..3).map(move |u| (0..2).map(|x| [x, u, v]).collect())).collect();
        let views: Vec<&[[u32; 3]]> = views.iter().map(Vec::as_slice).collect();
        let mosaic = micro_images([3, 2], [2, 1], &views);
        for (at, pixel) in mosaic.iter().enumerate() {
            let (x, y) = (at as u32 % 6, at as u32 / 6);
            assert_eq!(*pixel, [x / 3, x % 3, y]);
        }
    }
}
