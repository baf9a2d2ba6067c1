//! A scene of one mesh that does not come from a glTF file: a scan, or a surface made from depth.

use crate::gltf::geometry::assembly::MAX_COORDINATE;
use crate::gltf::geometry::primitive::compact_indices;
use crate::gltf::scene_cameras;
use crate::{LoadOptions, Material, Node, Part, Scene, SceneCamera, SceneError, Triangle};
use glam::{DMat4, DQuat, DVec3, Vec3, Vec4};
use std::path::PathBuf;

/// Triangles with vertex attributes, unchecked.
#[derive(Clone, Debug, Default)]
pub struct SurfaceMesh {
    /// The file that they come from, for messages.
    pub path: PathBuf,
    /// The surface's name.
    pub name: String,
    /// World positions.
    pub positions: Vec<DVec3>,
    /// Normals of any length, one a position; empty if there are none.
    pub normals: Vec<Vec3>,
    /// Linear colours and opacity, one a position; empty if there are none.
    pub colors: Vec<Vec4>,
    /// Corners, counter-clockwise seen from the front, as indices of positions.
    pub triangles: Vec<[u32; 3]>,
}

impl Scene {
    /// The scene of a mesh. Its surface is double-sided, since scans and depth maps do not define sides; with colours
    /// it is unlit and shows them, without it is a grey diffuse surface. It has one part, one node and one material.
    /// Unused vertices are dropped, and so are, with a warning, triangles with a vertex that does not exist, is not
    /// finite or is absurdly far away.
    ///
    /// # Errors
    /// [`SceneError::NoTriangles`] if none is left, [`SceneError::Bad`] if there are more than `options` allow.
    pub fn from_mesh(mesh: SurfaceMesh, options: &LoadOptions) -> Result<Self, SceneError> {
        let SurfaceMesh { path, name, positions, normals, colors, triangles } = mesh;
        if triangles.len() as u64 > options.max_triangles {
            let what =
                format!("it has {} triangles, the limit is {}", triangles.len(), options.max_triangles);
            return Err(SceneError::Bad { file: path, fault: crate::Fault::TooBig { what } });
        }
        let is_usable = |&v: &u32| {
            let position = positions.get(v as usize);
            position.is_some_and(|p| p.is_finite() && p.abs().max_element() <= MAX_COORDINATE)
        };
        let all = triangles.len();
        let usable: Vec<[u32; 3]> =
            triangles.into_iter().filter(|corners| corners.iter().all(is_usable)).collect();
        let mut warnings = Vec::new();
        if usable.len() < all {
            warnings.push(format!(
                "{} of {all} triangles have a vertex that does not exist, is infinite, undefined or absurdly far away; left out",
                all - usable.len()
            ));
        }
        if usable.is_empty() {
            let why = warnings.pop().unwrap_or_else(|| "the mesh has none".into());
            return Err(SceneError::NoTriangles { file: path, why });
        }
        let (triangles, used) = compact_indices(&usable);
        drop(usable);
        let normal = |&v: &u32| normals.get(v as usize).map_or(Vec3::ZERO, |n| n.normalize_or_zero());
        let color = |&v: &u32| match colors.get(v as usize) {
            Some(color) if color.is_finite() => color.max(Vec4::ZERO),
            _ => Vec4::ONE,
        };
        let material = match colors.is_empty() {
            true => Material {
                base_color: Vec3::splat(0.5).extend(1.0),
                double_sided: true,
                ..Material::lambertian_white()
            },
            false => Material::unlit_white(),
        };
        let mut scene = Self {
            path,
            positions: used.iter().map(|&v| positions[v as usize]).collect(),
            normals: if normals.is_empty() { Vec::new() } else { used.iter().map(normal).collect() },
            colors: if colors.is_empty() { Vec::new() } else { used.iter().map(color).collect() },
            triangles: triangles.into_iter().map(|vertices| Triangle { vertices, part: 0 }).collect(),
            nodes: vec![Node { name: name.clone(), index: 0, world: DMat4::IDENTITY }],
            materials: vec![Material { name, ..material }],
            has_default_camera: true,
            warnings,
            ..Self::default()
        };
        let end = scene.triangles.len() as u32;
        scene.parts.push(Part {
            node: 0,
            material: 0,
            triangles: 0..end,
            has_uv: [false; 2],
            mirrored: false,
        });
        scene.set_upright(DQuat::IDENTITY);
        Ok(scene)
    }

    /// Frames the scene again if its camera is a default: `upright` rotates the world so that up is +y. The scene
    /// itself is not rotated.
    pub fn set_upright(&mut self, upright: DQuat) {
        if self.has_default_camera {
            self.cameras = vec![scene_cameras::framing_camera(self, upright)];
            scene_cameras::focus_cameras(self);
        }
    }

    /// Replaces the cameras, and focuses each on the first surface ahead.
    ///
    /// # Panics
    /// There are none.
    pub fn set_cameras(&mut self, cameras: Vec<SceneCamera>) {
        assert!(!cameras.is_empty());
        (self.cameras, self.has_default_camera) = (cameras, false);
        scene_cameras::focus_cameras(self);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh() -> SurfaceMesh {
        SurfaceMesh {
            path: "a.ply".into(),
            name: "a".into(),
            positions: vec![DVec3::NAN, DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE, DVec3::splat(1e200)],
            triangles: vec![[1, 2, 3], [0, 1, 2], [1, 2, 9], [3, 2, 1], [5, 1, 2]],
            ..SurfaceMesh::default()
        }
    }

    #[test]
    fn only_valid_triangles_remain() {
        let scene = Scene::from_mesh(mesh(), &LoadOptions::default()).unwrap();
        assert_eq!(scene.positions, [DVec3::ZERO, DVec3::X, DVec3::Y]);
        assert_eq!(scene.triangles.iter().map(|t| t.vertices).collect::<Vec<_>>(), [[0, 1, 2], [2, 1, 0]]);
        assert!(scene.warnings[0].starts_with("3 of 5 triangles"), "{:?}", scene.warnings);
        assert!(scene.materials[0].double_sided && !scene.materials[0].unlit);
        assert!(scene.cameras.len() == 1 && scene.normals.is_empty() && scene.colors.is_empty());
    }

    #[test]
    fn attributes_follow_their_vertices() {
        let colors = (0..6).map(|v| Vec4::splat(v as f32)).collect();
        let normals = (0..6).map(|v| Vec3::Z * v as f32).collect();
        let scene =
            Scene::from_mesh(SurfaceMesh { colors, normals, ..mesh() }, &LoadOptions::default()).unwrap();
        assert_eq!(scene.colors, [1.0, 2.0, 3.0].map(Vec4::splat));
        assert_eq!(scene.normals, [Vec3::Z; 3]);
        assert!(scene.materials[0].unlit && scene.materials[0].double_sided);
    }

    #[test]
    fn what_cannot_be_a_scene_is_refused() {
        let of = |mesh, options: &LoadOptions| Scene::from_mesh(mesh, options).unwrap_err().to_string();
        let nothing = of(SurfaceMesh { triangles: vec![], ..mesh() }, &LoadOptions::default());
        assert!(nothing.starts_with("a.ply: no triangle"), "{nothing}");
        let unsound = of(SurfaceMesh { triangles: vec![[0, 1, 2]], ..mesh() }, &LoadOptions::default());
        assert!(unsound.contains("1 of 1 triangles"), "{unsound}");
        let many = of(mesh(), &LoadOptions { max_triangles: 4, ..LoadOptions::default() });
        assert!(many.contains("5 triangles, the limit is 4"), "{many}");
    }

    #[test]
    fn the_framing_is_upright_where_up_is_elsewhere() {
        let mut scene = Scene::from_mesh(mesh(), &LoadOptions::default()).unwrap();
        scene.set_upright(DQuat::from_rotation_arc(DVec3::Z, DVec3::Y));
        let camera = &scene.cameras[0];
        assert!(camera.camera_to_world.y_axis.z > 0.8, "{}", camera.camera_to_world);
        let ahead = camera.camera_to_world.inverse().transform_point3(DVec3::new(0.3, 0.3, 0.0));
        assert!(ahead.z < 0.0 && camera.focus_distance > 0.0);
    }
}
