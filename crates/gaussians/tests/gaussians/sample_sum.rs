//! The picture that samples of splats make: for tests and figures, point by point of the aperture.

use gaussians::{
    ApertureScene, CloudBuilder, ClusterOptions, Clusters, GaussianCloud, GaussianPicture, GaussianView,
    Splat, aperture_images, cluster_picture,
};
use glam::{DVec2, Vec3};
use lens::{FocusOffset, Picture};
use progress::Unwatched;

/// The sum of the aperture images of samples, each a square of a pixel for every one of `points` of the aperture.
pub fn splat_samples(
    view: &GaussianView<'_>,
    clusters: &Clusters,
    cells: u32,
    points: u32,
) -> GaussianPicture {
    let scene = ApertureScene {
        view,
        clusters,
        points: &[],
        ray_end: &|_, _| f64::INFINITY,
        margin_px: margin_px(view),
        coarse_below_px2: 0.0,
        rays_per_px: 2,
    };
    let images = aperture_images(&scene, cells, &Unwatched).expect("not cancelled");
    let (camera, optics) = (view.camera(), view.optics());
    let mut picture = Picture::black(camera.width, camera.height);
    for (number, cluster) in clusters.list.iter().enumerate() {
        let (shares, radiance) = (images.shares(number).collect::<Vec<_>>(), images.radiance(number));
        let kappa = optics.kappa(cluster.inverse_depth, FocusOffset::STANDARD);
        for index in 0..points {
            let at = f64::from(index) + 0.5;
            let u = DVec2::from_angle(at * 2.399_963_229_728_653) * (at / f64::from(points)).sqrt();
            let cell =
                ((u + 1.0) / 2.0 * f64::from(cells)).min(DVec2::splat(f64::from(cells) - 1.0)).as_uvec2();
            let share = shares[(cell.y * cells + cell.x) as usize] / points as f32;
            let shift = kappa * optics.aperture_radius * u / optics.tan_half_yfov * optics.half_height_px;
            let corner = cluster.pixel + DVec2::new(shift.x, -shift.y) - 0.5;
            let (base, fraction) = (corner.floor(), corner - corner.floor());
            for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                let (x, y) = (base.x + dx, base.y + dy);
                if x < 0.0 || y < 0.0 || x >= f64::from(camera.width) || y >= f64::from(camera.height) {
                    continue;
                }
                let part = |at: f64, fraction: f64| if at == 0.0 { 1.0 - fraction } else { fraction };
                let weight = share * (part(dx, fraction.x) * part(dy, fraction.y)) as f32;
                let pixel = y as usize * camera.width as usize + x as usize;
                (0..3).for_each(|c| picture.radiance[pixel][c] += weight * radiance[c]);
                picture.coverage[pixel] += weight;
            }
        }
    }
    let alpha = picture.coverage.clone();
    GaussianPicture { picture, alpha }
}

/// The margin that samples need: the largest circle of confusion, px.
pub fn margin_px(view: &GaussianView<'_>) -> u32 {
    let optics = view.optics();
    let radius =
        |splat: u32| optics.splat_radius_px(optics.standard_kappa(1.0 / view.mean_depth(splat))).abs();
    (0..view.len() as u32).map(radius).fold(0.0, f64::max).ceil() as u32 + 2
}

/// The clusters of a picture, with the margin that they need.
pub fn clusters(view: &GaussianView<'_>, options: &ClusterOptions) -> Clusters {
    let options = ClusterOptions { margin_px: margin_px(view), ..*options };
    cluster_picture(view, &options, &Unwatched).expect("not cancelled")
}

/// The same splats, all white.
pub fn white(cloud: &GaussianCloud) -> GaussianCloud {
    let mut builder = CloudBuilder::new(0, cloud.len());
    let base_color = Vec3::splat(Splat::base_of_color(1.0));
    (0..cloud.len()).for_each(|index| builder.push(Splat { base_color, ..cloud.splat(index) }, &[]));
    builder.finish(cloud.traits())
}
