//! The material at one point, after texture lookup.

use crate::Film;
use crate::ggx::Ggx;
use crate::split::is_carried;
use glam::DVec3;

/// Whether light that meets microfacets more than once counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scattering {
    /// It counts: energy is conserved.
    #[default]
    Multiple,
    /// It is lost, as in renderers that leave it out: rough metal and glass are too dark. Metal and dielectric are the formulas of glTF
    /// 2.0's appendix B to the letter: facets after Trowbridge and Reitz, Smith's shadowing of either direction by itself, Schlick's
    /// reflectance at the facet's angle, and beneath the dielectric 1 − F at that angle of a Lambertian ground. Any renderer can be
    /// matched with that.
    Single,
}

/// KHR_materials_clearcoat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// How much of the surface is coated, in [0, 1].
    pub factor: f64,
    /// Perceptual roughness of the coat, in [0, 1].
    pub roughness: f64,
}

/// KHR_materials_sheen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Linear RGB, each in [0, 1].
    pub color: DVec3,
    /// Perceptual roughness, in [0, 1].
    pub roughness: f64,
}

/// The material of a point: glTF 2.0 and its KHR extensions, in their own terms and ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Linear RGB, each in [0, 1].
    pub base_color: DVec3,
    /// 0 dielectric … 1 metal.
    pub metallic: f64,
    /// Perceptual roughness in [0, 1]; α is its square.
    pub roughness: f64,
    /// Index of refraction, ≥ 1 (KHR_materials_ior).
    pub ior: f64,
    /// Strength of the dielectric reflection (KHR_materials_specular), in [0, 1].
    pub specular: f64,
    /// Colour of the dielectric reflection at normal incidence, linear RGB ≥ 0.
    pub specular_color: DVec3,
    /// Anisotropy strength along the frame's tangent (KHR_materials_anisotropy), in [0, 1].
    pub anisotropy: f64,
    /// Share of light that is refracted and not scattered beneath the surface (KHR_materials_transmission), in [0,
    /// 1].
    pub transmission: f64,
    /// Whether the same medium lies behind: no volume, so no refraction (KHR_materials_volume's thickness is 0).
    pub is_thin: bool,
    /// Share of the diffuse light that leaves on the other side (KHR_materials_diffuse_transmission), in [0, 1].
    pub diffuse_transmission: f64,
    /// Colour of the diffuse transmission, linear RGB.
    pub diffuse_transmission_color: DVec3,
    /// A thin film on metal and dielectric (KHR_materials_iridescence).
    pub film: Option<Film>,
    /// A coat on top.
    pub clearcoat: Option<Clearcoat>,
    /// Cloth's fuzz, beneath the coat.
    pub sheen: Option<Sheen>,
    /// Whether light that meets microfacets more than once counts.
    pub scattering: Scattering,
}

impl Default for Surface {
    /// glTF's default material.
    fn default() -> Self {
        Self {
            base_color: DVec3::ONE,
            metallic: 1.0,
            roughness: 1.0,
            ior: 1.5,
            specular: 1.0,
            specular_color: DVec3::ONE,
            anisotropy: 0.0,
            transmission: 0.0,
            is_thin: true,
            diffuse_transmission: 0.0,
            diffuse_transmission_color: DVec3::ONE,
            film: None,
            clearcoat: None,
            sheen: None,
            scattering: Scattering::Multiple,
        }
    }
}

impl Surface {
    /// KHR_materials_pbrSpecularGlossiness: a diffuse colour under a reflection of `specular` (its F0). The largest channel of F0 is taken
    /// from the diffuse colour, as the extension specifies.
    pub fn from_specular_glossiness(diffuse: DVec3, specular: DVec3, glossiness: f64) -> Self {
        // F90 is 1 there, so the ior is the one whose F0 is that largest channel, tinted to `specular`.
        let largest = specular.max_element().clamp(0.0, 0.999_999);
        let root = largest.sqrt();
        let specular_color = if largest > 0.0 { specular / largest } else { DVec3::ONE };
        Self {
            base_color: diffuse,
            metallic: 0.0,
            roughness: 1.0 - glossiness,
            ior: (1.0 + root) / (1.0 - root),
            specular_color,
            ..Self::default()
        }
    }

    /// The same as seen by a wide lobe: reflects no sharper than perceptual `roughness`. Transmissive surfaces are
    /// unchanged.
    pub fn no_sharper_than(self, roughness: f64) -> Self {
        if self.transmission > 0.0 {
            return self;
        }
        let coat = self.clearcoat.map(|coat| Clearcoat { roughness: coat.roughness.max(roughness), ..coat });
        Self { roughness: self.roughness.max(roughness), clearcoat: coat, ..self }
    }

    /// The width of the narrowest lobe that carries light: the angle between two directions, rad, from which mirrored or transmitted light
    /// differs; 0 for a mirror, `None` where all light is own. A reflected GGX lobe is 2.6 α wide at half its height.
    pub fn carried_width(&self) -> Option<f64> {
        const WIDTH: f64 = 2.6;
        let is_glass = self.metallic < 1.0 && self.transmission > 0.0;
        let is_gloss = self.metallic > 0.0 || self.transmission < 1.0 && self.specular > 0.0;
        let alpha = Ggx::new(self.roughness, self.anisotropy).mean_alpha();
        let coat = self.clearcoat.filter(|coat| coat.factor > 0.0);
        let coat = coat.map(|coat| Ggx::new(coat.roughness, 0.0).mean_alpha());
        let lobes = [(is_glass, alpha), (is_gloss && is_carried(alpha), alpha)];
        let lobes = lobes.into_iter().filter(|(is_there, _)| *is_there).map(|(_, alpha)| alpha);
        let narrowest = lobes.chain(coat.filter(|&alpha| is_carried(alpha))).reduce(f64::min);
        narrowest.map(|alpha| WIDTH * alpha)
    }
}

/// The share of light left after `length` in a medium that transmits `color` over `distance` (KHR_materials_volume; Beer's law):
/// color^(length/distance). An infinite distance transmits all.
pub fn attenuation(color: DVec3, distance: f64, length: f64) -> DVec3 {
    if !distance.is_finite() {
        return DVec3::ONE;
    }
    let optical = length / distance;
    // 0⁰ is 1: no length, no loss.
    color.map(|channel| channel.powf(optical))
}

/// The index of refraction at a wavelength, nm (KHR_materials_dispersion: Cauchy's formula through `ior` at the d line, 587.6
/// nm, with the Abbe number 20/dispersion between the C and F lines). `dispersion` 0 is none.
pub fn dispersed_ior(ior: f64, dispersion: f64, wavelength: f64) -> f64 {
    const D: f64 = 587.6;
    const C: f64 = 656.3;
    const F: f64 = 486.1;
    let spread = (ior - 1.0) * dispersion / 20.0;
    let b = spread / (1.0 / (F * F) - 1.0 / (C * C));
    (ior + b * (1.0 / (wavelength * wavelength) - 1.0 / (D * D))).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beers_law_and_dispersion_have_their_limits() {
        let color = DVec3::new(0.5, 0.25, 0.0);
        assert_eq!(attenuation(color, 2.0, 4.0), DVec3::new(0.25, 0.0625, 0.0));
        assert_eq!(attenuation(color, 2.0, 0.0), DVec3::ONE);
        assert_eq!(attenuation(color, f64::INFINITY, 1e9), DVec3::ONE);
        assert_eq!(dispersed_ior(1.5, 0.0, 400.0), 1.5);
        let abbe = (1.5 - 1.0) / (dispersed_ior(1.5, 0.4, 486.1) - dispersed_ior(1.5, 0.4, 656.3));
        assert!((abbe - 50.0).abs() < 1e-9, "{abbe}");
    }

    #[test]
    fn the_narrowest_lobe_that_carries_light_is_measured() {
        let width = |surface: Surface| surface.carried_width();
        let rough = Surface { metallic: 0.0, roughness: 0.5, ..Surface::default() };
        assert_eq!(width(rough), None, "α = 0.25 is all own");
        let shiny = Surface { roughness: 0.2, ..rough };
        assert!((width(shiny).unwrap() - 2.6 * 0.04).abs() < 1e-6);
        assert_eq!(width(Surface { specular: 0.0, ..shiny }), None);
        let coat = Some(Clearcoat { factor: 0.5, roughness: 0.1 });
        assert!((width(Surface { clearcoat: coat, ..rough }).unwrap() - 0.026).abs() < 1e-6);
        assert!(width(Surface { transmission: 0.3, ..rough }).is_some(), "what is let through is carried");
        assert!(width(Surface { roughness: 0.0, ..shiny }).unwrap() < 1e-2);
    }

    #[test]
    fn specular_glossiness_has_its_own_reflectance() {
        let surface = Surface::from_specular_glossiness(DVec3::ONE, DVec3::new(0.2, 0.5, 0.1), 0.25);
        let f0 = crate::reflectance_of_ior(surface.ior) * surface.specular_color;
        assert!(f0.distance(DVec3::new(0.2, 0.5, 0.1)) < 1e-12, "{f0}");
        assert_eq!(surface.roughness, 0.75);
    }
}
