//! Adding Gaussian splats to a scene.
//!
//! To all that knows surfaces a splat is a triangle: one standard deviation wide, in the plane of its two longest axes, about its mean, in its mean colour. So
//! each has an address, a place in the atlas and paint, and can be shown by what draws triangles. Rays do not hit these triangles; what they meet of the cloud itself, the crates that trace decide.

use crate::model::fill_attribute;
use crate::{Material, Node, Part, PlacedCloud, Scene, SplatEdit, SurfacePoint, Triangle};
use gaussians::cloud::{harmonics, srgb_to_linear};
use gaussians::{ColorSpace, GaussianCloud, Placement};
use glam::{DMat4, DQuat, DVec2, DVec3, Vec2, Vec3, Vec4};
use numerics::quantile;
use rayon::prelude::*;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

impl PlacedCloud {
    /// The address of a splat.
    pub fn address(&self, splat: u32) -> SurfacePoint {
        SurfacePoint { triangle: self.first_triangle + splat, barycentric: DVec2::ZERO }
    }
}

impl Scene {
    /// The scene of a file of splats. Its camera is a default that frames them from the front.
    pub fn from_splats(
        path: PathBuf,
        name: String,
        cloud: Arc<GaussianCloud>,
        placement: Placement,
        format: &'static str,
    ) -> Self {
        let mut scene = Self { path, has_default_camera: true, ..Self::default() };
        scene.add_splats(name, cloud, placement, format);
        scene.set_upright(DQuat::IDENTITY);
        scene
    }

    /// Adds splats behind all triangles: a node, a part and a material of this name. They send their own light, and nothing lights them.
    ///
    /// # Panics
    /// The scene has splats already, or more than 2³² triangles or vertices.
    pub fn add_splats(
        &mut self,
        name: String,
        cloud: Arc<GaussianCloud>,
        placement: Placement,
        format: &'static str,
    ) {
        assert!(self.splats.is_none(), "a scene has one cloud");
        let count = u32::try_from(cloud.len()).expect("a cloud's splats are numbered by 32 bits");
        let [first_triangle, first_vertex] =
            [self.triangles.len(), self.positions.len()].map(|n| u32::try_from(n).expect("32 bits"));
        assert!(first_vertex.checked_add(count.saturating_mul(3)).is_some() && count <= u32::MAX / 3);
        self.colors.resize(self.positions.len(), Vec4::ONE);
        let color = |splat: u32| [mean_color(&cloud, splat); 3];
        self.colors.par_extend((0..count).into_par_iter().flat_map_iter(color));
        let corners = |splat: u32| splat_corners(&cloud, &placement, splat);
        self.positions.par_extend((0..count).into_par_iter().flat_map_iter(corners));
        fill_attribute(&mut self.normals, self.positions.len(), Vec3::ZERO);
        let further = self.further_uv.iter_mut();
        self.uv.iter_mut().chain(further).for_each(|uv| fill_attribute(uv, self.positions.len(), Vec2::ZERO));
        let part = self.parts.len() as u32;
        let vertices = |splat: u32| [0, 1, 2].map(|corner| first_vertex + 3 * splat + corner);
        self.triangles.extend((0..count).map(|splat| Triangle { vertices: vertices(splat), part }));
        fill_attribute(&mut self.tangents, self.triangles.len(), [Vec4::ZERO; 3]);
        let (node, material) = (self.nodes.len() as u32, self.materials.len() as u32);
        let triangles = first_triangle..first_triangle + count;
        self.parts.push(Part { node, material, triangles, has_uv: [false; 2], mirrored: false });
        self.nodes.push(Node { name: name.clone(), index: node, world: DMat4::IDENTITY });
        self.materials.push(Material { name, ..Material::unlit_white() });
        let bounds = bounds(&cloud, &placement);
        self.splats = Some(Arc::new(PlacedCloud {
            cloud,
            placement,
            original_placement: placement,
            edit: SplatEdit::default(),
            file: None,
            format,
            first_triangle,
            bounds,
        }));
    }

    /// Adds the splats of the scene at rest to the scene at a time of an animation: splats do not move. Returns the triangles at rest.
    pub(crate) fn add_splats_of(&mut self, rest: &Self) -> Range<u32> {
        let triangles = rest.splats.as_ref().map_or(0..0, |splats| splats.triangles());
        if let Some(splats) = &rest.splats {
            let name = rest.nodes[rest.part_of(triangles.start).node as usize].name.clone();
            self.add_splats(name, splats.cloud.clone(), splats.placement, splats.format);
            let first_triangle = self.surface_triangles().end;
            self.splats = Some(Arc::new(PlacedCloud { first_triangle, ..(**splats).clone() }));
        }
        triangles
    }

    /// The scene without its splats; `None` if there is nothing else.
    pub fn without_splats(&self) -> Option<Self> {
        let count = self.surface_triangles().len();
        let mut scene = self.clone();
        if self.splats.is_some() {
            scene.triangles.truncate(count);
            scene.parts.retain(|part| part.triangles.start < count as u32);
            scene.splats = None;
        }
        (count > 0).then_some(scene)
    }

    /// Whether this scene, as it was read from its file, has the triangles and parts of another that are not splats, nor its floor.
    pub fn is_surface_of(&self, other: &Self) -> bool {
        let added = other.floor.as_ref().map(|floor| floor.triangles().start);
        let end = added.unwrap_or(other.surface_triangles().end) as usize;
        let added_parts = usize::from(other.splats.is_some()) + usize::from(other.floor.is_some());
        other.triangles[..end] == self.triangles
            && other.positions.starts_with(&self.positions)
            && other.parts.len() - added_parts == self.parts.len()
    }

    /// The triangles that rays can hit: all but those of splats.
    pub fn surface_triangles(&self) -> Range<u32> {
        0..self.splats.as_ref().map_or(self.triangles.len() as u32, |splats| splats.first_triangle)
    }

    /// Whether a triangle stands for a splat.
    #[inline]
    pub fn is_splat(&self, triangle: u32) -> bool {
        self.splats.as_ref().is_some_and(|splats| triangle >= splats.first_triangle)
    }

    /// World positions in whose hull the scene lies, but for its floor, and what is far from most of a cloud of splats.
    pub(crate) fn extent(&self) -> impl Iterator<Item = DVec3> {
        let end = self.floor.as_ref().map_or(self.surface_triangles().end, |floor| floor.triangles().start);
        let surface = &self.triangles[..end as usize];
        let vertices = surface.iter().flat_map(|t| t.vertices).map(|v| self.positions[v as usize]);
        let of_splats = self.splats.iter().flat_map(|splats| {
            let (low, high) = splats.bounds;
            (0..8).map(move |corner| {
                let is_high = [0, 1, 2].map(|axis| corner >> axis & 1 == 1);
                DVec3::from_array(std::array::from_fn(|k| if is_high[k] { high[k] } else { low[k] }))
            })
        });
        vertices.chain(of_splats)
    }
}

/// The linear colour of a splat, the mean over all directions.
fn mean_color(cloud: &GaussianCloud, splat: u32) -> Vec4 {
    let color = (0.5 + harmonics::BASE * cloud.splat(splat as usize).base_color).max(Vec3::ZERO);
    let linear = match cloud.traits().color_space {
        ColorSpace::Srgb => color.map(srgb_to_linear),
        ColorSpace::Linear => color,
    };
    linear.extend(1.0)
}

/// The corners of the triangle of a splat, its centroid at the mean. That of a hidden splat is too small to be noticed, but has a place.
pub(crate) fn splat_corners(cloud: &GaussianCloud, placement: &Placement, index: u32) -> [DVec3; 3] {
    /// The shorter axis is at least this share of the longer: needles have an area, too.
    const THINNEST: f64 = 1e-3;
    /// The size of a hidden splat.
    const HIDDEN: f64 = 1e-4;
    let splat = cloud.splat(index as usize);
    let (mean, rotation) = (placement.point(splat.mean.as_dvec3()), splat.rotation.as_dquat());
    let mut axes = [DVec3::X, DVec3::Y, DVec3::Z]
        .map(|axis| (axis.dot(splat.log_scale.as_dvec3().exp()), placement.linear() * (rotation * axis)));
    axes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let [(longest, a), (second, b), _] = axes;
    let shown = if cloud.is_hidden(index as usize) { HIDDEN } else { 1.0 };
    let (a, b) = (a * (shown * longest), b * (shown * second.max(THINNEST * longest)));
    let half = 0.75f64.sqrt() * b;
    [mean + a, mean - 0.5 * a + half, mean - 0.5 * a - half]
}

/// The box in which most means lie, with what is as far beyond them as a few hundredths of its size.
pub(crate) fn bounds(cloud: &GaussianCloud, placement: &Placement) -> (DVec3, DVec3) {
    /// The share of means beyond each side of the box.
    const OUTLIERS: f64 = 0.02;
    const ROOM: f64 = 0.05;
    /// As many means as decide: more change nothing.
    const MOST: usize = 200_000;
    let is_all_hidden = cloud.hidden_count() == cloud.len();
    let is_counted = |index: &usize| is_all_hidden || !cloud.is_hidden(*index);
    let counted = if is_all_hidden { cloud.len() } else { cloud.len() - cloud.hidden_count() };
    let step = counted.div_ceil(MOST).max(1);
    let place = |index: usize| placement.point(cloud.means()[index].as_dvec3());
    let means: Vec<DVec3> = (0..cloud.len()).filter(is_counted).step_by(step).map(place).collect();
    let side = |share: f64| {
        DVec3::from_array([0, 1, 2].map(|axis| {
            let mut places: Vec<f64> = means.iter().map(|mean| mean[axis]).collect();
            quantile(&mut places, share).unwrap_or(0.0)
        }))
    };
    let (low, high) = (side(OUTLIERS), side(1.0 - OUTLIERS));
    let room = ROOM * (high - low);
    (low - room, high + room)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gaussians::{CloudBuilder, CloudTraits, Splat};
    use glam::Quat;

    fn cloud(count: u32) -> Arc<GaussianCloud> {
        let mut builder = CloudBuilder::new(0, count as usize);
        for k in 0..count {
            let far = if k == 0 { 1000.0 } else { 1.0 };
            builder.push(
                Splat {
                    mean: Vec3::new((k % 10) as f32, (k / 10) as f32, 2.0) * far,
                    rotation: Quat::from_rotation_x(0.3),
                    log_scale: Vec3::new(-1.0, f32::NEG_INFINITY, -2.0),
                    opacity: 0.9,
                    base_color: Vec3::ZERO,
                },
                &[],
            );
        }
        Arc::new(builder.finish(CloudTraits::default()))
    }

    #[test]
    fn every_splat_has_a_triangle_about_its_mean() {
        let placement = Placement { translation: DVec3::new(5.0, 0.0, 0.0), ..Placement::IDENTITY };
        let scene = Scene::from_splats("a.ply".into(), "a".into(), cloud(100), placement, "PLY");
        let splats = scene.splats.as_ref().unwrap();
        assert_eq!(
            (scene.triangles.len(), scene.surface_triangles(), splats.triangles()),
            (100, 0..0, 0..100)
        );
        for triangle in 0..100 {
            assert!(scene.is_splat(triangle) && splats.splat_of(triangle) == Some(triangle));
            let centroid = scene.corners(triangle).iter().sum::<DVec3>() / 3.0;
            let mean = placement.point(splats.cloud.means()[triangle as usize].as_dvec3());
            assert!(centroid.distance(mean) < 1e-9);
            // Perpendicular to the flat axis.
            let normal = scene.area_normal(triangle).normalize();
            assert!(normal.dot(DQuat::from_rotation_x(0.3) * DVec3::Y).abs() > 0.999_999);
        }
        // One far away changes neither the bounds nor the view.
        let (low, high) = scene.bounds();
        assert!(high.max_element() < 20.0 && low.min_element() > -2.0, "{low} {high}");
        let camera = &scene.cameras[0];
        assert!(camera.camera_to_world.w_axis.truncate().length() < 60.0 && camera.focus_distance < 60.0);
    }

    #[test]
    fn splats_follow_the_triangles_of_meshes() {
        let mesh = crate::SurfaceMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            colors: vec![Vec4::splat(0.5); 3],
            triangles: vec![[0, 1, 2]],
            ..crate::SurfaceMesh::default()
        };
        let mut scene = Scene::from_mesh(mesh, &crate::LoadOptions::default()).unwrap();
        scene.add_splats("b".into(), cloud(7), Placement::IDENTITY, "PLY");
        assert_eq!((scene.surface_triangles(), scene.triangles.len()), (0..1, 8));
        assert!(!scene.is_splat(0) && scene.is_splat(1) && scene.colors.len() == scene.positions.len());
        assert_eq!(scene.part_of(5).triangles, 1..8);
        assert!(scene.normals.is_empty() && scene.tangents.is_empty());
        assert_eq!(scene.splats.as_ref().unwrap().address(2).triangle, 3);
    }
}
