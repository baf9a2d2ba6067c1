//! The header of a panel: its title, its display options, and its menu.

use crate::window::action::PanelCommand;
use crate::window::layout::{DockState, Pane};
use crate::window::views::picture_view::{DisplayedPicture, PictureView};
use crate::window::widgets::icon::{Icon, icon_button};
use crate::window::widgets::{controls, keys};
use crate::window::{Action, ViewSettings};
use egui::{Button, Ui};
use session::{CommandId, Session};

/// Smallest width of the picture's header that includes the scale in percent, points.
const WIDTH_WITH_PERCENT: f32 = 500.0;

/// Additional width if the header shows the fixated point, points.
const FIXATED_WIDTH: f32 = 80.0;

/// Least room for a slider in the navigator's header, points.
const WIDTH_WITH_SLIDER: f32 = 90.0;

/// Width of the panel's buttons, points.
const MENU_WIDTH: f32 = 60.0;

/// Size of the button that enlarges a panel, points.
const ENLARGE_BUTTON: egui::Vec2 = egui::vec2(22.0, 22.0);

/// The header of a panel.
pub struct ViewHeader<'a> {
    /// The panel.
    pub pane: Pane,
    /// How the panel is docked.
    pub docked: DockState,
    /// The session.
    pub session: &'a Session,
    /// The view settings.
    pub settings: &'a mut ViewSettings,
    /// The picture view.
    pub picture: &'a mut PictureView,
}

impl ViewHeader<'_> {
    /// Draws the header. Returns whether the panel is being dragged by its title.
    pub fn show(self, ui: &mut Ui, actions: &mut Vec<Action>) -> bool {
        let (pane, docked) = (self.pane, self.docked);
        // Panels other than the views have nothing in their header that is not on their tab.
        if pane.is_foldable() && docked == DockState::Tab {
            return false;
        }
        let margin = egui::Margin::symmetric(8, 3);
        let frame = match docked {
            DockState::Floating | DockState::Navigator => egui::Frame::new().fill(ui.visuals().panel_fill),
            _ => egui::Frame::new(),
        };
        let frame = frame.inner_margin(margin);
        let line = |ui: &mut Ui| {
            let spacing = std::mem::take(&mut ui.spacing_mut().item_spacing.x);
            // The menu stays at the right end, however the controls wrap.
            let menu_width = if docked == DockState::Tab { 0.0 } else { MENU_WIDTH };
            let width = ui.available_width() - menu_width;
            let wrapped = |ui: &mut Ui| {
                ui.set_width(width);
                ui.spacing_mut().item_spacing.x = spacing;
                ui.horizontal_wrapped(|ui| self.controls(ui, actions)).inner
            };
            let layout = egui::Layout::top_down(egui::Align::Min);
            let is_dragged = ui.allocate_ui_with_layout(egui::vec2(width, 0.0), layout, wrapped).inner;
            if docked != DockState::Tab {
                let layout = egui::Layout::right_to_left(egui::Align::Min);
                ui.with_layout(layout, |ui| {
                    panel_menu(ui, pane, docked, actions);
                    enlarge_button(ui, pane, docked, actions);
                });
            }
            is_dragged
        };
        let framed = frame.show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.horizontal_top(line).inner
        });
        framed.inner
    }

    /// Controls wrap in a narrow view, so that the header does not widen it.
    fn controls(self, ui: &mut Ui, actions: &mut Vec<Action>) -> bool {
        ui.spacing_mut().item_spacing.x = 5.0;
        let title = egui::RichText::new(self.pane.title()).strong();
        let is_dragged = match self.docked {
            DockState::Tiled => {
                let name = egui::Label::new(title).selectable(false).sense(egui::Sense::drag());
                let name = ui.add(name).on_hover_text("Drag to move this panel, also into tabs.");
                name.drag_started()
            }
            DockState::Enlarged | DockState::Navigator => {
                ui.add(egui::Label::new(title).selectable(false));
                false
            }
            DockState::Tab | DockState::Floating => false,
        };
        match self.pane {
            Pane::Paint if self.docked == DockState::Navigator => navigator_header(ui, self.settings),
            Pane::Paint => paint_header(ui, self.session, self.settings),
            Pane::Picture => picture_header(ui, self.session, self.picture, actions),
            _ => {}
        }
        is_dragged
    }
}

/// The button that shows a panel alone, and all again.
fn enlarge_button(ui: &mut Ui, pane: Pane, docked: DockState, actions: &mut Vec<Action>) {
    let is_alone = docked == DockState::Enlarged;
    let name = format!("Enlarge {}", pane.title().to_lowercase());
    let tip = if is_alone { "Show the other panels again." } else { "Show only this panel." };
    if icon_button(ui, Icon::Enlarge, &name, is_alone, ENLARGE_BUTTON).on_hover_text(tip).clicked() {
        actions.push(Action::Place(pane, PanelCommand::Enlarge));
    }
}

/// The menu of a panel.
pub fn panel_menu(ui: &mut Ui, pane: Pane, docked: DockState, actions: &mut Vec<Action>) {
    let response = ui.menu_button("…", |ui| {
        let mut entry = |ui: &mut Ui, name: &str, placing: PanelCommand, tip: &str| {
            if ui.button(name).on_hover_text(tip).clicked() {
                actions.push(Action::Place(pane, placing));
                ui.close();
            }
        };
        match docked {
            DockState::Enlarged => {
                entry(ui, "All panels", PanelCommand::Enlarge, "Show the other panels again.")
            }
            _ => entry(ui, "Enlarge", PanelCommand::Enlarge, "Show only this panel."),
        }
        match docked {
            DockState::Floating => entry(ui, "Dock", PanelCommand::Float, "Dock this panel again."),
            DockState::Navigator => {
                entry(ui, "Dock", PanelCommand::Float, "Put the paint view beside the picture.")
            }
            DockState::Enlarged => {}
            _ => entry(ui, "Float", PanelCommand::Float, "Make this panel float over the others."),
        }
        if pane.is_foldable() {
            entry(ui, "Close", PanelCommand::Close, "Close this panel; the View menu opens it again.");
        }
    });
    controls::set_accessible_name(&response.response, &format!("{} panel's menu", pane.title()));
    response.response.on_hover_text("Panel menu.");
}

fn paint_header(ui: &mut Ui, session: &Session, settings: &mut ViewSettings) {
    ui.label("Surface").on_hover_text("The scene's own colours.");
    false_color_slider(ui, settings);
    ui.label("Blur").on_hover_text("The false colour of blur.");
    ui.checkbox(&mut settings.contours, "Contours")
        .on_hover_text("Lines where the blur is 1, 4 and 16 px wide.");
    let Some(document) = session.document() else { return };
    if document.stage.scene.picture.is_some() {
        ui.checkbox(&mut settings.depth, "Depth").on_hover_text(
            "Depth: near yellow, far dark blue. Move the slider to Surface to see only depth; the tools of \
             the Copy depth family (U) repair it.",
        );
        ui.checkbox(&mut settings.photograph_counts, "Invented").on_hover_text(
            "Magenta: parts not visible in any picture, filled in from their surroundings. \
                            Move the slider to Surface to see only these.",
        );
    }
    if !document.stage.scene.views.is_empty() {
        ui.checkbox(&mut settings.photograph_counts, "Photographs").on_hover_text(
            "Number of photographs that show the surface: none magenta (its light is filled in from its surroundings), one dark blue, ten green, 32 and more \
             yellow. Move the slider to Surface to see only these colours.",
        );
    }
}

/// What the navigator has room for.
fn navigator_header(ui: &mut Ui, settings: &mut ViewSettings) {
    if ui.available_width() >= WIDTH_WITH_SLIDER {
        false_color_slider(ui, settings);
    }
}

fn false_color_slider(ui: &mut Ui, settings: &mut ViewSettings) {
    let mix = egui::Slider::new(&mut settings.focus_share, 0.0..=1.0).show_value(false);
    let tip =
        "From the scene's own colours (V) to the colours of blur (C): near orange, sharp white, far blue.";
    ui.spacing_mut().slider_width = 70.0;
    controls::set_accessible_name(&ui.add(mix).on_hover_text(tip), "Share of false colour");
}

/// A menu of pictures.
fn choose_picture(
    ui: &mut Ui,
    session: &Session,
    name: &str,
    choices: &[DisplayedPicture],
    shown: &mut DisplayedPicture,
) {
    let combo = egui::ComboBox::from_id_salt(name).selected_text(shown.name()).width(104.0);
    let combo = combo.wrap_mode(egui::TextWrapMode::Truncate);
    let response = combo.show_ui(ui, |ui| {
        for choice in choices.iter().copied().filter(|choice| choice.exists_for(session.document())) {
            ui.selectable_value(shown, choice, choice.name()).on_hover_text(choice.tip());
        }
    });
    controls::set_accessible_name(&response.response, name);
    response.response.on_hover_text(shown.tip());
}

fn picture_header(ui: &mut Ui, session: &Session, picture: &mut PictureView, actions: &mut Vec<Action>) {
    choose_picture(ui, session, "Shown picture", &DisplayedPicture::ALL, &mut picture.displayed);
    let mut wiping = picture.wipe.is_on;
    let tip = keys::command_tooltip(ui.ctx(), CommandId::Wipe);
    if ui.checkbox(&mut wiping, "Compare").on_hover_text(tip).changed() {
        actions.push(CommandId::Wipe.into());
    }
    // Stereo pairs cannot be compared; the space is used for their options.
    if !picture.displayed.is_pair() {
        ui.add_enabled_ui(wiping, |ui| {
            let choices: Vec<DisplayedPicture> =
                DisplayedPicture::ALL.into_iter().filter(|shown| !shown.is_pair()).collect();
            choose_picture(ui, session, "Compared picture", &choices, &mut picture.wipe.against)
        });
    }
    let is_fixated = matches!(picture.displayed, DisplayedPicture::Anaglyph | DisplayedPicture::SideBySide)
        && session.is_fixating();
    if is_fixated {
        let response = ui.button("Fixated ×");
        if response.on_hover_text(keys::command_tooltip(ui.ctx(), CommandId::FixateFocus)).clicked() {
            actions.push(CommandId::FixateFocus.into());
        }
    }
    let response = ui.add(Button::selectable(picture.verify.is_selecting(), "Verify"));
    if response.on_hover_text(keys::command_tooltip(ui.ctx(), CommandId::Verify)).clicked() {
        actions.push(CommandId::Verify.into());
    }
    for (id, label) in [(CommandId::PictureFit, "Fit"), (CommandId::PictureActualSize, "100 %")] {
        if ui.add(Button::new(label)).on_hover_text(keys::command_tooltip(ui.ctx(), id)).clicked() {
            actions.push(id.into());
        }
    }
    let with_percent = WIDTH_WITH_PERCENT + if is_fixated { FIXATED_WIDTH } else { 0.0 };
    if let Some(percent) =
        picture.scale_percent(session, ui.ctx().pixels_per_point()).filter(|p| p.is_finite())
        && ui.max_rect().width() > with_percent
    {
        ui.add(egui::Label::new(egui::RichText::new(format!("{percent:.0} %")).weak()).extend())
            .on_hover_text("Screen pixels per picture pixel.");
    }
}
