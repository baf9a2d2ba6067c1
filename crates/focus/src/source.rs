//! The source of the focus of a surface point: a constant, a value for each triangle, a texture in the mesh's UVs, or the painted atlas.

use crate::focus_map::focus_image::interpolate_uv;
use crate::{FocusImage, FocusMap};
use atlas::Atlas;
use glam::DVec2;
use lens::FocusOffset;
use scene::{Scene, SurfaceField, SurfacePoint, Wrap};
use std::sync::Arc;

/// Source of a part's focus.
#[derive(Clone, Debug)]
pub enum FocusSource {
    /// One value.
    Constant(FocusOffset),
    /// A value for each triangle of the whole scene, by its index. Splats have a triangle each.
    Triangles(Arc<[FocusOffset]>),
    /// A texture in the first UV set, bilinear.
    Uv {
        /// The texture.
        image: Arc<FocusImage>,
        /// What it shows outside [0, 1].
        wrap: [Wrap; 2],
    },
    /// The painted map over the atlas, bilinear.
    Atlas {
        /// Where the part lies.
        atlas: Arc<Atlas>,
        /// The map.
        map: Arc<FocusMap>,
    },
}

/// The focus of a whole scene: one source for each part, and the background's value.
#[derive(Clone)]
pub struct Focus {
    /// The scene.
    pub scene: Arc<Scene>,
    /// One source for each part of the scene.
    pub parts: Vec<FocusSource>,
    /// The background's focus.
    pub background: FocusOffset,
}

impl Focus {
    /// The same focus everywhere, the background included.
    pub fn constant(scene: Arc<Scene>, value: FocusOffset) -> Self {
        let parts = vec![FocusSource::Constant(value); scene.parts.len()];
        Self { scene, parts, background: value }
    }

    /// The focus that a painted map gives the whole scene; the map must have the atlas's size.
    pub fn from_atlas_map(scene: Arc<Scene>, atlas: Arc<Atlas>, map: Arc<FocusMap>) -> Self {
        debug_assert_eq!([atlas.width, atlas.height], map.size());
        let background = map.background;
        let parts = vec![FocusSource::Atlas { atlas, map }; scene.parts.len()];
        Self { scene, parts, background }
    }
}

impl SurfaceField<FocusOffset> for Focus {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        let part = self.scene.triangles[point.triangle as usize].part;
        match &self.parts[part as usize] {
            FocusSource::Constant(value) => *value,
            FocusSource::Triangles(values) => values[point.triangle as usize],
            FocusSource::Uv { image, wrap } => {
                let uv = interpolate_uv(self.scene.corner_uv(point.triangle, 0), point.weights());
                image.sample(uv, *wrap)
            }
            FocusSource::Atlas { atlas, map } => map.sample(atlas.position_of(point)),
        }
    }

    fn at_infinity(&self) -> FocusOffset {
        self.background
    }

    fn affects_carried_light(&self) -> bool {
        // Usually all parts share one map, or the values of triangles.
        let (mut last_checked, mut last_values) = (std::ptr::null(), std::ptr::null());
        let mut has_gloss = |source: &FocusSource| match source {
            FocusSource::Constant(value) => value.gloss != 0.0,
            FocusSource::Triangles(values) => {
                std::mem::replace(&mut last_values, values.as_ptr()) != values.as_ptr()
                    && values.iter().any(|value| value.gloss != 0.0)
            }
            FocusSource::Uv { image, .. } => image.gloss.is_some(),
            FocusSource::Atlas { map, .. } => {
                std::mem::replace(&mut last_checked, Arc::as_ptr(map)) != Arc::as_ptr(map) && map.has_gloss()
            }
        };
        self.background.gloss != 0.0 || self.parts.iter().any(&mut has_gloss)
    }

    /// Bounds over all texels that any point of the triangle may be interpolated from.
    fn bounds(&self, triangle: u32) -> Option<[FocusOffset; 2]> {
        let part = self.scene.triangles[triangle as usize].part;
        let texels = |corners: [DVec2; 3]| {
            let (low, high) =
                (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
            // The texels around a position are centred up to one texel from it.
            [(low - 0.5).floor(), (high - 0.5).floor() + 1.0]
        };
        match &self.parts[part as usize] {
            FocusSource::Constant(value) => Some([*value; 2]),
            FocusSource::Triangles(values) => Some([values[triangle as usize]; 2]),
            FocusSource::Uv { image, wrap } => {
                let size = DVec2::new(f64::from(image.width), f64::from(image.height));
                let corners = self.scene.corner_uv(triangle, 0).map(|uv| uv.as_dvec2() * size);
                Some(image.bounds(texels(corners), *wrap))
            }
            FocusSource::Atlas { atlas, map } => {
                let corners = atlas.corners[triangle as usize].map(|corner| corner.as_dvec2());
                Some(map.bounds(texels(corners)))
            }
        }
    }
}
