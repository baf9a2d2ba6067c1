//! A project's paint on another surface.

use super::partners::partners;
use crate::error::SessionError;
use atlas::{Atlas, TexelMap};
use focus::{FocusLayer, FocusMap, LayerStack};
use glam::DVec2;
use lens::FocusOffset;
use project::{ProjectFile, TexelSet, surface_to_bytes};
use scene::Scene;
use std::path::Path;

/// How paint came onto another surface.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedPaint {
    /// Nodes of which something found no partner, most of them first.
    pub gaps: Vec<CarriedNode>,
    /// The share of the whole surface that found one.
    pub share: f64,
}

/// What of a node found no partner.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedNode {
    /// Its name.
    pub name: String,
    /// The share of its surface without a partner, in (0, 1].
    pub share: f64,
}

impl CarriedPaint {
    /// A sentence about the file at `scene`.
    pub fn told(&self, scene: &Path) -> String {
        const LISTED: usize = 8;
        let percent =
            |share: f64| if share >= 0.995 { "all".into() } else { format!("{:.1} %", 100.0 * share) };
        let named: Vec<_> = (self.gaps.iter().take(LISTED))
            .map(|gap| format!("{} of \"{}\"", percent(gap.share), gap.name))
            .collect();
        let more = self.gaps.len().saturating_sub(LISTED);
        let more = if more > 0 { format!(" and parts of {more} more nodes") } else { String::new() };
        let what = match named.is_empty() {
            true => "all of it found its partner".into(),
            false => format!("no partner has {}{more}, which keeps the ordinary lens", named.join(", ")),
        };
        format!("{}: is another surface now, and the paint was carried over to it: {what}", scene.display())
    }
}

/// The project with its paint on the surface of `new`, whose atlas is `atlas`; it lay on that of `old`, in the project's own atlas. The
/// scene of the project is the new one then.
pub(crate) fn carried(
    project: &ProjectFile,
    old: &Scene,
    new: &Scene,
    atlas: &Atlas,
) -> Result<(ProjectFile, CarriedPaint), SessionError> {
    let bad = |what: String| SessionError::bad(&project.scene, what);
    let stored =
        project.atlas.as_ref().ok_or_else(|| bad("its project has no atlas (paint it anew)".into()))?;
    let old_atlas = Atlas::from_bytes(stored, old).map_err(|error| bad(error.to_string()))?;
    let texels = atlas.texel_map(new);
    let places = partners(old, &old_atlas, new, &texels);
    let onto = Onto { atlas, texels: &texels, places: &places };

    let focus_map = project.focus_map.as_ref().map(|map| onto.map(map));
    let layers = project.layers.as_ref().and_then(|layers| {
        let moved =
            layers.layers().iter().map(|layer| FocusLayer { map: onto.map(&layer.map), ..layer.clone() });
        LayerStack::new(moved.collect(), layers.active_index())
    });
    let project = ProjectFile {
        scene: new.path.clone(),
        scene_sha256: ProjectFile::scene_checksum(&new.path)?,
        atlas: Some(atlas.to_bytes()),
        surface: Some(surface_to_bytes(new)),
        focus_map,
        layers,
        selection: onto.gaps(),
        ..project.clone()
    };
    Ok((project, onto.told(new)))
}

/// The way onto the new texels.
struct Onto<'a> {
    atlas: &'a Atlas,
    texels: &'a TexelMap,
    places: &'a [Option<DVec2>],
}

impl Onto<'_> {
    fn map(&self, old: &FocusMap) -> FocusMap {
        let (width, height) = (self.atlas.width, self.atlas.height);
        let count = width as usize * height as usize;
        let standard = FocusOffset::STANDARD;
        let mut values = vec![[standard.t as f32, standard.anchor as f32]; count];
        let mut gloss = vec![standard.gloss as f32; count];
        let mut mask = vec![0.0; count];
        for (texel, place) in self.texels.texels.iter().zip(self.places) {
            let Some(place) = place else { continue };
            let at = texel.y as usize * width as usize + texel.x as usize;
            let focus = old.sample(*place);
            values[at] = [focus.t as f32, focus.anchor as f32];
            gloss[at] = focus.gloss as f32;
            mask[at] = old.sample_mask(*place);
        }
        self.atlas.dilate(self.texels, &mut values);
        self.atlas.dilate(self.texels, &mut gloss);
        self.atlas.dilate(self.texels, &mut mask);
        let mut map = FocusMap::new(width, height, standard);
        if let Some(whole) = FocusMap::from_rows(width, height, &values, old.background) {
            map = whole;
        }
        let is_whole = (!old.has_gloss() || map.set_gloss_rows(&gloss))
            && (!old.has_mask() || map.set_mask_rows(Some(&mask)));
        debug_assert!(is_whole, "rows have the size of the atlas");
        (map.background, map.background_mask) = (old.background, old.background_mask);
        map
    }

    /// Texels without a partner as a selection; none where all have one.
    fn gaps(&self) -> Option<TexelSet> {
        let lonely = self.texels.texels.iter().zip(self.places).filter(|(_, place)| place.is_none());
        let mut lonely = lonely.map(|(texel, _)| [texel.x, texel.y]).peekable();
        lonely.peek()?;
        Some(TexelSet::new([self.atlas.width, self.atlas.height], lonely))
    }

    fn told(&self, scene: &Scene) -> CarriedPaint {
        let mut areas = vec![[0.0; 2]; scene.nodes.len()];
        for (texel, place) in self.texels.texels.iter().zip(self.places) {
            let [all, without] = &mut areas[scene.part_of(texel.centroid.triangle).node as usize];
            *all += texel.area;
            *without += if place.is_none() { texel.area } else { 0.0 };
        }
        let of_node = scene.nodes.iter().zip(&areas).filter(|(_, [_, without])| *without > 0.0);
        let mut gaps: Vec<CarriedNode> = of_node
            .map(|(node, [all, without])| CarriedNode { name: node.name.clone(), share: without / all })
            .collect();
        gaps.sort_by(|a, b| b.share.total_cmp(&a.share));
        let [all, without] = areas.iter().fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
        CarriedPaint { gaps, share: if all > 0.0 { 1.0 - without / all } else { 1.0 } }
    }
}
