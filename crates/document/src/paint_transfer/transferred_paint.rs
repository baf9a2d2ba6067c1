//! Transfer of a project's paint to another surface.

use crate::error::DocumentError;
use crate::paint_transfer::correspondences::find_correspondences;
use atlas::{Atlas, TexelMap};
use focus::{FocusLayer, FocusMap, LayerStack, Spread};
use glam::DVec2;
use lens::FocusOffset;
use project::{ProjectFile, TexelSet, surface_to_bytes};
use scene::Scene;
use std::path::Path;

/// The result of a transfer of paint to another surface.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferredPaint {
    /// Nodes with texels that have no corresponding point, in descending order of their share.
    pub unmatched_nodes: Vec<UnmatchedNode>,
    /// The share of the whole surface that has corresponding points, in [0, 1].
    pub matched_share: f64,
}

/// A node with texels that have no corresponding point.
#[derive(Clone, Debug, PartialEq)]
pub struct UnmatchedNode {
    /// Its name.
    pub name: String,
    /// The share of its surface without corresponding points, in (0, 1].
    pub unmatched_share: f64,
}

impl TransferredPaint {
    /// A sentence that describes the transfer to the scene in the file `scene`.
    pub fn summary(&self, scene: &Path) -> String {
        const MAX_LISTED: usize = 8;
        let percent =
            |share: f64| if share >= 0.995 { "all".into() } else { format!("{:.1} %", 100.0 * share) };
        let listed: Vec<_> = (self.unmatched_nodes.iter().take(MAX_LISTED))
            .map(|node| format!("{} of \"{}\"", percent(node.unmatched_share), node.name))
            .collect();
        let more = self.unmatched_nodes.len().saturating_sub(MAX_LISTED);
        let more = if more > 0 { format!(" and parts of {more} more nodes") } else { String::new() };
        let message = match listed.is_empty() {
            true => "all of it was matched".into(),
            false => format!("not matched, with the ordinary lens: {}{more}", listed.join(", ")),
        };
        format!(
            "{}: its surface has changed, and the paint was carried over to it: {message}",
            scene.display()
        )
    }
}

/// Transfers the paint of a project from the surface of `old`, in the project's own atlas, to that of `new`, in `atlas`. The returned project
/// refers to the new scene.
pub(crate) fn transfer_paint(
    project: &ProjectFile,
    old: &Scene,
    new: &Scene,
    atlas: &Atlas,
) -> Result<(ProjectFile, TransferredPaint), DocumentError> {
    let bad_scene = |message: String| DocumentError::bad_file(&project.scene, message);
    let stored =
        project.atlas.as_ref().ok_or_else(|| bad_scene("its project has no atlas (paint it anew)".into()))?;
    let old_atlas = Atlas::from_bytes(stored, old).map_err(|error| bad_scene(error.to_string()))?;
    let new_texels = atlas.texel_map(new);
    let source_positions = find_correspondences(old, &old_atlas, new, &new_texels);
    let transfer = PaintTransfer { atlas, texels: &new_texels, source_positions: &source_positions };

    let focus_map = project.focus_map.as_ref().map(|map| transfer.transfer_map(map));
    let layers = project.layers.as_ref().and_then(|layers| {
        let spread_of = |layer: &FocusLayer| {
            let spread = layer.spread.as_ref()?;
            Some(Spread { strokes: transfer.transfer_map(&spread.strokes), settings: spread.settings })
        };
        let transferred = layers.layers().iter().map(|layer| FocusLayer {
            map: transfer.transfer_map(&layer.map),
            spread: spread_of(layer),
            ..layer.clone()
        });
        LayerStack::new(transferred.collect(), layers.active_index())
    });
    let project = ProjectFile {
        scene: new.path.clone(),
        scene_sha256: ProjectFile::scene_checksum(&new.path)?,
        atlas: Some(atlas.to_bytes()),
        surface: Some(surface_to_bytes(new)),
        focus_map,
        layers,
        selection: transfer.unmatched_texels(),
        ..project.clone()
    };
    Ok((project, transfer.report(new)))
}

/// The sources of the new texels' paint.
struct PaintTransfer<'a> {
    atlas: &'a Atlas,
    texels: &'a TexelMap,
    source_positions: &'a [Option<DVec2>],
}

impl PaintTransfer<'_> {
    fn transfer_map(&self, old: &FocusMap) -> FocusMap {
        let (width, height) = (self.atlas.width, self.atlas.height);
        let count = width as usize * height as usize;
        let standard = FocusOffset::STANDARD;
        let mut values = vec![[standard.t as f32, standard.anchor as f32]; count];
        let mut gloss = vec![standard.gloss as f32; count];
        let mut mask = vec![0.0; count];
        for (texel, source_position) in self.texels.texels.iter().zip(self.source_positions) {
            let Some(source_position) = source_position else { continue };
            let index = texel.y as usize * width as usize + texel.x as usize;
            let focus = old.sample(*source_position);
            values[index] = [focus.t as f32, focus.anchor as f32];
            gloss[index] = focus.gloss as f32;
            mask[index] = old.sample_mask(*source_position);
        }
        self.atlas.dilate(self.texels, &mut values);
        self.atlas.dilate(self.texels, &mut gloss);
        self.atlas.dilate(self.texels, &mut mask);
        let mut map = FocusMap::new(width, height, standard);
        if let Some(transferred) = FocusMap::from_rows(width, height, &values, old.background) {
            map = transferred;
        }
        let is_whole = (!old.has_gloss() || map.set_gloss_rows(&gloss))
            && (!old.has_mask() || map.set_mask_rows(Some(&mask)));
        debug_assert!(is_whole, "rows have the size of the atlas");
        (map.background, map.background_mask) = (old.background, old.background_mask);
        map
    }

    /// The texels without a corresponding point, as a selection; `None` if there are none.
    fn unmatched_texels(&self) -> Option<TexelSet> {
        let unmatched = self
            .texels
            .texels
            .iter()
            .zip(self.source_positions)
            .filter(|(_, source_position)| source_position.is_none());
        let mut unmatched = unmatched.map(|(texel, _)| [texel.x, texel.y]).peekable();
        unmatched.peek()?;
        Some(TexelSet::new([self.atlas.width, self.atlas.height], unmatched))
    }

    fn report(&self, scene: &Scene) -> TransferredPaint {
        let mut areas = vec![[0.0; 2]; scene.nodes.len()];
        for (texel, source_position) in self.texels.texels.iter().zip(self.source_positions) {
            let [node_area, unmatched_area] =
                &mut areas[scene.part_of(texel.centroid.triangle).node as usize];
            *node_area += texel.area;
            *unmatched_area += if source_position.is_none() { texel.area } else { 0.0 };
        }
        let incomplete =
            scene.nodes.iter().zip(&areas).filter(|(_, [_, unmatched_area])| *unmatched_area > 0.0);
        let mut unmatched_nodes: Vec<UnmatchedNode> = incomplete
            .map(|(node, [node_area, unmatched_area])| UnmatchedNode {
                name: node.name.clone(),
                unmatched_share: unmatched_area / node_area,
            })
            .collect();
        unmatched_nodes.sort_by(|a, b| b.unmatched_share.total_cmp(&a.unmatched_share));
        let [total_area, unmatched_area] = areas.iter().fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
        TransferredPaint {
            unmatched_nodes,
            matched_share: if total_area > 0.0 { 1.0 - unmatched_area / total_area } else { 1.0 },
        }
    }
}
