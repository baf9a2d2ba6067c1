//! Irradiance kept on the surface: what has been scattered before, for every camera.
//!
//! The surface is parted into patches ([`patches`]): what lies in one cell of a lattice, of one part, and faces about one way. Each
//! knows the light that arrives at it: *direct* (of lights that are drawn, as far as nothing stands between) and *indirect* (all else),
//! solved for bounce by bounce (`solving`). Between patches it is interpolated by place and normal, so that it has no borders but those of parts, and what
//! faces away, a wall's other side above all, has no say. What a surface sends of it is its diffuse lobes' times E/π.

mod lattice;
pub(crate) mod patches;
pub(crate) mod place;

use glam::Vec3;
use patches::Patches;
use place::Place;

/// Light that arrives at every patch of a scene's surface.
#[derive(Debug)]
pub struct Irradiance {
    patches: Patches,
    /// Irradiance/π by patch: of lights that are drawn.
    direct: Vec<Vec3>,
    /// And all other.
    indirect: Vec<Vec3>,
}

impl Irradiance {
    /// Of what was solved for: irradiance/π by patch.
    pub(crate) fn new(patches: Patches, direct: Vec<Vec3>, indirect: Vec<Vec3>) -> Self {
        Self { patches, direct, indirect }
    }

    /// Irradiance/π by patch: direct and indirect. With the scene and the options it was solved with, all there is to keep.
    pub fn values(&self) -> [&[Vec3]; 2] {
        [&self.direct, &self.indirect]
    }

    /// How many patches there are.
    pub fn len(&self) -> usize {
        self.direct.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.direct.is_empty()
    }

    /// Bytes it takes.
    pub fn bytes(&self) -> usize {
        self.patches.bytes() + 2 * size_of::<Vec3>() * self.len()
    }

    /// The side of a patch, world units.
    pub(crate) fn spacing(&self) -> f64 {
        self.patches.spacing()
    }

    /// Indirect irradiance/π at a place; `None` where no patch is.
    pub(crate) fn indirect(&self, place: &Place) -> Option<Vec3> {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        self.patches.visit_around(place, |patch, weight| {
            sum += self.indirect[patch as usize] * weight;
            weights += weight;
        });
        (weights > 0.0).then(|| sum / weights)
    }

    /// All irradiance/π at a place; `None` where no patch is.
    pub(crate) fn total(&self, place: &Place) -> Option<Vec3> {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        self.patches.visit_around(place, |patch, weight| {
            sum += (self.direct[patch as usize] + self.indirect[patch as usize]) * weight;
            weights += weight;
        });
        (weights > 0.0).then(|| sum / weights)
    }
}
