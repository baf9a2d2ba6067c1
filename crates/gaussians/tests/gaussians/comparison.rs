//! Pictures of another implementation, how far ours are from them, and wrong pictures that must be farther.

use gaussians::{CloudBuilder, Eye, GaussianCloud, GaussianPicture, GaussianView, Splat, render_pinhole};
use glam::{DVec2, Quat, Vec3};
use half::f16;
use progress::Unwatched;
use std::path::Path;

/// A picture of another implementation: linear radiance and coverage.
pub struct Reference {
    rgbc: Vec<[f32; 4]>,
}

impl Reference {
    /// Reads an array height × width × 4 of little-endian floats, as numpy writes it.
    pub fn read(file: &Path) -> Self {
        let bytes = std::fs::read(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let header = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        let text = String::from_utf8_lossy(&bytes[10..10 + header]);
        assert!(text.contains("'<f4'") && text.contains("'fortran_order': False"), "{text}");
        let floats =
            bytes[10 + header..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let floats: Vec<f32> = floats.collect();
        Self { rgbc: floats.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect() }
    }

    /// How near a picture is, dB of its radiance in [0, 1].
    pub fn psnr(&self, picture: &GaussianPicture) -> f64 {
        let radiance = &picture.picture.radiance;
        assert_eq!(radiance.len(), self.rgbc.len());
        psnr(self.rgbc.iter().zip(radiance).map(|(p, rgb)| ([p[0], p[1], p[2]], *rgb)))
    }

    /// The same of radiance over coverage.
    pub fn normalised_psnr(&self, picture: &GaussianPicture) -> f64 {
        let normal = |rgb: [f32; 3], coverage: f32| rgb.map(|c| c / coverage.max(1e-3));
        let ours = picture.picture.radiance.iter().zip(&picture.picture.coverage);
        psnr(self.rgbc.iter().zip(ours).map(|([r, g, b, coverage], (rgb, covered))| {
            (normal([*r, *g, *b], *coverage), normal(*rgb, *covered))
        }))
    }

    /// The same of another reference.
    pub fn psnr_of(&self, other: &Self) -> f64 {
        let rgb = |p: &[f32; 4]| [p[0], p[1], p[2]];
        psnr(self.rgbc.iter().zip(&other.rgbc).map(|(a, b)| (rgb(a), rgb(b))))
    }
}

/// Of two pictures of ours.
pub fn psnr_between(a: &GaussianPicture, b: &GaussianPicture) -> f64 {
    psnr(a.picture.radiance.iter().copied().zip(b.picture.radiance.iter().copied()))
}

/// The same of radiance over coverage.
pub fn normalised_psnr_between(a: &GaussianPicture, b: &GaussianPicture) -> f64 {
    let normal = |picture: &GaussianPicture, k: usize| {
        picture.picture.radiance[k].map(|c| c / picture.picture.coverage[k].max(1e-3))
    };
    psnr((0..a.alpha.len()).map(|k| (normal(a, k), normal(b, k))))
}

/// Of linear values in [0, 1], dB.
fn psnr(pairs: impl ExactSizeIterator<Item = ([f32; 3], [f32; 3])>) -> f64 {
    let count = 3.0 * pairs.len() as f64;
    let square = |(a, b): (f32, f32)| f64::from(a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).powi(2);
    let error: f64 = pairs.map(|(a, b)| a.into_iter().zip(b).map(square).sum::<f64>()).sum();
    -10.0 * (error / count).max(1e-12).log10()
}

/// Control: the pinhole's picture if the colour of each splat were decoded, instead of the sum of a ray.
pub fn each_splat_decoded(view: &GaussianView<'_>) -> GaussianPicture {
    let mut picture = render_pinhole(view, 1, &Unwatched).expect("not cancelled");
    let eye = Eye::new(view, DVec2::ZERO);
    let colors: Vec<Vec3> = (0..view.len() as u32).map(|splat| eye.decoded(eye.color(splat))).collect();
    let width = view.camera().width as usize;
    for (index, radiance) in picture.picture.radiance.iter_mut().enumerate() {
        let pixel = DVec2::new((index % width) as f64 + 0.5, (index / width) as f64 + 0.5);
        let hits = eye.hits(view.direction(DVec2::ZERO, pixel));
        let sum: Vec3 = hits.iter().map(|hit| hit.weight as f32 * colors[hit.splat as usize]).sum();
        *radiance = sum.to_array();
    }
    picture
}

/// The cloud, its rotations and coefficients changed.
fn changed(cloud: &GaussianCloud, change: impl Fn(Quat, Vec<f32>) -> (Quat, Vec<f32>)) -> GaussianCloud {
    let mut builder = CloudBuilder::new(cloud.degree(), cloud.len());
    for index in 0..cloud.len() {
        let coefficients = cloud.coefficients(index).iter().copied().map(f16::to_f32).collect();
        let (rotation, coefficients) = change(cloud.splat(index).rotation, coefficients);
        builder.push(Splat { rotation, ..cloud.splat(index) }, &coefficients);
    }
    builder.finish(cloud.traits())
}

/// Control: as if red, green and blue of a coefficient were beside each other in a PLY file.
pub fn interleaved(cloud: &GaussianCloud) -> GaussianCloud {
    changed(cloud, |rotation, values| {
        let count = values.len() / 3;
        let in_file = |k: usize| values[k % count * 3 + k / count];
        (rotation, (0..values.len()).map(in_file).collect())
    })
}

/// Control: as if the four numbers of a rotation were x y z w in a PLY file.
pub fn scalar_last(cloud: &GaussianCloud) -> GaussianCloud {
    changed(cloud, |q, values| (Quat::from_xyzw(q.w, q.x, q.y, q.z), values))
}
