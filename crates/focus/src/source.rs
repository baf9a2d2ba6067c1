//! Where the focus of a surface point comes from: a constant, a texture in the mesh's UV, or the painted atlas.

use crate::FocusMap;
use atlas::Atlas;
use lens::FocusOffset;
use scene::{Scene, SurfaceField, SurfacePoint, Wrap};
use std::sync::Arc;

/// A focus map in a mesh's own UV set, as recipes give it.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusImage {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// [t, anchor] a texel, row 0 on top.
    pub texels: Vec<[f32; 2]>,
}

/// Where a part's focus comes from.
#[derive(Clone, Debug)]
pub enum FocusSource {
    /// One value.
    Constant(FocusOffset),
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

/// The focus of a whole scene: a source a part, and the background's value.
#[derive(Clone)]
pub struct Focus {
    /// The scene.
    pub scene: Arc<Scene>,
    /// One source for each of the scene's parts.
    pub parts: Vec<FocusSource>,
    /// The background's focus.
    pub background: FocusOffset,
}

impl SurfaceField<FocusOffset> for Focus {
    fn at(&self, _point: SurfacePoint) -> FocusOffset {
        todo!()
    }
    fn at_infinity(&self) -> FocusOffset {
        self.background
    }
}
