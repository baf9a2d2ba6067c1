//! Strokes over a surface as strokes over the picture that it was made from.

use crate::document::{Document, SurfaceHit};
use relief::{DepthRepair, DepthStroke};

impl Document {
    /// The stroke that repairs depth along places of the surface, as wide there as the brush is where it begins; none where nothing was hit, or
    /// the surface is of no picture.
    pub fn depth_stroke(&self, repair: DepthRepair, hits: &[SurfaceHit]) -> Option<DepthStroke> {
        let stage = &self.stage;
        let picture = stage.scene.picture.as_ref()?;
        let px = f64::from(picture.pixels);
        let place = |hit: &SurfaceHit| {
            let texel = stage.atlas.position_of(hit.point);
            let behind = f64::from(picture.behind);
            let row = if texel.y < behind { texel.y } else { texel.y - behind };
            [texel.x, row].map(|at| ((at - f64::from(picture.margin)) * px) as f32)
        };
        let camera = stage.scene.cameras.first()?;
        let from_camera = camera.camera_to_world.inverse().transform_point3(hits.first()?.position);
        let seen_rows = f64::from(picture.shown()[1]) * px;
        let seen_height = -2.0 * from_camera.z * (0.5 * camera.yfov).tan();
        let stroke = DepthStroke {
            repair,
            way: hits.iter().map(place).collect(),
            radius_px: (self.brush.radius / seen_height * seen_rows) as f32,
            hardness: self.brush.hardness as f32,
            strength: self.brush.strength as f32,
        };
        stroke.is_valid().then_some(stroke)
    }
}
