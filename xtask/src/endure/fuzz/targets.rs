//! The targets, and which of them an intact file is a seed of.

/// Fuzz targets: the files of `tests/fuzz/targets`.
pub const TARGETS: [&str; 32] = [
    "gltf",
    "draco",
    "meshopt",
    "ktx2",
    "picture",
    "openexr",
    "radiance",
    "project",
    "part",
    "camera",
    "world",
    "recipe",
    "strokes",
    "keys",
    "preset",
    "focus_map",
    "salf",
    "atlas",
    "colmap",
    "nerfstudio",
    "bundler",
    "visualsfm",
    "metashape",
    "mesh",
    "depth_map",
    "depth_picture",
    "light_field",
    "splat_ply",
    "spz",
    "sog",
    "ksplat",
    "cameras_json",
];

/// The targets that read a file of this name, each with the bytes that it wants before those of the file.
pub fn targets_of(name: &str) -> Vec<(&'static str, &'static [u8])> {
    let plain = |targets: &[&'static str]| targets.iter().map(|target| (*target, &b""[..])).collect();
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    match name {
        "cam.json" => plain(&["camera"]),
        "world.json" => plain(&["world"]),
        "recipe.json" => plain(&["recipe"]),
        "strokes.json" => plain(&["strokes"]),
        "keys.json" => plain(&["keys"]),
        "transforms.json" => plain(&["nerfstudio"]),
        "cameras.json" => plain(&["cameras_json"]),
        "views.json" => vec![("light_field", b"\x02")],
        "parameters.cfg" => vec![("light_field", b"\0")],
        "attributes.dat" => vec![("light_field", b"\x01")],
        "cameras.txt" => vec![("colmap", b"\0")],
        "images.txt" => vec![("colmap", b"\x01")],
        "model.bin" => vec![("colmap", b"\x02")],
        "bundle.out" => plain(&["bundler"]),
        _ => match extension {
            "glb" | "gltf" if name.contains("draco") => plain(&["draco"]),
            "glb" | "gltf" if name.contains("meshopt") => plain(&["meshopt"]),
            "glb" | "gltf" if name.contains("etc1s") || name.contains("uastc") => plain(&["ktx2"]),
            "glb" | "gltf" => plain(&["gltf"]),
            "png" => {
                let mut targets: Vec<_> = plain(&["picture", "focus_map", "depth_map"]);
                targets.push(("light_field", b"\x03"));
                targets
            }
            "jpg" => plain(&["picture", "depth_picture"]),
            "webp" => plain(&["picture"]),
            "exr" => plain(&["openexr", "focus_map", "depth_map", "depth_picture"]),
            "hdr" => plain(&["radiance"]),
            "pfm" => plain(&["depth_map"]),
            "json" => plain(&["preset"]),
            "fbrush" => plain(&["project"]),
            "salf" => plain(&["salf"]),
            "part" => plain(&["part"]),
            "atlas" => plain(&["atlas"]),
            "nvm" => plain(&["visualsfm"]),
            "xml" => plain(&["metashape"]),
            "ply" => plain(&["mesh", "splat_ply"]),
            "obj" => plain(&["mesh"]),
            "spz" => plain(&["spz"]),
            "sog" => plain(&["sog"]),
            "ksplat" | "splat" => plain(&["ksplat"]),
            _ => Vec::new(),
        },
    }
}
