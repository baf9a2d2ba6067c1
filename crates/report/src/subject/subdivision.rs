//! Subdivision of a scene into four times as many triangles.

use scene::{Scene, Triangle};
use std::collections::HashMap;

/// Subdivides every triangle of `scene` into four at the midpoints of its sides. Surfaces, colours and
/// textures are unchanged; normals up to the precision of interpolation. Shared sides share a midpoint, so
/// that closed meshes stay closed. `None` if the vertex indices would exceed 32 bits.
pub fn subdivide(scene: &Scene) -> Option<Scene> {
    let mut fine = Scene { triangles: Vec::with_capacity(scene.triangles.len() * 4), ..scene.clone() };
    let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
    let mut middle = |fine: &mut Scene, a: u32, b: u32| -> Option<u32> {
        let side = [a.min(b), a.max(b)];
        if let Some(&existing) = middles.get(&side) {
            return Some(existing);
        }
        let index = u32::try_from(fine.positions.len()).ok().filter(|&index| index < u32::MAX)?;
        push_middle(&mut fine.positions, side, |a, b| 0.5 * (a + b));
        push_middle(&mut fine.normals, side, |a, b| 0.5 * (a + b));
        for uv in fine.uv.iter_mut().chain(&mut fine.further_uv) {
            push_middle(uv, side, |a, b| 0.5 * (a + b));
        }
        push_middle(&mut fine.colors, side, |a, b| 0.5 * (a + b));
        middles.insert(side, index);
        Some(index)
    };
    for Triangle { vertices: [a, b, c], part } in &scene.triangles {
        let ab = middle(&mut fine, *a, *b)?;
        let bc = middle(&mut fine, *b, *c)?;
        let ca = middle(&mut fine, *c, *a)?;
        let quarters = [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]];
        fine.triangles.extend(quarters.map(|vertices| Triangle { vertices, part: *part }));
    }
    for part in &mut fine.parts {
        part.triangles = part.triangles.start.checked_mul(4)?..part.triangles.end.checked_mul(4)?;
    }
    Some(fine)
}

/// Appends the mean of two vertices' values; an absent attribute stays empty.
fn push_middle<T: Copy>(values: &mut Vec<T>, [a, b]: [u32; 2], mean: impl Fn(T, T) -> T) {
    if let (Some(&a), Some(&b)) = (values.get(a as usize), values.get(b as usize)) {
        values.push(mean(a, b));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec2, Vec2Swizzles, Vec3};

    fn square() -> Scene {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        Scene {
            positions: corners.map(|[x, y]| DVec3::new(x, y, -3.0)).to_vec(),
            normals: vec![Vec3::Z; 4],
            uv: [corners.map(|[x, y]| Vec2::new(x as f32, y as f32) / 2.0).to_vec(), Vec::new()],
            further_uv: vec![corners.map(|[x, y]| Vec2::new(y as f32, x as f32)).to_vec()],
            triangles: [[0, 1, 2], [0, 2, 3]].map(|vertices| Triangle { vertices, part: 0 }).to_vec(),
            parts: vec![scene::Part {
                node: 0,
                material: 0,
                triangles: 0..2,
                has_uv: [true, false],
                mirrored: false,
            }],
            ..Scene::default()
        }
    }

    #[test]
    fn four_times_the_triangles_of_the_same_surface() {
        let scene = square();
        let fine = subdivide(&scene).unwrap();
        assert_eq!(fine.triangles.len(), 8);
        assert_eq!(fine.parts[0].triangles, 0..8);
        // Four corners, four outer sides and one shared diagonal.
        assert_eq!(fine.positions.len(), 9);
        let area = |scene: &Scene| -> f64 {
            (0..scene.triangles.len() as u32).map(|t| scene.area_normal(t).length() / 2.0).sum()
        };
        assert_eq!(area(&fine), area(&scene));
        assert!((0..8).all(|t| fine.area_normal(t).z > 0.0), "no triangle is turned over");
        for (position, uv) in fine.positions.iter().zip(&fine.uv[0]) {
            assert_eq!((position.truncate() / 2.0).as_vec2(), *uv);
        }
        assert!(fine.uv[1].is_empty());
        for (position, uv) in fine.positions.iter().zip(&fine.further_uv[0]) {
            assert_eq!(position.truncate().yx().as_vec2(), *uv);
        }
        assert_eq!(fine.further_uv[0].len(), fine.positions.len());
    }
}
