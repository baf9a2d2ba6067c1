//! The unwrapping engines that flatten a patch.

use crate::unwrap::surface_patch::{FlattenedPatch, SurfacePatch, UNPLACED};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// An unwrapping engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Engine {
    /// The C++ library: low distortion and few charts, but it may crash or hang.
    Xatlas,
    /// The pure-Rust library.
    Uvunwrap,
}

impl Engine {
    /// Its name on the child's command line.
    pub fn name(self) -> &'static str {
        match self {
            Engine::Xatlas => "xatlas",
            Engine::Uvunwrap => "uvunwrap",
        }
    }

    /// The engine with this name; `None` if there is none.
    pub fn from_name(word: &str) -> Option<Self> {
        [Engine::Xatlas, Engine::Uvunwrap].into_iter().find(|engine| engine.name() == word)
    }

    /// Flattens a patch of surface; `None` if the engine fails.
    pub fn flatten(self, patch: &SurfacePatch) -> Option<FlattenedPatch> {
        match self {
            Engine::Xatlas => crate::unwrap::xatlas::flatten_with_xatlas(patch),
            Engine::Uvunwrap => flatten_with_uvunwrap(patch, &|| false),
        }
    }
}

/// Flattens a patch with uvunwrap, until `cancelled`. A panic of the library counts as failure.
pub(crate) fn flatten_with_uvunwrap(
    patch: &SurfacePatch,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Option<FlattenedPatch> {
    let mesh = uvunwrap::MeshInput::new(&patch.positions, patch.corners.as_flattened());
    // Its packing is not used, so take the fastest, with charts large enough that f32 keeps their shape.
    let options = uvunwrap::Options {
        density: uvunwrap::Density::Fixed { texels_per_unit: 16.0, page_size: None },
        packing: uvunwrap::Packing::Fast,
        padding: 0,
        ..uvunwrap::Options::default()
    };
    let unwrap = || uvunwrap::generate_with_progress(&[mesh], &options, |_| !cancelled());
    let atlas = catch_unwind(AssertUnwindSafe(unwrap)).ok()?.ok()?;
    let size = [atlas.width as f32, atlas.height as f32];
    let mesh = atlas.meshes.first()?;
    let mut flattened = FlattenedPatch::unplaced(patch.corners.len());
    for (triangle, corners) in mesh.indices.chunks_exact(3).enumerate().take(patch.corners.len()) {
        let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices.get(corners[k] as usize));
        let (a, b, c) = (a?, b?, c?);
        let one_chart = a.chart == b.chart && b.chart == c.chart;
        flattened.chart[triangle] = a.chart.filter(|_| one_chart).unwrap_or(UNPLACED);
        flattened.corners[triangle] = [a, b, c].map(|v| [v.uv[0] * size[0], v.uv[1] * size[1]]);
    }
    Some(flattened)
}
