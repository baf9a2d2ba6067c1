//! Cross-validation of captures: how well the light from the other photographs predicts one that was left out, compared with simple
//! baselines.

use crate::error::RenderError;
use crate::picture::photograph_picture::{MIN_PHOTOGRAPHED_SHARE, photograph_picture};
use crate::picture::pixel_ray::pixel_ray;
use atlas::UnwrapOptions;
use document::{Input, camera_from_photograph};
use glam::Vec3;
use lens::{Camera, Exposure};
use light::Steps;
use numerics::psnr;
use project::{LinearPicture, compare};
use rayon::prelude::*;
use scene::{Scene, SurfacePoint, View};
use slf::{PhotographLight, PhotographModel, PhotographOptions};
use std::sync::Arc;
use std::time::Instant;
use trace::{Radiance, Tracer};

/// A prediction of a photograph that was left out.
#[derive(Clone, Debug)]
pub struct LeftOutPrediction {
    /// `light`, `constant texture` or `texture of one photograph`.
    pub method: &'static str,
    /// PSNR where other photographs show the surface, dB, of linear values clipped to [0, 1].
    pub psnr: f64,
    /// Mean FLIP there.
    pub flip: f64,
    /// The prediction; equals the photograph where no other photograph shows the surface.
    pub picture: LinearPicture,
}

/// A photograph that was left out.
#[derive(Clone, Debug)]
pub struct LeftOutPicture {
    /// Its name.
    pub name: String,
    /// The share of the frame where other photographs show the surface, in [0, 1].
    pub visible_share: f64,
    /// The reference: the photograph undistorted, linear, with a gain per channel fitted to the light.
    pub photograph: LinearPicture,
    /// The predictions; the first is by the light.
    pub predictions: Vec<LeftOutPrediction>,
}

/// The results of leaving photographs out.
#[derive(Clone, Debug)]
pub struct LeftOut {
    /// The photographs that were left out.
    pub pictures: Vec<LeftOutPicture>,
    /// Time for solving the light from the others, s.
    pub seconds: f64,
}

/// Leaves `count` photographs out, evenly spaced among those of the capture, and measures how well the others predict them. Photographs
/// that the project excludes are not used at all.
///
/// # Errors
/// The input is not a capture of more than `count` photographs, a photograph cannot be read, or the work was cancelled.
pub fn leave_photographs_out(
    input: &Input,
    count: usize,
    unwrap: &UnwrapOptions,
    steps: &dyn Steps,
) -> Result<LeftOut, RenderError> {
    let all = &input.scene.views;
    if all.len() <= count {
        let what =
            format!("has {} photographs (leaving {count} out takes at least {})", all.len(), count + 1);
        return Err(RenderError::bad_file(&input.path, what));
    }
    let is_out = |number: usize| (0..count).any(|k| (2 * k + 1) * all.len() / (2 * count) == number);
    let (out, rest): (Vec<_>, Vec<_>) =
        all.iter().cloned().enumerate().partition(|(number, _)| is_out(*number));
    let views = |numbered: Vec<(usize, View)>| numbered.into_iter().map(|(_, view)| view).collect();
    let (out, rest): (Vec<View>, Vec<View>) = (views(out), views(rest));
    let scene = Arc::new(Scene { views: rest.clone(), ..Scene::clone(&input.scene) });
    let atlas = input.atlas(unwrap, steps)?;
    let tracer = Arc::new(Tracer::new(scene));
    let solved = |model: PhotographModel| {
        let options = PhotographOptions { model, ..PhotographOptions::default() };
        PhotographLight::solve(
            &tracer,
            &atlas,
            &rest,
            &options,
            &*steps.begin("light without some photographs"),
        )
        .map_err(|error| RenderError::BadInput(error.to_string()))
    };
    let start = Instant::now();
    let light = solved(PhotographModel::Light)?;
    let seconds = start.elapsed().as_secs_f64();
    let one_view = solved(PhotographModel::OneView)?;
    let predict = |view| left_out_picture(input, view, &tracer, &light, &one_view);
    Ok(LeftOut { pictures: out.iter().map(predict).collect::<Result<_, _>>()?, seconds })
}

fn left_out_picture(
    input: &Input,
    view: &View,
    tracer: &Tracer,
    light: &PhotographLight,
    one_view: &PhotographLight,
) -> Result<LeftOutPicture, RenderError> {
    let camera = camera_from_photograph(tracer.scene().bounds(), view, &input.camera);
    let (photograph, mut layers) = photograph_picture(view, &camera, tracer, Some(light))?;
    let photograph = LinearPicture::from_picture(&photograph, Exposure::Conserve);
    let is_visible: Vec<bool> =
        layers.remove(0).values.into_iter().map(|share| share >= MIN_PHOTOGRAPHED_SHARE).collect();
    let visible_share =
        is_visible.iter().filter(|&&is_visible| is_visible).count() as f64 / is_visible.len().max(1) as f64;
    let from = view.position();
    let predict = |method, radiance: &(dyn Fn(SurfacePoint) -> Vec3 + Sync)| {
        let picture = predicted(tracer, &camera, &photograph, &is_visible, radiance);
        let compared = compare(&picture, &photograph)?;
        // Elsewhere the difference is 0, so the mean over visible pixels is larger.
        let within = |mean: f64| if visible_share > 0.0 { mean / visible_share } else { 0.0 };
        Ok(LeftOutPrediction {
            method,
            psnr: psnr(within(compared.rmse.powi(2))),
            flip: within(compared.flip),
            picture,
        })
    };
    let predictions = [
        predict("light", &|point| light.total_outgoing(point, from)),
        predict("constant texture", &|point| light.constant(point)),
        predict("texture of one photograph", &|point| one_view.constant(point)),
    ];
    let predictions = predictions.into_iter().collect::<Result<_, RenderError>>()?;
    Ok(LeftOutPicture { name: view.name.clone(), visible_share, photograph, predictions })
}

/// The pinhole picture of the surface where it is visible; the photograph elsewhere.
fn predicted(
    tracer: &Tracer,
    camera: &Camera,
    photograph: &LinearPicture,
    is_visible: &[bool],
    radiance: &(dyn Fn(SurfacePoint) -> Vec3 + Sync),
) -> LinearPicture {
    let of_pixel = |(number, (&photograph, &is_visible)): (usize, (&[f32; 3], &bool))| {
        let hit = is_visible.then(|| tracer.first_hit(&pixel_ray(camera, number as u32))).flatten();
        hit.map_or(photograph, |hit| radiance(hit.point).to_array())
    };
    let rgb = photograph.rgb.par_iter().zip(is_visible).enumerate().map(of_pixel).collect();
    LinearPicture { rgb, ..photograph.clone() }
}
