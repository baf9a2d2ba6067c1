//! The node hierarchy: which nodes the scene shows, and their transforms.
//!
//! Traversed without recursion, every node once: a node with two parents belongs to the first, a cycle among the
//! shown nodes is an error.
//!
//! KHR_node_visibility hides a node and all its descendants, whatever those declare: their meshes and lights are
//! omitted. Cameras are not part of the picture and stay, as the extension specifies; so do the transforms of joints.

use crate::error::Fault;
use crate::gltf::document::Document;
use glam::{DMat4, DQuat, DVec3};

/// The nodes of a document with their transforms.
pub(crate) struct Hierarchy {
    /// The nodes of the shown scene, parents before children, in file order, including hidden ones.
    pub shown: Vec<usize>,
    /// Whether a node, by its index, or one of its ancestors is hidden.
    pub hidden: Vec<bool>,
    /// World from node, of all nodes reachable from a root, shown or not.
    pub world: Vec<Option<DMat4>>,
}

impl Hierarchy {
    /// Reads the nodes, with their places in the world.
    ///
    /// # Errors
    /// A node is faulty, or nodes are nested in a circle.
    pub fn read(document: &Document<'_>) -> Result<Self, Fault> {
        let count = document.len("nodes");
        let roots = scene_roots(document)?;
        let mut world = vec![None; count];
        let mut hidden = vec![false; count];
        let shown = place_nodes(document, &roots, &mut world, &mut hidden, ErrorHandling::Strict)?;
        // Joints of a skin may lie outside the scene.
        let mut is_child = vec![false; count];
        for node in 0..count {
            children(document, node).for_each(|child| is_child[child] = true);
        }
        let others: Vec<usize> =
            (0..count).filter(|&node| !is_child[node] && world[node].is_none()).collect();
        place_nodes(document, &others, &mut world, &mut hidden, ErrorHandling::Lenient)?;
        Ok(Self { shown, hidden, world })
    }
}

/// How a fault during the traversal is handled.
#[derive(Clone, Copy, PartialEq)]
enum ErrorHandling {
    /// As an error: the nodes are shown.
    Strict,
    /// By ending the branch: the nodes are not shown.
    Lenient,
}

/// The index of the shown scene: `scene`, else the first; `None` if the file has none.
pub(crate) fn shown_scene(document: &Document<'_>) -> Option<usize> {
    let typed = document.typed();
    typed.default_scene().or_else(|| typed.scenes().next()).map(|scene| scene.index())
}

/// The roots of the shown scene: of `scene`, else of the first scene, else all roots.
fn scene_roots(document: &Document<'_>) -> Result<Vec<usize>, Fault> {
    if let Err(fault) = document.check_at("/scene") {
        document.warn(format!("{fault}; another is shown"));
    }
    let typed = document.typed();
    if let Some(scene) = shown_scene(document).and_then(|index| typed.scenes().nth(index)) {
        document.check_below(&format!("/scenes/{}", scene.index()))?;
        return Ok(scene.nodes().map(|node| node.index()).collect());
    }
    let count = document.len("nodes");
    let mut is_child = vec![false; count];
    for node in 0..count {
        children(document, node).for_each(|child| is_child[child] = true);
    }
    let roots: Vec<usize> = (0..count).filter(|&node| !is_child[node]).collect();
    if roots.is_empty() && count > 0 {
        return Err(cycle_error(0));
    }
    Ok(roots)
}

fn children(document: &Document<'_>, node: usize) -> impl DoubleEndedIterator<Item = usize> {
    let node = document.typed().as_json().nodes.get(node);
    let list = node.and_then(|node| node.children.as_deref()).unwrap_or_default();
    list.iter().map(gltf::json::Index::value)
}

fn cycle_error(node: usize) -> Fault {
    Fault::Malformed { place: format!("/nodes/{node}"), what: "is part of a cycle of nodes".into() }
}

/// Computes the transforms of everything below `roots`; depth first, in file order.
fn place_nodes(
    document: &Document<'_>,
    roots: &[usize],
    world: &mut [Option<DMat4>],
    hidden: &mut [bool],
    mode: ErrorHandling,
) -> Result<Vec<usize>, Fault> {
    enum Step {
        Enter { node: usize, parent: Option<usize> },
        Leave(usize),
    }
    let mut stack: Vec<Step> = roots.iter().rev().map(|&node| Step::Enter { node, parent: None }).collect();
    let mut on_path = vec![false; world.len()];
    let mut order = Vec::new();
    while let Some(step) = stack.pop() {
        let (node, parent) = match step {
            Step::Enter { node, parent } => (node, parent),
            Step::Leave(node) => {
                on_path[node] = false;
                continue;
            }
        };
        if on_path.get(node) == Some(&true) {
            match mode {
                ErrorHandling::Strict => return Err(cycle_error(node)),
                ErrorHandling::Lenient => continue,
            }
        }
        if world.get(node).is_some_and(Option::is_some) {
            if mode == ErrorHandling::Strict {
                document.warn(format!("/nodes/{node}: has several parents; only the first counts"));
            }
            continue;
        }
        let read = || {
            document.check_below(&format!("/nodes/{node}/children"))?;
            local_transform(document, node)
        };
        let local = match (read(), mode) {
            (Ok(local), _) => local,
            (Err(fault), ErrorHandling::Strict) => return Err(fault),
            (Err(_), ErrorHandling::Lenient) => continue,
        };
        let parent_world = parent.and_then(|parent| world[parent]).unwrap_or(DMat4::IDENTITY);
        world[node] = Some(parent_world * local);
        hidden[node] = parent.is_some_and(|parent| hidden[parent]) || is_hidden_by_extension(document, node);
        on_path[node] = true;
        order.push(node);
        stack.push(Step::Leave(node));
        let children = children(document, node).rev();
        stack.extend(children.map(|child| Step::Enter { node: child, parent: Some(node) }));
    }
    Ok(order)
}

/// Whether KHR_node_visibility hides a node itself. A fault there hides nothing.
fn is_hidden_by_extension(document: &Document<'_>, node: usize) -> bool {
    const EXTENSION: &str = "KHR_node_visibility";
    if let Err(fault) = document.check_below(&format!("/nodes/{node}/extensions/{EXTENSION}")) {
        document.warn(format!("{fault}; the node is shown"));
    }
    let node = document.typed().as_json().nodes.get(node);
    let extension = node.and_then(|node| node.extensions.as_ref()?.others.get(EXTENSION));
    extension.and_then(|extension| extension.get("visible")?.as_bool()) == Some(false)
}

/// A node's own transform: its matrix, else translation · rotation · scale. The typed document has these numbers in
/// f32, which is too coarse for a scene far from the origin, so they are read from the JSON.
fn local_transform(document: &Document<'_>, node: usize) -> Result<DMat4, Fault> {
    let node = document.item("nodes", node, "/scenes")?;
    if let Some(matrix) = node.numbers::<16>("matrix")? {
        return Ok(DMat4::from_cols_array(&matrix));
    }
    let vector = |key, default| -> Result<DVec3, Fault> {
        Ok(node.numbers::<3>(key)?.map_or(default, DVec3::from_array))
    };
    let rotation = DQuat::from_array(node.numbers::<4>("rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    let rotation = match rotation.length() {
        length if length > 0.0 && length.is_finite() => rotation / length,
        _ => {
            document.warn(format!("{}/rotation: is not a rotation; left out", node.place));
            DQuat::IDENTITY
        }
    };
    Ok(DMat4::from_scale_rotation_translation(
        vector("scale", DVec3::ONE)?,
        rotation,
        vector("translation", DVec3::ZERO)?,
    ))
}
