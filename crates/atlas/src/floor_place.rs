//! A place for the floor that was put under a scene: a square of texels below all charts.
//!
//! What the charts of the scene itself hold stays where it is when a floor comes or goes: the square begins at a row of tiles of the focus map, so that no tile
//! holds both.

use crate::{Atlas, AtlasError, Chart, MAX_SIDE};
use glam::{DVec2, Vec2};
use scene::{Floor, Scene};

/// The first row of the square is a multiple of this: the side of a focus map's tiles.
const ROW_STEP: u32 = 64;
/// The largest side of the square, texels: paint on a floor may be coarse.
const MAX_FLOOR_SIDE: u32 = 256;

impl Atlas {
    /// The atlas of a scene with a floor, from that of all else of it: the floor has rows of its own below.
    ///
    /// # Errors
    /// [`AtlasError::TooManyCharts`]: there is no room below.
    pub fn with_floor(self, scene: &Scene, floor: &Floor) -> Result<Self, AtlasError> {
        let Self { width, height, mut corners, mut chart_of, charts, density, notes, .. } = self;
        let first_row = height.next_multiple_of(ROW_STEP);
        let side = width.min(MAX_FLOOR_SIDE);
        let height = first_row.saturating_add(side);
        if height > MAX_SIDE {
            return Err(AtlasError::TooManyCharts { charts: charts.len() + 1, side: MAX_SIDE });
        }
        let center = DVec2::new(0.5 * f64::from(side), f64::from(first_row) + 0.5 * f64::from(side));
        let place = |corner: DVec2| (center + 0.5 * f64::from(side) * corner).as_vec2();
        let placed = floor.triangles().map(|triangle| -> [Vec2; 3] {
            // As it is seen from above: x to the right, z down.
            floor.corners_on_disc(triangle).map(place)
        });
        corners.extend(placed);
        let mut part_of_chart: Vec<u32> = charts.iter().map(|Chart { part, .. }| *part).collect();
        chart_of.resize(corners.len(), part_of_chart.len() as u32);
        part_of_chart.push(scene.parts.len() as u32 - 1);
        Ok(Self { notes, ..Self::new([width, height], corners, chart_of, &part_of_chart, density) })
    }
}

#[cfg(test)]
mod tests {
    use crate::{Atlas, UnwrapOptions};
    use glam::DVec3;
    use progress::Unwatched;
    use scene::{LoadOptions, Scene, SurfaceMesh};

    #[test]
    fn what_was_there_stays_where_it_is() {
        let mesh = SurfaceMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            ..SurfaceMesh::default()
        };
        let mut scene = Scene::from_mesh(mesh, &LoadOptions::default()).unwrap();
        let unwrap = |scene: &Scene| Atlas::unwrap(scene, &UnwrapOptions::default(), &Unwatched).unwrap();
        let alone = unwrap(&scene);
        scene.set_floor(true);
        let atlas = unwrap(&scene);
        assert_eq!((atlas.corners[0], atlas.width), (alone.corners[0], alone.width));
        assert_eq!(
            (atlas.corners.len(), atlas.charts.len()),
            (scene.triangles.len(), alone.charts.len() + 1)
        );
        let texels = atlas.texel_map(&scene);
        let of_floor = texels.texels.iter().filter(|texel| texel.centroid.triangle > 0).count();
        assert!(of_floor > 100, "{of_floor}");
        scene.set_floor(false);
        assert_eq!(unwrap(&scene).hash, atlas.hash, "a hidden floor keeps its place");
        assert_eq!(Atlas::from_bytes(&atlas.to_bytes(), &scene).unwrap().hash, atlas.hash);
    }
}
