//! Photographs for comparison with pictures: undistorted, linear, with the exposure fitted to all photographs.

use crate::error::RenderError;
use crate::picture::photographed::{light_of_photographs, photographed_shares};
use crate::picture::pixel_ray::pixel_ray;
use document::{Input, camera_from_photograph, find_photograph};
use glam::{DVec2, DVec3, Vec3};
use lens::{Camera, Picture};
use light::Steps;
use project::Layer;
use rayon::prelude::*;
use scene::{LoadOptions, Photograph, View};
use slf::{Exposure, PhotographLight};
use trace::{Radiance, Tracer};

/// Points with at least this share count as photographed.
pub(crate) const MIN_PHOTOGRAPHED_SHARE: f32 = 0.5;

/// The photograph `name` of a capture as its camera ([`document::camera_from_photograph`]) would show it, and the layer `seen`: 1 where
/// the surface was photographed by others, 0 where it was not or the photograph shows nothing. For a photograph that the project
/// excludes, a gain per channel is fitted. Views of a light field keep their exposure.
///
/// # Errors
/// There is no photograph of that name, it cannot be read, or the light of the others cannot be solved.
pub fn render_photograph(
    input: &Input,
    name: &str,
    steps: &dyn Steps,
) -> Result<(Picture, Vec<Layer>), RenderError> {
    let scene = &input.scene;
    let view = find_photograph(scene, name).map_err(|what| RenderError::bad_file(&input.path, what))?;
    let lit = input.lit_scene()?;
    let light = light_of_photographs(&lit, steps)?;
    let camera = camera_from_photograph(scene.bounds(), view, &input.camera);
    photograph_picture(view, &camera, lit.tracer(), light.as_deref())
}

/// The photograph `view` as `camera` ([`document::camera_from_photograph`]) shows it, and the layer `seen` as in [`render_photograph`].
/// `light` is the light of the photographs, with or without this one; `None` for a surface that was made from a picture.
///
/// # Errors
/// The photograph cannot be read.
pub fn photograph_picture(
    view: &View,
    camera: &Camera,
    tracer: &Tracer,
    light: Option<&PhotographLight>,
) -> Result<(Picture, Vec<Layer>), RenderError> {
    let shown =
        view.read_photograph(&LoadOptions::default()).map_err(|e| RenderError::BadInput(e.to_string()))?;
    let reduction = (shown.width / camera.width.max(1)).max(1);
    let shown = shown.downsampled(reduction);
    let scene = tracer.scene();
    let photographed = photographed_shares(tracer, camera, light);
    let projection = PhotographProjection { camera, view, shown: &shown, reduction: f64::from(reduction) };
    let own = scene.views.iter().position(|other| other.name == view.name);
    let exposure = match (light, own) {
        (None, _) => Exposure::default(),
        (Some(light), Some(index)) => light.exposures()[index],
        (Some(light), None) => projection.fit_exposure(tracer, light, &photographed),
    };
    let pixels: Vec<_> =
        (0..camera.width * camera.height).into_par_iter().map(|n| projection.at(n)).collect();
    let radiance = |pixel: &Option<(DVec2, Vec3)>| {
        pixel.map_or([0.0; 3], |(at, value)| (value * exposure.to_radiance(view, at)).to_array())
    };
    let photographed =
        pixels.iter().zip(photographed).map(|(pixel, share)| if pixel.is_some() { share } else { 0.0 });
    let layer = Layer { name: "seen".into(), values: photographed.collect() };
    let picture = Picture {
        width: camera.width,
        height: camera.height,
        radiance: pixels.iter().map(radiance).collect(),
        coverage: vec![1.0; pixels.len()],
        colour_coverage: None,
    };
    Ok((picture, vec![layer]))
}

/// A photograph, and the camera that shows it.
struct PhotographProjection<'a> {
    camera: &'a Camera,
    view: &'a View,
    /// The photograph, downsampled by `reduction` per side.
    shown: &'a Photograph,
    reduction: f64,
}

impl PhotographProjection<'_> {
    /// Position and value of the photograph at a pixel of the camera.
    fn at(&self, number: u32) -> Option<(DVec2, Vec3)> {
        let ray = pixel_ray(self.camera, number);
        let at = self.view.project(ray.origin + ray.direction)?;
        self.view.lens.is_in_picture(at).then(|| (at, self.shown.sample(at / self.reduction)))
    }

    /// Fits a gain per channel to the light by least squares, where the surface was photographed and the sensor is not clipped.
    /// Vignetting is that of another photograph of the same lens. A channel that is clipped everywhere has the mean gain of the others.
    fn fit_exposure(&self, tracer: &Tracer, light: &PhotographLight, photographed: &[f32]) -> Exposure {
        let views = &tracer.scene().views;
        let of_lens = views.iter().position(|other| other.lens == self.view.lens);
        let vignetting_stops = of_lens.map_or([0.0; 2], |index| light.exposures()[index].vignetting_stops);
        let flat = Exposure { vignetting_stops, ..Exposure::default() };
        let limit = self.shown.clipping_level();
        let products = |number: u32| {
            let is_photographed = photographed[number as usize] >= MIN_PHOTOGRAPHED_SHARE;
            let (at, shown) = self.at(number).filter(|_| is_photographed)?;
            let ray = pixel_ray(self.camera, number);
            let hit = tracer.first_hit(&ray)?;
            let is_unclipped = DVec3::select(shown.cmplt(Vec3::splat(limit)), DVec3::ONE, DVec3::ZERO);
            let shown = (shown * flat.to_radiance(self.view, at)).as_dvec3() * is_unclipped;
            let light = light.total_outgoing(hit.point, ray.origin).as_dvec3();
            Some([shown * light, shown * shown])
        };
        // Summed in order, so that the result does not depend on the number of threads.
        let product_pairs: Vec<_> =
            (0..self.camera.width * self.camera.height).into_par_iter().filter_map(products).collect();
        let [both, square] =
            product_pairs.into_iter().fold([DVec3::ZERO; 2], |[a, b], [c, d]| [a + c, b + d]);
        let gain = |both: f64, square: f64| (both > 0.0 && square > 0.0).then(|| (square / both).log2());
        let gains: [Option<f64>; 3] = std::array::from_fn(|channel| gain(both[channel], square[channel]));
        let fitted_gains = gains.iter().flatten();
        let mean = fitted_gains.clone().sum::<f64>() / fitted_gains.count().max(1) as f64;
        Exposure { gain_stops: gains.map(|gain| gain.unwrap_or(mean)), vignetting_stops }
    }
}
