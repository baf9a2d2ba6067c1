//! The objects and materials of the scene, each with a button to fill it; and its splats.

mod splats_rows;

pub use splats_rows::SplatsRows;

use crate::window::Action;
use document::{Document, FillRegion, SurfaceHit};
use egui::{ScrollArea, Ui};
use glam::DVec2;
use scene::{BackFaces, Scene, SurfacePoint};
use session::Command;

/// State of the list.
#[derive(Default)]
pub struct ScenePanel {
    filter: String,
    by_material: bool,
}

impl ScenePanel {
    /// Draws the list.
    pub fn ui(&mut self, ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
        let scene = document.scene();
        ui.label(format!(
            "{} triangles, {} objects, {} materials, {} charts in {} × {} texels",
            scene.triangles.len(),
            scene.nodes.len(),
            scene.materials.len(),
            document.stage.atlas.charts.len(),
            document.map.width(),
            document.map.height()
        ));
        let mut shows = scene.back_faces == BackFaces::Show;
        let hint = "Show single-sided faces from behind, too: for files with inverted faces. If off, a wall seen \
                    from outside does not hide the room.";
        if ui.checkbox(&mut shows, "Show back faces").on_hover_text(hint).changed() {
            let back_faces = if shows { BackFaces::Show } else { BackFaces::Hide };
            actions.push(Command::SetBackFaces(back_faces).into());
        }
        for warning in &document.warnings {
            ui.colored_label(ui.visuals().warn_fg_color, warning);
        }
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.by_material, false, "Objects")
                .on_hover_text("List the scene's objects.");
            ui.selectable_value(&mut self.by_material, true, "Materials")
                .on_hover_text("List the scene's materials.");
            let edit = egui::TextEdit::singleline(&mut self.filter).hint_text("filter").desired_width(110.0);
            crate::window::widgets::controls::set_accessible_name(&ui.add(edit), "Filter the list");
        });
        let rows = if self.by_material { material_rows(scene) } else { object_rows(scene) };
        let filter = self.filter.to_lowercase();
        let rows: Vec<_> = rows.into_iter().filter(|row| row.name.to_lowercase().contains(&filter)).collect();
        let height = ui.text_style_height(&egui::TextStyle::Button) + 6.0;
        ScrollArea::vertical().id_salt("scene list").max_height(180.0).min_scrolled_height(150.0).show_rows(
            ui,
            height,
            rows.len(),
            |ui, range| {
                for row in &rows[range] {
                    ui.horizontal(|ui| {
                        if ui
                            .button("Fill")
                            .on_hover_text(format!("Fill {} with the chosen focus.", row.name))
                            .clicked()
                        {
                            let region =
                                if self.by_material { FillRegion::Material } else { FillRegion::Node };
                            let command = Command::Fill(region(row.hit), document.brush.target);
                            actions.push(command.into());
                        }
                        ui.add(egui::Label::new(&row.name).truncate());
                    });
                }
            },
        );
    }
}

/// A row of the list, with a surface point that represents it.
struct Row {
    name: String,
    hit: SurfaceHit,
}

fn object_rows(scene: &Scene) -> Vec<Row> {
    let first = |node: usize| {
        scene.parts.iter().find(|part| part.node as usize == node && !part.triangles.is_empty())
    };
    let row = |(index, node): (usize, &scene::Node)| {
        Some(Row { name: node.name.clone(), hit: triangle_center(scene, first(index)?.triangles.start) })
    };
    scene.nodes.iter().enumerate().filter_map(row).collect()
}

fn material_rows(scene: &Scene) -> Vec<Row> {
    let first = |material: usize| {
        scene.parts.iter().find(|part| part.material as usize == material && !part.triangles.is_empty())
    };
    let row = |(index, material): (usize, &scene::Material)| {
        Some(Row { name: material.name.clone(), hit: triangle_center(scene, first(index)?.triangles.start) })
    };
    scene.materials.iter().enumerate().filter_map(row).collect()
}

/// The centroid of a triangle as a hit.
fn triangle_center(scene: &Scene, triangle: u32) -> SurfaceHit {
    let point = SurfacePoint { triangle, barycentric: DVec2::splat(1.0 / 3.0) };
    let normal = scene.area_normal(triangle).normalize_or_zero();
    SurfaceHit { point, position: point.position(scene), normal, distance: 0.0 }
}
