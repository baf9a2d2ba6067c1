//! Materials as in the file: factors and the textures that scale them.
//!
//! glTF 2.0's metallic-roughness or KHR_materials_pbrSpecularGlossiness, and the KHR_materials extensions, in their
//! own terms. Values at a surface point are sampled by `surface_color`; scattering is computed elsewhere.

use crate::{BackFaces, TextureRef};
use glam::{Vec3, Vec4};

/// A material.
#[derive(Clone, Debug)]
pub struct Material {
    /// Its name in the file, or `material N`.
    pub name: String,
    /// Linear base colour and opacity; the diffuse colour of specular-glossiness.
    pub base_color: Vec4,
    /// sRGB image multiplied into the base colour.
    pub base_color_texture: Option<TextureRef>,
    /// Linear emitted radiance, emissive strength included.
    pub emissive: Vec3,
    /// sRGB image multiplied into the emitted radiance.
    pub emissive_texture: Option<TextureRef>,
    /// KHR_materials_unlit: the base colour is the radiance.
    pub unlit: bool,
    /// How opacity is used.
    pub alpha: AlphaMode,
    /// Whether the back is shaded like the front; otherwise the back emits nothing.
    pub double_sided: bool,
    /// Parametrisation of its reflection.
    pub workflow: Workflow,
    /// The normal map.
    pub normal_map: Option<NormalMap>,
    /// Index of refraction, ≥ 1; 0 stands for infinity (KHR_materials_ior).
    pub ior: f32,
    /// Strength of the dielectric reflection in [0, 1] (KHR_materials_specular).
    pub specular: Scalar,
    /// Colour of the reflection at normal incidence, ≥ 0.
    pub specular_color: Tint,
    /// Fraction of light that is transmitted, in [0, 1] (KHR_materials_transmission).
    pub transmission: Scalar,
    /// The medium behind the surface; `None` for a thin wall (KHR_materials_volume).
    pub volume: Option<Volume>,
    /// 20/Abbe number, ≥ 0 (KHR_materials_dispersion).
    pub dispersion: f32,
    /// KHR_materials_clearcoat.
    pub clearcoat: Option<Clearcoat>,
    /// KHR_materials_sheen.
    pub sheen: Option<Sheen>,
    /// KHR_materials_anisotropy.
    pub anisotropy: Option<Anisotropy>,
    /// KHR_materials_iridescence.
    pub iridescence: Option<Iridescence>,
    /// KHR_materials_diffuse_transmission.
    pub diffuse_transmission: Option<DiffuseTransmission>,
}

/// The parametrisation of a material's reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Workflow {
    /// glTF 2.0's own.
    MetallicRoughness {
        /// In [0, 1]; the texture's blue.
        metallic: Scalar,
        /// In [0, 1]; the texture's green.
        roughness: Scalar,
    },
    /// KHR_materials_pbrSpecularGlossiness.
    SpecularGlossiness {
        /// Reflectance at normal incidence, linear RGB in [0, 1].
        specular: Tint,
        /// 1 − roughness; the texture's alpha.
        glossiness: Scalar,
    },
}

/// A number that is scaled by a channel of a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scalar {
    /// The number.
    pub factor: f32,
    /// The texture and its channel, 0 red … 3 alpha; linear.
    pub texture: Option<(TextureRef, u8)>,
}

/// A linear colour that is scaled by a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tint {
    /// The colour.
    pub factor: Vec3,
    /// The texture.
    pub texture: Option<TextureRef>,
}

/// A texture of normals in tangent space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// Linear; each channel encodes [−1, 1].
    pub texture: TextureRef,
    /// Multiplied into x and y.
    pub scale: f32,
}

/// A homogeneous medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Distance after which white light has `attenuation_color`, > 0; infinite if nothing is attenuated.
    pub attenuation_distance: f64,
    /// Linear RGB in [0, 1].
    pub attenuation_color: Vec3,
}

/// A clear coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// Fraction of the surface that is coated, in [0, 1]; texture channel red.
    pub factor: Scalar,
    /// In [0, 1]; texture channel green.
    pub roughness: Scalar,
    /// The coat's own normal map; without one it is smooth whatever lies beneath.
    pub normal_map: Option<NormalMap>,
}

/// A layer of fibres, as on cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Linear RGB in [0, 1].
    pub color: Tint,
    /// In [0, 1]; texture channel alpha.
    pub roughness: Scalar,
}

/// A highlight that is wider across than along the surface direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// In [0, 1].
    pub strength: f32,
    /// From the tangent, counter-clockwise, rad.
    pub rotation: f32,
    /// Red and green: a direction in [−1, 1]² that `rotation` turns further; blue scales the strength.
    pub texture: Option<TextureRef>,
}

/// A thin film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iridescence {
    /// Fraction of the surface that has it, in [0, 1]; texture channel red.
    pub factor: Scalar,
    /// Index of refraction, ≥ 1.
    pub ior: f32,
    /// Thickness in nm where the texture is 0 and where it is 1 (or without a texture).
    pub thickness: [f32; 2],
    /// Thickness texture, channel green.
    pub thickness_texture: Option<TextureRef>,
}

/// Diffuse light that leaves on the other side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// Its fraction, in [0, 1]; texture channel alpha.
    pub factor: Scalar,
    /// Its colour.
    pub color: Tint,
}

/// How a material's opacity is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Ignored.
    Opaque,
    /// A point exists where opacity ≥ the cutoff.
    Mask(f32),
    /// A point transmits 1 − opacity of the light behind it.
    Blend,
}

impl Scalar {
    /// A parameter that is the same everywhere, without a texture.
    pub const fn constant(factor: f32) -> Self {
        Self { factor, texture: None }
    }
}

impl Tint {
    /// A linear colour that is the same everywhere, without a texture.
    pub const fn constant(factor: Vec3) -> Self {
        Self { factor, texture: None }
    }
}

impl Default for Material {
    /// glTF's default material, without a name: a rough white metal.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            unlit: false,
            alpha: AlphaMode::Opaque,
            double_sided: false,
            workflow: Workflow::MetallicRoughness {
                metallic: Scalar::constant(1.0),
                roughness: Scalar::constant(1.0),
            },
            normal_map: None,
            ior: 1.5,
            specular: Scalar::constant(1.0),
            specular_color: Tint::constant(Vec3::ONE),
            transmission: Scalar::constant(0.0),
            volume: None,
            dispersion: 0.0,
            clearcoat: None,
            sheen: None,
            anisotropy: None,
            iridescence: None,
            diffuse_transmission: None,
        }
    }
}

impl Material {
    /// A white unlit surface: shows its base colour on both sides, whatever the light.
    pub fn unlit_white() -> Self {
        Self { unlit: true, double_sided: true, ..Self::default() }
    }

    /// A white surface that only scatters diffusely: no metal, no reflection (Lambert).
    pub fn lambertian_white() -> Self {
        let workflow =
            Workflow::MetallicRoughness { metallic: Scalar::constant(0.0), roughness: Scalar::constant(1.0) };
        Self { workflow, specular: Scalar::constant(0.0), ..Self::default() }
    }

    /// Whether the material's back faces are hidden, given the scene's setting.
    pub fn culls_back_faces(&self, back_faces: BackFaces) -> bool {
        back_faces == BackFaces::Hide && !self.double_sided
    }

    /// Whether some point of it may transmit light ([`AlphaMode::Mask`] and [`AlphaMode::Blend`]).
    pub fn may_be_transparent(&self) -> bool {
        self.alpha != AlphaMode::Opaque
    }

    /// Whether any property varies over the surface by a texture.
    pub fn has_textures(&self) -> bool {
        self.base_color_texture.is_some() || self.emissive_texture.is_some() || !self.has_uniform_gloss()
    }

    /// Whether neither a normal map nor any texture other than the base colour's varies its reflection.
    pub fn has_uniform_gloss(&self) -> bool {
        let scalar = |scalar: &Scalar| scalar.texture.is_some();
        let tint = |tint: &Tint| tint.texture.is_some();
        let is_workflow_textured = match &self.workflow {
            Workflow::MetallicRoughness { metallic, roughness } => scalar(metallic) || scalar(roughness),
            Workflow::SpecularGlossiness { specular, glossiness } => tint(specular) || scalar(glossiness),
        };
        let is_textured = is_workflow_textured
            || self.normal_map.is_some()
            || scalar(&self.specular)
            || tint(&self.specular_color)
            || scalar(&self.transmission)
            || self.clearcoat.is_some_and(|coat| {
                scalar(&coat.factor) || scalar(&coat.roughness) || coat.normal_map.is_some()
            })
            || self.sheen.is_some_and(|sheen| tint(&sheen.color) || scalar(&sheen.roughness))
            || self.anisotropy.is_some_and(|anisotropy| anisotropy.texture.is_some())
            || self.iridescence.is_some_and(|film| scalar(&film.factor) || film.thickness_texture.is_some())
            || self
                .diffuse_transmission
                .is_some_and(|through| scalar(&through.factor) || tint(&through.color));
        !is_textured
    }

    /// Whether it emits light: unlit, or emissive.
    pub fn is_emitter(&self) -> bool {
        self.unlit || self.emissive != Vec3::ZERO
    }
}
