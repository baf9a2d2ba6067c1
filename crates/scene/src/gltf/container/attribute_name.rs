//! The names of vertex attributes (glTF 2.0 §3.7.2.1).

/// A parsed attribute name.
pub(crate) struct AttributeName<'a> {
    pub base: &'a str,
    pub set: Option<u32>,
}

impl<'a> AttributeName<'a> {
    /// Parses the name of a vertex attribute; `None` if glTF does not define it.
    pub fn parse(name: &'a str) -> Option<Self> {
        if matches!(name, "POSITION" | "NORMAL" | "TANGENT") || name.starts_with('_') && name.len() > 1 {
            return Some(Self { base: name, set: None });
        }
        let (base, set) = name.split_once('_')?;
        let canonical = set == "0" || !set.starts_with('0') && set.bytes().all(|byte| byte.is_ascii_digit());
        let is_numbered = matches!(base, "TEXCOORD" | "COLOR" | "JOINTS" | "WEIGHTS");
        (is_numbered && canonical)
            .then(|| set.parse().ok())
            .flatten()
            .map(|set| Self { base, set: Some(set) })
    }
}
