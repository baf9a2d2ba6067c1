//! The vertices of a primitive, split where charts of the atlas separate them.

use glam::Vec2;
use std::collections::HashMap;

/// A corner of a triangle: its element in the primitive's accessors, and its place in the atlas; `None` for a
/// triangle that is not in the atlas.
pub(crate) type Corner = (u32, Option<Vec2>);

/// The vertices of a primitive that has the atlas as a UV set.
///
/// They are the elements of its accessors, in order, followed by a copy for each further place that an element has in
/// the atlas. From accessors that are shared with much else only the elements in use are taken.
#[derive(Debug, PartialEq)]
pub(crate) struct SplitVertices {
    /// For each vertex, its element in the accessors.
    pub elements: Vec<u32>,
    /// For each vertex, its place in the atlas; zero if no triangle of the atlas uses it.
    pub places: Vec<Vec2>,
    /// The triangles.
    pub indices: Vec<u32>,
    /// Whether the vertices are the elements, unchanged.
    pub is_unchanged: bool,
}

impl SplitVertices {
    /// Splits the vertices of these triangles, whose accessors have `count` elements.
    pub fn new(triangles: &[[Corner; 3]], count: u32) -> Self {
        let corners = || triangles.iter().flatten();
        let mut used: Vec<u32> = corners().map(|(element, _)| *element).collect();
        used.sort_unstable();
        used.dedup();
        let keeps_all = count as usize <= 2 * used.len();
        let elements = if keeps_all { (0..count).collect() } else { used };
        let first_slot = |elements: &[u32], element: u32| match keeps_all {
            true => element,
            false => elements.partition_point(|&other| other < element) as u32,
        };
        let base = elements.len();
        let mut split =
            Self { places: vec![Vec2::ZERO; base], elements, indices: Vec::new(), is_unchanged: false };
        let mut is_placed = vec![false; base];
        let mut copies: HashMap<(u32, [u32; 2]), u32> = HashMap::new();
        for &(element, place) in corners() {
            let slot = first_slot(&split.elements[..base], element);
            let Some(place) = place else {
                split.indices.push(slot);
                continue;
            };
            if !is_placed[slot as usize] {
                is_placed[slot as usize] = true;
                split.places[slot as usize] = place;
            }
            let has_same_place = split.places[slot as usize].to_array().map(f32::to_bits)
                == place.to_array().map(f32::to_bits);
            let vertex = match has_same_place {
                true => slot,
                false => *copies.entry((slot, place.to_array().map(f32::to_bits))).or_insert_with(|| {
                    split.elements.push(element);
                    split.places.push(place);
                    split.elements.len() as u32 - 1
                }),
            };
            split.indices.push(vertex);
        }
        split.is_unchanged = keeps_all && split.elements.len() == base;
        split
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Vec2 = Vec2::new(0.1, 0.2);
    const B: Vec2 = Vec2::new(0.3, 0.4);
    const C: Vec2 = Vec2::new(0.5, 0.6);

    fn placed(triangle: [(u32, Vec2); 3]) -> [Corner; 3] {
        triangle.map(|(element, place)| (element, Some(place)))
    }

    #[test]
    fn vertices_with_one_place_each_stay() {
        let quad = [placed([(0, A), (1, B), (2, C)]), placed([(2, C), (1, B), (4, A)])];
        let split = SplitVertices::new(&quad, 5);
        assert!(split.is_unchanged);
        assert_eq!(split.elements, [0, 1, 2, 3, 4]);
        assert_eq!(split.places, [A, B, C, Vec2::ZERO, A]);
        assert_eq!(split.indices, [0, 1, 2, 2, 1, 4]);
    }

    #[test]
    fn a_vertex_of_two_places_is_there_twice() {
        let seam = [
            placed([(0, A), (1, B), (2, C)]),
            placed([(2, C), (1, A), (3, B)]),
            placed([(0, A), (3, B), (1, A)]),
        ];
        let split = SplitVertices::new(&seam, 4);
        assert!(!split.is_unchanged);
        assert_eq!(split.elements, [0, 1, 2, 3, 1]);
        assert_eq!(split.places, [A, B, C, B, A]);
        assert_eq!(split.indices, [0, 1, 2, 2, 4, 3, 0, 3, 4]);
    }

    #[test]
    fn of_large_accessors_only_what_occurs_is_taken() {
        let split = SplitVertices::new(&[placed([(70, A), (5000, B), (8, C)])], 1 << 20);
        assert!(!split.is_unchanged);
        assert_eq!((split.elements, split.places), (vec![8, 70, 5000], vec![C, A, B]));
        assert_eq!(split.indices, [1, 2, 0]);
    }

    #[test]
    fn triangles_outside_the_atlas_take_no_place_from_others() {
        let hidden = [(0, None), (1, None), (2, None)];
        let split = SplitVertices::new(&[hidden, placed([(0, A), (2, B), (3, C)])], 4);
        assert!(split.is_unchanged);
        assert_eq!(split.places, [A, Vec2::ZERO, B, C]);
        assert_eq!(split.indices, [0, 1, 2, 0, 2, 3]);
    }
}
