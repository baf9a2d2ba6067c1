//! The first surfaces of a picture, in cells of a few pixels: how far they are, and how they are painted.

use glam::DVec2;
use lens::blur_scale::paint_code;
use lens::{Camera, FocusOffset, Optics};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::SurfaceField;
use trace::{Ray, Tracer};
use web_page::{DistanceRange, PaintMaps, PixelMap};

/// Pixels along a side of a cell, at least.
const PIXELS_A_SIDE: u32 = 2;
/// Cells along a side of the picture, at most.
const MOST_CELLS: u32 = 1024;

/// What the chief rays of the pixels of each cell meet first: of all the one in the middle by depth. Row by row from the top.
pub struct FirstSurfaces {
    /// Columns and rows of cells.
    size: [u32; 2],
    /// 1/z, 1/length; 0 where there is no surface.
    inverse_depths: Vec<f64>,
    focus: Vec<FocusOffset>,
}

impl FirstSurfaces {
    /// Traces the rays.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn trace(
        tracer: &Tracer,
        camera: &Camera,
        focus: &dyn SurfaceField<FocusOffset>,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let longest = camera.width.max(camera.height);
        let pixels_a_side = longest.div_ceil(MOST_CELLS).max(PIXELS_A_SIDE);
        let size = [camera.width, camera.height].map(|side| side.div_ceil(pixels_a_side));
        let surface = |[x, y]: [u32; 2]| {
            let pixel = DVec2::new(x.into(), y.into()) + 0.5;
            match tracer.visible_surface(&Ray::pinhole(camera, DVec2::ZERO, pixel)) {
                Some(hit) => (1.0 / hit.t, focus.at(hit.point).or_standard()),
                None => (0.0, focus.at_infinity().or_standard()),
            }
        };
        let cell = |column: u32, row: u32| {
            let pixels = |cell: u32, side: u32| {
                let first = cell * pixels_a_side;
                first..(first + pixels_a_side).min(side)
            };
            let rows = pixels(row, camera.height);
            let all = rows.flat_map(|y| pixels(column, camera.width).map(move |x| surface([x, y])));
            let mut by_depth: Vec<(f64, FocusOffset)> = all.collect();
            let middle = by_depth.len() / 2;
            // Of two in the middle the nearer one.
            *by_depth.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0)).1
        };
        let rows = (0..size[1]).into_par_iter().map(|row| {
            progress.check()?;
            Ok((0..size[0]).map(|column| cell(column, row)).collect::<Vec<_>>())
        });
        let rows = rows.collect::<Result<Vec<_>, Cancelled>>()?;
        let (inverse_depths, focus) = rows.into_iter().flatten().unzip();
        Ok(Self { size, inverse_depths, focus })
    }

    /// The distances that make some surface sharp for the ordinary lens, and that of the camera.
    pub fn range(&self, camera: &Camera) -> DistanceRange {
        let opening = camera.optics().inverse_focus_distance;
        let all = || self.inverse_depths.iter().copied();
        DistanceRange { farthest: all().fold(opening, f64::min), nearest: all().fold(opening, f64::max) }
    }

    /// Whether any of the surfaces is not focused by the ordinary lens.
    pub fn is_painted(&self) -> bool {
        !self.focus.iter().all(|focus| focus.is_standard())
    }

    /// Codes of the distances that make the surfaces sharp for the ordinary lens.
    pub fn sharp_distances(&self, range: DistanceRange) -> PixelMap {
        self.map(|inverse_depth, _| range.code(Some(inverse_depth)))
    }

    /// Codes of the distances that make them sharp as painted, and of the paint.
    pub fn paint_maps(&self, range: DistanceRange, optics: &Optics) -> PaintMaps {
        PaintMaps {
            sharp_distances: self.map(|inverse_depth, focus| {
                range.code(optics.sharp_inverse_focus_distance(inverse_depth, focus))
            }),
            paint: self.map(|_, focus| {
                // What the paint adds to the defocus at the anchor.
                let circle_px = 2.0 * optics.splat_radius_px((focus.t - 1.0) / optics.image_distance);
                paint_code((!focus.is_standard()).then_some(circle_px))
            }),
        }
    }

    /// The distances in `range` that make some surface sharp, as painted or for the ordinary lens, ascending.
    pub fn all_sharp_distances(&self, range: DistanceRange, optics: &Optics, is_painted: bool) -> Vec<f64> {
        let surfaces = self.inverse_depths.iter().zip(&self.focus);
        let sharp = surfaces.filter_map(|(&inverse_depth, &focus)| {
            let focus = if is_painted { focus } else { FocusOffset::STANDARD };
            optics.sharp_inverse_focus_distance(inverse_depth, focus)
        });
        let mut all: Vec<f64> = sharp.filter(|d| (range.farthest..=range.nearest).contains(d)).collect();
        all.sort_unstable_by(f64::total_cmp);
        all
    }

    fn map(&self, code: impl Fn(f64, FocusOffset) -> u8) -> PixelMap {
        let surfaces = self.inverse_depths.iter().zip(&self.focus);
        PixelMap { size: self.size, codes: surfaces.map(|(&inverse, &focus)| code(inverse, focus)).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use document::load_scene;
    use focus::{Focus, FocusSource};
    use progress::Unwatched;
    use scene::Scene;
    use std::sync::Arc;

    /// A wall at 4 and, left of the middle, a card at 2.
    fn quads() -> Arc<Scene> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("quads.glb");
        crate::tiny_glb::write(&file);
        load_scene(&file, &Unwatched).unwrap()
    }

    fn camera() -> Camera {
        Camera { width: 96, height: 64, focus_distance: 2.5, aperture_radius: 0.1, ..Camera::default() }
    }

    /// The first surfaces where the card is painted, and their codes at a place of the picture, from 0 to 1.
    fn painted(card: FocusOffset) -> (FirstSurfaces, impl Fn(&PixelMap, f64, f64) -> u8) {
        let scene = quads();
        let mut focus = Focus::constant(scene.clone(), FocusOffset::STANDARD);
        focus.parts[1] = FocusSource::Constant(card);
        let surfaces = FirstSurfaces::trace(&Tracer::new(scene), &camera(), &focus, &Unwatched).unwrap();
        let code = |map: &PixelMap, x: f64, y: f64| {
            let [column, row] =
                [x * f64::from(map.size[0]), y * f64::from(map.size[1])].map(|at| at as usize);
            map.codes[row * map.size[0] as usize + column]
        };
        (surfaces, code)
    }

    /// On the card and on the wall.
    const CARD: (f64, f64) = (0.2, 0.5);
    const WALL: (f64, f64) = (0.75, 0.9);

    #[test]
    fn surfaces_are_sharp_at_their_distance_or_where_paint_moves_it() {
        let camera = camera();
        let optics = camera.optics();
        // Sharp at 4, where the wall is.
        let t = 1.0 / (1.0 + (0.25 - 0.5) * optics.image_distance);
        let (surfaces, code) = painted(FocusOffset::new(t, 0.0));
        let range = surfaces.range(&camera);
        assert!((range.farthest - 0.25).abs() < 1e-9 && (range.nearest - 0.5).abs() < 1e-9, "{range:?}");
        let ordinary = surfaces.sharp_distances(range);
        assert_eq!(ordinary.size, [48, 32]);
        assert_eq!((code(&ordinary, CARD.0, CARD.1), code(&ordinary, WALL.0, WALL.1)), (255, 1));
        let maps = surfaces.paint_maps(range, &optics);
        let sharp = &maps.sharp_distances;
        assert_eq!((code(sharp, CARD.0, CARD.1), code(sharp, WALL.0, WALL.1)), (1, 1));
        assert!(surfaces.is_painted());
        let all = |is_painted| surfaces.all_sharp_distances(range, &optics, is_painted);
        assert!(all(false).iter().any(|d| (d - 0.5).abs() < 1e-9) && all(true).iter().all(|d| *d < 0.26));
        let (blurred, unpainted) = (code(&maps.paint, CARD.0, CARD.1), code(&maps.paint, WALL.0, WALL.1));
        assert!(blurred > 128 && unpainted == 0, "{blurred} {unpainted}: t above 1 blurs as far");
    }

    #[test]
    fn what_no_distance_makes_sharp_has_no_code() {
        let camera = camera();
        for (card, paint) in [(FocusOffset::SHARP, 128..=128), (FocusOffset::new(1.2, 1.0), 129..=255)] {
            let (surfaces, code) = painted(card);
            let maps = surfaces.paint_maps(surfaces.range(&camera), &camera.optics());
            assert_eq!(code(&maps.sharp_distances, CARD.0, CARD.1), 0);
            assert!(paint.contains(&code(&maps.paint, CARD.0, CARD.1)), "{card:?}");
        }
        assert!(!painted(FocusOffset::STANDARD).0.is_painted());
    }

    #[test]
    fn a_large_picture_has_large_cells_and_the_camera_widens_the_range() {
        let scene = quads();
        let focus = Focus::constant(scene.clone(), FocusOffset::STANDARD);
        let wide = Camera { width: 4001, height: 9, focus_distance: 1.0, ..camera() };
        let surfaces = FirstSurfaces::trace(&Tracer::new(scene), &wide, &focus, &Unwatched).unwrap();
        assert_eq!(surfaces.size, [1001, 3]);
        assert_eq!(surfaces.inverse_depths.len(), 3003);
        assert_eq!(surfaces.range(&wide).nearest, 1.0);
        assert_eq!(surfaces.range(&wide).farthest, 0.0, "beside the wall there is nothing");
    }
}
