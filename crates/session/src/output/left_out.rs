//! How well photographs of a capture tell one that was left out: light, and what it is to be better than.

use super::photograph_picture::{SEEN, photograph_picture};
use super::render::pixel_ray;
use crate::document::{Input, camera_of_photograph};
use crate::error::SessionError;
use crate::jobs::Steps;
use atlas::UnwrapOptions;
use glam::Vec3;
use lens::{Camera, Exposure};
use project::{LinearPicture, compare, psnr};
use rayon::prelude::*;
use scene::{Scene, SurfacePoint, View};
use slf::{PhotographLight, PhotographModel, PhotographOptions};
use std::sync::Arc;
use std::time::Instant;
use trace::{Radiance, Tracer};

/// What tells a photograph that was left out.
#[derive(Clone, Debug)]
pub struct ToldBy {
    /// `light`, `constant texture` or `texture of one photograph`.
    pub what: &'static str,
    /// PSNR where the others see the surface, dB; linear, clipped to [0, 1].
    pub psnr: f64,
    /// Mean FLIP there.
    pub flip: f64,
    /// What it shows; the photograph itself where nothing is seen.
    pub picture: LinearPicture,
}

/// A photograph that was left out.
#[derive(Clone, Debug)]
pub struct LeftOutPicture {
    /// Its name.
    pub name: String,
    /// The share of the frame where the others see the surface.
    pub seen: f64,
    /// The photograph as it is compared with: undistorted, linear, a gain a channel fitted to the light.
    pub photograph: LinearPicture,
    /// What tells it, the light first.
    pub told: Vec<ToldBy>,
}

/// What was measured by leaving photographs out.
#[derive(Clone, Debug)]
pub struct LeftOut {
    /// Each of them.
    pub pictures: Vec<LeftOutPicture>,
    /// Seconds that light of the others took.
    pub seconds: f64,
}

impl Input {
    /// Leaves `count` photographs out, evenly among those of the capture, and looks how the others tell them. Those that the project
    /// leaves out stay out.
    ///
    /// # Errors
    /// It is no capture of more than `count` photographs, one cannot be read, or it was cancelled.
    pub fn leave_photographs_out(
        &self,
        count: usize,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<LeftOut, SessionError> {
        let all = &self.scene.views;
        if all.len() <= count {
            let what = format!("has {} photographs ({} at least to leave {count} out)", all.len(), count + 1);
            return Err(SessionError::bad(&self.path, what));
        }
        let is_out = |number: usize| (0..count).any(|k| (2 * k + 1) * all.len() / (2 * count) == number);
        let (out, rest): (Vec<_>, Vec<_>) =
            all.iter().cloned().enumerate().partition(|(number, _)| is_out(*number));
        let views = |numbered: Vec<(usize, View)>| numbered.into_iter().map(|(_, view)| view).collect();
        let (out, rest): (Vec<View>, Vec<View>) = (views(out), views(rest));
        let scene = Arc::new(Scene { views: rest.clone(), ..Scene::clone(&self.scene) });
        let atlas = self.atlas(unwrap, steps)?;
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
            .map_err(|error| SessionError::BadInput(error.to_string()))
        };
        let start = Instant::now();
        let light = solved(PhotographModel::Light)?;
        let seconds = start.elapsed().as_secs_f64();
        let one_view = solved(PhotographModel::OneView)?;
        let told = |view| self.left_out_picture(view, &tracer, &light, &one_view);
        Ok(LeftOut { pictures: out.iter().map(told).collect::<Result<_, _>>()?, seconds })
    }

    fn left_out_picture(
        &self,
        view: &View,
        tracer: &Tracer,
        light: &PhotographLight,
        one_view: &PhotographLight,
    ) -> Result<LeftOutPicture, SessionError> {
        let camera = camera_of_photograph(tracer.scene().bounds(), view, &self.camera);
        let (photograph, mut layers) = photograph_picture(view, &camera, tracer, Some(light))?;
        let photograph = LinearPicture::of(&photograph, Exposure::Conserve);
        let is_seen: Vec<bool> = layers.remove(0).values.into_iter().map(|seen| seen >= SEEN).collect();
        let seen = is_seen.iter().filter(|&&seen| seen).count() as f64 / is_seen.len().max(1) as f64;
        let from = view.position();
        let told = |what, radiance: &(dyn Fn(SurfacePoint) -> Vec3 + Sync)| {
            let picture = shown(tracer, &camera, &photograph, &is_seen, radiance);
            let compared = compare(&picture, &photograph)?;
            // Elsewhere there is no difference.
            let within = |mean: f64| if seen > 0.0 { mean / seen } else { 0.0 };
            Ok(ToldBy {
                what,
                psnr: psnr(within(compared.rmse.powi(2))),
                flip: within(compared.flip),
                picture,
            })
        };
        let told = [
            told("light", &|point| light.toward(point, from)),
            told("constant texture", &|point| light.constant(point)),
            told("texture of one photograph", &|point| one_view.constant(point)),
        ];
        let told = told.into_iter().collect::<Result<_, SessionError>>()?;
        Ok(LeftOutPicture { name: view.name.clone(), seen, photograph, told })
    }
}

/// What the surface sends through a pinhole where it is seen, elsewhere the photograph.
fn shown(
    tracer: &Tracer,
    camera: &Camera,
    photograph: &LinearPicture,
    is_seen: &[bool],
    radiance: &(dyn Fn(SurfacePoint) -> Vec3 + Sync),
) -> LinearPicture {
    let of_pixel = |(number, (&photograph, &is_seen)): (usize, (&[f32; 3], &bool))| {
        let hit = is_seen.then(|| tracer.first_hit(&pixel_ray(camera, number as u32))).flatten();
        hit.map_or(photograph, |hit| radiance(hit.point).to_array())
    };
    let rgb = photograph.rgb.par_iter().zip(is_seen).enumerate().map(of_pixel).collect();
    LinearPicture { rgb, ..photograph.clone() }
}
