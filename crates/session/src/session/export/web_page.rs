//! Exporting the picture as a web page on which anyone can refocus it.

use crate::error::SessionError;
use crate::job_steps::JobSteps;
use crate::preview::Exporting;
use crate::session::job_outcome::JobOutcome;
use crate::session::state::Session;
use document::{Document, file_name};
use focus::Focus;
use lens::Camera;
use light::{LitScene, Steps};
use render::{
    Caption, RenderError, WebPageEstimate, WebPageOptions, WebPageReport, estimate_web_page,
    export_engine_page, export_web_page, usual_engine_camera,
};
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl Session {
    /// How large the web page of the document is going to be. `None` if nothing is open.
    pub fn web_page_estimate(&self) -> Option<WebPageEstimate> {
        let document = self.document.as_ref()?;
        let options = WebPageOptions::default();
        Some(estimate_web_page(&document.stage.lit, &document.camera, &painted_focus(document), &options))
    }

    pub(in crate::session) fn export_web_page(&mut self, path: PathBuf) -> Result<(), SessionError> {
        let camera = self.document_mut()?.camera.clone();
        self.export_page(path, camera, export_web_page)
    }

    pub(in crate::session) fn export_engine_page(&mut self, path: PathBuf) -> Result<(), SessionError> {
        let camera = usual_engine_camera(&self.document_mut()?.camera);
        self.export_page(path, camera, export_engine_page)
    }

    fn export_page(&mut self, path: PathBuf, camera: Camera, export: PageExport) -> Result<(), SessionError> {
        let tone = self.tone();
        let preview = self.preview_thread.shared();
        let document = self.document_mut()?;
        let (lit, focus) = (document.stage.lit.clone(), painted_focus(document));
        let title = Path::new(&document.name()).with_extension("").display().to_string();
        let caption = Caption { title, ..Caption::default() };
        let options = WebPageOptions { caption, tone, ..WebPageOptions::default() };
        self.start_job(format!("drawing {}", file_name(&path)), move |progress| {
            let _export_guard = Exporting::new(&preview);
            let report = export(&path, &lit, &camera, &focus, &options, &JobSteps { progress })?;
            Ok(JobOutcome::FileWritten(path, report.warnings()))
        })?;
        Ok(())
    }
}

/// Draws and writes a page.
type PageExport = fn(
    &Path,
    &Arc<LitScene>,
    &Camera,
    &Focus,
    &WebPageOptions,
    &dyn Steps,
) -> Result<WebPageReport, RenderError>;

/// The document's focus as it is painted now.
fn painted_focus(document: &Document) -> Focus {
    let stage = &document.stage;
    Focus::from_atlas_map(stage.scene.clone(), stage.atlas.clone(), Arc::new(document.map.clone()))
}
