//! Options of reading a scene file: its variant, and resource limits.

/// The variant, and limits that protect the machine from a hostile or broken file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadOptions {
    /// Maximum bytes held at once: files, decoded images, vertices and triangles together.
    pub max_memory: u64,
    /// Bytes beyond them for each byte of a file, so that a large model may take what it needs, and a small file that claims to be large may not.
    pub memory_per_file_byte: u64,
    /// Triangles after instancing.
    pub max_triangles: u64,
    /// Texels of one image.
    pub max_texels: u64,
    /// The name of a variant (KHR_materials_variants), one of [`crate::Scene::variants`]; `None`: the file's own
    /// materials.
    pub variant: Option<String>,
}

impl Default for LoadOptions {
    /// 640 MiB (so that the whole program stays below 1 GiB for small files), 20 million triangles, images up to 8192²; the file's own
    /// materials.
    fn default() -> Self {
        Self {
            max_memory: 640 << 20,
            memory_per_file_byte: 20,
            max_triangles: 20_000_000,
            max_texels: 8192 * 8192,
            variant: None,
        }
    }
}
