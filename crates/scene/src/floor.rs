//! A floor under a scene, which catches its shadows.
//!
//! A matte disc at the height of the lowest vertex, in the colour in which it looks like the backdrop where nothing shades it: what is seen of it are shadows,
//! contact, and light from the scene. Towards its rim it becomes transparent. It is a part of the scene like any other: rays hit it, and it takes paint.

use crate::model::fill_attribute;
use crate::{
    AlphaMode, Backdrop, Environment, Floor, LightKind, Material, Node, Part, Scene, Triangle, World,
};
use glam::{DMat4, DVec2, DVec3, Vec2, Vec3, Vec4};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// The name of its node and its material.
const NAME: &str = "shadow floor";

/// Its radius over that of the scene: half the diagonal of its ground plan, or half its height.
const REACH: f64 = 3.2;
/// How far below the lowest vertex it lies, over the radius of the scene: a scene with a floor of its own hides it.
const DEPTH: f64 = 1e-4;

/// The share of light that it reflects.
const REFLECTANCE: [f32; 2] = [0.02, 0.9];
/// The same where no light comes from far away: middle grey.
const REFLECTANCE_WITHOUT_SKY: f32 = 0.5;

impl Scene {
    /// Why the scene cannot have a floor that catches shadows; `None` if it can.
    pub fn floor_problem(&self) -> Option<&'static str> {
        let is_lit = |part: &Part| !self.materials[part.material as usize].unlit;
        match () {
            _ if self.splats.is_some() => Some("Gaussian splats cast no shadow"),
            _ if self.picture.is_some() || !self.views.is_empty() => {
                Some("shadows are in the photographs already")
            }
            _ if !self.parts.iter().any(is_lit) => Some("its materials are unlit and cast no shadow"),
            _ => None,
        }
    }

    /// Puts a floor under the scene behind all triangles, unless it has one; and shows it or not. The scene must have no
    /// [problem](Self::floor_problem) with that.
    ///
    /// # Panics
    /// The scene has Gaussian splats, or more than 2³² triangles or vertices.
    pub fn set_floor(&mut self, is_shown: bool) {
        if self.floor.is_none() {
            self.add_floor();
        }
        let Some(floor) = &mut self.floor else { return };
        floor.is_shown = is_shown;
        let floor = *floor;
        let radius = if is_shown { floor.radius } else { 0.0 };
        for vertex in 0..Floor::VERTICES {
            let (place, _) = Floor::disc_vertex(vertex);
            let offset = radius * DVec3::new(place.x, 0.0, place.y);
            self.positions[(floor.first_vertex + vertex) as usize] = floor.center + offset;
        }
        self.color_floor();
    }

    fn add_floor(&mut self) {
        assert!(self.splats.is_none(), "splats are behind all triangles");
        let [first_triangle, first_vertex] =
            [self.triangles.len(), self.positions.len()].map(|n| u32::try_from(n).expect("32 bits"));
        let (low, high) = self.bounds();
        let size = 0.5 * (high - low);
        let radius = DVec2::new(size.x, size.z).length().max(size.y);
        let middle = 0.5 * (low + high);
        let center = DVec3::new(middle.x, low.y - DEPTH * radius, middle.z);
        self.colors.resize(self.positions.len(), Vec4::ONE);
        self.colors.extend((0..Floor::VERTICES).map(|v| Vec3::ONE.extend(Floor::disc_vertex(v).1)));
        let count = self.positions.len() + Floor::VERTICES as usize;
        self.positions.resize(count, center);
        fill_attribute(&mut self.normals, count, Vec3::Y);
        let further = self.further_uv.iter_mut();
        self.uv.iter_mut().chain(further).for_each(|uv| fill_attribute(uv, count, Vec2::ZERO));
        let part = self.parts.len() as u32;
        let triangle = |k: u32| Floor::disc_triangle(k).map(|vertex| first_vertex + vertex);
        self.triangles.extend((0..Floor::TRIANGLES).map(|k| Triangle { vertices: triangle(k), part }));
        fill_attribute(&mut self.tangents, self.triangles.len(), [Vec4::ZERO; 3]);
        let floor = Floor { is_shown: false, center, radius: REACH * radius, first_triangle, first_vertex };
        let (node, material) = (self.nodes.len() as u32, self.materials.len() as u32);
        let (triangles, has_uv) = (floor.triangles(), [false; 2]);
        self.parts.push(Part { node, material, triangles, has_uv, mirrored: false });
        self.nodes.push(Node { name: NAME.into(), index: node, world: DMat4::IDENTITY });
        self.materials.push(Material {
            name: NAME.into(),
            alpha: AlphaMode::Blend,
            double_sided: true,
            ..Material::lambertian_white()
        });
        self.floor = Some(floor);
    }

    /// The scene without its floor.
    pub fn without_floor(&self) -> Self {
        let mut scene = self.clone();
        if let Some(floor) = scene.floor.take() {
            scene.triangles.truncate(floor.first_triangle as usize);
            scene.parts.pop();
        }
        scene
    }

    /// The linear colour of the floor, if there is one.
    pub fn floor_color(&self) -> Option<Vec3> {
        let floor = self.floor.as_ref()?;
        Some(self.material_of(floor.first_triangle).base_color.truncate())
    }

    /// Gives the floor the colour of the backdrop in the light of the world as it is now.
    pub fn color_floor(&mut self) {
        let Some(floor) = &self.floor else { return };
        let material = self.part_of(floor.first_triangle).material as usize;
        let color = backdrop_reflectance(&World::from_scene(self, None), self);
        self.materials[material].base_color = color.extend(1.0);
    }

    /// Puts the floor of the scene at rest under the scene at a time of an animation: it does not move. Returns its triangles at rest.
    pub(crate) fn add_floor_of(&mut self, rest: &Self) -> Range<u32> {
        let Some(floor) = &rest.floor else { return 0..0 };
        self.add_floor();
        if let Some(own) = &mut self.floor {
            (own.center, own.radius) = (floor.center, floor.radius);
        }
        self.set_floor(floor.is_shown);
        floor.triangles()
    }
}

/// The share of light that a level matte surface reflects if it looks like the backdrop, ρ = π B / E, by colour: B is the radiance of the backdrop, of a sky
/// just below the horizon, E the irradiance from above by all that is far away.
fn backdrop_reflectance(world: &World, scene: &Scene) -> Vec3 {
    let sun = scene.lights.iter().filter(|light| light.kind == LightKind::Directional);
    let from_suns: Vec3 = sun.map(|light| light.intensity * (-light.direction.y).max(0.0) as f32).sum();
    let irradiance = sky_irradiance(world) + from_suns;
    let backdrop = match world.backdrop {
        Backdrop::Color(color) => color,
        Backdrop::Environment => below_horizon(world),
    };
    let share = |k: usize| match irradiance[k] > 0.0 {
        true => (PI as f32 * backdrop[k] / irradiance[k]).clamp(REFLECTANCE[0], REFLECTANCE[1]),
        false => REFLECTANCE_WITHOUT_SKY,
    };
    Vec3::from_array(std::array::from_fn(share))
}

/// The irradiance on a level surface, W/m², from above by the environment.
fn sky_irradiance(world: &World) -> Vec3 {
    match &world.environment {
        Environment::Uniform(radiance) => *radiance * (world.strength * PI as f32),
        Environment::Map(map) => {
            let mut sum = DVec3::ZERO;
            for row in 0..map.height {
                // ∫ sin θ cos θ dθ over the row's latitudes θ, as far as they are above the horizon.
                let [top, bottom] = [row, row + 1].map(|edge| map.row_latitude(edge.into()).max(0.0).sin());
                let weight = 0.5 * (top * top - bottom * bottom) * TAU / f64::from(map.width);
                let first = row as usize * map.width as usize;
                let texels = &map.texels[first..first + map.width as usize];
                sum += weight * texels.iter().map(|texel| Vec3::from_array(*texel).as_dvec3()).sum::<DVec3>();
            }
            (sum * f64::from(world.strength)).as_vec3()
        }
    }
}

/// The mean radiance of an environment a little below the horizon: where the floor would meet it.
fn below_horizon(world: &World) -> Vec3 {
    const DIRECTIONS: u32 = 256;
    const SINE: f64 = -0.15;
    let flat = (1.0 - SINE * SINE).sqrt();
    let radiance = |k: u32| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(DIRECTIONS)).sin_cos();
        world.radiance(DVec3::new(flat * cos, SINE, flat * sin))
    };
    (0..DIRECTIONS).map(radiance).sum::<Vec3>() / DIRECTIONS as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadOptions, SurfaceMesh};

    /// A triangle that stands on y = 1.
    fn scene() -> Scene {
        let mesh = SurfaceMesh {
            positions: vec![DVec3::new(-1.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 2.0), DVec3::new(0.0, 3.0, 1.0)],
            triangles: vec![[0, 1, 2]],
            ..SurfaceMesh::default()
        };
        Scene::from_mesh(mesh, &LoadOptions::default()).unwrap()
    }

    #[test]
    fn it_lies_below_and_faces_up() {
        let mut scene = scene();
        let bounds = scene.bounds();
        scene.set_floor(true);
        assert_eq!(scene.bounds(), bounds, "a floor does not count");
        let floor = scene.floor.unwrap();
        assert_eq!(floor.triangles().end as usize, scene.triangles.len());
        let mut area = 0.0;
        for triangle in floor.triangles() {
            let normal = scene.area_normal(triangle);
            assert!(normal.y > 0.0 && normal.x == 0.0 && normal.z == 0.0, "{normal}");
            area += 0.5 * normal.y;
            let corners = floor.corners_on_disc(triangle).map(|corner| floor.radius * corner);
            for (corner, place) in scene.corners(triangle).into_iter().zip(corners) {
                let expected = floor.center + DVec3::new(place.x, 0.0, place.y);
                assert!(corner.distance(expected) < 1e-12 && (0.99..1.0).contains(&corner.y));
            }
        }
        assert!((area / (PI * floor.radius * floor.radius) - 1.0).abs() < 0.01);
    }

    #[test]
    fn hidden_it_is_one_point() {
        let mut scene = scene();
        scene.set_floor(true);
        scene.set_floor(false);
        let floor = scene.floor.unwrap();
        assert!(floor.triangles().all(|triangle| scene.area_normal(triangle) == DVec3::ZERO));
        let before = scene.clone();
        scene.set_floor(true);
        assert_eq!(scene.triangles, before.triangles);
        assert_eq!(scene.without_floor().triangles.len(), 1);
    }

    #[test]
    fn in_a_white_room_it_is_the_backdrop() {
        let mut scene = scene();
        let world = World { strength: 2.0, ..World::uniform(Vec3::splat(0.5)) };
        let backdrop = Vec3::new(0.2, 0.4, 0.7);
        scene.world = Some(World { backdrop: Backdrop::Color(backdrop), ..world.clone() });
        scene.set_floor(true);
        let reflected = scene.floor_color().unwrap() * sky_irradiance(&world) / PI as f32;
        assert!(reflected.abs_diff_eq(backdrop, 1e-6), "{reflected}");
        scene.world = Some(World { backdrop: Backdrop::Color(Vec3::ZERO), ..world });
        scene.color_floor();
        assert_eq!(scene.floor_color(), Some(Vec3::splat(REFLECTANCE[0])));
    }

    #[test]
    fn the_irradiance_of_a_map_is_that_of_its_radiance() {
        for environment in crate::BuiltInEnvironment::ALL {
            let world = World::built_in(environment);
            // Enough of them on a sun as small as the evening's.
            let (count, mut sum) = (1600, DVec3::ZERO);
            // Points of the unit disc are directions with the density of the cosine.
            for k in 0..count * count {
                let [x, z] =
                    [k % count, k / count].map(|i| (2.0 * f64::from(i) + 1.0) / f64::from(count) - 1.0);
                if x * x + z * z < 1.0 {
                    let direction = DVec3::new(x, (1.0 - x * x - z * z).sqrt(), z);
                    sum += world.radiance(direction).as_dvec3() * 4.0 / f64::from(count * count);
                }
            }
            let ratio = sky_irradiance(&world).as_dvec3() / sum;
            assert!((ratio - 1.0).abs().max_element() < 0.03, "{environment:?}: {ratio}");
        }
    }

    #[test]
    fn what_casts_no_shadow_has_no_floor() {
        assert_eq!(scene().floor_problem(), None);
        let mut unlit = scene();
        unlit.materials[0].unlit = true;
        assert!(unlit.floor_problem().is_some());
    }
}
