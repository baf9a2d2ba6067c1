//! Executes the commands of the command table.

use super::Shell;
use crate::window::book::book_url;
use crate::window::dialogs::file_dialog::Purpose;
use crate::window::dialogs::unsaved_changes_dialog::PendingAction;
use crate::window::layout::{Arrangement, Layout, Pane};
use crate::window::tools::brush_gesture::BrushParameter;
use crate::window::views::paint_view::PaintView;
use crate::window::views::picture_view::TRUTH_SAMPLES;
use crate::window::widgets::brush_controls::{largest_radius, signed_circle_px};
use crate::window::{Tool, ViewSettings};
use document::{BookmarkEdit, CameraEdit, FillRegion};
use egui::{Context, OpenUrl, ViewportCommand};
use focus::{Brush, BrushMode, CombineMode, LayerEdit};
use lens::{Exposure, FocusOffset};
use project::{PresetKind, SelectionShape};
use session::{Command, CommandId, KeyMap, ReferenceKind};
use std::path::Path;

/// Scales of the user interface.
const SCALES: [f32; 8] = [0.75, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0];

/// Factor of the brush size per key press.
const SIZE_STEP: f64 = 1.15;
/// A third of a stop as a ratio of f-numbers: the sixth root of 2.
const THIRD_STOP: f64 = 1.122_462_048_309_373;
/// Factor of the focus distance per key press.
const DISTANCE_STEP: f64 = 1.05;
/// Step of the brush's blur on the blur map per key press.
const BLUR_STEP: f64 = 0.05;

impl Shell {
    /// Executes a command of the table, which must be possible.
    pub(super) fn execute(&mut self, id: CommandId, context: &Context) {
        match id {
            CommandId::Open => self.confirm_then(PendingAction::ChooseFile, context),
            CommandId::OpenCapture => self.confirm_then(PendingAction::ChooseCapture, context),
            CommandId::OpenDemo => self.confirm_then(PendingAction::OpenDemo, context),
            CommandId::Save => self.save(context),
            CommandId::SaveAs => self.open_file_dialog(Purpose::SaveAs, context),
            CommandId::ExportPicture => self.open_export_dialog(),
            CommandId::ExportShown => self.open_file_dialog(Purpose::ExportShown, context),
            CommandId::ExportWebPage => self.open_file_dialog(Purpose::ExportWebPage, context),
            CommandId::ExportEnginePage => self.open_file_dialog(Purpose::ExportEnginePage, context),
            CommandId::ExportFocusMap => self.open_file_dialog(Purpose::ExportFocusMap, context),
            CommandId::ExportScene => self.open_file_dialog(Purpose::ExportScene, context),
            CommandId::ExportStrokes => self.open_file_dialog(Purpose::ExportStrokes, context),
            CommandId::ImportFocusMap => self.open_file_dialog(Purpose::ImportFocusMap, context),
            CommandId::ImportPreset => {
                self.open_dialog_in_user_folder(Purpose::ImportPreset, Path::new(""), context)
            }
            CommandId::SaveBrushPreset => self.save_preset(PresetKind::Brush),
            CommandId::SaveLensPreset => self.save_preset(PresetKind::Lens),
            CommandId::SaveBokehPreset => self.save_preset(PresetKind::Bokeh),
            CommandId::Quit => self.confirm_then(PendingAction::Quit, context),
            CommandId::Undo => self.apply(Command::Undo),
            CommandId::Redo => self.apply(Command::Redo),
            CommandId::FrameAll => self.with_paint_view(|paint, document| paint.frame_all(document)),
            CommandId::FrameCursor => self.with_paint_view(|paint, document| paint.frame_cursor(document)),
            CommandId::ViewFromCamera => self.paint.view_through_camera(),
            CommandId::PictureFit => self.picture.fit(),
            CommandId::PictureActualSize => self.picture.actual_size(context.pixels_per_point()),
            CommandId::ShowFocus => self.settings.focus_share = ViewSettings::default().focus_share,
            CommandId::ShowSurface => self.settings.focus_share = 0.0,
            CommandId::ResetLayout => {
                self.layout = Layout::default();
            }
            CommandId::PaintAsNavigator => self.layout.arrange(Arrangement::Navigator),
            CommandId::PaintBeside => self.layout.arrange(Arrangement::SideBySide),
            CommandId::PaintAbove => self.layout.arrange(Arrangement::Stacked),
            CommandId::PictureAlone => self.layout.toggle_enlarged(Pane::Picture),
            CommandId::EnlargePanel => self.layout.toggle_enlarged(self.hovered_pane),
            CommandId::FloatPanel => self.layout.toggle_floating(self.hovered_pane),
            CommandId::FullScreen => {
                let is_full = context.input(|input| input.viewport().fullscreen.unwrap_or(false));
                context.send_viewport_cmd(ViewportCommand::Fullscreen(!is_full));
            }
            CommandId::ShowInspector => self.layout.toggle(Pane::Inspector),
            CommandId::ShowAtlas => self.layout.toggle(Pane::Atlas),
            CommandId::ShowAperture => {
                self.layout.toggle(Pane::Aperture);
                // The next click chooses the point.
                if self.layout.is_shown(Pane::Aperture) && !self.drawer.has_aperture_point() {
                    self.tool = Tool::Inspect;
                }
            }
            CommandId::ShowHistogram => self.layout.toggle(Pane::Histogram),
            CommandId::ShowPhotographs => self.layout.toggle(Pane::Photographs),
            CommandId::ShowTimeline => self.layout.toggle(Pane::Timeline),
            CommandId::NextToneCurve => self.settings.tone_curve = self.settings.tone_curve.next(),
            CommandId::LightOrDark => self.settings.light_theme = !self.settings.light_theme,
            CommandId::ScaleUp => self.change_scale(1),
            CommandId::ScaleDown => self.change_scale(-1),
            CommandId::ScaleReset => self.settings.scale = 1.0,
            CommandId::ShowGuides => self.settings.guides = !self.settings.guides,
            CommandId::ShowFocusPlane => self.settings.focus_plane = !self.settings.focus_plane,
            CommandId::Walk => {
                if let Some(document) = self.session.document() {
                    self.picture.walk.start(document);
                }
            }
            CommandId::KeysBlender => self.settings.key_map = KeyMap::Blender,
            CommandId::KeysSubstance => self.settings.key_map = KeyMap::Substance,
            CommandId::KeysKrita => self.settings.key_map = KeyMap::Krita,
            CommandId::Brush
            | CommandId::CurveBrush
            | CommandId::Smooth
            | CommandId::Sharpen
            | CommandId::Clone
            | CommandId::Erase
            | CommandId::FillPart
            | CommandId::FillMaterial
            | CommandId::FillChart
            | CommandId::Gradient
            | CommandId::DepthSpread
            | CommandId::DepthNearer
            | CommandId::DepthFarther
            | CommandId::DepthSmooth
            | CommandId::PlaceFocalPlane
            | CommandId::SharpHere
            | CommandId::SelectLasso
            | CommandId::SelectBox
            | CommandId::SelectObject
            | CommandId::SelectMaterial
            | CommandId::SelectChart
            | CommandId::SelectFacing
            | CommandId::SelectDepth
            | CommandId::SelectSimilar
            | CommandId::FocusHere
            | CommandId::FixateHere
            | CommandId::RackFocus
            | CommandId::Pick
            | CommandId::Inspect => self.choose_tool_of(id),
            CommandId::SelectAll => {
                self.apply(Command::Select(SelectionShape::Everything, CombineMode::Replace));
            }
            CommandId::InvertSelection => {
                self.apply(Command::Select(SelectionShape::Inverse, CombineMode::Replace));
            }
            CommandId::RefineSelection => {
                let width = self.settings.tools.refine_texels;
                self.apply(Command::Select(SelectionShape::Refined { width }, CombineMode::Replace));
            }
            CommandId::SpreadStrokes => self.apply(Command::Spread(self.settings.tools.spread)),
            CommandId::ShowStrokes => self.apply(Command::ShowStrokes),
            CommandId::MaskFromSelection => self.apply(Command::MaskFromSelection),
            CommandId::HideSelectedSplats => self.apply(Command::HideSelectedSplats),
            CommandId::ShowAllSplats => {
                let edit = self.session.document().and_then(|document| document.splat_edit_showing_all());
                if let Some(edit) = edit {
                    self.apply(Command::EditSplats("Show splats", edit.into()));
                }
            }
            CommandId::FillAll => {
                if let Some(target) = self.session.document().map(|document| document.brush.target) {
                    self.apply(Command::Fill(FillRegion::All, target));
                }
            }
            CommandId::ResetMap => self.apply(Command::ResetMap),
            CommandId::BrushSize => self.set_brush_number(BrushParameter::Size, context),
            CommandId::BrushStrength => self.set_brush_number(BrushParameter::Strength, context),
            CommandId::BrushHardness => self.set_brush_number(BrushParameter::Hardness, context),
            CommandId::BrushStronger => {
                self.edit_brush(|brush, _| brush.strength = (brush.strength + 0.1).min(1.0));
            }
            CommandId::BrushWeaker => {
                self.edit_brush(|brush, _| brush.strength = (brush.strength - 0.1).max(0.0));
            }
            CommandId::BrushLarger => {
                self.edit_brush(|brush, most| brush.radius = (brush.radius * SIZE_STEP).min(most))
            }
            CommandId::BrushSmaller => {
                self.edit_brush(|brush, most| brush.radius = (brush.radius / SIZE_STEP).max(most * 1e-4));
            }
            CommandId::BrushHarder => {
                self.edit_brush(|brush, _| brush.hardness = (brush.hardness + 0.1).min(1.0))
            }
            CommandId::BrushSofter => {
                self.edit_brush(|brush, _| brush.hardness = (brush.hardness - 0.1).max(0.0))
            }
            CommandId::BrushNearer => self.move_blur(-BLUR_STEP),
            CommandId::BrushFarther => self.move_blur(BLUR_STEP),
            CommandId::BrushSharp => self.edit_brush(|brush, _| {
                brush.target = FocusOffset::SHARP.with_gloss(brush.target.gloss);
            }),
            CommandId::ToggleAnchor => self.edit_brush(|brush, _| {
                brush.target.anchor = if brush.target.anchor < 0.5 { 1.0 } else { 0.0 };
            }),
            CommandId::ToggleGloss => self.edit_brush(|brush, _| {
                brush.target.gloss = if brush.target.gloss < 1.0 { 1.0 } else { 0.0 };
            }),
            CommandId::AddLayer => self.apply(Command::EditLayers(LayerEdit::AddPaint)),
            CommandId::AddDepthCurve => self.apply(Command::EditLayers(LayerEdit::AddCurve)),
            CommandId::AddFocalPlane => {
                self.apply(Command::EditLayers(LayerEdit::AddPlane));
                self.choose_tool_of(CommandId::PlaceFocalPlane);
            }
            CommandId::DuplicateLayer => self.edit_layer(LayerEdit::Duplicate),
            CommandId::RemoveLayer => self.edit_layer(LayerEdit::Remove),
            CommandId::RaiseLayer => self.edit_layer(|from| LayerEdit::Shift { from, to: from + 1 }),
            CommandId::LowerLayer => self.edit_layer(|from| LayerEdit::Shift { from, to: from - 1 }),
            CommandId::LayerAbove => self.activate_layer(1),
            CommandId::LayerBelow => self.activate_layer(-1),
            CommandId::AddMask => self.edit_layer(LayerEdit::AddMask),
            CommandId::InvertMask => self.edit_layer(LayerEdit::InvertMask),
            CommandId::RemoveMask => self.edit_layer(LayerEdit::RemoveMask),
            CommandId::OpenAperture => {
                self.edit_camera(|camera| CameraEdit::FNumber(camera.f_number() / THIRD_STOP))
            }
            CommandId::CloseAperture => {
                self.edit_camera(|camera| CameraEdit::FNumber(camera.f_number() * THIRD_STOP))
            }
            CommandId::FocusNearer => {
                self.edit_camera(|camera| CameraEdit::FocusDistance(camera.focus_distance / DISTANCE_STEP));
            }
            CommandId::FocusFarther => {
                self.edit_camera(|camera| CameraEdit::FocusDistance(camera.focus_distance * DISTANCE_STEP));
            }
            CommandId::CameraFromView => {
                let pose = self.paint.camera().pose();
                self.edit_camera(|_| CameraEdit::Pose(pose));
            }
            CommandId::BookmarkCamera => self.apply(Command::EditBookmarks(BookmarkEdit::Add)),
            CommandId::OrbitAperture => {
                let toggled = self.aperture_orbit.toggle(&mut self.session, context);
                self.show_failure(toggled);
            }
            CommandId::KeyLens => self.key_lens(),
            CommandId::KeyLayer => self.key_layer(),
            CommandId::RemoveKeys => self.remove_keys(),
            CommandId::PlayTimeline => {
                self.layout.open(Pane::Timeline);
                self.drawer.toggle_playing();
            }
            CommandId::Normalise => {
                if let Some(document) = self.session.document() {
                    let other = match document.exposure {
                        Exposure::Normalise => Exposure::Conserve,
                        Exposure::Conserve => Exposure::Normalise,
                    };
                    self.apply(Command::SetExposure(other));
                }
            }
            CommandId::Bake => self.apply(Command::Bake),
            CommandId::Verify => self.picture.verify.toggle_selecting(),
            CommandId::Wipe => self.picture.toggle_wipe(),
            CommandId::ShowStereo => self.picture.cycle_stereo(),
            CommandId::FixateFocus => self.apply(Command::Fixate(None)),
            CommandId::RenderTruth => {
                let kind = ReferenceKind::Truth;
                self.apply(Command::MakeReference { kind, samples_per_pixel: TRUTH_SAMPLES });
            }
            CommandId::Stop => self.apply(Command::CancelAll),
            CommandId::Palette => self.palette.toggle(),
            CommandId::Shortcuts => self.help.shortcuts = !self.help.shortcuts,
            CommandId::ShowMessages => self.toasts.is_list_open = !self.toasts.is_list_open,
            CommandId::Book => self.open_book(context),
            CommandId::About => self.help.about = !self.help.about,
        }
    }

    fn with_paint_view(&mut self, act: impl FnOnce(&mut PaintView, &document::Document)) {
        if let Some(document) = self.session.document() {
            act(&mut self.paint, document);
        }
    }

    /// Opens the book in the browser.
    fn open_book(&mut self, context: &Context) {
        match book_url() {
            Some(url) => context.open_url(OpenUrl::new_tab(url)),
            None => self
                .toasts
                .error("The book's pages are not there (\"cargo xtask book\" writes them in a source tree)."),
        }
    }

    /// Changes the scale of the user interface by steps of [`SCALES`].
    fn change_scale(&mut self, step: isize) {
        let at = SCALES.partition_point(|scale| *scale < self.settings.scale - 1e-3);
        let next = at.saturating_add_signed(step).min(SCALES.len() - 1);
        self.settings.scale = SCALES[next];
    }

    fn set_brush_number(&mut self, number: BrushParameter, context: &Context) {
        if let Some(document) = self.session.document() {
            self.gesture.begin(number, &document.brush, context);
        }
    }

    /// Activates the tool of a command.
    fn choose_tool_of(&mut self, id: CommandId) {
        let (Some(document), Some(tool)) = (self.session.document(), Tool::for_command(id)) else { return };
        // Returns from another tool's mode to one that paints the chosen focus.
        let paints_target =
            matches!(document.brush.mode, BrushMode::Set | BrushMode::Add | BrushMode::Subtract);
        let mode = tool.mode(if paints_target { document.brush.mode } else { BrushMode::Set });
        self.edit_brush(|brush, _| brush.mode = mode);
        self.tool = tool;
        self.rack_from = None;
    }

    /// Edits the active layer.
    fn edit_layer(&mut self, edit: impl FnOnce(usize) -> LayerEdit) {
        let Some(document) = self.session.document() else { return };
        let edit = edit(document.layers.active_index());
        self.apply(Command::EditLayers(edit));
    }

    fn activate_layer(&mut self, step: isize) {
        let Some(document) = self.session.document() else { return };
        if let Some(index) = document.layers.active_index().checked_add_signed(step) {
            self.apply(Command::ActivateLayer(index));
        }
    }

    fn edit_brush(&mut self, edit: impl FnOnce(&mut Brush, f64)) {
        let Some(document) = self.session.document() else { return };
        let mut brush = document.brush.clone();
        edit(&mut brush, largest_radius(document));
        self.apply(Command::SetBrush(brush));
    }

    fn edit_camera(&mut self, edit: impl FnOnce(&lens::Camera) -> CameraEdit) {
        let Some(document) = self.session.document() else { return };
        let edit = edit(&document.camera);
        self.apply(Command::EditCamera(edit));
        self.apply(Command::FinishEdit);
    }

    /// Moves the brush's blur on the blur map, stopping at sharp on the way.
    fn move_blur(&mut self, step: f64) {
        use crate::window::widgets::false_colour::{circle_px, position};
        let Some(document) = self.session.document() else { return };
        let optics = document.camera.optics();
        let before = position(signed_circle_px(&optics, document.brush.target.t));
        let mut after = (before + step).clamp(-1.0, 1.0);
        if before * after < 0.0 || after.abs() < BLUR_STEP / 4.0 {
            after = 0.0;
        }
        let kappa = optics.kappa_for_circle_px(circle_px(after));
        let t = kappa.and_then(|kappa| optics.offset_for_kappa(kappa, optics.inverse_focus_distance, 1.0));
        match t {
            Some(t) => self.edit_brush(|brush, _| brush.target.t = t),
            None => self.toasts.notice("A pinhole blurs nothing: open the aperture first."),
        }
    }
}
