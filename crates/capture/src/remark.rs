//! Remarks on a capture that opened with irregularities.

/// A remark on a capture. Displays as one line, `FILE: what (what to do)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// The sentence.
    pub text: String,
    /// All pictures or files that it is about.
    pub names: Vec<String>,
    /// Whether something is missing that the capture refers to; otherwise it is only information.
    pub is_incomplete: bool,
}

/// The most names that are listed in the sentence.
const MAX_NAMES: usize = 5;

impl Remark {
    /// Information.
    pub(crate) fn note(text: impl Into<String>) -> Self {
        Self { text: text.into(), names: Vec::new(), is_incomplete: false }
    }

    /// A sentence about some names, `None` if there are none; `text` gets their list.
    pub(crate) fn about(
        names: Vec<String>,
        is_incomplete: bool,
        text: impl Fn(&str) -> String,
    ) -> Option<Self> {
        let shown = |name: &String| -> String {
            name.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
        };
        let listed = names.iter().take(MAX_NAMES).map(shown).collect::<Vec<_>>().join(", ");
        let rest = names.len().saturating_sub(MAX_NAMES);
        let listed = if rest > 0 { format!("{listed} and {rest} more") } else { listed };
        (!names.is_empty()).then(|| Self { text: text(&listed), names, is_incomplete })
    }
}

impl std::fmt::Display for Remark {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}
