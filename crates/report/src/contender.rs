//! The renderers that are measured, each with its knob.

use crate::stopwatch::{Timed, timed};
use focus::Focus;
use lens::{Camera, Picture};
use session::{RenderOptions, Renderer, SessionError, Steps, bake, render};
use splat::Splatter;
use std::sync::Arc;
use trace::Tracer;

/// A renderer and where its knob stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contender {
    /// The light field, baked and splatted.
    Splat {
        /// How coarse partial visibility may be, px.
        tolerance_px: f64,
    },
    /// Distributed ray tracing.
    Truth {
        /// Rays a pixel.
        samples_per_pixel: u32,
    },
    /// A blur of the pinhole picture by depth.
    Blur,
}

/// What a contender draws.
#[derive(Clone, Copy)]
pub struct Shot<'a> {
    /// The scene.
    pub tracer: &'a Arc<Tracer>,
    /// The camera.
    pub camera: &'a Camera,
    /// How it is focused.
    pub focus: &'a Focus,
}

/// What a contender drew, and what that took.
pub struct Drawn {
    /// The picture.
    pub picture: Picture,
    /// Seconds of the bake, where there is one.
    pub bake_seconds: Option<f64>,
    /// Seconds of everything else; the median of the repeats.
    pub picture_seconds: f64,
    /// How often the picture was drawn.
    pub repeats: u32,
    /// What is kept for the next picture, bytes.
    pub bytes: usize,
    /// Samples of the light field.
    pub samples: Option<usize>,
}

/// The measured ray tracer's seed: another one than the references'.
const MEASURED_SEED: u32 = 1;

impl Contender {
    /// The splat as it is unless asked otherwise.
    pub fn usual_splat() -> Self {
        Self::Splat { tolerance_px: RenderOptions::default().tolerance_px }
    }

    /// Its name.
    pub fn renderer(&self) -> &'static str {
        match self {
            Self::Splat { .. } => "splat",
            Self::Truth { .. } => "truth",
            Self::Blur => "blur",
        }
    }

    /// What it is, for the page.
    pub fn what(renderer: &str) -> &'static str {
        match renderer {
            "splat" => "the light field, splatted",
            "truth" => "distributed ray tracing",
            _ => "blur of the pinhole picture by depth",
        }
    }

    /// Its knob's name; empty where it has none.
    pub fn knob(&self) -> &'static str {
        match self {
            Self::Splat { .. } => "tolerance_px",
            Self::Truth { .. } => "spp",
            Self::Blur => "",
        }
    }

    /// Where its knob stands.
    pub fn value(&self) -> f64 {
        match self {
            Self::Splat { tolerance_px } => *tolerance_px,
            Self::Truth { samples_per_pixel } => f64::from(*samples_per_pixel),
            Self::Blur => 0.0,
        }
    }

    /// Draws the picture, again if that is quick.
    pub fn draw(&self, shot: Shot<'_>, steps: &dyn Steps) -> Result<Drawn, SessionError> {
        match self {
            Self::Splat { tolerance_px } => splat(shot, *tolerance_px, steps),
            Self::Truth { samples_per_pixel } => {
                let options = RenderOptions {
                    renderer: Renderer::Truth,
                    samples_per_pixel: *samples_per_pixel,
                    seed: MEASURED_SEED,
                    ..RenderOptions::default()
                };
                whole(shot, &options, shot.tracer.bytes(), steps)
            }
            Self::Blur => {
                let options = RenderOptions { renderer: Renderer::Blur, ..RenderOptions::default() };
                // A colour and a defocus a pixel.
                let pixels = shot.camera.width as usize * shot.camera.height as usize;
                whole(shot, &options, pixels * (size_of::<[f32; 3]>() + size_of::<f64>()), steps)
            }
        }
    }
}

/// A renderer that makes everything anew for every picture.
fn whole(
    shot: Shot<'_>,
    options: &RenderOptions,
    bytes: usize,
    steps: &dyn Steps,
) -> Result<Drawn, SessionError> {
    let drawn = timed(|| render(shot.tracer, shot.camera, shot.focus, options, steps))?;
    Ok(Drawn {
        picture: drawn.value.picture,
        bake_seconds: None,
        picture_seconds: drawn.seconds,
        repeats: drawn.repeats,
        bytes,
        samples: None,
    })
}

fn splat(shot: Shot<'_>, tolerance_px: f64, steps: &dyn Steps) -> Result<Drawn, SessionError> {
    let Shot { tracer, camera, focus } = shot;
    let baked = timed(|| bake(tracer, camera, focus, tolerance_px, steps))?;
    let salf = Arc::new(baked.value);
    let Timed { value: picture, seconds, repeats } = timed(|| {
        let mut splatter = Splatter::new(salf.clone());
        splatter.render(camera, focus, &*steps.begin("splatting"))?;
        Ok(splatter.picture().clone())
    })?;
    Ok(Drawn {
        picture,
        bake_seconds: Some(baked.seconds),
        picture_seconds: seconds,
        repeats,
        bytes: salf.statistics().bytes,
        samples: Some(salf.samples.len()),
    })
}
