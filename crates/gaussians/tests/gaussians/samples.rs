//! Splats as samples: their sum is the picture, and white stays white.

use crate::comparison::{normalised_psnr_between, psnr_between};
use crate::sample_sum::{clusters, margin_px, splat_samples, white};
use crate::scene::{camera, scattered, still_life};
use gaussians::{
    ApertureScene, ClusterOptions, GaussianView, Placement, TruthOptions, aperture_images, cluster_picture,
    render_pinhole, render_truth,
};
use glam::{DVec2, Vec3};
use lens::Camera;
use progress::Unwatched;

#[test]
fn samples_sum_to_the_aperture_picture() {
    let (cloud, camera) = (still_life(), Camera { width: 96, height: 72, ..camera() });
    let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
    let truth = render_truth(&view, None, &TruthOptions::default(), &Unwatched).expect("not cancelled");
    let clusters = clusters(&view, &ClusterOptions::default());
    let pixels = f64::from((camera.width + 2 * margin_px(&view)) * (camera.height + 2 * margin_px(&view)));
    let [coarse, fine] = [4, 8].map(|cells| splat_samples(&view, &clusters, cells, 256));
    let figures = [&coarse, &fine].map(|samples| psnr_between(&truth, samples));
    let normalised = normalised_psnr_between(&truth, &fine);
    println!(
        "{:.2} clusters a pixel, {:.1} and {:.1} dB with 4 and 8 cells, normalised {normalised:.1} dB",
        clusters.list.len() as f64 / pixels,
        figures[0],
        figures[1]
    );
    assert!(figures[1] >= 42.0 && figures[1] > figures[0] && normalised >= 42.0, "{figures:?} {normalised}");
    // Control: without the aperture.
    let pinhole = psnr_between(&truth, &render_pinhole(&view, 2, &Unwatched).expect("not cancelled"));
    println!("control, no aperture: {pinhole:.1} dB");
    assert!(pinhole < 40.0, "{pinhole}");
}

#[test]
fn white_splats_cover_evenly() {
    let (cloud, camera) = (white(&still_life()), Camera { width: 96, height: 72, ..camera() });
    let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
    let truth = render_truth(&view, None, &TruthOptions::default(), &Unwatched).expect("not cancelled");
    let samples = splat_samples(&view, &clusters(&view, &ClusterOptions::default()), 8, 256);
    let mut coverage: Vec<f32> = samples
        .picture
        .coverage
        .iter()
        .zip(&truth.alpha)
        .filter(|(_, alpha)| **alpha > 0.99)
        .map(|(c, _)| *c)
        .collect();
    assert!(coverage.len() > 3000, "the scene is closed: {}", coverage.len());
    coverage.sort_by(f32::total_cmp);
    let median = coverage[coverage.len() / 2];
    let mean = coverage.iter().sum::<f32>() / coverage.len() as f32;
    let deviation = (coverage.iter().map(|c| (c - mean).powi(2)).sum::<f32>() / coverage.len() as f32).sqrt();
    println!("coverage: median {median:.4}, mean {mean:.4}, standard deviation {deviation:.4}");
    assert!((median - 1.0).abs() < 0.01 && deviation < 0.04, "{median} {deviation}");
}

#[test]
fn every_splat_of_a_chief_ray_is_in_one_cluster() {
    let (cloud, camera) = (scattered(200, 0), Camera { width: 24, height: 18, ..camera() });
    let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
    let eye = gaussians::Eye::new(&view, DVec2::ZERO);
    let clusters = cluster_picture(&view, &ClusterOptions::default(), &Unwatched).expect("not cancelled");
    for pixel in clusters.list.chunk_by(|a, b| a.pixel == b.pixel) {
        let mut members: Vec<u32> =
            pixel.iter().flat_map(|cluster| clusters.members(cluster)).copied().collect();
        members.sort_unstable();
        let direction = view.direction(DVec2::ZERO, pixel[0].pixel);
        let hits = eye.all_hits(direction);
        assert_eq!(members, hits.iter().map(|hit| hit.splat).collect::<Vec<_>>());
        assert!(pixel.is_sorted_by(|a, b| a.inverse_depth >= b.inverse_depth));
        for cluster in pixel {
            assert!(clusters.members(cluster).contains(&cluster.heaviest));
        }
    }
}

/// Of a band only the splats that it can see are looked at: it is as in the whole picture.
#[test]
fn bands_are_parts_of_the_picture() {
    let (cloud, camera) = (still_life(), Camera { width: 48, height: 36, ..camera() });
    let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
    let shares = |rows: Option<[u32; 2]>| -> Vec<(DVec2, u32, Vec<f32>, Vec3)> {
        let clusters = clusters(&view, &ClusterOptions { rows, ..ClusterOptions::default() });
        let scene = ApertureScene {
            view: &view,
            clusters: &clusters,
            points: &[],
            ray_end: &|_, _| f64::INFINITY,
            margin_px: margin_px(&view),
            coarse_below_px2: 0.0,
            rays_per_px: 2,
        };
        let images = aperture_images(&scene, 4, &Unwatched).expect("not cancelled");
        let each = clusters.list.iter().enumerate().map(|(number, cluster)| {
            (cluster.pixel, cluster.heaviest, images.shares(number).collect(), images.radiance(number))
        });
        each.collect()
    };
    let first = (margin_px(&view) + 16) / 8 * 8;
    let (all, band) = (shares(None), shares(Some([first, first + 8])));
    let rows = band[0].0.y..=band[band.len() - 1].0.y;
    let expected: Vec<_> = all.into_iter().filter(|(pixel, ..)| rows.contains(&pixel.y)).collect();
    assert!(band.len() > 100 && band.iter().any(|(_, _, shares, _)| shares.iter().any(|share| *share > 0.1)));
    assert_eq!(band, expected);
}
