//! The aperture as seen from a surface point, and the light sent there: the light field at one point, cell by cell.

use crate::light_field::running_sum::BakedField;
use document::{Document, SurfaceHit};
use glam::{DVec2, DVec3};
use lens::FocusOffset;
use rayon::prelude::*;
use salf::Visibility;

/// The aperture as seen from one surface point, traced by rays.
#[derive(Clone, Debug, PartialEq)]
pub struct ApertureImage {
    /// World position of the point.
    pub position: DVec3,
    /// Rows and columns of cells over the square [−R, R]².
    pub side: usize,
    /// The cells: row 0 at v = +R, column 0 at u = −R, as seen from behind the camera.
    pub cells: Vec<ApertureCell>,
    /// Depth of the point in the shot camera.
    pub depth: f64,
    /// Focus of the point.
    pub focus: FocusOffset,
    /// Its defocus κ: how this image is scaled where it lands in the picture.
    pub kappa: f64,
    /// Signed diameter of its circle of confusion, px; if negative, the image is rotated by 180°.
    pub circle_px: f64,
    /// What the preview's light field stores here; `None` without a light field or nearby sample.
    pub baked: Option<BakedVisibility>,
}

/// The visibility of the light field's sample nearest to a point.
#[derive(Clone, Debug, PartialEq)]
pub struct BakedVisibility {
    /// Rows and columns of cells over the square [−R, R]² of the baked lens; 1 if the whole aperture is visible.
    pub side: usize,
    /// Which cells are visible, in the order of [`ApertureImage::cells`].
    pub cells: Vec<bool>,
    /// Linear RGB radiance toward the aperture: one for all cells.
    pub radiance: [f32; 3],
    /// Distance of the sample from the point, scene units.
    pub distance: f64,
    /// The baked aperture radius, which the cells cover even if the lens has been stopped down since.
    pub aperture_radius: f64,
}

impl BakedVisibility {
    /// The share of visible cells, in [0, 1].
    pub fn visible_share(&self) -> f64 {
        self.cells.iter().filter(|is_visible| **is_visible).count() as f64 / self.cells.len().max(1) as f64
    }
}

/// A cell of the aperture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ApertureCell {
    /// Transmission of the aperture's shape, in [0, 1].
    pub transmission: f32,
    /// Whether its centre is visible from the point, past the lens's rims.
    pub is_visible: bool,
    /// Linear RGB radiance from the point to its centre, as the lens's edges weigh it; black if not visible.
    pub radiance: [f32; 3],
}

/// Successive search radii for the nearest sample, texels.
const SEARCH_RADII_TEXELS: [u32; 6] = [0, 2, 8, 24, 64, 160];

impl ApertureImage {
    /// Rows and columns of cells.
    pub const SIDE: usize = 32;

    /// The share of the open aperture that is visible from the point, in [0, 1].
    pub fn visible_share(&self) -> f64 {
        let sum = |cells: &mut dyn Iterator<Item = &ApertureCell>| {
            cells.map(|cell| f64::from(cell.transmission)).sum::<f64>()
        };
        let open = sum(&mut self.cells.iter());
        if open > 0.0 { sum(&mut self.cells.iter().filter(|cell| cell.is_visible)) / open } else { 0.0 }
    }
}

impl ApertureImage {
    /// Traces the aperture as seen from a surface point (about a thousand rays), and looks the point up in `field`. `None` if the
    /// aperture is a pinhole or the point is behind it.
    pub(crate) fn trace_at(
        document: &Document,
        field: Option<&BakedField>,
        hit: &SurfaceHit,
    ) -> Option<Self> {
        let (camera, tracer) = (&document.camera, document.stage.tracer());
        let position = camera.camera_from_world(hit.position);
        let (radius, depth) = (camera.aperture_radius, position.z);
        if radius <= 0.0 || depth <= 0.0 {
            return None;
        }
        let light = document.stage.lit.available(camera);
        let focus = document.focus_at(hit);
        let character = camera.character_optics();
        let optics = &character.optics;
        let chief = optics.chief(position);
        let kappa = character.at(chief).kappa(1.0 / depth, focus);
        let side = ApertureImage::SIDE;
        let cell = |index: usize| {
            let [row, column] = [index / side, index % side].map(|k| (k as f64 + 0.5) / side as f64);
            let u = DVec2::new(2.0 * column - 1.0, 1.0 - 2.0 * row);
            let eye = camera.world_from_camera((u * radius).extend(0.0));
            let passes = character.passes(chief, 1.0 / depth, u * radius);
            let is_visible = passes && !tracer.is_hidden_from(hit.point, eye);
            let weight = character.edges.weight(u * radius, kappa) as f32;
            ApertureCell {
                transmission: camera.aperture.transmission(u) as f32,
                is_visible,
                radiance: if is_visible {
                    (light.total_outgoing(hit.point, eye) * weight).to_array()
                } else {
                    [0.0; 3]
                },
            }
        };
        let cells = (0..side * side).into_par_iter().map(cell).collect();
        let circle_px = 2.0 * optics.splat_radius_px(kappa);
        let baked = field.and_then(|field| BakedVisibility::nearest_to(document, field, hit));
        Some(Self { position: hit.position, side, cells, depth, focus, kappa, circle_px, baked })
    }
}

impl BakedVisibility {
    /// The visibility of the sample nearest to a surface point, searched in squares of increasing size in the atlas.
    fn nearest_to(document: &Document, field: &BakedField, hit: &SurfaceHit) -> Option<Self> {
        let stage = &document.stage;
        let texel_position = stage.atlas.position_of(hit.point);
        let samples = SEARCH_RADII_TEXELS.into_iter().find_map(|search_radius| {
            let range_along = |at: f64, count: u32| {
                let at = (at.max(0.0) as u32).min(count.saturating_sub(1));
                at.saturating_sub(search_radius)..(at + search_radius + 1).min(count)
            };
            let (columns, rows) = (
                range_along(texel_position.x, stage.atlas.width),
                range_along(texel_position.y, stage.atlas.height),
            );
            let texels: Vec<_> = rows.flat_map(|y| columns.clone().map(move |x| [x, y])).collect();
            Some(field.index.samples_reading(&texels)).filter(|nearby| !nearby.is_empty())
        })?;
        let mut addresses = field.salf.samples.addresses();
        let mut position = |index: u32| Some(addresses.get(index).surface?.position(&stage.scene));
        let near =
            samples.into_iter().filter_map(|index| Some((position(index)?.distance(hit.position), index)));
        let (distance, index) = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        let sample = field.salf.samples.get(index);
        let (side, cells) = match &sample.visibility {
            Visibility::Open => (1, vec![true]),
            Visibility::Cells { words, .. } => {
                let side = Visibility::side_of(words);
                // Its row 0 lies at v = −R.
                let rows = (0..side).rev().map(|row| Visibility::row(words, row));
                (side, rows.flat_map(|bits| (0..side).map(move |column| bits >> column & 1 == 1)).collect())
            }
        };
        let (radiance, aperture_radius) = (sample.radiance.to_array(), field.salf.camera.aperture_radius);
        Some(Self { side, cells, radiance, distance, aperture_radius })
    }
}
