//! XMP: the metadata of a picture in XML, as attributes or as elements.

use super::jpeg::{At, Segments};
use roxmltree::{Document, Node, ParsingOptions};

/// The most elements, and the most attributes of one: the parser compares each with each.
const MAX_NODES: u32 = 100_000;
const MAX_ATTRIBUTES: usize = 1000;

/// The XMP texts of a file: the main one and the extended one.
pub(super) struct XmpTexts {
    texts: Vec<String>,
}

impl XmpTexts {
    /// The XMP texts of a JPEG's segments; empty if there are none.
    pub fn from_segments(segments: &Segments<'_>) -> At<Self> {
        let text = |bytes: &[u8]| {
            let text = String::from_utf8_lossy(bytes);
            text.trim_matches(|c: char| c == '\0' || c == '\u{feff}' || c.is_whitespace()).to_owned()
        };
        let mut texts: Vec<String> = segments.xmp.map(text).into_iter().collect();
        let guid = texts.first().and_then(|text| {
            // As an attribute or as an element.
            let (_, rest) = text.split_once("HasExtendedXMP")?;
            let rest = rest.trim_start_matches(|c: char| !c.is_ascii_hexdigit());
            Some(rest.chars().take_while(char::is_ascii_hexdigit).collect::<String>())
        });
        if let Some(guid) = guid {
            match segments.extended(&guid) {
                Ok(extended) => texts.push(text(&extended)),
                // The extension may not be needed: the directory of Dynamic Depth is in the main text.
                Err(_) if texts[0].contains("DepthURI") => {}
                Err(error) => return Err(error),
            }
        }
        Ok(Self { texts })
    }

    /// The texts, parsed as XML.
    ///
    /// # Errors
    /// Why one is no XML, as text.
    pub fn documents(&self) -> Result<Vec<Document<'_>>, String> {
        self.texts.iter().map(|text| parsed(text)).collect()
    }

    /// Whether any of the texts contains `what`.
    pub fn mention(&self, what: &str) -> bool {
        self.texts.iter().any(|text| text.contains(what))
    }
}

fn parsed(text: &str) -> Result<Document<'_>, String> {
    // An element's tag ends before the next begins.
    if text.split('<').any(|tag| tag.bytes().filter(|byte| *byte == b'=').count() > MAX_ATTRIBUTES) {
        return Err(format!("has an element of more than {MAX_ATTRIBUTES} attributes"));
    }
    let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        // What it quotes may be long.
        let what: String = error.to_string().chars().take(120).collect();
        format!("is not XML: {what}")
    })
}

/// A property of a node: its attribute, or the text of its child, of this name, with any prefix and namespace.
pub(super) fn property<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    let attribute = node.attributes().find(|attribute| attribute.name() == name);
    let child = || node.children().find(|child| child.tag_name().name() == name);
    attribute.map(|attribute| attribute.value()).or_else(|| child()?.text())
}

/// A property of any node, in a namespace that ends so (with or without its last slash).
pub(super) fn find_property<'a>(
    documents: &'a [Document<'_>],
    namespace: &str,
    name: &str,
) -> Option<&'a str> {
    let is_meant = |uri: Option<&str>| uri.is_some_and(|uri| uri.trim_end_matches('/').ends_with(namespace));
    let of_node = |node: Node<'a, '_>| {
        let attribute =
            node.attributes().find(|attribute| attribute.name() == name && is_meant(attribute.namespace()));
        let is_element = node.tag_name().name() == name && is_meant(node.tag_name().namespace());
        attribute.map(|attribute| attribute.value()).or_else(|| is_element.then(|| node.text()).flatten())
    };
    documents.iter().flat_map(|document| document.descendants()).find_map(of_node)
}
