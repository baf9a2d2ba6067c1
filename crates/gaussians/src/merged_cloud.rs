//! Several clouds as one, in the axes of the world.

use crate::cloud::harmonics::{MAX_DEGREE, coefficient_count};
use crate::cloud::{Axes, CloudBuilder, CloudTraits, GaussianCloud, HarmonicsRotation, Splat};
use crate::placement::Placement;
use glam::DQuat;

/// The splats of several clouds, where they stand in the world, one cloud after the other. Coefficients are those of the highest degree.
///
/// `None` if there are no clouds; the clouds do not agree in colour space and low-pass; together they are more than 32 bits can number; or one is
/// mirrored or not scaled alike along its axes, which is no rotation and no size of a splat.
pub fn merge_clouds(parts: &[(GaussianCloud, Placement)]) -> Option<GaussianCloud> {
    let traits = CloudTraits { axes: Axes::RIGHT_UP_BACK, ..parts.first()?.0.traits() };
    let agrees = |cloud: &GaussianCloud| CloudTraits { axes: traits.axes, ..cloud.traits() } == traits;
    if !parts.iter().all(|(cloud, placement)| agrees(cloud) && placement.is_similarity()) {
        return None;
    }
    let degree = parts.iter().map(|(cloud, _)| cloud.degree()).max()?.min(MAX_DEGREE);
    let count: usize = parts.iter().map(|(cloud, _)| cloud.len()).sum();
    u32::try_from(count).ok()?;
    let mut builder = CloudBuilder::new(degree, count);
    let mut coefficients = vec![0.0; 3 * coefficient_count(degree)];
    for (cloud, placement) in parts {
        let turn = HarmonicsRotation::new(placement.rotation, cloud.degree());
        let rotation = DQuat::from_mat3(&placement.rotation).normalize();
        let log_scale = placement.scale.x.ln() as f32;
        for index in 0..cloud.len() {
            let splat = cloud.splat(index);
            let own = cloud.coefficients(index);
            coefficients.fill(0.0);
            coefficients.iter_mut().zip(own).for_each(|(to, from)| *to = from.to_f32());
            turn.apply(&mut coefficients[..own.len()]);
            let splat = Splat {
                mean: placement.point(splat.mean.as_dvec3()).as_vec3(),
                rotation: (rotation * splat.rotation.as_dquat()).normalize().as_quat(),
                log_scale: splat.log_scale + log_scale,
                ..splat
            };
            builder.push(splat, &coefficients);
        }
    }
    Some(builder.finish(traits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColorSpace, GaussianView, render_pinhole};
    use glam::{DMat3, DVec3, Quat, Vec3};
    use progress::Unwatched;

    fn cloud(degree: u32, seed: u32) -> GaussianCloud {
        let mut builder = CloudBuilder::new(degree, 40);
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32 - 0.5
        };
        for _ in 0..40 {
            let splat = Splat {
                mean: Vec3::new(random(), random(), random()),
                rotation: Quat::from_xyzw(random(), random(), random(), random()),
                log_scale: Vec3::new(random(), random(), random()) - 2.5,
                opacity: 0.75 + 0.4 * random(),
                base_color: Vec3::new(random(), random(), random()),
            };
            let coefficients: Vec<f32> = (0..3 * coefficient_count(degree)).map(|_| 0.4 * random()).collect();
            builder.push(splat, &coefficients);
        }
        builder.finish(CloudTraits::default())
    }

    #[test]
    fn merged_splats_look_as_they_did_where_they_stood() {
        let placement = Placement {
            rotation: DMat3::from_rotation_y(2.0) * DMat3::from_rotation_x(0.7),
            scale: DVec3::splat(1.7),
            translation: DVec3::new(0.2, -0.1, -3.0),
        };
        let camera = lens::Camera { width: 64, height: 48, aperture_radius: 0.0, ..lens::Camera::default() };
        let picture = |cloud: &GaussianCloud, placement: &Placement| {
            let view = GaussianView::new(cloud, placement, &camera);
            render_pinhole(&view, 1, &Unwatched).unwrap().picture.radiance
        };
        let alone = cloud(3, 1);
        let merged = merge_clouds(&[(alone.clone(), placement)]).unwrap();
        let far = |a: &[[f32; 3]], b: &[[f32; 3]]| {
            a.iter()
                .zip(b)
                .map(|(a, b)| (Vec3::from(*a) - Vec3::from(*b)).abs().max_element())
                .fold(0.0, f32::max)
        };
        let expected = picture(&alone, &placement);
        assert!(expected.iter().any(|rgb| rgb[0] > 0.1));
        let difference = far(&expected, &picture(&merged, &Placement::IDENTITY));
        assert!(difference < 2e-3, "{difference}");
        let unturned = Placement { rotation: DMat3::IDENTITY, ..placement };
        assert!(far(&expected, &picture(&alone, &unturned)) > 0.05, "any cloud would pass");

        let both = merge_clouds(&[(cloud(1, 2), Placement::IDENTITY), (alone.clone(), placement)]).unwrap();
        assert_eq!((both.len(), both.degree()), (80, 3));
    }

    #[test]
    fn what_is_no_cloud_any_more_is_refused() {
        let (a, identity) = (cloud(1, 1), Placement::IDENTITY);
        assert!(merge_clouds(&[]).is_none());
        let linear = a.clone().with_traits(CloudTraits { color_space: ColorSpace::Linear, ..a.traits() });
        assert!(merge_clouds(&[(a.clone(), identity), (linear, identity)]).is_none());
        let flat = Placement { scale: DVec3::new(1.0, 1.0, 0.5), ..identity };
        assert!(merge_clouds(&[(a.clone(), flat)]).is_none());
        let mirror = Placement { rotation: -DMat3::IDENTITY, ..identity };
        assert!(merge_clouds(&[(a, mirror)]).is_none());
    }
}
