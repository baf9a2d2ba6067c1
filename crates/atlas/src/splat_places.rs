//! Places for Gaussian splats: a texel for each, along Morton's curve, row by row.
//!
//! A splat has area in the world, but its place is the middle of its texel alone: it is looked up exactly, and no other is mixed in. The curve puts
//! splats that are near in space near each other, so that a focus map as a picture compresses well.

use crate::{Atlas, AtlasError, Chart, MAX_SIDE};
use glam::Vec2;
use scene::{PlacedCloud, Scene};

impl Atlas {
    /// The atlas of a scene of splats alone.
    pub(crate) fn of_splats(scene: &Scene, splats: &PlacedCloud) -> Result<Self, AtlasError> {
        let side = (splats.cloud.len() as f64).sqrt().ceil() as u32;
        let none = Self::new([side.next_power_of_two().min(MAX_SIDE), 0], Vec::new(), Vec::new(), &[], 1.0);
        none.with_splats(scene, splats)
    }

    /// The atlas of all other triangles with those of splats: in rows of their own below.
    pub(crate) fn with_splats(self, scene: &Scene, splats: &PlacedCloud) -> Result<Self, AtlasError> {
        let Self { width, height, mut corners, mut chart_of, charts, density, notes, .. } = self;
        let (count, part) = (splats.cloud.len(), scene.parts.len() as u32 - 1);
        let gutter = if height > 0 { crate::MIN_GUTTER } else { 0 };
        let first_row = height + gutter;
        let rows = u32::try_from(count.div_ceil(width.max(1) as usize)).unwrap_or(u32::MAX);
        let height = first_row.saturating_add(rows);
        if height > MAX_SIDE {
            return Err(AtlasError::TooManyCharts { charts: count, side: MAX_SIDE });
        }
        let first = corners.len();
        corners.resize(first + count, [Vec2::ZERO; 3]);
        for (place, splat) in (0..).zip(splats.cloud.morton_order()) {
            let texel = Vec2::new((place % width) as f32, (first_row + place / width) as f32);
            corners[first + splat as usize] = [texel + 0.5; 3];
        }
        let mut part_of_chart: Vec<u32> = charts.iter().map(|Chart { part, .. }| *part).collect();
        chart_of.resize(first + count, part_of_chart.len() as u32);
        part_of_chart.push(part);
        // Texels per unit of length: a splat has one.
        let density = if first > 0 { density } else { 1.0 / mean_side(scene, splats) };
        Ok(Self { notes, ..Self::new([width, height], corners, chart_of, &part_of_chart, density) })
    }
}

/// The side of a square as large as a splat's triangle, in the geometric mean of some.
fn mean_side(scene: &Scene, splats: &PlacedCloud) -> f64 {
    const MOST: usize = 10_000;
    let triangles = splats.triangles();
    let step = triangles.len().div_ceil(MOST).max(1);
    let sides = triangles.step_by(step).map(|triangle| (0.5 * scene.area_normal(triangle).length()).sqrt());
    let logarithms: Vec<f64> = sides.map(f64::ln).filter(|x| x.is_finite()).collect();
    if logarithms.is_empty() { 1.0 } else { (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp() }
}

#[cfg(test)]
mod tests {
    use crate::{Atlas, UnwrapOptions};
    use gaussians::{CloudBuilder, CloudTraits, Placement, Splat};
    use glam::{DVec3, Quat, Vec3};
    use progress::Unwatched;
    use scene::{LoadOptions, Scene, SurfaceMesh};
    use std::sync::Arc;

    fn add_splats(scene: &mut Scene, count: u32) {
        let mut builder = CloudBuilder::new(0, count as usize);
        for k in 0..count {
            builder.push(
                Splat {
                    mean: Vec3::new((k % 7) as f32, (k / 7) as f32, (k % 3) as f32),
                    rotation: Quat::IDENTITY,
                    log_scale: Vec3::splat(-2.0),
                    opacity: 0.9,
                    base_color: Vec3::ZERO,
                },
                &[],
            );
        }
        let cloud = Arc::new(builder.finish(CloudTraits::default()));
        scene.add_splats("s".into(), cloud, Placement::IDENTITY, "PLY");
    }

    #[test]
    fn each_splat_has_the_middle_of_a_texel() {
        let mut scene = Scene::default();
        add_splats(&mut scene, 100);
        let atlas = Atlas::unwrap(&scene, &UnwrapOptions::default(), &Unwatched).unwrap();
        assert_eq!([atlas.width, atlas.height], [16, 7]);
        let texels = atlas.texel_map(&scene);
        assert_eq!(texels.texels.len(), 100);
        for splat in 0..100 {
            let position = atlas.position_of(scene.splats.as_ref().unwrap().address(splat));
            assert_eq!(position.fract(), glam::DVec2::splat(0.5));
            let texel = texels.texel_at(position.x as u32, position.y as u32).unwrap();
            assert_eq!(texel.centroid.triangle, splat);
            let mean = scene.splats.as_ref().unwrap().cloud.means()[splat as usize].as_dvec3();
            assert!(texel.centroid.position(&scene).distance(mean) < 1e-9);
        }
        assert_eq!(Atlas::from_bytes(&atlas.to_bytes(), &scene).unwrap().hash, atlas.hash);
    }

    #[test]
    fn splats_lie_below_the_charts_of_meshes() {
        let mesh = SurfaceMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            ..SurfaceMesh::default()
        };
        let alone = Scene::from_mesh(mesh, &LoadOptions::default()).unwrap();
        let unwrap = |scene: &Scene| Atlas::unwrap(scene, &UnwrapOptions::default(), &Unwatched).unwrap();
        let mut both = alone.clone();
        add_splats(&mut both, 30);
        let (alone, atlas) = (unwrap(&alone), unwrap(&both));
        assert_eq!((atlas.corners[0], atlas.corners.len()), (alone.corners[0], 31));
        assert_eq!((atlas.chart_of[0], atlas.chart_of[30], atlas.charts[1].part), (0, 1, 1));
        assert!(atlas.corners[1..].iter().flatten().all(|corner| corner.y > alone.height as f32));
    }
}
