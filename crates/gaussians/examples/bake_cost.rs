//! What the aperture images of a scene take: counts, and seconds of this process' threads where Linux tells them.
//!
//! ```text
//! bake_cost SCENE CAMERA.json [WIDTH] [EXTENT_PX] [ROW END] [COARSE_BELOW_PX2] [RAYS_PER_PX]
//! ```

#[path = "../tests/gaussians/camera_file.rs"]
mod camera_file;

use camera_file::read_camera;
use gaussians::{
    ApertureScene, ClusterOptions, GaussianView, Placement, ReadOptions, aperture_images, cluster_picture,
    open,
};
use progress::Unwatched;
use std::path::Path;

/// User and system time of the process so far, s; 0 where the system does not tell.
fn processor_seconds() -> f64 {
    /// Clock ticks a second, the same on every Linux.
    const TICKS: f64 = 100.0;
    let Ok(text) = std::fs::read_to_string("/proc/self/stat") else { return 0.0 };
    let fields = text.rsplit(')').next().unwrap_or_default().split_whitespace();
    fields.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / TICKS
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, camera, numbers @ ..] = &arguments[..] else {
        panic!("SCENE CAMERA [WIDTH] [EXTENT_PX] [ROW END]")
    };
    let number = |index: usize| numbers.get(index).map(|text| text.parse::<f64>().expect("a number"));
    let file = open(Path::new(scene), &ReadOptions::default(), &Unwatched).unwrap_or_else(|e| panic!("{e}"));
    println!("opened: {} splats, {:.1} s", file.cloud.len(), processor_seconds());
    let mut camera = read_camera(Path::new(camera));
    if let Some(width) = number(0) {
        camera.height = (f64::from(camera.height) * width / f64::from(camera.width)).round() as u32;
        camera.width = width as u32;
    }
    let extent_px = number(1).unwrap_or(1.0);
    let rows = number(2).zip(number(3)).map(|(first, end)| [first as u32, end as u32]);
    let view = GaussianView::new(&file.cloud, &Placement::IDENTITY, &camera);
    println!("seen: {} splats, {:.1} s", view.len(), processor_seconds());
    let options = ClusterOptions { extent_px, gap_px: extent_px / 2.0, rows, ..ClusterOptions::default() };
    let clusters = cluster_picture(&view, &options, &Unwatched).expect("not cancelled");
    let height = rows.map_or(camera.height, |[first, end]| end - first);
    let pixels = f64::from(camera.width * height);
    println!(
        "{} × {} px: {:.2} clusters and {:.1} members a pixel, {:.1} s",
        camera.width,
        height,
        clusters.list.len() as f64 / pixels,
        clusters.members.len() as f64 / pixels,
        processor_seconds()
    );
    let scene = ApertureScene {
        view: &view,
        clusters: &clusters,
        points: &[],
        ray_end: &|_, _| f64::INFINITY,
        margin_px: 0,
        coarse_below_px2: number(4).unwrap_or(0.0) as f32,
        rays_per_px: number(5).unwrap_or(1.0) as u32,
    };
    let images = aperture_images(&scene, 8, &Unwatched).expect("not cancelled");
    let sums = (0..clusters.list.len()).map(|cluster| images.shares(cluster).map(f64::from).sum::<f64>());
    let seen: Vec<f64> = sums.filter(|sum| *sum > 0.0).collect();
    println!(
        "{} clusters are seen, mean share {:.9}, {:.1} s",
        seen.len(),
        seen.iter().sum::<f64>() / 64.0 / seen.len() as f64,
        processor_seconds()
    );
}
