//! Dispatching commands.

use crate::commands::{Command, Event};
use crate::error::SessionError;
use crate::session::stage_change::{ChangeCause, StageChange};
use crate::session::state::{LIGHT_JOB, PREVIEW_JOB, SPARE_JOB, Session};
use document::CameraEdit;
use focus::FillTarget;
use project::FocusHold;

impl Session {
    /// Carries out `command`, or starts it in the background.
    ///
    /// # Errors
    /// No document is open, the command's values are invalid, a file cannot be used, or no thread can be started. Errors of background work
    /// are reported as [`Event::Failed`].
    pub fn apply(&mut self, command: Command) -> Result<(), SessionError> {
        match command {
            Command::Open(path) => self.open(path),
            Command::OpenCapture(path, choices) => self.open_capture(path, choices),
            Command::OpenTemplate(path) => self.open_template(path),
            Command::Undo => self.step_back(),
            Command::Redo => self.step_forward(),
            Command::GoToHistoryStep(steps) => self.go_to(steps),
            Command::ApplyRecordedStep(step) => self.apply_recorded_step(&step),
            Command::EditCamera(edit) => self.edit_camera(edit),
            Command::EditBookmarks(edit) => {
                self.document_mut()?.edit_bookmarks(edit);
                Ok(())
            }
            Command::GoToBookmark(number) => self.go_to_bookmark(number),
            Command::FinishEdit => {
                self.document_mut()?.undo.finish_run();
                Ok(())
            }
            Command::GoToTime(seconds) => self.go_to_time(seconds),
            Command::SetLensMotion(name, motion) => self.set_lens_motion(name, motion),
            Command::RackFocus { points, seconds, ease } => self.rack(points, seconds, ease),
            Command::SetView(view) => {
                self.document_mut()?.view = view;
                Ok(())
            }
            Command::SetExposure(exposure) => {
                self.document_mut()?.exposure = exposure;
                self.show_tone();
                Ok(())
            }
            Command::SetBackFaces(back_faces) => self.rebuild_stage(StageChange::BackFaces(back_faces)),
            Command::SetWorld(world) => self.rebuild_stage(StageChange::World(world)),
            Command::LoadEnvironment(file) => self.rebuild_stage(StageChange::Environment(file)),
            Command::SetVariant(name) => {
                self.rebuild_stage(StageChange::Variant { name, cause: ChangeCause::Command })
            }
            Command::EditSplats(name, edit) => {
                self.rebuild_stage(StageChange::Splats { name, edit, cause: ChangeCause::Command })
            }
            Command::SetFloor(is_shown) => {
                self.rebuild_stage(StageChange::Floor { is_shown, cause: ChangeCause::Command })
            }
            Command::HideSelectedSplats => self.hide_selected_splats(),
            Command::SetDisplay(display) => {
                self.display = display;
                self.show_tone();
                Ok(())
            }
            Command::SetSubAperture(point) => {
                self.set_sub_aperture(point);
                Ok(())
            }
            Command::SetPreviewSize(size) => {
                self.options.preview_size = size.max(1);
                self.show_camera();
                Ok(())
            }
            Command::SetTolerance(tolerance) => {
                self.tolerance = tolerance;
                self.preview_thread.set_tolerance(tolerance);
                Ok(())
            }
            Command::SetBrush(brush) => match brush.problem() {
                Some(problem) => Err(SessionError::BadInput(format!("brush: {problem}"))),
                None => {
                    self.document_mut()?.brush = brush;
                    Ok(())
                }
            },
            Command::BeginStroke(point) => self.begin_stroke(point),
            Command::ExtendStroke(point) => self.extend_stroke(point),
            Command::CommitStroke => self.commit_stroke(),
            Command::AbortStroke => self.abort_stroke(),
            Command::EditLayers(edit) => self.edit_layers(edit),
            Command::ActivateLayer(index) => self.activate_layer(index),
            Command::Fill(region, focus) => self.fill(region, focus),
            Command::ResetMap => self.reset_map(),
            Command::SetBackgroundFocus(focus) => self.fill_targets(vec![FillTarget::Background], focus),
            Command::RepairDepth(stroke) => self.repair_depth(stroke),
            Command::DragGradient(gradient) => self.drag_gradient(gradient),
            Command::Select(shape, combine) => self.select(shape, combine),
            Command::Spread(settings) => self.spread(settings),
            Command::ShowStrokes => self.show_strokes(),
            Command::MaskFromSelection => self.mask_selected(),
            Command::SelectRegion(region, combine) => self.select_region(region, combine),
            Command::FocusHere(hit) => {
                self.edit_camera(CameraEdit::FocusOn(FocusHold::Point(hit.position)))?;
                self.document_mut()?.undo.finish_run();
                Ok(())
            }
            Command::Fixate(hit) => {
                self.document_mut()?;
                self.fixation_point = hit.map(|hit| hit.position);
                Ok(())
            }
            Command::Pick(hit) => {
                let Some(focus) = self.focus_at(&hit) else { return Err(SessionError::NothingOpen) };
                self.document_mut()?.brush.target = focus;
                self.events.push(Event::BrushChanged);
                Ok(())
            }
            Command::Bake => {
                self.document_mut()?;
                self.preview_thread.bake();
                Ok(())
            }
            Command::Cancel(PREVIEW_JOB) => {
                self.preview_thread.cancel();
                Ok(())
            }
            Command::Cancel(LIGHT_JOB | SPARE_JOB) => {
                self.preview_thread.pause_background();
                Ok(())
            }
            Command::Cancel(id) => {
                self.jobs.iter().filter(|job| job.id == id).for_each(|job| job.progress.cancel());
                Ok(())
            }
            Command::CancelAll => {
                self.preview_thread.cancel();
                self.jobs.iter().for_each(|job| job.progress.cancel());
                Ok(())
            }
            Command::Save => self.save(None),
            Command::SaveAs(path) => self.save(Some(path)),
            Command::ExportPicture(path, export) => self.export_picture(path, export),
            Command::ExportShown(path) => self.export_shown(path),
            Command::ExportWebPage(path) => self.export_web_page(path),
            Command::ExportEnginePage(path) => self.export_engine_page(path),
            Command::ExportFocusMap(path) => self.export_focus_map(path),
            Command::ExportScene(path) => self.export_scene(path),
            Command::ExportStrokes(path) => self.export_strokes(&path),
            Command::ImportFocusMap(path) => self.import_focus_map(path),
            Command::VerifyRegion(corners) => self.verify(corners),
            Command::EndVerification => {
                self.end_verification();
                Ok(())
            }
            Command::MakeReference { kind, samples_per_pixel } => {
                self.make_reference(kind, samples_per_pixel)
            }
        }
    }
}
