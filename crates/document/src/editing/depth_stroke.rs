//! Depth strokes: strokes on a surface, projected to the picture that it was made from.

use crate::open_document::Document;
use crate::picking::SurfaceHit;
use relief::{DepthRepair, DepthStroke};

impl Document {
    /// The depth stroke along points of the surface, with the brush's size at the first point; `None` if there are no points, or the surface was
    /// not made from a picture.
    pub fn depth_stroke(&self, repair: DepthRepair, hits: &[SurfaceHit]) -> Option<DepthStroke> {
        let stage = &self.stage;
        let picture = stage.scene.picture.as_ref()?;
        let cell_px = f64::from(picture.pixels_per_texel);
        let picture_position = |hit: &SurfaceHit| {
            let texel = stage.atlas.position_of(hit.point);
            let layer_stride = f64::from(picture.behind_first_row);
            let row = if texel.y < layer_stride { texel.y } else { texel.y - layer_stride };
            [texel.x, row].map(|coordinate| ((coordinate - f64::from(picture.margin)) * cell_px) as f32)
        };
        let camera = stage.scene.cameras.first()?;
        let camera_space = camera.camera_to_world.inverse().transform_point3(hits.first()?.position);
        let visible_rows = f64::from(picture.picture_size()[1]) * cell_px;
        let visible_height = -2.0 * camera_space.z * (0.5 * camera.yfov).tan();
        let stroke = DepthStroke {
            repair,
            path: hits.iter().map(picture_position).collect(),
            radius_px: (self.brush.radius / visible_height * visible_rows) as f32,
            hardness: self.brush.hardness as f32,
            strength: self.brush.strength as f32,
        };
        stroke.is_valid().then_some(stroke)
    }
}
