//! Exporting pictures: rendered at full size, from an existing light field if one is compatible, or as they are on screen.

use crate::error::SessionError;
use crate::exported_picture::PictureExport;
use crate::job_steps::JobSteps;
use crate::light_field::exceeds_margin;
use crate::preview::{Exporting, Quality, Shared};
use crate::session::job_outcome::JobOutcome;
use crate::session::state::Session;
use document::{Stage, file_name};
use focus::Focus;
use lens::{Camera, Picture};
use light::Steps;
use project::{Layer, PictureOptions, write_picture, write_rgb};
use render::{Aov, LightFieldStore, RenderOptions, Rendered, Tone, is_baked_for};
use salf::{Carried, Salf};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Whether there is a light field for a picture at full size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FullSizeFieldState {
    /// There is one.
    Ready,
    /// The live picture's light field is being made and will be compatible.
    InProgress,
    /// There is none: it has to be baked.
    Missing,
}

/// The light fields that need not be baked.
#[derive(Clone)]
pub(in crate::session) struct AvailableFields {
    stage: Arc<Stage>,
    /// That of the live picture.
    preview_field: Option<Arc<Salf>>,
    store: Option<LightFieldStore>,
    /// Who may be making another.
    preview: Arc<Shared>,
}

impl AvailableFields {
    /// One that shows what `camera` sees of `focus`, the margin included.
    fn find_covering(&self, camera: &Camera, focus: &Focus) -> Option<Arc<Salf>> {
        let from_preview = self.preview_field.clone().filter(|salf| is_baked_for(&salf.camera, camera));
        let candidate = from_preview.or_else(|| {
            let store = self.store.as_ref()?;
            let carried = Carried::for_focus(focus);
            let found = store.find(&self.stage, camera, 0.0, carried, self.preview.baked_on());
            found.map(|(salf, _)| Arc::new(salf))
        });
        candidate.filter(|salf| covers_focus(salf, camera, focus))
    }

    /// Renders a picture, exactly unless `options` say otherwise. What is baked for it is kept.
    pub(in crate::session) fn render(
        &self,
        camera: &Camera,
        focus: &Focus,
        options: &RenderOptions,
        steps: &dyn Steps,
    ) -> Result<Rendered, SessionError> {
        let lit = &self.stage.lit;
        let available = match self.find_covering(camera, focus) {
            // One bake at a time: what the live picture waits for is the smaller one, and may be the same.
            None => self
                .preview
                .wait_for_field(&self.stage, camera, &*steps.begin("baking the live picture"))?
                .filter(|salf| covers_focus(salf, camera, focus)),
            available => available,
        };
        let salf = match available {
            Some(salf) => salf,
            None => {
                let start = Instant::now();
                let usual = RenderOptions { bake_on: self.preview.bake_on(), ..RenderOptions::default() };
                let salf = Arc::new(usual.bake(lit, camera, focus, steps)?);
                if let Some(store) = &self.store {
                    store.save(&self.stage, &salf, 0, start.elapsed());
                }
                salf
            }
        };
        Ok(options.sum_light_field(salf, lit, camera, focus, steps)?)
    }
}

/// Whether a light field tells carried light finely enough, and its margin holds all that comes into the frame.
fn covers_focus(salf: &Salf, camera: &Camera, focus: &Focus) -> bool {
    salf.carried >= Carried::for_focus(focus) && !exceeds_margin(salf, camera, focus)
}

impl Session {
    /// The light fields of the document that need not be baked.
    pub(in crate::session) fn available_fields(&self, stage: Arc<Stage>) -> AvailableFields {
        let preview_field = self.light_field.as_ref().map(|field| field.salf.clone());
        let (store, preview) = (self.options.light_field_store.clone(), self.preview_thread.shared());
        AvailableFields { stage, preview_field, store, preview }
    }

    /// Whether an exported picture has to wait for a light field, judged without the paint.
    pub fn export_field_state(&self, export: &PictureExport) -> FullSizeFieldState {
        let Some(document) = &self.document else { return FullSizeFieldState::Missing };
        let camera = export.camera(&document.camera);
        let is_baked_for = |baked: &Camera| is_baked_for(baked, &camera);
        let is_preview_compatible =
            self.light_field.as_ref().is_some_and(|field| is_baked_for(&field.salf.camera));
        let store = self.options.light_field_store.as_ref();
        let baked_on = self.preview_thread.shared().baked_on();
        if is_preview_compatible || store.is_some_and(|store| store.has(&document.stage, &camera, baked_on)) {
            FullSizeFieldState::Ready
        } else if self.preview_camera.as_ref().is_some_and(is_baked_for)
            && self.preview_thread.shared().is_at_work()
        {
            FullSizeFieldState::InProgress
        } else {
            FullSizeFieldState::Missing
        }
    }

    /// Renders the live picture without tolerance. Blocks until it is done.
    ///
    /// # Errors
    /// Nothing is open, or rendering fails.
    pub fn exact_picture(&self) -> Result<Picture, SessionError> {
        let (Some(document), Some(preview)) = (self.document(), self.preview()) else {
            return Err(SessionError::NothingOpen);
        };
        let stage = document.stage.clone();
        let map = Arc::new(document.map.clone());
        let focus = Focus::from_atlas_map(stage.scene.clone(), stage.atlas.clone(), map);
        let available_fields = self.available_fields(stage);
        let options = RenderOptions::default();
        Ok(available_fields.render(&preview.camera, &focus, &options, &progress::Unwatched)?.picture)
    }

    pub(in crate::session) fn export_picture(
        &mut self,
        path: PathBuf,
        export: PictureExport,
    ) -> Result<(), SessionError> {
        let tone = self.tone();
        let document = self.document_mut()?;
        let (stage, camera) = (document.stage.clone(), export.camera(&document.camera));
        camera.validate().map_err(|error| SessionError::BadInput(error.to_string()))?;
        let focus =
            Focus::from_atlas_map(stage.scene.clone(), stage.atlas.clone(), Arc::new(document.map.clone()));
        let available_fields = self.available_fields(stage);
        let exporting = Exporting::new(&available_fields.preview);
        self.start_job(format!("rendering {}", file_name(&path)), move |progress| {
            let _export_guard = exporting;
            let aovs = [vec![Aov::Coverage], export.layers].concat();
            let options = RenderOptions { aovs, ..RenderOptions::default() };
            let rendered = available_fields.render(&camera, &focus, &options, &JobSteps { progress })?;
            write_displayed(&path, &rendered.picture, &rendered.layers, tone)?;
            Ok(JobOutcome::FileWritten(path, Vec::new()))
        })?;
        Ok(())
    }

    /// Writes the live picture as it is.
    pub(in crate::session) fn export_shown(&mut self, path: PathBuf) -> Result<(), SessionError> {
        let tone = self.tone();
        let preview = self.preview.as_ref().ok_or(SessionError::NothingOpen)?;
        if preview.quality == Quality::Coarse {
            let what = "the picture on screen is still rough (wait until the status line says live or exact; File, Export picture waits by itself)";
            return Err(SessionError::bad_file(&path, what));
        }
        let picture = preview.picture.clone();
        self.start_job(format!("writing {}", file_name(&path)), move |_| {
            let what = "the graphics card that held the picture was lost (try again once it is drawn anew)";
            let picture = picture.fetch().ok_or(SessionError::TryAgain(what.into()))?;
            write_displayed(&path, &picture, &[Layer::coverage(&picture)], tone)?;
            Ok(JobOutcome::FileWritten(path, Vec::new()))
        })?;
        Ok(())
    }

    /// How the screen shows the document.
    pub(in crate::session) fn tone(&self) -> Tone {
        let exposure = self.document.as_ref().map(|document| document.exposure).unwrap_or_default();
        Tone { exposure, display: self.display }
    }
}

/// Writes a picture: EXR with its layers and unchanged light, anything else as the screen shows it.
fn write_displayed(path: &Path, picture: &Picture, layers: &[Layer], tone: Tone) -> Result<(), SessionError> {
    let is_exr = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    if is_exr {
        write_picture(
            path,
            picture,
            layers,
            &PictureOptions { exposure: tone.exposure, ..PictureOptions::default() },
        )?;
    } else {
        write_rgb(path, picture.width, picture.height, &tone.displayed(picture))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::Exposure;
    use render::{Display, ToneCurve, to_screen};

    #[test]
    fn a_png_holds_what_the_screen_shows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shown.png");
        let mut picture = Picture::black(16, 4);
        for (k, (radiance, coverage)) in picture.radiance.iter_mut().zip(&mut picture.coverage).enumerate() {
            (*radiance, *coverage) = ([k as f32 * 0.02, 0.3, 0.01], 0.5 + (k % 7) as f32 * 0.1);
        }
        for (exposure, stops, curve) in [
            (Exposure::Normalise, 0.7, ToneCurve::Agx),
            (Exposure::Conserve, 0.0, ToneCurve::Clip),
            (Exposure::Normalise, -1.0, ToneCurve::Neutral),
        ] {
            let tone = Tone { exposure, display: Display { stops, curve } };
            write_displayed(&path, &picture, &[], tone).unwrap();
            let written = project::read_picture(&path).unwrap();
            let mut back = Picture::black(16, 4);
            (back.radiance, back.coverage) = (written.rgb, vec![1.0; 64]);
            let plain = Tone { exposure: Exposure::Conserve, display: Display::default() };
            for (written, shown) in to_screen(&back, plain).iter().zip(to_screen(&picture, tone)) {
                assert!((0..3).all(|c| written[c].abs_diff(shown[c]) <= 1), "{written:?} {shown:?}");
            }
        }
    }
}
