//! Reading the file's materials.

use crate::error::Fault;
use crate::gltf::document::{Document, nonempty_name};
use crate::gltf::focus_brush_extras;
use crate::gltf::materials::lenient_properties::LenientProperties;
use crate::gltf::materials::texture_info::further_uv_sets;
use crate::gltf::materials::texture_reader::TextureReader;
use crate::{
    AlphaMode, Anisotropy, Clearcoat, DiffuseTransmission, Image, Iridescence, Material, Sheen, TextureRef,
    Volume, Workflow,
};
use glam::{Vec3, Vec4};

const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// glTF's default material.
pub(crate) fn default_material() -> Material {
    Material { name: "default material".into(), ..Material::default() }
}

/// Reads materials.
pub(crate) struct MaterialReader<'a> {
    textures: TextureReader<'a>,
}

impl<'a> MaterialReader<'a> {
    /// A reader of a document's materials that has read none.
    pub fn new(document: &'a Document<'a>) -> Self {
        Self { textures: TextureReader::new(document) }
    }

    /// The images that the materials read so far need, by their index in the scene.
    pub fn into_images(self) -> Vec<Image> {
        self.textures.images
    }

    /// The name of material `index`, or a substitute if it has none.
    pub fn material_name(&self, index: usize) -> String {
        let material = self.textures.document.typed().materials().nth(index);
        material
            .and_then(|material| nonempty_name(material.name()))
            .unwrap_or_else(|| format!("material {index}"))
    }

    /// Reads material `index`, which is used by `place`. Faults in base colour, emission or opacity are errors; any
    /// other faulty property is reported as a warning and left out.
    ///
    /// # Errors
    /// The material does not exist, or its base colour, emission or opacity is faulty.
    pub fn read(&mut self, index: usize, place: &str) -> Result<Material, Fault> {
        let document = self.textures.document;
        let place = document.entry("materials", index, place)?;
        let name = self.material_name(index);
        let Some(file) = document.typed().materials().nth(index) else {
            return Ok(Material { name, ..default_material() });
        };
        document.check_at(&place)?;
        for key in ["pbrMetallicRoughness", "emissiveFactor", "doubleSided"] {
            document.check_below(&format!("{place}/{key}"))?;
        }
        check_color_extensions(document, &format!("{place}/extensions"))?;
        let sets = further_uv_sets(document, Some(index));
        if let Some(radiance) = self.read_radiance(index, &sets) {
            return Ok(Material {
                name,
                double_sided: file.double_sided(),
                base_color_texture: Some(radiance),
                unlit: true,
                ..Material::default()
            });
        }
        let (base_color, [section, texture]) = read_base_color(&file);
        let emissive = file.emissive_strength().unwrap_or(1.0) * Vec3::from_array(file.emissive_factor());
        if !base_color.is_finite() || !emissive.is_finite() {
            return Err(Fault::Malformed { place, what: "its colours are not finite".into() });
        }
        if emissive != Vec3::ZERO {
            document.check_below(&format!("{place}/emissiveTexture"))?;
        }
        let mut material = Material {
            name,
            base_color,
            emissive,
            unlit: file.unlit(),
            double_sided: file.double_sided(),
            alpha: match file.alpha_mode() {
                gltf::material::AlphaMode::Opaque => AlphaMode::Opaque,
                gltf::material::AlphaMode::Mask => {
                    document.check_at(&format!("{place}/alphaCutoff"))?;
                    AlphaMode::Mask(file.alpha_cutoff().unwrap_or(0.5))
                }
                gltf::material::AlphaMode::Blend => AlphaMode::Blend,
            },
            ..Material::default()
        };
        let object = document.item("materials", index, &place)?;
        let mut properties = LenientProperties::new(&mut self.textures, object, &sets);
        material.base_color_texture =
            properties.section(section).and_then(|mut section| section.texture(texture, true));
        if material.emissive != Vec3::ZERO {
            material.emissive_texture = properties.texture("emissiveTexture", true);
        }
        if !material.unlit {
            read_scattering(&mut material, &mut properties);
        }
        Ok(material)
    }
}

impl MaterialReader<'_> {
    /// The texture of the radiance that material `index` emits, if it has one.
    fn read_radiance(&mut self, index: usize, sets: &[u32]) -> Option<TextureRef> {
        let document = self.textures.document;
        let info = document
            .item("materials", index, "")
            .and_then(|object| focus_brush_extras::radiance(document, &object));
        let info = info.unwrap_or_else(|fault| {
            document.warn(format!("{fault}; the light is left out"));
            None
        });
        self.textures.radiance(&info?, sets)
    }
}

/// The base colour, and the section and key of the texture that scales it: that of metallic-roughness, or the diffuse
/// colour of KHR_materials_pbrSpecularGlossiness, which takes precedence if both exist. An unlit material shows its
/// base colour by definition, if it has one.
fn read_base_color(file: &gltf::Material<'_>) -> (Vec4, [&'static str; 2]) {
    let plain = file.pbr_metallic_roughness();
    let factor = Vec4::from_array(plain.base_color_factor());
    let has_base_color = plain.base_color_texture().is_some() || factor != Vec4::ONE;
    match file.pbr_specular_glossiness().filter(|_| !(file.unlit() && has_base_color)) {
        Some(glossy) => (Vec4::from_array(glossy.diffuse_factor()), [SPECULAR_GLOSSINESS, "diffuseTexture"]),
        None => (factor, ["pbrMetallicRoughness", "baseColorTexture"]),
    }
}

/// Reads all scattering properties except the base colour.
fn read_scattering(material: &mut Material, file: &mut LenientProperties<'_, '_>) {
    const UNLIMITED: f32 = f32::MAX;
    material.normal_map = file.normal_map("normalTexture");
    material.workflow = read_workflow(file);
    if let Some(index) = file.section("KHR_materials_ior") {
        let ior = index.number("ior", 1.5, [0.0, UNLIMITED]);
        material.ior = if ior == 0.0 { 0.0 } else { ior.max(1.0) };
    }
    if let Some(mut specular) = file.section("KHR_materials_specular") {
        material.specular = specular.scalar(["specularFactor", "specularTexture"], 1.0, 3);
        material.specular_color =
            specular.tint(["specularColorFactor", "specularColorTexture"], Vec3::ONE, UNLIMITED);
    }
    if let Some(mut transmission) = file.section("KHR_materials_transmission") {
        material.transmission = transmission.scalar(["transmissionFactor", "transmissionTexture"], 0.0, 0);
    }
    if let Some(volume) = file.section("KHR_materials_volume")
        && volume.number("thicknessFactor", 0.0, [0.0, UNLIMITED]) > 0.0
    {
        material.volume = Some(Volume {
            attenuation_distance: volume.distance("attenuationDistance"),
            attenuation_color: volume.color("attenuationColor", Vec3::ONE, 1.0),
        });
    }
    if let Some(dispersion) = file.section("KHR_materials_dispersion") {
        material.dispersion = dispersion.number("dispersion", 0.0, [0.0, UNLIMITED]);
    }
    material.clearcoat = file.section("KHR_materials_clearcoat").and_then(|mut coat| {
        let factor = coat.scalar(["clearcoatFactor", "clearcoatTexture"], 0.0, 0);
        (factor.factor > 0.0).then(|| Clearcoat {
            factor,
            roughness: coat.scalar(["clearcoatRoughnessFactor", "clearcoatRoughnessTexture"], 0.0, 1),
            normal_map: coat.normal_map("clearcoatNormalTexture"),
        })
    });
    material.sheen = file.section("KHR_materials_sheen").and_then(|mut sheen| {
        let color = sheen.tint(["sheenColorFactor", "sheenColorTexture"], Vec3::ZERO, 1.0);
        let roughness = ["sheenRoughnessFactor", "sheenRoughnessTexture"];
        (color.factor != Vec3::ZERO).then(|| Sheen { color, roughness: sheen.scalar(roughness, 0.0, 3) })
    });
    material.anisotropy = file.section("KHR_materials_anisotropy").and_then(|mut anisotropy| {
        let strength = anisotropy.number("anisotropyStrength", 0.0, [0.0, 1.0]);
        (strength > 0.0).then(|| Anisotropy {
            strength,
            rotation: anisotropy.number("anisotropyRotation", 0.0, [-UNLIMITED, UNLIMITED]),
            texture: anisotropy.texture("anisotropyTexture", false),
        })
    });
    material.iridescence = file.section("KHR_materials_iridescence").and_then(|mut film| {
        let factor = film.scalar(["iridescenceFactor", "iridescenceTexture"], 0.0, 0);
        let ends = [("iridescenceThicknessMinimum", 100.0), ("iridescenceThicknessMaximum", 400.0)];
        (factor.factor > 0.0).then(|| Iridescence {
            factor,
            ior: film.number("iridescenceIor", 1.3, [1.0, UNLIMITED]),
            thickness: ends.map(|(key, absent)| film.number(key, absent, [0.0, UNLIMITED])),
            thickness_texture: film.texture("iridescenceThicknessTexture", false),
        })
    });
    material.diffuse_transmission =
        file.section("KHR_materials_diffuse_transmission").and_then(|mut through| {
            let factor = through.scalar(["diffuseTransmissionFactor", "diffuseTransmissionTexture"], 0.0, 3);
            let color = ["diffuseTransmissionColorFactor", "diffuseTransmissionColorTexture"];
            (factor.factor > 0.0)
                .then(|| DiffuseTransmission { factor, color: through.tint(color, Vec3::ONE, 1.0) })
        });
}

/// Metalness and roughness, or colour and glossiness of the reflection.
fn read_workflow(file: &mut LenientProperties<'_, '_>) -> Workflow {
    if let Some(mut glossy) = file.section(SPECULAR_GLOSSINESS) {
        const TEXTURE: &str = "specularGlossinessTexture";
        return Workflow::SpecularGlossiness {
            specular: glossy.tint(["specularFactor", TEXTURE], Vec3::ONE, 1.0),
            glossiness: glossy.scalar(["glossinessFactor", TEXTURE], 1.0, 3),
        };
    }
    const TEXTURE: &str = "metallicRoughnessTexture";
    let section = file.section("pbrMetallicRoughness");
    section.map_or(Material::default().workflow, |mut own| Workflow::MetallicRoughness {
        metallic: own.scalar(["metallicFactor", TEXTURE], 1.0, 2),
        roughness: own.scalar(["roughnessFactor", TEXTURE], 1.0, 1),
    })
}

/// An error if a material's `extensions` have a fault that affects its colours.
fn check_color_extensions(document: &Document<'_>, place: &str) -> Result<(), Fault> {
    document.check_at(place)?;
    for name in ["emissive_strength", "unlit"] {
        document.check_below(&format!("{place}/KHR_materials_{name}"))?;
    }
    let glossy = format!("{place}/{SPECULAR_GLOSSINESS}");
    document.check_at(&glossy)?;
    document.check_below(&format!("{glossy}/diffuseFactor"))?;
    document.check_below(&format!("{glossy}/diffuseTexture"))
}
