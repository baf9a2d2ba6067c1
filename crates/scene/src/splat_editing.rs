//! Showing the splats of a scene as an edit says.

use crate::splats_in_scene::{bounds, splat_corners};
use crate::{PlacedCloud, Scene, SplatCleanup, SplatEdit};
use gaussians::{GaussianCloud, Placement, have_neighbors};
use glam::{DQuat, DVec3};
use rayon::prelude::*;
use std::sync::Arc;

impl Scene {
    /// Shows the splats as `edit` says, instead of as they were shown. A default camera frames them again. Nothing happens without splats.
    ///
    /// # Panics
    /// The edit is not valid.
    pub fn edit_splats(&mut self, edit: SplatEdit) {
        assert!(edit.is_valid(), "{edit:?}");
        let Some(mut splats) = self.splats.take().map(Arc::unwrap_or_clone) else { return };
        splats.placement = edit.transform.apply(&splats.original_placement);
        let cloud = Arc::make_mut(&mut splats.cloud);
        cloud.hide(Vec::new());
        let hidden = hidden_splats(&edit, cloud, &splats.placement);
        cloud.hide(hidden);
        splats.edit = edit;
        self.place_splats(splats);
    }

    /// Takes up splats that stand elsewhere or are hidden, in place of those that have the same triangles.
    fn place_splats(&mut self, mut splats: PlacedCloud) {
        let first = self.triangles.get(splats.first_triangle as usize).map(|triangle| triangle.vertices[0]);
        if let Some(first) = first {
            let corners = splats.cloud.len() as u32;
            let corners =
                (0..corners).into_par_iter().map(|k| splat_corners(&splats.cloud, &splats.placement, k));
            let places = self.positions[first as usize..].par_chunks_exact_mut(3);
            places.zip(corners).for_each(|(places, corners)| places.copy_from_slice(&corners));
        }
        splats.bounds = bounds(&splats.cloud, &splats.placement);
        self.splats = Some(Arc::new(splats));
        self.set_upright(DQuat::IDENTITY);
    }
}

/// Whether each splat of a cloud that stands at `placement` is hidden.
fn hidden_splats(edit: &SplatEdit, cloud: &GaussianCloud, placement: &Placement) -> Vec<bool> {
    let SplatCleanup { min_opacity, max_size, max_distance } = edit.cleanup;
    let count = cloud.len();
    let mean = |index: usize| placement.point(cloud.means()[index].as_dvec3());
    let stretch = placement.scale.max_element();
    let is_hidden = |index: usize| {
        let splat = cloud.splat(index);
        let size = f64::from(splat.log_scale.max_element()).exp() * stretch;
        let place = mean(index);
        let is_outside = |(low, high): (DVec3, DVec3)| place.cmplt(low).any() || place.cmpgt(high).any();
        f64::from(splat.opacity) < min_opacity
            || max_size.is_some_and(|limit| size > limit)
            || edit.crop.is_some_and(is_outside)
    };
    let mut hidden: Vec<bool> = (0..count).into_par_iter().map(is_hidden).collect();
    for range in edit.hidden.iter() {
        let end = count.min(range.end as usize);
        hidden[end.min(range.start as usize)..end].fill(true);
    }
    if let Some(distance) = max_distance {
        // What is hidden already keeps nobody company.
        let places: Vec<DVec3> = (0..count)
            .into_par_iter()
            .map(|index| if hidden[index] { DVec3::NAN } else { mean(index) })
            .collect();
        let near = have_neighbors(&places, distance, SplatCleanup::NEIGHBORS);
        hidden.iter_mut().zip(near).for_each(|(is_hidden, is_near)| *is_hidden |= !is_near);
    }
    hidden
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SplatTransform;
    use gaussians::{CloudBuilder, CloudTraits, Splat};
    use glam::{Quat, Vec3};

    /// A wall of 10 × 10 splats a unit apart, one of them thin air, one huge; and one far away.
    fn scene() -> Scene {
        let mut builder = CloudBuilder::new(0, 101);
        for k in 0..101u32 {
            let mean = Vec3::new((k % 10) as f32, (k / 10) as f32, if k == 100 { 50.0 } else { 0.0 });
            let size: f32 = if k == 7 { 5.0 } else { 0.3 };
            builder.push(
                Splat {
                    mean,
                    rotation: Quat::IDENTITY,
                    log_scale: Vec3::splat(size.ln()),
                    opacity: if k == 3 { 0.05 } else { 0.9 },
                    base_color: Vec3::ZERO,
                },
                &[],
            );
        }
        let cloud = Arc::new(builder.finish(CloudTraits::default()));
        Scene::from_splats("a.ply".into(), "a".into(), cloud, Placement::IDENTITY, "PLY")
    }

    fn hidden(scene: &Scene) -> Vec<usize> {
        let cloud = &scene.splats.as_ref().unwrap().cloud;
        (0..cloud.len()).filter(|index| cloud.is_hidden(*index)).collect()
    }

    #[test]
    fn floaters_are_hidden_by_what_they_are_and_shown_again() {
        let original = scene();
        let mut scene = original.clone();
        let mut show = |edit: SplatEdit| {
            scene.edit_splats(edit);
            hidden(&scene)
        };
        let by = |cleanup: SplatCleanup| SplatEdit { cleanup, ..SplatEdit::default() };
        assert_eq!(show(by(SplatCleanup { min_opacity: 0.1, ..SplatCleanup::default() })), [3]);
        assert_eq!(show(by(SplatCleanup { max_size: Some(1.0), ..SplatCleanup::default() })), [7]);
        assert_eq!(show(by(SplatCleanup { max_distance: Some(3.0), ..SplatCleanup::default() })), [100]);
        let crop = Some((DVec3::splat(-0.5), DVec3::new(100.0, 8.5, 1.0)));
        let cropped = show(SplatEdit { crop, ..SplatEdit::default() });
        assert_eq!(cropped, (90..101).collect::<Vec<_>>());
        let one_by_one = SplatEdit::default().hiding([5, 4, 99, 4]);
        assert_eq!(*one_by_one.hidden, [4..6, 99..100]);
        assert_eq!(show(one_by_one.hiding([6])), [4, 5, 6, 99]);
        assert!(show(SplatEdit::default()).is_empty());
        assert_eq!(scene.positions, original.positions);
        assert_eq!(scene.splats.as_ref().unwrap().cloud, original.splats.as_ref().unwrap().cloud);
    }

    #[test]
    fn limits_are_those_of_the_world() {
        let mut scene = scene();
        let transform = SplatTransform { scale: 10.0, ..SplatTransform::default() };
        let cleanup =
            SplatCleanup { max_size: Some(10.0), max_distance: Some(30.0), ..SplatCleanup::default() };
        scene.edit_splats(SplatEdit { transform, cleanup, ..SplatEdit::default() });
        assert_eq!(hidden(&scene), [7, 100]);
    }

    #[test]
    fn splats_are_moved_with_their_triangles_and_their_bounds() {
        let original = scene();
        let mut scene = original.clone();
        let transform = SplatTransform {
            translation: DVec3::new(1.0, 2.0, 3.0),
            rotation: DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2),
            scale: 2.0,
        };
        scene.edit_splats(SplatEdit { transform, ..SplatEdit::default() });
        let centroid = |scene: &Scene, k: u32| scene.corners(k).iter().sum::<DVec3>() / 3.0;
        // (4, 2, 0) · 2 = (8, 4, 0), turned (−4, 8, 0).
        assert!(centroid(&scene, 24).distance(DVec3::new(-3.0, 10.0, 3.0)) < 1e-9);
        assert!(scene.bounds().0.x < -15.0 && original.bounds().0.x > -2.0);
        // An edit is from where the file put them, not from where the last edit did.
        scene.edit_splats(SplatEdit { transform, ..SplatEdit::default() });
        assert!(centroid(&scene, 24).distance(DVec3::new(-3.0, 10.0, 3.0)) < 1e-9);
    }
}
