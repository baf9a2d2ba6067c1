//! Pictures with their references, embedded in the page.

use crate::measurement::contender::Contender;
use crate::measurement::record::Record;
use crate::output::markup::escaped;
use crate::output::plot::{seconds, significant};
use crate::report::Measured;
use crate::studies::left_out_photographs::Photographs;
use crate::summary::{FocusSummary, SceneSummary};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use baselines::ghost_free_depths;
use lens::Camera;
use session::SessionError;
use std::path::Path;

/// The reference, and one picture of every renderer with its error map.
///
/// # Errors
/// A picture cannot be read.
pub fn figures(
    scene: &SceneSummary,
    focus: &FocusSummary,
    measured: &[&Measured],
) -> Result<String, SessionError> {
    let reference = focus.reference.error;
    let caption = format!(
        "<b>reference</b>: {} rays a pixel, {}; its own error {:.1} dB",
        reference.spp,
        seconds(reference.seconds),
        reference.psnr
    );
    let mut html = format!(
        "<div class=\"pictures\"><figure>{}<figcaption>{caption}</figcaption></figure>\n",
        image_element(&focus.picture, "reference")?
    );
    for shown in select_shown(measured) {
        let Some([picture, flip]) = &shown.pictures else { continue };
        let Record { renderer, psnr, flip: mean_flip, seconds: took, .. } = &shown.record;
        let value = significant(shown.record.value);
        let knob = match shown.record.knob.as_str() {
            "" => String::new(),
            "tolerance_px" => format!(", tolerance {value} px"),
            "views_a_side" => format!(", {value} × {value} views"),
            "rays_a_sample" => format!(", {value} rays a sample"),
            knob => format!(", {value} {knob}"),
        };
        let again = match shown.record.bake_seconds {
            Some(_) => format!(", refocus {}", seconds(shown.record.picture_seconds)),
            None => String::new(),
        };
        let caption = format!(
            "<b>{renderer}</b>{}: {psnr:.1} dB, FLIP {mean_flip:.4}, {}{again}{}",
            escaped(&knob),
            seconds(*took),
            ghosting(&scene.camera, &shown.record)
        );
        html += &format!(
            "<figure>{}{}<figcaption>{caption}</figcaption></figure>\n",
            image_element(picture, &format!("{renderer}{knob}"))?,
            image_element(flip, &format!("FLIP error of {renderer}{knob}"))?
        );
    }
    Ok(html + "</div>")
}

/// The splat at its default tolerance, the ray tracer with the number of rays that takes the most similar time,
/// and every other renderer at its smallest error.
fn select_shown<'a>(measured: &[&'a Measured]) -> Vec<&'a Measured> {
    let usual = Contender::default_splat();
    let splat = measured
        .iter()
        .find(|m| m.record.renderer == usual.renderer() && m.record.value == usual.knob_value())
        .copied();
    let target = splat.map_or(1.0, |splat| splat.record.seconds);
    let away = |m: &Measured| (m.record.seconds / target).ln().abs();
    let truths = measured.iter().filter(|m| m.record.renderer == "truth").copied();
    let truth = truths.min_by(|a, b| away(a).total_cmp(&away(b)));
    let mut shown: Vec<_> = splat.into_iter().chain(truth).collect();
    for m in measured.iter().filter(|m| !["splat", "truth"].contains(&m.record.renderer.as_str())) {
        match shown.iter_mut().find(|chosen| chosen.record.renderer == m.record.renderer) {
            Some(chosen) if chosen.record.rmse > m.record.rmse => *chosen = m,
            Some(_) => {}
            None => shown.push(m),
        }
    }
    shown
}

/// The depths at which pinhole views ghost: where the copies of neighbouring views are more than a pixel apart.
/// Empty for other renderers.
fn ghosting(camera: &Camera, record: &Record) -> String {
    if record.knob != "views_a_side" {
        return String::new();
    }
    let views_a_side = record.value as u32;
    let [nearest, farthest] = ghost_free_depths(camera, views_a_side);
    let far = if farthest.is_finite() { significant(farthest) } else { "infinity".into() };
    format!(
        ". <b>Ghosts</b> beyond the bound of {views_a_side} views a side: circles of confusion over {views_a_side} px, \
         unpainted those of depths outside {} to {far}",
        significant(nearest)
    )
}

/// The photographs that were left out, each with its reconstruction from light below.
///
/// # Errors
/// A picture cannot be read.
pub fn left_out(photographs: &Photographs) -> Result<String, SessionError> {
    let mut html = String::from("<div class=\"pictures\">\n");
    let light = photographs.reconstructions.iter().filter(|reconstruction| reconstruction.method == "light");
    for (reconstruction, [photograph, shown]) in light.zip(&photographs.pictures) {
        let name = escaped(&reconstruction.photograph);
        html += &format!(
            "<figure>{}{}<figcaption><b>{name}</b>, and below it the light of the others: {:.1} dB, FLIP \
             {:.4}</figcaption></figure>\n",
            image_element(photograph, &reconstruction.photograph)?,
            image_element(shown, &format!("{} by the light of the others", reconstruction.photograph))?,
            reconstruction.psnr,
            reconstruction.flip
        );
    }
    Ok(html + "</div>\n")
}

/// An image element with embedded data.
fn image_element(file: &Path, what: &str) -> Result<String, SessionError> {
    let bytes = std::fs::read(file).map_err(|error| SessionError::io(file, &error))?;
    let data = BASE64_STANDARD.encode(bytes);
    Ok(format!(r#"<img alt="{}" src="data:image/png;base64,{data}">"#, escaped(what)))
}
