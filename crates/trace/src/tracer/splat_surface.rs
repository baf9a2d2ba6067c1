//! The surface of Gaussian splats: where half of a ray is stopped.

use super::Tracer;
use super::splat_tree::SplatTree;
use crate::{Hit, Ray};

impl Tracer {
    /// The surface that is visible along a ray from its origin: the first hit ([`Self::first_hit`]), or before it the median depth of Gaussian splats,
    /// with the splat that the ray meets there. The first call in a scene with splats takes a while.
    pub fn visible_surface(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.first_hit(ray);
        let Some(splats) = &self.scene().splats else { return hit };
        let tree = self.splat_tree.get_or_init(|| SplatTree::new(splats));
        let before = Ray { t_max: hit.map_or(ray.t_max, |hit| hit.t), ..*ray };
        tree.surface(splats, &before).or(hit)
    }

    /// Whether the scene has Gaussian splats.
    pub fn has_splats(&self) -> bool {
        self.scene().splats.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gaussians::CloudRay;
    use gaussians::{CloudBuilder, CloudTraits, Placement, Splat};
    use glam::DVec3;
    use glam::{Quat, Vec3};
    use scene::{LoadOptions, Scene, SurfaceMesh};
    use std::sync::Arc;

    /// Walls of splats at z = −1, half there, and −2, nearly opaque; a triangle at z = −3.
    fn tracer() -> Tracer {
        let mut builder = CloudBuilder::new(0, 200);
        for k in 0..200 {
            let (row, column) = (k % 100 / 10, k % 10);
            let (z, opacity) = if k < 100 { (-1.0, 0.2) } else { (-2.0, 0.95) };
            builder.push(
                Splat {
                    mean: Vec3::new(column as f32 - 4.5, row as f32 - 4.5, z),
                    rotation: Quat::IDENTITY,
                    log_scale: Vec3::new(0.4, 0.4, 0.001).map(f32::ln),
                    opacity,
                    base_color: Vec3::ZERO,
                },
                &[],
            );
        }
        let mesh = SurfaceMesh {
            positions: [[-20.0, -20.0, -3.0], [20.0, -20.0, -3.0], [0.0, 40.0, -3.0]].map(DVec3::from).into(),
            triangles: vec![[0, 1, 2]],
            ..SurfaceMesh::default()
        };
        let mut scene = Scene::from_mesh(mesh, &LoadOptions::default()).unwrap();
        let cloud = Arc::new(builder.finish(CloudTraits::default()));
        scene.add_splats("wall".into(), cloud, Placement::IDENTITY, "PLY");
        Tracer::new(Arc::new(scene))
    }

    #[test]
    fn a_ray_stops_at_the_median_depth_or_at_the_mesh() {
        let tracer = tracer();
        let ray = |x: f64, y: f64| Ray {
            origin: DVec3::ZERO,
            direction: DVec3::new(x, y, -1.0),
            t_min: 0.0,
            t_max: f64::INFINITY,
            skip: None,
        };
        for k in 0..40 {
            let ray = ray(0.02 * f64::from(k) - 0.4, 0.3);
            let all = tracer.visible_surface(&ray).unwrap();
            let splats = tracer.scene().splats.clone().unwrap();
            let every = CloudRay::new(&splats.placement, ray.origin, ray.direction);
            let expected = every.surface_of_all(&splats.cloud).unwrap();
            assert!(all.t == expected.depth && all.point == splats.address(expected.splat));
            assert_eq!(tracer.first_hit(&ray).map(|hit| hit.t), Some(3.0), "light does not meet splats");
        }
        assert_eq!(tracer.visible_surface(&ray(0.5, 0.5)).map(|hit| hit.t), Some(2.0));
        assert_eq!(tracer.visible_surface(&ray(3.5, 0.0)).map(|hit| hit.t), Some(3.0), "beside the splats");
        let behind = Ray { t_min: 2.5, ..ray(0.5, 0.5) };
        assert_eq!(tracer.visible_surface(&behind).map(|hit| hit.t), Some(3.0));
    }
}
