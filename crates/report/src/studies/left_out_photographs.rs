//! How well photographs of a capture are reconstructed from the others, and the capture as a sparse light
//! field.

use crate::store::{Store, file_name_part};
use baselines::ghosting_bounds;
use glam::DVec3;
use numerics::upper_median;
use project::{LinearPicture, write_rgb};
use render::LeftOut;
use scene::{Photograph, Scene, View};
use serde::{Deserialize, Serialize};
use session::SessionError;
use std::path::PathBuf;

/// Number of photographs left out of a capture.
pub const LEFT_OUT_COUNT: usize = 4;

/// A reconstruction of a photograph that was left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReconstructedPhotograph {
    /// The photograph's name.
    pub photograph: String,
    /// Method: `light`, `constant texture` or `texture of one photograph`.
    #[serde(rename = "told_by")]
    pub method: String,
    /// Share of the frame whose surface is visible in other photographs.
    #[serde(rename = "seen")]
    pub visible_share: f64,
    /// PSNR there, dB; linear, clipped to [0, 1].
    pub psnr: f64,
    /// Mean FLIP there.
    pub flip: f64,
}

/// Measurements of a capture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Photographs {
    /// Number of photographs.
    pub count: usize,
    /// Seconds to compute the light from all photographs but those left out.
    pub seconds: f64,
    /// Peak increase of memory meanwhile, bytes, if measured.
    pub peak_bytes: Option<u64>,
    /// One entry per photograph and method.
    #[serde(rename = "told")]
    pub reconstructions: Vec<ReconstructedPhotograph>,
    /// The photographs as a sparse light field.
    pub sparse: Option<SparseLightField>,
    /// For each photograph: the photograph itself and its reconstruction from light.
    #[serde(skip)]
    pub pictures: Vec<[PathBuf; 2]>,
}

/// The views of a light field that is refocused by shifting and adding.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SparseLightField {
    /// Median distance from the cameras to the centre of the scene, scene units.
    pub depth: f64,
    /// Median distance to the nearest other camera, scene units.
    pub spacing: f64,
    /// Focus depths between which an object at `depth` does not ghost (equations 5 to 7 of the thesis
    /// proposal); `None`: infinity.
    pub ghost_free: [Option<f64>; 2],
}

impl Photographs {
    /// Measurements of photographs that were left out; their pictures are saved in `store`.
    ///
    /// # Errors
    /// A picture cannot be written or compared.
    pub fn from_left_out(
        scene: &Scene,
        left_out: &LeftOut,
        peak_bytes: Option<u64>,
        name: &str,
        store: &Store,
    ) -> Result<Self, SessionError> {
        let mut reconstructions = Vec::new();
        for picture in &left_out.pictures {
            reconstructions.extend(picture.predictions.iter().map(|reconstruction| {
                ReconstructedPhotograph {
                    photograph: picture.name.clone(),
                    method: reconstruction.method.into(),
                    visible_share: picture.visible_share,
                    psnr: reconstruction.psnr,
                    flip: reconstruction.flip,
                }
            }));
            let files = picture_files(store, name, &picture.name);
            for (file, picture) in files.iter().zip([&picture.photograph, &picture.predictions[0].picture]) {
                let small = reduced_for_page(picture);
                write_rgb(file, small.width, small.height, &small.pixels)?;
            }
        }
        let mut photographs = Self {
            count: scene.views.len(),
            seconds: left_out.seconds,
            peak_bytes,
            reconstructions,
            sparse: SparseLightField::from_views(scene, &scene.views),
            pictures: Vec::new(),
        };
        photographs.find_pictures(name, store);
        Ok(photographs)
    }

    /// Sets the picture files, which may be from an earlier run.
    pub fn find_pictures(&mut self, name: &str, store: &Store) {
        let light = self.reconstructions.iter().filter(|reconstruction| reconstruction.method == "light");
        self.pictures =
            light.map(|reconstruction| picture_files(store, name, &reconstruction.photograph)).collect();
    }

    /// PSNR of a method over all photographs, from the mean of their squared errors, dB.
    pub fn overall_psnr(&self, method: &str) -> f64 {
        let of_method =
            || self.reconstructions.iter().filter(|reconstruction| reconstruction.method == method);
        let squares: f64 =
            of_method().map(|reconstruction| numerics::mean_square_of_psnr(reconstruction.psnr)).sum();
        numerics::psnr(squares / of_method().count().max(1) as f64)
    }
}

fn picture_files(store: &Store, name: &str, photograph: &str) -> [PathBuf; 2] {
    let part = file_name_part(photograph);
    [store.file(&format!("{name}-{part}"), "png"), store.file(&format!("{name}-{part}-light"), "png")]
}

impl SparseLightField {
    /// For some of the views of a scene; `None` for fewer than two.
    pub fn from_views(scene: &Scene, views: &[View]) -> Option<Self> {
        let (low, high) = scene.bounds();
        let middle = 0.5 * (low + high);
        let to_next = |view: &View| {
            let others = views.iter().filter(|other| other.name != view.name);
            others.map(|other| other.position().distance(view.position())).min_by(f64::total_cmp)
        };
        let depth = median(
            views.iter().map(|view| depth_along_axis(view, middle)).filter(|depth| *depth > 0.0).collect(),
        )?;
        let spacing = median(views.iter().filter_map(to_next).collect())?;
        let focal_px = median(views.iter().map(|view| view.lens.intrinsics().focal_px[0]).collect())?;
        let [nearer, farther] = ghosting_bounds(depth, 1.0, spacing, focal_px);
        let finite = |depth: f64| depth.is_finite().then_some(depth);
        Some(Self { depth, spacing, ghost_free: [finite(depth + nearer), finite(depth + farther)] })
    }
}

fn depth_along_axis(view: &View, point: DVec3) -> f64 {
    (point - view.position()).dot(view.forward())
}

/// The median; `None` of no values, and where it is NaN.
fn median(mut values: Vec<f64>) -> Option<f64> {
    upper_median(&mut values).filter(|median| !median.is_nan())
}

/// Largest width of a picture in the page, px.
const MAX_WIDTH_PX: u32 = 720;

/// The picture reduced by an integer factor, which limits the size of the page.
fn reduced_for_page(picture: &LinearPicture) -> Photograph {
    let whole = Photograph { width: picture.width, height: picture.height, pixels: picture.rgb.clone() };
    whole.downsampled(picture.width.div_ceil(MAX_WIDTH_PX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_become_small_enough_and_keep_their_mean() {
        let picture = LinearPicture {
            width: 1000,
            height: 4,
            rgb: (0..4000).map(|k| [(k % 2) as f32, 0.25, 1.0]).collect(),
            ..LinearPicture::default()
        };
        let small = reduced_for_page(&picture);
        assert_eq!((small.width, small.height), (500, 2));
        assert!(small.pixels.iter().all(|&pixel| pixel == [0.5, 0.25, 1.0]));
    }

    #[test]
    fn all_photographs_count_by_their_squared_errors() {
        let reconstruction = |psnr: f64| ReconstructedPhotograph {
            photograph: "a".into(),
            method: "light".into(),
            visible_share: 1.0,
            psnr,
            flip: 0.0,
        };
        let photographs = Photographs {
            count: 9,
            seconds: 1.0,
            peak_bytes: None,
            reconstructions: vec![reconstruction(20.0), reconstruction(30.0)],
            sparse: None,
            pictures: Vec::new(),
        };
        assert!((photographs.overall_psnr("light") - 22.596).abs() < 1e-3);
    }
}
