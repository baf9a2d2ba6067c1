//! Extensions: which are supported, which can be ignored, and the remedy for the others.

use crate::error::Fault;
use crate::gltf::document::Document;

/// Supported.
pub(crate) const SUPPORTED: [&str; 26] = [
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_gaussian_splatting",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_materials_iridescence",
];

/// Without influence on the default picture.
const HARMLESS: [&str; 5] = [
    "KHR_animation_pointer",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_xmp",
    "KHR_xmp_json_ld",
];

/// The names in `extensionsUsed`.
pub(crate) fn used<'a>(document: &'a Document<'_>) -> impl Iterator<Item = &'a str> {
    document.typed().extensions_used().chain(document.decoded[0].iter().copied())
}

/// The names in `extensionsRequired`.
pub(crate) fn required<'a>(document: &'a Document<'_>) -> impl Iterator<Item = &'a str> {
    document.typed().extensions_required().chain(document.decoded[1].iter().copied())
}

/// Rejects a document that requires an unsupported extension; warns about visible extensions that are ignored.
pub(crate) fn check(document: &Document<'_>) -> Result<(), Fault> {
    let is_unsupported = |extension: &&str| !SUPPORTED.contains(extension) && !HARMLESS.contains(extension);
    if let Some(extension) = required(document).find(is_unsupported) {
        return Err(Fault::Extension {
            cure: "export the scene without it".into(),
            extension: extension.into(),
        });
    }
    for extension in used(document).filter(is_unsupported) {
        document
            .warn(format!("the extension {extension} is ignored; the picture may differ from other viewers"));
    }
    Ok(())
}
