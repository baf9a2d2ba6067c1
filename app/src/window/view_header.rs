//! The line above each view: its name, and how it shows things.

use super::layout::Pane;
use super::picture_view::{PictureView, Shown};
use super::{Action, ViewSettings, controls, keys};
use egui::{Button, Ui};
use session::{CommandId, Session};

/// Room for the picture's scale in percent, points: without it the number is left out.
const PERCENT_WIDTH: f32 = 60.0;

/// What the headers change.
pub struct HeaderState<'a> {
    /// How the paint view looks.
    pub settings: &'a mut ViewSettings,
    /// Which picture is shown.
    pub picture: &'a mut PictureView,
}

/// The line above a view. Returns whether the view is being dragged elsewhere by its name.
pub fn view_header(
    ui: &mut Ui,
    pane: Pane,
    session: &Session,
    state: HeaderState<'_>,
    actions: &mut Vec<Action>,
) -> bool {
    let frame = egui::Frame::new().inner_margin(egui::Margin::symmetric(8, 3)).fill(ui.visuals().panel_fill);
    let title = match pane {
        Pane::Paint => "Paint",
        Pane::Picture => "Picture",
    };
    frame
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            // A narrow view wraps its header: it must not grow wider than itself.
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = 5.0;
                let name = egui::Label::new(egui::RichText::new(title).strong()).selectable(false);
                let name = ui
                    .add(name.sense(egui::Sense::drag()))
                    .on_hover_text("Drag to place this view elsewhere.");
                match pane {
                    Pane::Paint => paint_header(ui, state.settings),
                    Pane::Picture => picture_header(ui, session, state.picture, actions),
                }
                name.drag_started()
            })
            .inner
        })
        .inner
}

fn paint_header(ui: &mut Ui, settings: &mut ViewSettings) {
    ui.label("Surface").on_hover_text("The scene's own colours.");
    let mix = egui::Slider::new(&mut settings.focus_share, 0.0..=1.0).show_value(false);
    let tip =
        "From the scene's own colours (V) to the colours of blur (C): near orange, sharp white, far blue.";
    ui.spacing_mut().slider_width = 70.0;
    controls::named(&ui.add(mix).on_hover_text(tip), "Share of false colour");
    ui.label("Blur").on_hover_text("The false colour of blur.");
    ui.checkbox(&mut settings.contours, "Contours")
        .on_hover_text("Lines where the blur is 1, 4 and 16 px wide.");
}

/// A menu of the pictures that can be shown.
fn choose_picture(ui: &mut Ui, name: &str, shown: &mut Shown) {
    let combo = egui::ComboBox::from_id_salt(name).selected_text(shown.name()).width(104.0);
    let response = combo.show_ui(ui, |ui| {
        for choice in Shown::ALL {
            ui.selectable_value(shown, choice, choice.name()).on_hover_text(choice.tip());
        }
    });
    controls::named(&response.response, name);
    response.response.on_hover_text(shown.tip());
}

fn picture_header(ui: &mut Ui, session: &Session, picture: &mut PictureView, actions: &mut Vec<Action>) {
    choose_picture(ui, "Shown picture", &mut picture.shown);
    let mut wiping = picture.wipe.is_on;
    let tip = keys::tip(ui.ctx(), CommandId::Wipe);
    if ui.checkbox(&mut wiping, "Compare").on_hover_text(tip).changed() {
        actions.push(CommandId::Wipe.into());
    }
    ui.add_enabled_ui(wiping, |ui| choose_picture(ui, "Compared picture", &mut picture.wipe.against));
    let response = ui.add(Button::selectable(picture.verify.is_selecting(), "Verify"));
    if response.on_hover_text(keys::tip(ui.ctx(), CommandId::Verify)).clicked() {
        actions.push(CommandId::Verify.into());
    }
    for (id, label) in [(CommandId::PictureFit, "Fit"), (CommandId::PictureActualSize, "100 %")] {
        if ui.add(Button::new(label)).on_hover_text(keys::tip(ui.ctx(), id)).clicked() {
            actions.push(id.into());
        }
    }
    if let Some(percent) = picture.percent(session, ui.ctx().pixels_per_point()).filter(|p| p.is_finite())
        && ui.available_width() > PERCENT_WIDTH
    {
        ui.add(egui::Label::new(egui::RichText::new(format!("{percent:.0} %")).weak()).extend())
            .on_hover_text("Screen pixels of a picture pixel.");
    }
}
