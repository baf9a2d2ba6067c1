//! How near the sum of samples is to the truth, and how evenly white splats cover it.
//!
//! ```text
//! sample_figures SCENE.ply SCENE.camera.json [EXTENT_PX] [CELLS]
//! ```

#[path = "../tests/gaussians/camera_file.rs"]
mod camera_file;
#[path = "../tests/gaussians/comparison.rs"]
#[allow(dead_code, reason = "shared with the tests, which compare with references, too")]
mod comparison;
#[path = "../tests/gaussians/sample_sum.rs"]
mod sample_sum;

use camera_file::read_camera;
use comparison::{normalised_psnr_between, psnr_between};
use gaussians::{ClusterOptions, GaussianView, Placement, ReadOptions, TruthOptions, open, render_truth};
use progress::Unwatched;
use sample_sum::{clusters, margin_px, splat_samples, white};
use std::path::Path;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, camera, numbers @ ..] = &arguments[..] else { panic!("SCENE CAMERA [EXTENT_PX] [CELLS]") };
    let number = |index: usize, default: f64| {
        numbers
            .get(index)
            .map_or(default, |text| text.parse().unwrap_or_else(|_| panic!("{text} is no number")))
    };
    let (extent_px, cells) = (number(0, 2.0), number(1, 8.0) as u32);
    let file = open(Path::new(scene), &ReadOptions::default(), &Unwatched).unwrap_or_else(|e| panic!("{e}"));
    let camera = read_camera(Path::new(camera));
    let options = ClusterOptions { extent_px, gap_px: extent_px / 2.0, ..ClusterOptions::default() };
    for (what, cloud) in [("colours", file.cloud.clone()), ("white", white(&file.cloud))] {
        let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
        let truth = render_truth(&view, None, &TruthOptions::default(), &Unwatched).expect("not cancelled");
        let begun = Instant::now();
        let clusters = clusters(&view, &options);
        let margin = 2 * margin_px(&view);
        let pixels = f64::from((camera.width + margin) * (camera.height + margin));
        let samples = splat_samples(&view, &clusters, cells, 1024);
        println!(
            "{scene}, {what}: {:.2} dB, normalised {:.2} dB, {:.2} clusters a pixel, {:.1?}",
            psnr_between(&truth, &samples),
            normalised_psnr_between(&truth, &samples),
            clusters.list.len() as f64 / pixels,
            begun.elapsed(),
        );
        let covered = samples.picture.coverage.iter().zip(&truth.alpha).filter(|(_, alpha)| **alpha > 0.99);
        let mut coverage: Vec<f32> = covered.map(|(coverage, _)| *coverage).collect();
        coverage.sort_by(f32::total_cmp);
        let count = coverage.len() as f32;
        let mean = coverage.iter().sum::<f32>() / count;
        let deviation = (coverage.iter().map(|c| (c - mean).powi(2)).sum::<f32>() / count).sqrt();
        let at = |share: f32| coverage[((count - 1.0) * share) as usize];
        println!(
            "    coverage where it is complete: median {:.4}, mean {mean:.4} ± {deviation:.4}, 1 % {:.3}, 99 % {:.3}",
            at(0.5),
            at(0.01),
            at(0.99)
        );
    }
}
