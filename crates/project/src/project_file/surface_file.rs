//! The surface that a project's paint lies on, as an entry of the project: the scene's own file may have changed when
//! it is opened again.
//!
//! ```text
//! magic       8 bytes   "FBSURF\r\n"
//! counts      4 × u32   of nodes, parts, vertices, triangles
//! origin      3 × f64   that positions are relative to
//! nodes       each: world from node, 16 × f64 by columns; its name's length, u32, and the name in UTF-8
//! parts       each: node u32, the end of its triangles u32
//! positions   3 × f32 each
//! triangles   3 × u32 each, part by part
//! ```
//!
//! Little endian.

use glam::{DMat4, DVec3, Vec3};
use scene::{Node, Part, Scene, Triangle};

const MAGIC: &[u8; 8] = b"FBSURF\r\n";

/// The surface of a scene as the bytes that a project stores of it.
pub fn surface_to_bytes(scene: &Scene) -> Vec<u8> {
    let origin = scene.positions.first().copied().unwrap_or_default();
    let counts = [scene.nodes.len(), scene.parts.len(), scene.positions.len(), scene.triangles.len()];
    let mut bytes = MAGIC.to_vec();
    bytes.extend(counts.iter().flat_map(|count| (*count as u32).to_le_bytes()));
    bytes.extend(origin.to_array().iter().flat_map(|x| x.to_le_bytes()));
    for node in &scene.nodes {
        bytes.extend(node.world.to_cols_array().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend((node.name.len() as u32).to_le_bytes());
        bytes.extend(node.name.as_bytes());
    }
    bytes.extend(
        scene.parts.iter().flat_map(|part| [part.node, part.triangles.end]).flat_map(u32::to_le_bytes),
    );
    let positions = scene.positions.iter().map(|position| (position - origin).as_vec3());
    bytes.extend(positions.flat_map(|position| position.to_array()).flat_map(f32::to_le_bytes));
    bytes.extend(scene.triangles.iter().flat_map(|triangle| triangle.vertices).flat_map(u32::to_le_bytes));
    bytes
}

/// A scene with only a surface: nodes, parts, positions and triangles. `None` if the bytes are malformed.
pub fn surface_from_bytes(bytes: &[u8]) -> Option<Scene> {
    let mut rest = bytes.strip_prefix(MAGIC)?;
    let mut take = |length: usize| {
        let (taken, left) = rest.split_at_checked(length)?;
        rest = left;
        Some(taken)
    };
    let words = |bytes: &[u8]| {
        bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect::<Vec<_>>()
    };
    let numbers = |bytes: &[u8]| {
        bytes.as_chunks::<8>().0.iter().map(|word| f64::from_le_bytes(*word)).collect::<Vec<_>>()
    };
    let counts = words(take(16)?);
    let [nodes, parts, vertices, triangles] = counts.as_slice() else { return None };
    let origin = DVec3::from_slice(&numbers(take(24)?));
    let mut scene = Scene::default();
    for index in 0..*nodes {
        let world = DMat4::from_cols_array(numbers(take(128)?).as_slice().try_into().ok()?);
        let length = *words(take(4)?).first()?;
        let name = std::str::from_utf8(take(length as usize)?).ok()?.to_owned();
        scene.nodes.push(Node { name, index, world });
    }
    let mut start = 0;
    for row in words(take(usize::try_from(*parts).ok()?.checked_mul(8)?)?).chunks_exact(2) {
        let (node, end) = (row[0], row[1]);
        let is_sound = node < *nodes && start <= end && end <= *triangles;
        scene.parts.push(Part {
            node,
            material: 0,
            triangles: start..end,
            has_uv: [false; 2],
            mirrored: false,
        });
        start = is_sound.then_some(end)?;
    }
    let positions = words(take((*vertices as usize).checked_mul(12)?)?);
    scene.positions = positions
        .chunks_exact(3)
        .map(|at| origin + Vec3::from_slice(&[at[0], at[1], at[2]].map(f32::from_bits)).as_dvec3())
        .collect();
    let corners = words(take((*triangles as usize).checked_mul(12)?)?);
    for (part, scene_part) in scene.parts.iter().enumerate() {
        for triangle in scene_part.triangles.clone() {
            let at = 3 * triangle as usize;
            let vertices = [corners[at], corners[at + 1], corners[at + 2]];
            scene.triangles.push(Triangle { vertices, part: part as u32 });
        }
    }
    let is_within =
        scene.triangles.iter().flat_map(|triangle| triangle.vertices).all(|vertex| vertex < *vertices);
    let is_finite = scene.positions.iter().all(|position| position.is_finite());
    (rest.is_empty() && start == *triangles && is_within && is_finite).then_some(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_parts() -> Scene {
        let node = |name: &str, at: f64| Node {
            name: name.into(),
            index: 0,
            world: DMat4::from_translation(DVec3::splat(at)),
        };
        let part =
            |node: u32, triangles| Part { node, material: 0, triangles, has_uv: [false; 2], mirrored: false };
        Scene {
            positions: (0..5).map(|k| DVec3::new(1e6 + f64::from(k), f64::from(k * k), 0.5)).collect(),
            triangles: [([0, 1, 2], 0), ([1, 2, 3], 0), ([2, 3, 4], 1)]
                .map(|(vertices, part)| Triangle { vertices, part })
                .into(),
            parts: vec![part(1, 0..2), part(0, 2..3)],
            nodes: vec![node("Ä", 1.0), node("", -2.5)],
            ..Scene::default()
        }
    }

    #[test]
    fn a_surface_comes_back() {
        let scene = two_parts();
        let back = surface_from_bytes(&surface_to_bytes(&scene)).unwrap();
        assert_eq!((&back.positions, &back.triangles), (&scene.positions, &scene.triangles));
        let of = |scene: &Scene| {
            let parts = scene.parts.iter().map(|part| (part.node, part.triangles.clone()));
            let nodes = scene.nodes.iter().map(|node| (node.name.clone(), node.world));
            (parts.collect::<Vec<_>>(), nodes.collect::<Vec<_>>())
        };
        assert_eq!(of(&back), of(&scene));
    }

    #[test]
    fn no_damage_is_taken_for_a_surface_and_none_panics() {
        let good = surface_to_bytes(&two_parts());
        for length in 0..good.len() {
            assert!(surface_from_bytes(&good[..length]).is_none(), "{length} bytes");
        }
        for at in 0..good.len() {
            for value in [0, 0x7F, 0xFF] {
                let mut bytes = good.clone();
                bytes[at] = value;
                let _ = surface_from_bytes(&bytes);
            }
        }
    }
}
