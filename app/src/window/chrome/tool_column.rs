//! The column of tools at the left: an icon a family, with names where there is room.

use crate::window::widgets::icon::{Icon, icon_button, labelled_icon_button};
use crate::window::widgets::{controls, keys};
use crate::window::{Action, Tool};
use document::Document;
use egui::{Response, ScrollArea, Ui, vec2};

/// Side of a button, points.
const BUTTON: f32 = 34.0;

/// Width of a button with a name, points.
const NAMED_BUTTON: f32 = 124.0;

/// Names are shown in windows of at least this width, points.
const WIDE_WINDOW: f32 = 1700.0;

/// The families before which there is a line: what selects, what focuses.
const GROUP_STARTS: [Tool; 2] = [Tool::SelectLasso, Tool::FocusHere];

/// Whether a window of this width, in points, has room for the names of tools.
pub fn has_room_for_names(window_width: f32) -> bool {
    window_width >= WIDE_WINDOW
}

/// Width of the column, points.
pub fn width(window_width: f32) -> f32 {
    let button = if has_room_for_names(window_width) { NAMED_BUTTON } else { BUTTON };
    button + 2.0 * f32::from(MARGIN)
}

/// Space at the column's sides, points.
pub const MARGIN: i8 = 5;

/// Draws the column.
pub fn tool_column(
    ui: &mut Ui,
    document: Option<&Document>,
    tool: Tool,
    with_names: bool,
    actions: &mut Vec<Action>,
) {
    let has_depth = document.is_some_and(|document| document.scene().picture.is_some());
    ui.spacing_mut().item_spacing.y = 3.0;
    ui.ctx().accesskit_node_builder(ui.unique_id(), |node| {
        node.set_role(egui::accesskit::Role::Toolbar);
        node.set_label("Tools");
    });
    ScrollArea::vertical().scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysHidden).show(
        ui,
        |ui| {
            for family in Tool::FAMILIES {
                if family[0].depth_repair().is_some() && !has_depth {
                    continue;
                }
                if GROUP_STARTS.contains(&family[0]) {
                    ui.add_space(3.0);
                    ui.separator();
                    ui.add_space(1.0);
                }
                family_button(ui, family, tool, with_names, actions);
            }
        },
    );
}

/// The button of a family of tools: the active tool or the first; a right click shows all.
fn family_button(ui: &mut Ui, family: &[Tool], tool: Tool, with_names: bool, actions: &mut Vec<Action>) {
    let chosen = family.contains(&tool);
    let shown = if chosen { tool } else { family[0] };
    let response = if with_names {
        labelled_icon_button(ui, icon(shown), shown.label(), chosen, vec2(NAMED_BUTTON, BUTTON))
    } else {
        icon_button(ui, icon(shown), shown.label(), chosen, vec2(BUTTON, BUTTON))
    };
    if family.len() > 1 {
        mark_family(ui, &response);
    }
    let tip = keys::command_tooltip(ui.ctx(), shown.command());
    let more = if family.len() > 1 { "\nRight-click for related tools." } else { "" };
    let response = response.on_hover_text(format!("{}: {tip}{more}", shown.label()));
    if response.clicked() {
        actions.push(shown.command().into());
    }
    if family.len() > 1 {
        response.context_menu(|ui| {
            for tool in family {
                let key = keys::shortcut_text(ui.ctx(), tool.command());
                let entry = controls::icon_entry(ui, icon(*tool), tool.label(), key);
                if entry.on_hover_text(tool.tip()).clicked() {
                    actions.push(tool.command().into());
                    ui.close();
                }
            }
        });
    }
}

/// A small corner, as other programs mark buttons with more behind them.
fn mark_family(ui: &Ui, response: &Response) {
    let corner = response.rect.right_bottom() - vec2(4.0, 4.0);
    let points = vec![corner, corner - vec2(5.0, 0.0), corner - vec2(0.0, 5.0)];
    let color = ui.visuals().weak_text_color();
    ui.painter().add(egui::Shape::convex_polygon(points, color, egui::Stroke::NONE));
}

/// The icon of a tool.
fn icon(tool: Tool) -> Icon {
    match tool {
        Tool::Brush => Icon::Brush,
        Tool::Curve => Icon::Curve,
        Tool::Smooth => Icon::Smooth,
        Tool::Sharpen => Icon::Sharpen,
        Tool::Clone => Icon::Clone,
        Tool::Reset => Icon::Reset,
        Tool::FillObject => Icon::Fill,
        Tool::FillMaterial => Icon::FillMaterial,
        Tool::FillChart => Icon::FillChart,
        Tool::SharpHere => Icon::SharpHere,
        Tool::Gradient => Icon::Gradient,
        Tool::FocalPlane => Icon::FocalPlane,
        Tool::DepthSpread => Icon::DepthSpread,
        Tool::DepthNearer => Icon::DepthNearer,
        Tool::DepthFarther => Icon::DepthFarther,
        Tool::DepthSmooth => Icon::DepthSmooth,
        Tool::SelectLasso => Icon::Lasso,
        Tool::SelectBox => Icon::SelectBox,
        Tool::SelectObject => Icon::SelectObject,
        Tool::SelectMaterial => Icon::SelectMaterial,
        Tool::SelectChart => Icon::SelectChart,
        Tool::SelectFacing => Icon::SelectFacing,
        Tool::SelectDepth => Icon::SelectDepth,
        Tool::SelectSimilar => Icon::SelectSimilar,
        Tool::FocusHere => Icon::FocusHere,
        Tool::RackFocus => Icon::RackFocus,
        Tool::FixateHere => Icon::Fixate,
        Tool::Pick => Icon::Pick,
        Tool::Inspect => Icon::Inspect,
    }
}
