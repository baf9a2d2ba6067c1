//! Symmetry of an object: along its own axes, about its own centre.

use crate::open_document::Document;
use crate::picking::SurfaceHit;
use crate::stage::Stage;
use focus::{Brush, Symmetry, WORLD_AXES};
use glam::{DMat3, DMat4, DVec3};

/// Axes shorter than this share of the longest have no usable direction: the transform flattens the object.
const SHORTEST_AXIS: f64 = 1e-9;

impl Document {
    /// The brush for a stroke that begins at `hit`: a brush that mirrors by object is mirrored about the object there.
    pub(crate) fn brush_at(&self, hit: Option<&SurfaceHit>) -> Brush {
        let Some(hit) = hit.filter(|_| self.brush.mirror_by_object) else { return self.brush.clone() };
        let (mirror_center, mirror_axes) = object_frame(&self.stage, hit);
        Brush { mirror_center, mirror_axes, mirror_by_object: false, ..self.brush.clone() }
    }

    /// The symmetry of a stroke that begins at `hit`.
    pub fn symmetry_at(&self, hit: Option<&SurfaceHit>) -> Symmetry {
        self.brush_at(hit).symmetry()
    }
}

/// Centre and axes of symmetry of the object at `hit`. The centre is the object's origin if that lies in its bounding box, otherwise the box's
/// centre; the axes are orthonormal.
fn object_frame(stage: &Stage, hit: &SurfaceHit) -> ([f64; 3], [[f64; 3]; 3]) {
    let scene = &stage.scene;
    let node = scene.part_of(hit.point.triangle).node;
    let world = scene.nodes[node as usize].world;
    let axes = orthonormal_axes(world);
    let object_from_world = DMat3::from_cols_array_2d(&axes).transpose();
    let parts = scene.parts.iter().filter(|part| part.node == node);
    let corners = parts.flat_map(|part| part.triangles.clone()).flat_map(|triangle| scene.corners(triangle));
    let (low, high) = corners
        .map(|corner| object_from_world * corner)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let origin = object_from_world * world.w_axis.truncate();
    let is_within = origin.cmpge(low).all() && origin.cmple(high).all();
    let center = if is_within { origin } else { (low + high) / 2.0 };
    ((object_from_world.transpose() * center).to_array(), axes)
}

/// The axes of a transform, orthonormalised (Gram–Schmidt from x, then y); the world's axes if the transform is degenerate.
fn orthonormal_axes(world: DMat4) -> [[f64; 3]; 3] {
    let columns = [world.x_axis, world.y_axis].map(|column| column.truncate());
    let longest = columns[0].length().max(columns[1].length());
    let direction = |v: DVec3| (v.length() > SHORTEST_AXIS * longest).then(|| v.normalize());
    let orthonormalized = || {
        let x = direction(columns[0])?;
        let y = direction(columns[1] - x * x.dot(columns[1]))?;
        Some([x, y, x.cross(y)].map(|axis| axis.to_array()))
    };
    orthonormalized().filter(|axes| axes.as_flattened().iter().all(|x| x.is_finite())).unwrap_or(WORLD_AXES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_for_any_transform() {
        let turned = DMat4::from_rotation_y(0.7) * DMat4::from_scale(DVec3::new(2.0, 0.5, -3.0));
        let sheared = DMat4::from_cols_array_2d(&[
            [1.0, 0.0, 0.0, 0.0],
            [0.4, 1.0, 0.0, 0.0],
            [0.0, 0.3, 1.0, 0.0],
            [5.0, 6.0, 7.0, 1.0],
        ]);
        for world in [DMat4::IDENTITY, turned, sheared] {
            let axes = orthonormal_axes(world);
            assert!(Symmetry { axes, ..Symmetry::default() }.is_valid(), "{axes:?}");
            let x = DVec3::from_array(axes[0]);
            assert!(x.dot(world.x_axis.truncate().normalize()) > 1.0 - 1e-12);
        }
        assert_eq!(orthonormal_axes(DMat4::IDENTITY), WORLD_AXES);
        assert_eq!(orthonormal_axes(DMat4::ZERO), WORLD_AXES);
        assert_eq!(orthonormal_axes(DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0))), WORLD_AXES);
    }
}
