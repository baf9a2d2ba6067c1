//! Exporting the picture as a web page on which anyone can refocus it.

use crate::error::SessionError;
use crate::job_steps::JobSteps;
use crate::preview::Exporting;
use crate::session::job_outcome::JobOutcome;
use crate::session::state::Session;
use document::{Document, file_name};
use focus::Focus;
use render::{Caption, WebPageEstimate, WebPageOptions, estimate_web_page, export_web_page};
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
        let tone = self.tone();
        let preview = self.preview_thread.shared();
        let document = self.document_mut()?;
        let (lit, camera, focus) =
            (document.stage.lit.clone(), document.camera.clone(), painted_focus(document));
        let title = Path::new(&document.name()).with_extension("").display().to_string();
        let caption = Caption { title, ..Caption::default() };
        let options = WebPageOptions { caption, tone, ..WebPageOptions::default() };
        self.start_job(format!("drawing {}", file_name(&path)), move |progress| {
            let _export_guard = Exporting::new(&preview);
            let report = export_web_page(&path, &lit, &camera, &focus, &options, &JobSteps { progress })?;
            Ok(JobOutcome::FileWritten(path, report.warnings()))
        })?;
        Ok(())
    }
}

/// The document's focus as it is painted now.
fn painted_focus(document: &Document) -> Focus {
    let stage = &document.stage;
    Focus::from_atlas_map(stage.scene.clone(), stage.atlas.clone(), Arc::new(document.map.clone()))
}
