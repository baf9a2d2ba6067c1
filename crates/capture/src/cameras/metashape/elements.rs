//! Elements of Metashape's XML.

use crate::files::text::number;
use roxmltree::Node;

/// The first child of this name.
pub(super) fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// All elements within the children of this name.
pub(super) fn below<'a, 'b>(node: Node<'a, 'b>, name: &'static str) -> impl Iterator<Item = Node<'a, 'b>> {
    node.children().filter(move |child| child.has_tag_name(name)).flat_map(|child| child.descendants())
}

/// The numbers in an element's text, if there are N.
pub(super) fn values<const N: usize>(node: Node<'_, '_>) -> Option<[f64; N]> {
    let fields: Vec<&str> = node.text()?.split_whitespace().take(N + 1).collect();
    (fields.len() == N).then_some(())?;
    let mut values = [0.0; N];
    for (value, field) in values.iter_mut().zip(fields) {
        *value = number(field)?;
    }
    Some(values)
}
