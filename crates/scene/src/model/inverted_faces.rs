//! Triangles that face the inside of a closed mesh.

use glam::DVec3;
use rayon::prelude::*;

/// A set of three corners; however often and in whatever order a mesh contains it, it is one face.
struct Face {
    corners: [u32; 3],
    /// Whether its orientation must be reversed to agree with the rest of its piece.
    is_flipped: bool,
}

/// A face beside another one.
#[derive(Clone, Copy, Default)]
struct Neighbour {
    face: u32,
    /// Whether both traverse their edge in the same direction.
    runs_alike: bool,
}

/// Number of triangles that face the inside of the closed piece they belong to.
///
/// `corners` are the triangles by their welded vertices, `position` returns a vertex's position. A piece is a set of
/// faces connected by edges; it is closed if each of its edges has two faces, and has an outside if they can be
/// oriented consistently: the sign of its volume, Σ a·(b×c)/6 over its triangles, then decides which side is out.
/// Triangles of other pieces are not counted.
pub fn count_inverted_faces(corners: &[[u32; 3]], position: impl Fn(u32) -> DVec3) -> usize {
    let is_face = |[a, b, c]: [u32; 3]| a != b && b != c && c != a;
    let sorted = |mut triangle: [u32; 3]| {
        triangle.sort_unstable();
        triangle
    };
    let mut by_corners: Vec<([u32; 3], u32)> = (0..corners.len() as u32)
        .into_par_iter()
        .filter(|&index| is_face(corners[index as usize]))
        .map(|index| (sorted(corners[index as usize]), index))
        .collect();
    by_corners.par_sort_unstable();
    let copies: Vec<&[([u32; 3], u32)]> = by_corners.chunk_by(|a, b| a.0 == b.0).collect();
    // A face has the orientation of its first triangle.
    let first = |copies: &[([u32; 3], u32)]| corners[copies[0].1 as usize];
    let mut faces: Vec<Face> =
        copies.iter().map(|copies| Face { corners: first(copies), is_flipped: false }).collect();
    let outward_sides = find_outward_sides(&mut faces, position);
    let inverted = |(copies, is_outward): (&&[([u32; 3], u32)], Option<bool>)| {
        let is_inverted = |&&(_, index): &&([u32; 3], u32)| {
            is_outward != Some(has_same_orientation(first(copies), corners[index as usize]))
        };
        if is_outward.is_some() { copies.iter().filter(is_inverted).count() } else { 0 }
    };
    copies.iter().zip(outward_sides).map(inverted).sum()
}

/// Whether two orders of the same corners have the same orientation.
fn has_same_orientation([a, b, c]: [u32; 3], other: [u32; 3]) -> bool {
    [[a, b, c], [b, c, a], [c, a, b]].contains(&other)
}

/// For each face, whether its corners are counter-clockwise seen from outside; `None` if there is no outside.
fn find_outward_sides(faces: &mut [Face], position: impl Fn(u32) -> DVec3) -> Vec<Option<bool>> {
    // Each side of a face, by its edge: the face, and whether it traverses the edge from the lower vertex.
    let mut sides: Vec<([u32; 2], u32, bool)> = faces
        .par_iter()
        .enumerate()
        .flat_map_iter(|(index, face)| {
            let [a, b, c] = face.corners;
            [[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], index as u32, p < q))
        })
        .collect();
    sides.par_sort_unstable();
    let mut is_open = vec![false; faces.len()];
    // Two entries an edge; where more than two faces meet at one, the first of them has all others.
    let mut neighbours: Vec<(u32, Neighbour)> = Vec::with_capacity(sides.len());
    for faces_at_edge in sides.chunk_by(|a, b| a.0 == b.0) {
        let (_, first, first_runs) = faces_at_edge[0];
        for &(_, face, runs) in &faces_at_edge[1..] {
            let runs_alike = runs == first_runs;
            neighbours.push((first, Neighbour { face, runs_alike }));
            neighbours.push((face, Neighbour { face: first, runs_alike }));
        }
        if faces_at_edge.len() != 2 {
            faces_at_edge.iter().for_each(|&(_, face, _)| is_open[face as usize] = true);
        }
    }
    drop(sides);
    let (starts, neighbours) = grouped(faces.len(), &neighbours);
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
            let around = starts[face] as usize..starts[face + 1] as usize;
            for &Neighbour { face: neighbour, runs_alike } in &neighbours[around] {
                let neighbour = neighbour as usize;
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

/// Values by the group that they belong to: where those of each group start, and all of them, with an end.
fn grouped<T: Copy + Default>(groups: usize, values: &[(u32, T)]) -> (Vec<u32>, Vec<T>) {
    let mut starts = vec![0; groups + 1];
    for &(group, _) in values {
        starts[group as usize + 1] += 1;
    }
    for group in 0..groups {
        starts[group + 1] += starts[group];
    }
    let (mut next, mut all) = (starts.clone(), vec![T::default(); values.len()]);
    for &(group, value) in values {
        all[next[group as usize] as usize] = value;
        next[group as usize] += 1;
    }
    (starts, all)
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
