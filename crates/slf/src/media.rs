//! The medium a path is in: air, or nested bodies of glass and water.

use glam::DVec3;
use material::{Interface, attenuation, dispersed_ior};
use scene::{Material, Scene};
use std::collections::HashMap;
use std::sync::OnceLock;

/// Stands for an infinite index of refraction, which glTF writes as 0: a perfect mirror.
const INFINITE_IOR: f64 = 1e6;

/// Index of refraction of a material, with glTF's 0 replaced.
pub(crate) fn effective_ior(material: &Material) -> f64 {
    if material.ior == 0.0 { INFINITE_IOR } else { f64::from(material.ior) }
}

/// Wavelengths that represent red, green and blue where glass disperses, nm: the peaks of sRGB's primaries.
const WAVELENGTHS: [f64; 3] = [611.4, 549.1, 464.2];

/// Interiors of a scene's materials, and the interfaces between them.
#[derive(Debug)]
pub(crate) struct Media {
    /// By material: the medium that fills its body.
    interiors: Vec<Interior>,
    /// The distinct indices of refraction; vacuum comes first.
    iors: Vec<f64>,
    /// By front and back index: the interface between them.
    interfaces: Vec<OnceLock<Interface>>,
}

#[derive(Clone, Copy, Debug)]
struct Interior {
    /// Whether the material encloses a volume.
    is_solid: bool,
    disperses: bool,
    /// Indices into `iors` for all colours together and for red, green and blue.
    ior: [u16; 4],
    color: DVec3,
    distance: f64,
}

/// Maximum number of nested bodies that are told apart.
const MAX_NESTED: usize = 8;

/// The bodies a path is in, innermost last.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MediumStack {
    materials: [u32; MAX_NESTED],
    count: usize,
    /// The colour channel followed, 0 to 2, once the path has been dispersed.
    pub channel: Option<usize>,
}

impl Media {
    /// The media inside the scene's solid materials.
    pub fn from_scene(scene: &Scene) -> Self {
        let mut numbers = HashMap::from([(1.0f64.to_bits(), 0u16)]);
        let mut iors = vec![1.0];
        let mut number = |ior: f64| {
            let next = iors.len().min(usize::from(u16::MAX)) as u16;
            *numbers.entry(ior.to_bits()).or_insert_with(|| {
                iors.push(ior);
                next
            })
        };
        let interiors = scene
            .materials
            .iter()
            .map(|material| {
                let ior = effective_ior(material);
                let dispersion = f64::from(material.dispersion);
                let is_solid = material.volume.is_some() && material.transmission.factor > 0.0;
                let plain = number(ior);
                let channel_iors = WAVELENGTHS.map(|wavelength| match is_solid && dispersion > 0.0 {
                    true => number(dispersed_ior(ior, dispersion, wavelength)),
                    false => plain,
                });
                Interior {
                    is_solid,
                    disperses: is_solid && dispersion > 0.0,
                    ior: [plain, channel_iors[0], channel_iors[1], channel_iors[2]],
                    color: material.volume.map_or(DVec3::ONE, |volume| volume.attenuation_color.as_dvec3()),
                    distance: material.volume.map_or(f64::INFINITY, |volume| volume.attenuation_distance),
                }
            })
            .collect();
        let interfaces = (0..iors.len() * iors.len()).map(|_| OnceLock::new()).collect();
        Self { interiors, iors, interfaces }
    }

    /// Whether a material, by its index in the scene, refracts each colour differently.
    pub fn disperses(&self, material: u32) -> bool {
        self.interiors[material as usize].disperses
    }

    /// The interface that a path meets on the front or the back of a material, given the bodies that it is inside of.
    pub fn interface(&self, material: u32, inside: &MediumStack, is_front: bool) -> &Interface {
        let own = self.ior(material, inside);
        let mut around = *inside;
        if !is_front {
            around.leave(material);
        }
        let outside = match around.innermost() {
            Some(outer) if self.interiors[material as usize].is_solid => self.ior(outer, inside),
            _ => 0,
        };
        let (front, back) = (usize::from(outside), usize::from(own));
        let interface = &self.interfaces[front * self.iors.len() + back];
        interface.get_or_init(|| Interface::between(self.iors[front], self.iors[back]))
    }

    fn ior(&self, material: u32, inside: &MediumStack) -> u16 {
        self.interiors[material as usize].ior[inside.channel.map_or(0, |channel| channel + 1)]
    }

    /// Transmittance of a segment of this length (world units) through the innermost body.
    pub fn attenuation(&self, inside: &MediumStack, length: f64) -> DVec3 {
        inside.innermost().map_or(DVec3::ONE, |material| {
            let interior = &self.interiors[material as usize];
            attenuation(interior.color, interior.distance, length)
        })
    }

    /// Crosses a surface of a material, into its body (`enters`) or out of it. Has no effect if the material has no
    /// body.
    pub fn cross(&self, inside: &mut MediumStack, material: u32, enters: bool) {
        if !self.interiors[material as usize].is_solid {
            return;
        }
        if !enters {
            inside.leave(material);
        } else if inside.count < MAX_NESTED {
            inside.materials[inside.count] = material;
            inside.count += 1;
        }
    }

    /// The medium of light that leaves a surface of a material toward its front or its back.
    pub fn outgoing_medium(&self, material: u32, is_front: bool) -> MediumStack {
        let mut inside = MediumStack::default();
        self.cross(&mut inside, material, !is_front);
        inside
    }
}

impl MediumStack {
    fn innermost(&self) -> Option<u32> {
        self.count.checked_sub(1).map(|last| self.materials[last])
    }

    /// Leaves the innermost body of this material. A body whose walls have several materials is left through any of
    /// them.
    fn leave(&mut self, material: u32) {
        let bodies = &mut self.materials[..self.count];
        let place = bodies.iter().rposition(|&other| other == material).or(bodies.len().checked_sub(1));
        if let Some(place) = place {
            bodies[place..].rotate_left(1);
            self.count -= 1;
        }
    }
}
