//! A ray of the world through a cloud, without a camera: picking, and the distance of what is ahead.

use super::ray_light::median_depth;
use super::shape::{MIN_ALPHA, MIN_AXIS};
use super::{Hit, MAX_ALPHA};
use crate::cloud::{GaussianCloud, Splat};
use crate::placement::Placement;
use glam::{DMat3, DQuat, DVec3};
use rayon::prelude::*;

/// A ray in the axes of a cloud's file; its parameter is that of the ray of the world.
#[derive(Clone, Copy, Debug)]
pub struct CloudRay {
    origin: DVec3,
    direction: DVec3,
}

impl CloudRay {
    /// The ray origin + t · direction of the world, for a cloud that stands at `placement`.
    pub fn new(placement: &Placement, origin: DVec3, direction: DVec3) -> Self {
        let file_from_world = placement.linear().inverse();
        Self {
            origin: file_from_world * (origin - placement.translation),
            direction: file_from_world * direction,
        }
    }

    /// The splat `index` as the ray meets it, its depth being the ray's t; `None` where its response is below 1/255, or behind the origin. There is no
    /// low-pass: a splat is as large as it is in the file.
    ///
    /// # Panics
    /// There is no such splat.
    pub fn hit(&self, cloud: &GaussianCloud, index: u32) -> Option<Hit> {
        let splat = cloud.splat(index as usize);
        let to_mean = splat.mean.as_dvec3() - self.origin;
        let whitening = whitening(&splat);
        let (p, q) = (whitening * to_mean, whitening * self.direction);
        let (pq, qq) = (p.dot(q), q.length_squared());
        let alpha =
            (f64::from(splat.opacity) * (-0.5 * p.cross(q).length_squared() / qq).exp()).min(MAX_ALPHA);
        let depth = pq / qq;
        (alpha >= MIN_ALPHA && depth > 0.0).then_some(Hit { splat: index, alpha, weight: 0.0, depth })
    }

    /// Where the surface is among these splats: the splat and the ray's t at which half of it is stopped; `None` if more of it passes.
    pub fn surface(&self, cloud: &GaussianCloud, splats: impl Iterator<Item = u32>) -> Option<Hit> {
        median_hit(&mut splats.filter_map(|index| self.hit(cloud, index)).collect::<Vec<_>>())
    }

    /// The same among all splats of a cloud: tests every one.
    pub fn surface_of_all(&self, cloud: &GaussianCloud) -> Option<Hit> {
        let hit = |index: u32| self.may_meet(cloud, index).then(|| self.hit(cloud, index)).flatten();
        median_hit(&mut (0..cloud.len() as u32).into_par_iter().filter_map(hit).collect::<Vec<_>>())
    }

    /// Whether the ray comes near a splat: a quick test.
    fn may_meet(&self, cloud: &GaussianCloud, index: u32) -> bool {
        let splat = cloud.splat(index as usize);
        let distance = (splat.mean.as_dvec3() - self.origin).cross(self.direction).length();
        distance <= splat.reach() * self.direction.length()
    }
}

/// diag(1/s) Rᵀ.
fn whitening(splat: &Splat) -> DMat3 {
    let scale = splat.log_scale.as_dvec3().exp();
    let scale = scale.max(DVec3::splat(MIN_AXIS * scale.max_element()));
    let rotation = DMat3::from_quat(DQuat::from_array(splat.rotation.to_array().map(f64::from)).normalize());
    DMat3::from_diagonal(scale.recip()) * rotation.transpose()
}

/// The hit at the median depth.
fn median_hit(hits: &mut [Hit]) -> Option<Hit> {
    let depth = median_depth(hits)?;
    hits.iter().find(|hit| hit.depth == depth).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{CloudBuilder, CloudTraits};
    use glam::{Quat, Vec3};

    #[test]
    fn a_ray_stops_where_half_of_it_is_stopped_wherever_the_cloud_stands() {
        let mut builder = CloudBuilder::new(0, 3);
        for (z, opacity) in [(1.0, 0.3), (2.0, 0.9), (3.0, 0.9)] {
            builder.push(
                Splat {
                    mean: Vec3::new(0.0, 0.0, z),
                    rotation: Quat::IDENTITY,
                    log_scale: Vec3::new(0.2, 0.1, 1e-6).map(f32::ln),
                    opacity,
                    base_color: Vec3::ZERO,
                },
                &[],
            );
        }
        let cloud = builder.finish(CloudTraits::default());
        let turned = Placement {
            rotation: DMat3::from_rotation_x(0.7),
            scale: DVec3::splat(3.0),
            translation: DVec3::new(5.0, -1.0, 2.0),
        };
        for placement in [Placement::IDENTITY, turned] {
            let (from, to) = (placement.point(DVec3::ZERO), placement.point(DVec3::new(0.0, 0.0, 4.0)));
            let ray = CloudRay::new(&placement, from, to - from);
            let hit = ray.surface_of_all(&cloud).unwrap();
            assert!(hit.splat == 1 && (hit.depth - 0.5).abs() < 1e-9, "{hit:?}");
            assert_eq!(ray.surface(&cloud, [0, 2].into_iter()).map(|hit| hit.splat), Some(2));
            assert_eq!(ray.surface(&cloud, [0].into_iter()), None, "most of it passes");
            let beside = CloudRay::new(&placement, from, placement.point(DVec3::new(4.0, 0.0, 4.0)) - from);
            assert_eq!(beside.surface_of_all(&cloud), None);
        }
    }
}
