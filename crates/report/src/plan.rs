//! The plan of measurements: for every scene a list of settings, each with the contenders that draw it.

use crate::measurement::contender::Contender;
use crate::measurement::record::Series;
use crate::number_text::significant;
use crate::options::ReportOptions;
use crate::subject::Subject;
use lens::Camera;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// A picture to draw; the pictures of all contenders are compared with one reference.
pub struct Setting {
    /// The series it belongs to.
    pub series: Series,
    /// Index of the subject's focus.
    pub focus: usize,
    /// The camera with its size and aperture.
    pub camera: Camera,
    /// Number of times every triangle is subdivided into four.
    pub cuts: u32,
    /// Rays per pixel of the reference.
    pub reference_spp: u32,
    /// The contenders that draw it.
    pub contenders: Vec<Contender>,
}

/// Largest number of triangles of a subdivided scene.
const MAX_TRIANGLES: usize = 2_000_000;

/// Factor by which references of cost series have fewer rays.
const COST_REFERENCE_SHARE: u32 = 8;

/// Rays per pixel of the ray tracer in cost series.
const COST_SPP: u32 = 64;

/// Views per side of the aperture in cost series.
const COST_VIEWS_A_SIDE: u32 = 5;

/// How far splats are dilated in cost series, in radii of the circle of confusion.
const COST_SIGMA_RADII: f64 = 1.0;

/// Index of the standard focus.
const STANDARD_FOCUS: usize = 0;

/// A sentence that describes the cost series.
pub fn cost_note() -> String {
    let splat = Contender::default_splat();
    format!(
        "Cost is measured under the standard lens: the splat at a tolerance of {} px, the ray tracer with {COST_SPP} rays per pixel, \
         {COST_VIEWS_A_SIDE} × {COST_VIEWS_A_SIDE} views.",
        significant(splat.knob_value())
    )
}

/// All settings of a subject.
pub fn plan_settings(subject: &Subject, options: &ReportOptions) -> Vec<Setting> {
    let has_splats = subject.scene.splats.is_some();
    let base = |series, focus, camera| Setting {
        series,
        focus,
        camera,
        cuts: 0,
        reference_spp: options.reference_spp,
        contenders: Vec::new(),
    };
    let mut settings: Vec<Setting> = (0..subject.focuses.len())
        .map(|focus| Setting {
            contenders: knob_sweep(options.is_quick, has_splats),
            ..base(Series::Knob, focus, subject.camera.clone())
        })
        .collect();

    let cost = |series, camera| Setting {
        reference_spp: (options.reference_spp / COST_REFERENCE_SHARE).max(ReportOptions::MIN_REFERENCE_SPP),
        contenders: vec![
            Contender::default_splat(),
            Contender::Truth { samples_per_pixel: COST_SPP },
            Contender::Blur,
            match has_splats {
                true => Contender::Dilation { sigma_radii: COST_SIGMA_RADII },
                false => Contender::Views { views_a_side: COST_VIEWS_A_SIDE },
            },
        ],
        ..base(series, STANDARD_FOCUS, camera)
    };
    let factors: &[f64] = if options.is_quick { &[0.5, 1.0] } else { &[0.25, 0.5, 1.0, 2.0] };
    settings.extend(factors.iter().map(|factor| {
        let aperture_radius = subject.camera.aperture_radius * factor;
        cost(Series::Aperture, Camera { aperture_radius, ..subject.camera.clone() })
    }));
    let factors: &[f64] = if options.is_quick { &[0.5, 1.0] } else { &[0.5, FRAC_1_SQRT_2, 1.0, SQRT_2] };
    settings.extend(factors.iter().map(|factor| {
        let scaled =
            |side: u32| ((f64::from(side) * factor).round() as u32).clamp(1, Camera::LARGEST_SIDE_PX);
        let (width, height) = (scaled(subject.camera.width), scaled(subject.camera.height));
        cost(Series::PictureSize, Camera { width, height, ..subject.camera.clone() })
    }));
    let max_cuts = match options.is_quick {
        // Splats cannot be cut.
        _ if has_splats => 0,
        true => 1,
        false => 2,
    };
    let fits = |cuts: &u32| subject.scene.triangles.len() << (2 * cuts) <= MAX_TRIANGLES;
    settings.extend(
        (0..=max_cuts)
            .filter(|cuts| *cuts == 0 || fits(cuts))
            .map(|cuts| Setting { cuts, ..cost(Series::SceneSize, subject.camera.clone()) }),
    );
    settings
}

/// Every contender with several values of its knob: of scenes with splats those that draw them, of others those that do not need them.
fn knob_sweep(is_quick: bool, has_splats: bool) -> Vec<Contender> {
    let tolerances: &[f64] = if is_quick { &[2.0, 0.0] } else { &[8.0, 4.0, 2.0, 1.0, 0.5, 0.0] };
    let spps: &[u32] = if is_quick { &[4, 16, 64] } else { &[4, 8, 16, 32, 64, 128, 256] };
    let splats = tolerances.iter().map(|&tolerance_px| Contender::Splat { tolerance_px });
    let truths = spps.iter().map(|&samples_per_pixel| Contender::Truth { samples_per_pixel });
    let layers: &[u32] = if is_quick { &[32] } else { &[8, 32, 128] };
    let views: &[u32] = if is_quick { &[5] } else { &[3, 5, 9] };
    let rays: &[u32] = if is_quick { &[16] } else { &[16, 64, 256] };
    let layers = layers.iter().map(|&layers| Contender::Layers { layers });
    let views = views.iter().filter(|_| !has_splats).map(|&views_a_side| Contender::Views { views_a_side });
    // As wide as a disc, as Spark, and as splat-transform draws it.
    let sigmas: &[f64] = if has_splats { &[0.5, 1.0, 2.0] } else { &[] };
    let dilations = sigmas.iter().map(|&sigma_radii| Contender::Dilation { sigma_radii });
    let scatters = rays.iter().map(|&rays_a_sample| Contender::Scatter { rays_a_sample });
    splats
        .chain(truths)
        .chain([Contender::Blur])
        .chain(layers)
        .chain(views)
        .chain(dilations)
        .chain(scatters)
        .collect()
}
