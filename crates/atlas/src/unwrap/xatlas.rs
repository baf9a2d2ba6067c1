//! The only module that uses xatlas.
//!
//! xatlas is C++ that crashes on some meshes (a closed smooth sphere of 80k triangles) and does not return from
//! others, so it runs only in a child process ([`crate::child`]). About its wrapper: the declaration must outlive the
//! `Xatlas` value; `face_ignore_data` is mistyped, and the progress closure is called from threads it was not made
//! for, so neither is used.

use crate::unwrap::surface_patch::{FlattenedPatch, SurfacePatch, UNPLACED};
use xatlas_rs_v2::{ChartOptions, IndexData, MeshData, MeshDecl, PackOptions, Xatlas};

/// Texels per unit of length for xatlas's packing; a mean triangle has an area of 1.
const TEXELS_PER_UNIT: f32 = 8.0;

/// Flattens a patch; `None` if xatlas refuses it.
pub(crate) fn flatten_with_xatlas(patch: &SurfacePatch) -> Option<FlattenedPatch> {
    let indices = patch.corners.as_flattened();
    let declaration = MeshDecl {
        vertex_position_data: MeshData::Contiguous(patch.positions.as_flattened()),
        index_data: Some(IndexData::U32(indices)),
        face_count: patch.corners.len() as u32,
        ..MeshDecl::default()
    };
    let mut atlas = Xatlas::new();
    atlas.add_mesh(&declaration).ok()?;
    atlas.compute_charts(&ChartOptions::default());
    // xatlas gives out coordinates only after packing; our own packer places the charts. The cost grows with the
    // texels, and packing stretches charts to whole texels, which scaling to the chart's metric undoes.
    let packing = PackOptions {
        texels_per_unit: TEXELS_PER_UNIT,
        bilinear: false,
        rotate_charts: false,
        ..PackOptions::default()
    };
    atlas.pack_charts(&packing);
    if atlas.mesh_count() != 1 || atlas.chart_count() == 0 {
        return None;
    }
    let meshes = atlas.meshes();
    let mesh = meshes.first()?;
    let mut flattened = FlattenedPatch::unplaced(patch.corners.len());
    for (triangle, corners) in mesh.index_array.chunks_exact(3).enumerate().take(patch.corners.len()) {
        let [a, b, c] = [0, 1, 2].map(|k| mesh.vertex_array.get(corners[k] as usize));
        let (a, b, c) = (a?, b?, c?);
        let one_chart = a.chart_index == b.chart_index && b.chart_index == c.chart_index;
        flattened.chart[triangle] =
            u32::try_from(a.chart_index).ok().filter(|_| one_chart).unwrap_or(UNPLACED);
        flattened.corners[triangle] = [a.uv, b.uv, c.uv];
    }
    Some(flattened)
}
