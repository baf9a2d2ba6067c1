//! Statistics of what a light field models: only what its picture needs.
//!
//! A few rays from a texel's centroid determine whether it sees all of the aperture (open), part of it (partly occluded) or nothing.
//! Texels are sampled at regular steps through the atlas, so the counts of a large atlas are estimates; the counts of samples and
//! their bytes are exact.

use atlas::{Atlas, AtlasTexel};
use glam::DVec2;
use lens::Camera;
use rayon::prelude::*;
use salf::{Salf, SalfStatistics};
use serde::{Deserialize, Serialize};
use trace::Tracer;

/// Bytes of a sample in dense form: a microimage of 8 × 8 aperture cells of RGB half floats.
pub const DENSE_SAMPLE_BYTES: usize = 8 * 8 * 3 * 2;

/// Maximum number of texels that are sampled. The standard error of each share is then 0.4 % of all texels.
const MAX_SAMPLED_TEXELS: usize = 1 << 14;

/// Aperture points per side that are tested for a sampled texel.
const APERTURE_POINTS_A_SIDE: usize = 3;

/// Number of texels of an atlas by visibility, for one camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TexelStatistics {
    /// Texels that cover surface.
    pub exist: usize,
    /// Texels in the picture or its margin that are visible from some point of the aperture.
    pub visible: usize,
    /// Visible texels from which the whole aperture is visible.
    pub open: usize,
    /// Visible texels from which part of the aperture is occluded.
    pub partial: usize,
    /// Number of texels that were sampled. The counts are estimates unless all were.
    #[serde(rename = "asked")]
    pub sampled: usize,
}

/// How much of the aperture is visible from a texel.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ApertureVisibility {
    Hidden,
    Partial,
    Open,
}

impl TexelStatistics {
    /// Estimates how much of `camera`'s aperture is visible from the covered `texels` of an atlas. A texel counts as in the picture if
    /// it projects, through the aperture's centre, to at most `margin_px` pixels outside the frame.
    pub fn estimate(tracer: &Tracer, camera: &Camera, margin_px: f64, texels: &[AtlasTexel]) -> Self {
        let step = texels.len().div_ceil(MAX_SAMPLED_TEXELS).max(1);
        let sampled: Vec<&AtlasTexel> = texels.iter().skip(step / 2).step_by(step).collect();
        let visibilities: Vec<ApertureVisibility> =
            sampled.par_iter().map(|texel| aperture_visibility(tracer, camera, margin_px, texel)).collect();
        let count = |kind: ApertureVisibility| {
            let count_of_kind = visibilities.iter().filter(|&&visibility| visibility == kind).count();
            let of_all = count_of_kind as f64 * texels.len() as f64 / sampled.len().max(1) as f64;
            of_all.round() as usize
        };
        let (open, partial) = (count(ApertureVisibility::Open), count(ApertureVisibility::Partial));
        Self { exist: texels.len(), visible: open + partial, open, partial, sampled: sampled.len() }
    }
}

fn aperture_visibility(
    tracer: &Tracer,
    camera: &Camera,
    margin_px: f64,
    texel: &AtlasTexel,
) -> ApertureVisibility {
    let optics = camera.optics();
    let point = camera.camera_from_world(texel.centroid.position(tracer.scene()));
    let reach = 1.0 + margin_px / optics.half_height_px;
    let [middle, half] = camera.frame_q();
    let position = optics.chief(point) - middle;
    let is_inside = position.x.abs() <= half.x + reach - 1.0 && position.y.abs() <= reach;
    if !(point.z > 0.0 && is_inside) {
        return ApertureVisibility::Hidden;
    }
    let is_visible = |point_index: usize| {
        let at = |k: usize| (2 * k + 1) as f64 / APERTURE_POINTS_A_SIDE as f64 - 1.0;
        let u =
            DVec2::new(at(point_index % APERTURE_POINTS_A_SIDE), at(point_index / APERTURE_POINTS_A_SIDE))
                * camera.aperture_radius;
        !tracer.is_hidden_from(texel.centroid, camera.world_from_camera(u.extend(0.0)))
    };
    let point_count = APERTURE_POINTS_A_SIDE * APERTURE_POINTS_A_SIDE;
    match (0..point_count).filter(|&point_index| is_visible(point_index)).count() {
        0 => ApertureVisibility::Hidden,
        all if all == point_count => ApertureVisibility::Open,
        _ => ApertureVisibility::Partial,
    }
}

/// What a light field models of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Modelled {
    /// Counts and bytes of the samples.
    pub samples: SalfStatistics,
    /// Counts of the texels, if there is an atlas.
    pub texels: Option<TexelStatistics>,
}

/// A row of the table of what is modelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ModelledRow {
    /// The kind's name.
    pub kind: &'static str,
    /// A description of the kind.
    pub what: &'static str,
    /// Texels of this kind, if there is an atlas and the kind applies to texels.
    pub texels: Option<usize>,
    /// Samples of this kind.
    pub samples: Option<usize>,
    /// Bytes of these samples.
    pub bytes: Option<usize>,
}

impl Modelled {
    /// Counts what `salf` models of the scene in `tracer`, with the texels of `atlas` if there is one.
    pub fn measure(salf: &Salf, tracer: &Tracer, atlas: Option<&Atlas>) -> Self {
        let texels = atlas.map(|atlas| atlas.texels(tracer.scene()));
        Self::with_texels(salf, tracer, texels.as_deref())
    }

    /// [`Self::measure`] with precomputed covered texels of the atlas.
    pub fn with_texels(salf: &Salf, tracer: &Tracer, texels: Option<&[AtlasTexel]>) -> Self {
        let estimate =
            |texels| TexelStatistics::estimate(tracer, &salf.camera, salf.margin_px as f64, texels);
        Self { samples: salf.statistics(), texels: texels.map(estimate) }
    }

    /// The number of samples of the light field.
    pub fn sample_count(&self) -> usize {
        self.samples.open + self.samples.partial
    }

    /// The bytes of the samples in dense form, one microimage for each.
    pub fn dense_bytes(&self) -> usize {
        self.sample_count() * DENSE_SAMPLE_BYTES
    }

    /// The mean number of bytes of a sample; 0 if there are no samples.
    pub fn bytes_a_sample(&self) -> f64 {
        self.samples.bytes as f64 / self.sample_count().max(1) as f64
    }

    /// A table of what is modelled, by kind, and the size of the dense form.
    pub fn rows(&self) -> Vec<ModelledRow> {
        let row = |kind, what| ModelledRow { kind, what, texels: None, samples: None, bytes: None };
        let (samples, texels) = (&self.samples, self.texels);
        vec![
            ModelledRow {
                texels: texels.map(|texels| texels.exist),
                ..row("exist", "texels that cover surface, seen or not")
            },
            ModelledRow {
                texels: texels.map(|texels| texels.visible),
                samples: Some(self.sample_count()),
                bytes: Some(samples.bytes),
                ..row("visible", "some point of the aperture sees it; only this is stored")
            },
            ModelledRow {
                texels: texels.map(|texels| texels.open),
                samples: Some(samples.open),
                bytes: Some(samples.open_bytes),
                ..row("open", "sees the whole aperture: one colour is enough")
            },
            ModelledRow {
                texels: texels.map(|texels| texels.partial),
                samples: Some(samples.partial),
                bytes: Some(samples.partial_bytes),
                ..row("partly occluded", "something hides it from part of the aperture: a mask of cells")
            },
            ModelledRow {
                samples: Some(samples.carried),
                ..row(
                    "of it carried",
                    "mirrored or let through: focused as by the ordinary lens unless gloss obeys the paint; counted above",
                )
            },
            ModelledRow {
                samples: Some(samples.background),
                ..row("of it background", "samples at infinity, counted above as open or partly occluded")
            },
            ModelledRow {
                samples: Some(self.sample_count()),
                bytes: Some(self.dense_bytes()),
                ..row("dense form", "a microimage of 8 × 8 RGB half floats for every visible sample")
            },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Scene, SurfacePoint, Triangle};
    use std::sync::Arc;

    fn statistics() -> SalfStatistics {
        SalfStatistics {
            open: 30,
            partial: 10,
            background: 5,
            carried: 3,
            bytes: 3000,
            open_bytes: 2000,
            partial_bytes: 1000,
        }
    }

    #[test]
    fn the_table_adds_up() {
        let texels = TexelStatistics { exist: 100, visible: 40, open: 25, partial: 15, sampled: 100 };
        let modelled = Modelled { samples: statistics(), texels: Some(texels) };
        let rows = modelled.rows();
        let row = |kind: &str| rows.iter().find(|row| row.kind == kind).copied().unwrap();
        assert_eq!(row("visible").samples, Some(40));
        let (open, partial) = (row("open"), row("partly occluded"));
        assert_eq!(open.bytes.unwrap() + partial.bytes.unwrap(), row("visible").bytes.unwrap());
        assert_eq!(open.texels.unwrap() + partial.texels.unwrap(), row("visible").texels.unwrap());
        assert_eq!([row("of it background").samples, row("of it carried").samples], [Some(5), Some(3)]);
        assert_eq!(row("dense form").bytes, Some(40 * 384));
        assert_eq!(modelled.bytes_a_sample(), 75.0);
        assert_eq!(Modelled::default().bytes_a_sample(), 0.0);
        assert!(Modelled::default().rows().iter().all(|row| row.texels.is_none()));
    }

    /// A wall at depth 4 before the default camera, the card before its left half.
    fn wall_and_card() -> Arc<Scene> {
        let quad = |x: [f64; 2], y: f64, z: f64| {
            [(0, -y), (1, -y), (1, y), (0, y)].map(|(k, y)| glam::DVec3::new(x[k], y, -z))
        };
        let positions = [quad([-0.5, 0.5], 0.3, 4.0), quad([-0.25, 0.0], 0.3, 3.9)].concat();
        let corners = |first: u32, part| {
            [[0, 1, 2], [0, 2, 3]].map(|k| Triangle { vertices: k.map(|k| first + k), part })
        };
        let part = |part: u32| scene::Part {
            node: 0,
            material: 0,
            triangles: 2 * part..2 * part + 2,
            has_uv: [false; 2],
            mirrored: false,
        };
        let material = scene::Material { name: "white".into(), ..scene::Material::unlit_white() };
        Arc::new(Scene {
            normals: vec![glam::Vec3::ZERO; positions.len()],
            positions,
            triangles: [corners(0, 0), corners(4, 1)].concat(),
            parts: vec![part(0), part(1)],
            nodes: vec![scene::Node { name: "all".into(), index: 0, world: glam::DMat4::IDENTITY }],
            materials: vec![material],
            ..Scene::default()
        })
    }

    #[test]
    fn texels_behind_the_card_are_not_seen() {
        let scene = wall_and_card();
        let tracer = Tracer::new(scene.clone());
        let texel = |x: f64| {
            // On the wall's lower triangle: x runs with the second corner's weight, y near the lower edge.
            let point = SurfacePoint { triangle: 0, barycentric: DVec2::new(x + 0.5 - 0.1, 0.1) };
            AtlasTexel { x: 0, y: 0, area: 1.0, centroid: point }
        };
        let camera = Camera { aperture_radius: 0.5, ..Camera::default() };
        let estimated =
            |x: f64, camera: &Camera| TexelStatistics::estimate(&tracer, camera, 0.0, &[texel(x)]);
        assert_eq!(estimated(-0.12, &camera).visible, 0, "behind the card's middle");
        assert_eq!(estimated(-0.004, &camera).partial, 1, "behind the card's edge");
        assert_eq!(estimated(0.3, &camera).open, 1, "beside the card");
        let behind =
            Camera { camera_to_world: glam::DMat4::from_translation(glam::DVec3::Z * -8.0), ..camera };
        assert_eq!(estimated(0.3, &behind).visible, 0, "behind the camera");
    }

    #[test]
    fn a_large_atlas_is_estimated() {
        let scene = wall_and_card();
        let tracer = Tracer::new(scene.clone());
        let texel = |k: usize| {
            let weight = (k % 1000) as f64 / 1000.0;
            let point = SurfacePoint { triangle: 0, barycentric: DVec2::new(weight * 0.9, 0.05) };
            AtlasTexel { x: 0, y: 0, area: 1.0, centroid: point }
        };
        let texels: Vec<_> = (0..50_000).map(texel).collect();
        let estimated = TexelStatistics::estimate(&tracer, &Camera::default(), 0.0, &texels);
        assert!(estimated.sampled <= MAX_SAMPLED_TEXELS && estimated.exist == 50_000, "{estimated:?}");
        // x from −0.45 to 0.45, of which −0.25 to 0 (as seen on the wall: 4/3.9 of it) is hidden.
        let hidden = 0.25 * 4.0 / 3.9 / 0.9;
        let share = 1.0 - estimated.visible as f64 / estimated.exist as f64;
        assert!((share - hidden).abs() < 0.02, "{share} against {hidden}");
    }
}
