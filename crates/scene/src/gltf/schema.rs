//! The schema of glTF 2.0: types, ranges and references of the properties of its objects, as tables. They are used
//! twice: to lint a document, and to repair it so that it can be typed.

/// The kind of a property.
pub(crate) enum PropertyKind {
    Flag,
    Text,
    /// In a closed range.
    Number(f64, f64),
    /// Above a limit.
    Above(f64),
    /// A whole number in a closed range.
    Integer(u64, u64),
    /// A multiple of 4 in a closed range.
    MultipleOf4(u64, u64),
    /// One of some numbers.
    Code(&'static [u64]),
    /// One of some texts.
    Word(&'static [&'static str]),
    /// Numbers (minimum and maximum count) in a closed range.
    Numbers(usize, usize, f64, f64),
    /// Index into a collection.
    Index(&'static str),
    /// Distinct indices into a collection, at least one.
    Indices(&'static str),
    /// Distinct texts, at least one.
    Texts,
    /// An object.
    Object(&'static Spec),
    /// Objects, at least one.
    List(&'static Spec),
    /// Accessors by name, at least one.
    Accessors,
    /// Accessors by the name of a vertex attribute, at least one.
    Attributes,
    /// Several of them.
    Targets,
}

use PropertyKind::*;

/// The properties of an object.
pub(crate) struct Spec {
    pub required: &'static [(&'static str, PropertyKind)],
    pub optional: &'static [(&'static str, PropertyKind)],
    /// The extensions allowed here, among the supported ones.
    pub extensions: &'static [(&'static str, &'static Spec)],
    /// (property, property that it requires).
    pub needs: &'static [(&'static str, &'static str)],
    /// Exactly one of these.
    pub one_of: &'static [&'static str],
    /// Optional properties that the typed document requires; they become empty if the file lacks them.
    pub filled: &'static [&'static str],
}

const NONE: Spec =
    Spec { required: &[], optional: &[], extensions: &[], needs: &[], one_of: &[], filled: &[] };

const ANY_NUMBER: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
const COUNT: PropertyKind = Integer(1, u64::MAX);
const OFFSET: PropertyKind = Integer(0, u64::MAX);
const SET: PropertyKind = Integer(0, u32::MAX as u64);
const UNIT: PropertyKind = Number(0.0, 1.0);
/// π/2 as exporters write it, in f32, where it is rounded up.
const RIGHT_ANGLE: f64 = std::f32::consts::FRAC_PI_2 as f64;
const COLOR: PropertyKind = Numbers(3, 3, 0.0, 1.0);
const fn numbers(least: usize, most: usize) -> PropertyKind {
    Numbers(least, most, ANY_NUMBER.0, ANY_NUMBER.1)
}

pub(crate) static ROOT: Spec = Spec {
    required: &[("asset", Object(&ASSET))],
    optional: &[
        ("extensionsUsed", Texts),
        ("extensionsRequired", Texts),
        ("accessors", List(&ACCESSOR)),
        ("animations", List(&ANIMATION)),
        ("buffers", List(&BUFFER)),
        ("bufferViews", List(&BUFFER_VIEW)),
        ("cameras", List(&CAMERA)),
        ("images", List(&IMAGE)),
        ("materials", List(&MATERIAL)),
        ("meshes", List(&MESH)),
        ("nodes", List(&NODE)),
        ("samplers", List(&SAMPLER)),
        ("scene", Index("scenes")),
        ("scenes", List(&SCENE)),
        ("skins", List(&SKIN)),
        ("textures", List(&TEXTURE)),
    ],
    extensions: &[
        ("EXT_lights_image_based", &NONE),
        ("KHR_lights_punctual", &LIGHTS),
        ("KHR_materials_variants", &VARIANTS),
    ],
    needs: &[("extensionsRequired", "extensionsUsed"), ("scene", "scenes")],
    ..NONE
};

static ASSET: Spec = Spec {
    required: &[("version", Text)],
    optional: &[("copyright", Text), ("generator", Text), ("minVersion", Text)],
    ..NONE
};

static ACCESSOR: Spec = Spec {
    required: &[
        ("componentType", Code(&[5120, 5121, 5122, 5123, 5125, 5126])),
        ("count", COUNT),
        ("type", Word(&["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"])),
    ],
    optional: &[
        ("name", Text),
        ("bufferView", Index("bufferViews")),
        ("byteOffset", OFFSET),
        ("normalized", Flag),
        ("max", numbers(1, 16)),
        ("min", numbers(1, 16)),
        ("sparse", Object(&SPARSE)),
    ],
    needs: &[("byteOffset", "bufferView")],
    ..NONE
};

static SPARSE: Spec = Spec {
    required: &[("count", COUNT), ("indices", Object(&SPARSE_INDICES)), ("values", Object(&SPARSE_VALUES))],
    ..NONE
};

static SPARSE_INDICES: Spec = Spec {
    required: &[("bufferView", Index("bufferViews")), ("componentType", Code(&[5121, 5123, 5125]))],
    optional: &[("byteOffset", OFFSET)],
    ..NONE
};

static SPARSE_VALUES: Spec =
    Spec { required: &[("bufferView", Index("bufferViews"))], optional: &[("byteOffset", OFFSET)], ..NONE };

static ANIMATION: Spec = Spec {
    required: &[("channels", List(&CHANNEL)), ("samplers", List(&ANIMATION_SAMPLER))],
    optional: &[("name", Text)],
    ..NONE
};

static CHANNEL: Spec = Spec { required: &[("sampler", OFFSET), ("target", Object(&CHANNEL_TARGET))], ..NONE };

static CHANNEL_TARGET: Spec = Spec {
    required: &[("path", Word(&["translation", "rotation", "scale", "weights", "pointer"]))],
    optional: &[("node", Index("nodes"))],
    ..NONE
};

static ANIMATION_SAMPLER: Spec = Spec {
    required: &[("input", Index("accessors")), ("output", Index("accessors"))],
    optional: &[("interpolation", Word(&["LINEAR", "STEP", "CUBICSPLINE"]))],
    ..NONE
};

static BUFFER: Spec = Spec {
    required: &[("byteLength", COUNT)],
    optional: &[("name", Text), ("uri", Text)],
    extensions: &[("EXT_meshopt_compression", &NONE), ("KHR_meshopt_compression", &NONE)],
    ..NONE
};

static BUFFER_VIEW: Spec = Spec {
    required: &[("buffer", Index("buffers")), ("byteLength", COUNT)],
    optional: &[
        ("name", Text),
        ("byteOffset", OFFSET),
        ("byteStride", MultipleOf4(4, 252)),
        ("target", Code(&[34962, 34963])),
    ],
    ..NONE
};

static CAMERA: Spec = Spec {
    required: &[("type", Word(&["orthographic", "perspective"]))],
    optional: &[
        ("name", Text),
        ("orthographic", Object(&ORTHOGRAPHIC)),
        ("perspective", Object(&PERSPECTIVE)),
    ],
    one_of: &["orthographic", "perspective"],
    ..NONE
};

static ORTHOGRAPHIC: Spec = Spec {
    required: &[
        ("xmag", Number(ANY_NUMBER.0, ANY_NUMBER.1)),
        ("ymag", Number(ANY_NUMBER.0, ANY_NUMBER.1)),
        ("zfar", Above(0.0)),
        ("znear", Number(0.0, ANY_NUMBER.1)),
    ],
    ..NONE
};

static PERSPECTIVE: Spec = Spec {
    required: &[("yfov", Above(0.0)), ("znear", Above(0.0))],
    optional: &[("aspectRatio", Above(0.0)), ("zfar", Above(0.0))],
    ..NONE
};

static IMAGE: Spec = Spec {
    optional: &[
        ("name", Text),
        ("uri", Text),
        ("mimeType", Word(&["image/jpeg", "image/png", "image/webp", "image/ktx2", "image/avif"])),
        ("bufferView", Index("bufferViews")),
    ],
    needs: &[("bufferView", "mimeType")],
    one_of: &["bufferView", "uri"],
    ..NONE
};

static MATERIAL: Spec = Spec {
    optional: &[
        ("name", Text),
        ("pbrMetallicRoughness", Object(&METALLIC_ROUGHNESS)),
        ("normalTexture", Object(&NORMAL_TEXTURE)),
        ("occlusionTexture", Object(&OCCLUSION_TEXTURE)),
        ("emissiveTexture", Object(&TEXTURE_INFO)),
        ("emissiveFactor", COLOR),
        ("alphaMode", Word(&["OPAQUE", "MASK", "BLEND"])),
        ("alphaCutoff", Number(0.0, ANY_NUMBER.1)),
        ("doubleSided", Flag),
    ],
    extensions: &[
        ("KHR_materials_anisotropy", &ANISOTROPY),
        ("KHR_materials_clearcoat", &CLEARCOAT),
        ("KHR_materials_diffuse_transmission", &DIFFUSE_TRANSMISSION),
        ("KHR_materials_dispersion", &DISPERSION),
        ("KHR_materials_emissive_strength", &EMISSIVE_STRENGTH),
        ("KHR_materials_ior", &IOR),
        ("KHR_materials_iridescence", &IRIDESCENCE),
        ("KHR_materials_pbrSpecularGlossiness", &SPECULAR_GLOSSINESS),
        ("KHR_materials_sheen", &SHEEN),
        ("KHR_materials_specular", &SPECULAR),
        ("KHR_materials_transmission", &TRANSMISSION),
        ("KHR_materials_unlit", &NONE),
        ("KHR_materials_volume", &VOLUME),
    ],
    ..NONE
};

static METALLIC_ROUGHNESS: Spec = Spec {
    optional: &[
        ("baseColorFactor", Numbers(4, 4, 0.0, 1.0)),
        ("baseColorTexture", Object(&TEXTURE_INFO)),
        ("metallicFactor", UNIT),
        ("roughnessFactor", UNIT),
        ("metallicRoughnessTexture", Object(&TEXTURE_INFO)),
    ],
    ..NONE
};

static EMISSIVE_STRENGTH: Spec =
    Spec { optional: &[("emissiveStrength", Number(0.0, ANY_NUMBER.1))], ..NONE };

static SPECULAR_GLOSSINESS: Spec = Spec {
    optional: &[
        ("diffuseFactor", Numbers(4, 4, 0.0, 1.0)),
        ("diffuseTexture", Object(&TEXTURE_INFO)),
        ("specularFactor", COLOR),
        ("glossinessFactor", UNIT),
        ("specularGlossinessTexture", Object(&TEXTURE_INFO)),
    ],
    ..NONE
};

static SPECULAR: Spec = Spec {
    optional: &[
        ("specularFactor", UNIT),
        ("specularTexture", Object(&TEXTURE_INFO)),
        ("specularColorFactor", Numbers(3, 3, 0.0, ANY_NUMBER.1)),
        ("specularColorTexture", Object(&TEXTURE_INFO)),
    ],
    ..NONE
};

static ANISOTROPY: Spec = Spec {
    optional: &[
        ("anisotropyStrength", UNIT),
        ("anisotropyRotation", Number(ANY_NUMBER.0, ANY_NUMBER.1)),
        ("anisotropyTexture", Object(&TEXTURE_INFO)),
    ],
    ..NONE
};

static CLEARCOAT: Spec = Spec {
    optional: &[
        ("clearcoatFactor", UNIT),
        ("clearcoatTexture", Object(&TEXTURE_INFO)),
        ("clearcoatRoughnessFactor", UNIT),
        ("clearcoatRoughnessTexture", Object(&TEXTURE_INFO)),
        ("clearcoatNormalTexture", Object(&NORMAL_TEXTURE)),
    ],
    ..NONE
};

static DIFFUSE_TRANSMISSION: Spec = Spec {
    optional: &[
        ("diffuseTransmissionFactor", UNIT),
        ("diffuseTransmissionTexture", Object(&TEXTURE_INFO)),
        ("diffuseTransmissionColorFactor", COLOR),
        ("diffuseTransmissionColorTexture", Object(&TEXTURE_INFO)),
    ],
    ..NONE
};

static DISPERSION: Spec = Spec { optional: &[("dispersion", Number(0.0, ANY_NUMBER.1))], ..NONE };

/// 0 stands for infinity; values between 0 and 1 are not allowed.
static IOR: Spec = Spec { optional: &[("ior", Number(0.0, ANY_NUMBER.1))], ..NONE };

static IRIDESCENCE: Spec = Spec {
    optional: &[
        ("iridescenceFactor", UNIT),
        ("iridescenceTexture", Object(&TEXTURE_INFO)),
        ("iridescenceIor", Number(1.0, ANY_NUMBER.1)),
        ("iridescenceThicknessMinimum", Number(0.0, ANY_NUMBER.1)),
        ("iridescenceThicknessMaximum", Number(0.0, ANY_NUMBER.1)),
        ("iridescenceThicknessTexture", Object(&TEXTURE_INFO)),
    ],
    ..NONE
};

static SHEEN: Spec = Spec {
    optional: &[
        ("sheenColorFactor", COLOR),
        ("sheenColorTexture", Object(&TEXTURE_INFO)),
        ("sheenRoughnessFactor", UNIT),
        ("sheenRoughnessTexture", Object(&TEXTURE_INFO)),
    ],
    ..NONE
};

static TRANSMISSION: Spec = Spec {
    optional: &[("transmissionFactor", UNIT), ("transmissionTexture", Object(&TEXTURE_INFO))],
    ..NONE
};

static VOLUME: Spec = Spec {
    optional: &[
        ("thicknessFactor", Number(0.0, ANY_NUMBER.1)),
        ("thicknessTexture", Object(&TEXTURE_INFO)),
        ("attenuationDistance", Above(0.0)),
        ("attenuationColor", COLOR),
    ],
    ..NONE
};

static TEXTURE_INFO: Spec = Spec {
    required: &[("index", Index("textures"))],
    optional: &[("texCoord", SET)],
    extensions: &[("KHR_texture_transform", &TEXTURE_TRANSFORM)],
    ..NONE
};

static NORMAL_TEXTURE: Spec = Spec {
    required: &[("index", Index("textures"))],
    optional: &[("texCoord", SET), ("scale", Number(ANY_NUMBER.0, ANY_NUMBER.1))],
    extensions: &[("KHR_texture_transform", &TEXTURE_TRANSFORM)],
    ..NONE
};

static OCCLUSION_TEXTURE: Spec = Spec {
    required: &[("index", Index("textures"))],
    optional: &[("texCoord", SET), ("strength", UNIT)],
    extensions: &[("KHR_texture_transform", &TEXTURE_TRANSFORM)],
    ..NONE
};

static TEXTURE_TRANSFORM: Spec = Spec {
    optional: &[
        ("offset", numbers(2, 2)),
        ("rotation", Number(ANY_NUMBER.0, ANY_NUMBER.1)),
        ("scale", numbers(2, 2)),
        ("texCoord", SET),
    ],
    ..NONE
};

static MESH: Spec = Spec {
    required: &[("primitives", List(&PRIMITIVE))],
    optional: &[("name", Text), ("weights", numbers(1, usize::MAX))],
    ..NONE
};

static PRIMITIVE: Spec = Spec {
    required: &[("attributes", Attributes)],
    optional: &[
        ("indices", Index("accessors")),
        ("material", Index("materials")),
        ("mode", Code(&[0, 1, 2, 3, 4, 5, 6])),
        ("targets", Targets),
    ],
    extensions: &[
        ("KHR_draco_mesh_compression", &NONE),
        ("KHR_gaussian_splatting", &NONE),
        ("KHR_materials_variants", &MAPPINGS),
    ],
    ..NONE
};

static VARIANTS: Spec = Spec { required: &[("variants", List(&VARIANT))], ..NONE };

static VARIANT: Spec = Spec { required: &[("name", Text)], ..NONE };

static MAPPINGS: Spec = Spec { required: &[("mappings", List(&MAPPING))], ..NONE };

static MAPPING: Spec = Spec {
    required: &[("material", Index("materials")), ("variants", Indices("variants"))],
    optional: &[("name", Text)],
    ..NONE
};

static NODE: Spec = Spec {
    optional: &[
        ("name", Text),
        ("camera", Index("cameras")),
        ("children", Indices("nodes")),
        ("skin", Index("skins")),
        ("matrix", numbers(16, 16)),
        ("mesh", Index("meshes")),
        ("rotation", Numbers(4, 4, -1.0, 1.0)),
        ("scale", numbers(3, 3)),
        ("translation", numbers(3, 3)),
        ("weights", numbers(1, usize::MAX)),
    ],
    extensions: &[
        ("KHR_lights_punctual", &NODE_LIGHT),
        ("EXT_mesh_gpu_instancing", &INSTANCING),
        ("KHR_node_visibility", &VISIBILITY),
    ],
    needs: &[("skin", "mesh"), ("weights", "mesh")],
    ..NONE
};

static INSTANCING: Spec = Spec { required: &[("attributes", Accessors)], ..NONE };

static VISIBILITY: Spec = Spec { optional: &[("visible", Flag)], ..NONE };

static SAMPLER: Spec = Spec {
    optional: &[
        ("name", Text),
        ("magFilter", Code(&[9728, 9729])),
        ("minFilter", Code(&[9728, 9729, 9984, 9985, 9986, 9987])),
        ("wrapS", Code(&[33071, 33648, 10497])),
        ("wrapT", Code(&[33071, 33648, 10497])),
    ],
    ..NONE
};

static SCENE: Spec = Spec {
    optional: &[("name", Text), ("nodes", Indices("nodes"))],
    extensions: &[("EXT_lights_image_based", &NONE)],
    filled: &["nodes"],
    ..NONE
};

static SKIN: Spec = Spec {
    required: &[("joints", Indices("nodes"))],
    optional: &[("name", Text), ("inverseBindMatrices", Index("accessors")), ("skeleton", Index("nodes"))],
    ..NONE
};

static TEXTURE: Spec = Spec {
    optional: &[("name", Text), ("sampler", Index("samplers")), ("source", Index("images"))],
    extensions: &[("EXT_texture_webp", &TEXTURE_OTHER), ("KHR_texture_basisu", &TEXTURE_OTHER)],
    ..NONE
};

static TEXTURE_OTHER: Spec = Spec { required: &[("source", Index("images"))], ..NONE };

static LIGHTS: Spec = Spec { required: &[("lights", List(&LIGHT))], ..NONE };

static LIGHT: Spec = Spec {
    required: &[("type", Word(&["directional", "point", "spot"]))],
    optional: &[
        ("name", Text),
        ("color", COLOR),
        ("intensity", Number(0.0, ANY_NUMBER.1)),
        ("range", Above(0.0)),
        ("spot", Object(&SPOT)),
    ],
    filled: &["spot"],
    ..NONE
};

static SPOT: Spec = Spec {
    optional: &[("innerConeAngle", Number(0.0, RIGHT_ANGLE)), ("outerConeAngle", Number(0.0, RIGHT_ANGLE))],
    ..NONE
};

static NODE_LIGHT: Spec = Spec { required: &[("light", Index("lights"))], ..NONE };
