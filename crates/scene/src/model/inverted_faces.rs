//! Triangles that face the inside of a closed mesh.

use glam::DVec3;
use std::collections::HashMap;

/// A set of three corners; however often and in whatever order a mesh contains it, it is one face.
struct Face {
    corners: [u32; 3],
    /// Whether its orientation must be reversed to agree with the rest of its piece.
    is_flipped: bool,
}

/// Number of triangles that face the inside of the closed piece they belong to.
///
/// `corners` are the triangles by their welded vertices, `position` returns a vertex's position. A piece is a set of
/// faces connected by edges; it is closed if each of its edges has two faces, and has an outside if they can be
/// oriented consistently: the sign of its volume, Σ a·(b×c)/6 over its triangles, then decides which side is out.
/// Triangles of other pieces are not counted.
pub fn count_inverted_faces(corners: &[[u32; 3]], position: impl Fn(u32) -> DVec3) -> usize {
    let mut faces: Vec<Face> = Vec::new();
    let mut by_corners = HashMap::new();
    // For each triangle, its face, and whether it has the face's orientation.
    let mut face_of_triangle = Vec::with_capacity(corners.len());
    for &triangle in corners {
        let [a, b, c] = triangle;
        if a == b || b == c || c == a {
            continue;
        }
        let mut key = triangle;
        key.sort_unstable();
        let face = *by_corners.entry(key).or_insert_with(|| {
            faces.push(Face { corners: triangle, is_flipped: false });
            faces.len() - 1
        });
        face_of_triangle.push((face, has_same_orientation(faces[face].corners, triangle)));
    }
    let outward_sides = find_outward_sides(&mut faces, position);
    face_of_triangle
        .into_iter()
        .filter(|&(face, is_same)| outward_sides[face].is_some_and(|is_outward| is_outward != is_same))
        .count()
}

/// Whether two orders of the same corners have the same orientation.
fn has_same_orientation([a, b, c]: [u32; 3], other: [u32; 3]) -> bool {
    [[a, b, c], [b, c, a], [c, a, b]].contains(&other)
}

/// For each face, whether its corners are counter-clockwise seen from outside; `None` if there is no outside.
fn find_outward_sides(faces: &mut [Face], position: impl Fn(u32) -> DVec3) -> Vec<Option<bool>> {
    // Each side of a face, by its edge: the face, and whether it traverses the edge from the lower vertex.
    let mut sides: Vec<([u32; 2], usize, bool)> = Vec::with_capacity(3 * faces.len());
    for (index, face) in faces.iter().enumerate() {
        let [a, b, c] = face.corners;
        sides.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], index, p < q)));
    }
    sides.sort_unstable();
    let mut neighbours = vec![Vec::with_capacity(3); faces.len()];
    let mut is_open = vec![false; faces.len()];
    for faces_at_edge in sides.chunk_by(|a, b| a.0 == b.0) {
        let (_, first, first_runs) = faces_at_edge[0];
        for &(_, face, runs) in &faces_at_edge[1..] {
            neighbours[first].push((face, runs == first_runs));
            neighbours[face].push((first, runs == first_runs));
        }
        if faces_at_edge.len() != 2 {
            faces_at_edge.iter().for_each(|&(_, face, _)| is_open[face] = true);
        }
    }
    let mut outward_sides = vec![None; faces.len()];
    let mut is_visited = vec![false; faces.len()];
    for start in 0..faces.len() {
        if is_visited[start] {
            continue;
        }
        is_visited[start] = true;
        let (mut piece, mut next, mut has_outside) = (vec![start], 0, true);
        while let Some(&face) = piece.get(next) {
            next += 1;
            has_outside &= !is_open[face];
            for &(neighbour, runs_alike) in &neighbours[face] {
                // Consistently oriented faces traverse their edge in opposite directions.
                let is_flipped = faces[face].is_flipped ^ runs_alike;
                if is_visited[neighbour] {
                    has_outside &= faces[neighbour].is_flipped == is_flipped;
                } else {
                    is_visited[neighbour] = true;
                    faces[neighbour].is_flipped = is_flipped;
                    piece.push(neighbour);
                }
            }
        }
        let origin = position(faces[start].corners[0]);
        let volume: f64 = piece.iter().map(|&face| signed_volume(&faces[face], origin, &position)).sum();
        if has_outside && volume != 0.0 && volume.is_finite() {
            for &face in &piece {
                outward_sides[face] = Some((volume > 0.0) ^ faces[face].is_flipped);
            }
        }
    }
    outward_sides
}

/// Six times the signed volume of the tetrahedron of a face, as oriented, and `origin`.
fn signed_volume(face: &Face, origin: DVec3, position: impl Fn(u32) -> DVec3) -> f64 {
    let [a, b, c] = face.corners.map(|corner| position(corner) - origin);
    let volume = a.dot(b.cross(c));
    if face.is_flipped { -volume } else { volume }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron, all faces outward.
    const OUTWARD: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    fn corner(index: u32) -> DVec3 {
        [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z][index as usize % 4] + 1e3 * f64::from(index / 4)
    }

    fn turned(triangles: &[[u32; 3]]) -> usize {
        count_inverted_faces(triangles, corner)
    }

    fn inward() -> [[u32; 3]; 4] {
        OUTWARD.map(|[a, b, c]| [a, c, b])
    }

    #[test]
    fn of_a_closed_mesh_those_are_counted_that_face_its_inside() {
        assert_eq!(turned(&OUTWARD), 0);
        assert_eq!(turned(&inward()), 4);
        for k in 0..4 {
            let mut one = OUTWARD;
            one[k] = [one[k][1], one[k][0], one[k][2]];
            assert_eq!(turned(&one), 1);
        }
        let doubled: Vec<_> = OUTWARD.into_iter().chain(inward()).collect();
        assert_eq!(turned(&doubled), 4, "every face a second time, facing inward");
        // Two meshes far apart, the second inside out.
        let second = inward().map(|face| face.map(|corner| corner + 4));
        assert_eq!(turned(&[OUTWARD, second].concat()), 4);
    }

    #[test]
    fn what_has_no_outside_is_not_counted() {
        assert_eq!(turned(&inward()[..3]), 0, "open");
        assert_eq!(turned(&[[0, 0, 1], [0, 1, 1]]), 0, "no faces at all");
        // A flap on an edge: three faces meet there.
        let flap: Vec<_> = inward().into_iter().chain([[0, 1, 5]]).collect();
        assert_eq!(turned(&flap), 0);
        // All in one plane: no volume.
        let flat = |index: u32| corner(index).with_z(0.0);
        assert_eq!(count_inverted_faces(&inward(), flat), 0);
    }
}
