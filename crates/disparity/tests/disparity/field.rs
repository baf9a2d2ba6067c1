//! A light field with owned pictures.

use disparity::{Picture, View};

/// Pictures and their positions.
pub struct Field {
    pub width: usize,
    pub height: usize,
    pub pictures: Vec<Vec<[f32; 3]>>,
    pub positions: Vec<[f64; 2]>,
}

impl Field {
    /// The views, borrowed.
    pub fn views(&self) -> Vec<View<'_>> {
        let views = self.pictures.iter().zip(&self.positions);
        views
            .map(|(rgb, position)| View {
                picture: Picture { width: self.width, height: self.height, rgb },
                position: *position,
            })
            .collect()
    }

    /// The index of the view at a position.
    pub fn at(&self, position: [f64; 2]) -> usize {
        self.positions.iter().position(|p| *p == position).expect("a view is there")
    }
}

/// A grid of positions around the middle, row by row.
pub fn grid(columns: i32, rows: i32) -> Vec<[f64; 2]> {
    (-rows..=rows).flat_map(|y| (-columns..=columns).map(move |x| [f64::from(x), f64::from(y)])).collect()
}
