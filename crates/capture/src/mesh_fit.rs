//! Whether a mesh fits its photographs.
//!
//! A small patch of one photograph is carried to another one through the surface: each of its pixels to where the surface point in it is
//! seen. If the mesh is right, the patch looks like what is there more than like what is 3 or 8 pixels beside it, in any of eight directions.
//! If it is not, the place is arbitrary, and one in seventeen patches agrees by chance. Correlation decides, so neither exposure nor white
//! balance matters, and only patches with something on them are compared.
//!
//! The stages: `view_pairs` (which photographs are compared) → `distance_map` (which surface point is in a pixel, and where else it is
//! visible) → `grey_picture` → `patches` (correlations).

mod distance_map;
mod grey_picture;
mod patches;
mod view_pairs;

use distance_map::DistanceMap;
use glam::{DVec2, DVec3};
use grey_picture::GreyPicture;
use patches::{Patterns, Tally, compare};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::{LoadOptions, Scene, View};
use std::collections::BTreeMap;
use view_pairs::{at_once, choose_pairs};

/// How well a mesh fits its photographs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshFit {
    /// The share of patches that look like another photograph where the mesh carries them, more than beside that place, 0 to 1.
    pub agreement: f64,
    /// How many patches were compared.
    pub patches: u32,
}

impl MeshFit {
    /// The agreement of a mesh that has nothing to do with the photographs.
    pub const BY_CHANCE: f64 = patches::BY_CHANCE;
    /// The least agreement of a mesh that fits.
    const LEAST: f64 = 0.35;
    /// With fewer patches nothing is claimed.
    const MIN_PATCHES: u32 = 40;

    /// Whether the mesh certainly does not fit.
    pub fn is_contradicted(&self) -> bool {
        self.agreement < Self::LEAST && self.patches >= Self::MIN_PATCHES
    }
}

impl std::fmt::Display for MeshFit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:.0} % of {} patches look alike in two photographs ({:.0} % would by chance)",
            100.0 * self.agreement,
            self.patches,
            100.0 * Self::BY_CHANCE
        )
    }
}

/// What photographs show of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum MeshObservation {
    /// None shows any of it.
    NotVisible,
    /// It is visible only where photographs are blank, though they are not so elsewhere.
    OnBlanks,
    /// It is visible; how well it fits, if enough of it has a pattern and is in two photographs.
    Visible(Option<MeshFit>),
}

impl MeshObservation {
    /// How well the mesh fits; `None` if no photograph shows enough of it.
    pub fn fit(&self) -> Option<MeshFit> {
        match self {
            Self::NotVisible | Self::OnBlanks => None,
            Self::Visible(fit) => *fit,
        }
    }

    /// How far the mesh agrees with the photographs, as text for a message.
    pub fn share(&self) -> String {
        match self {
            Self::NotVisible | Self::OnBlanks => "none".into(),
            Self::Visible(None) => "unknown".into(),
            Self::Visible(Some(fit)) => format!("{:.0} %", 100.0 * fit.agreement),
        }
    }

    /// Whether the mesh fits clearly better, beyond chance, than it does `elsewhere`.
    pub fn fits_better_than(&self, elsewhere: &Self) -> bool {
        /// More than chance makes of the fewest patches.
        const MARGIN: f64 = 0.15;
        match (self.fit(), elsewhere) {
            (Some(fit), _) if fit.is_contradicted() => false,
            (Some(fit), Self::Visible(Some(other))) => fit.agreement > other.agreement + MARGIN,
            (Some(_), _) => true,
            (None, Self::NotVisible | Self::OnBlanks) => matches!(self, Self::Visible(None)),
            (None, Self::Visible(_)) => false,
        }
    }
}

/// Measures how well the surface fits the photographs. Pictures that cannot be read are not compared.
pub(crate) fn measure(
    scene: &Scene,
    views: &[View],
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<MeshObservation, Cancelled> {
    let Some(pairs) = choose_pairs(scene, views) else { return Ok(MeshObservation::NotVisible) };
    progress.check()?;
    progress.report(0.4);
    let mut reductions: BTreeMap<usize, f64> = BTreeMap::new();
    for pair in &pairs {
        for view in pair.views {
            reductions.entry(view).or_insert_with(|| reduction(&views[view], &pair.points));
        }
    }
    let chosen: Vec<(usize, f64)> = reductions.into_iter().collect();
    // Large photographs take much memory while they are read.
    const LARGE: u64 = 8_000_000;
    let size = |view: usize| views[view].lens.size_px().map(u64::from).iter().product::<u64>();
    let is_large = chosen.iter().any(|(view, _)| size(*view) > LARGE);
    let at_once = if is_large { 2 } else { at_once(scene) };
    let mut prepared: BTreeMap<usize, (DistanceMap, GreyPicture)> = BTreeMap::new();
    for chunk in chosen.chunks(at_once) {
        progress.check()?;
        let prepare = |(view, factor): &(usize, f64)| {
            let map = DistanceMap::new(scene, &views[*view], *factor);
            let picture = GreyPicture::read(&views[*view], &map, options).ok()?;
            Some((*view, (map, picture)))
        };
        prepared.par_extend(chunk.par_iter().filter_map(prepare));
    }
    progress.report(0.8);
    let ordered_pairs: Vec<[usize; 2]> =
        pairs.iter().map(|pair| pair.views).flat_map(|[a, b]| [[a, b], [b, a]]).collect();
    let tallies = ordered_pairs.par_iter().filter_map(|[from, to]| {
        let (from_map, from_picture) = prepared.get(from)?;
        let (to_map, to_picture) = prepared.get(to)?;
        Some(compare((&views[*from], from_map, from_picture), (&views[*to], to_map, to_picture)))
    });
    let Tally { patches, agreeing } = tallies.sum();
    progress.report(1.0);
    let agreement = f64::from(agreeing) / f64::from(patches.max(1));
    if patches >= MeshFit::MIN_PATCHES {
        return Ok(MeshObservation::Visible(Some(MeshFit { agreement, patches })));
    }
    let patterns: Patterns = prepared.values().map(|(map, picture)| patches::patterns(map, picture)).sum();
    Ok(if patterns.is_surface_elsewhere() {
        MeshObservation::OnBlanks
    } else {
        MeshObservation::Visible(None)
    })
}

/// By how much a photograph is reduced along each side: so that the surface is some hundred pixels wide, and the error of a pose, a pixel
/// or a few, hardly shows. The points are on the surface.
fn reduction(view: &View, points: &[DVec3]) -> f64 {
    /// px
    const EXTENT: f64 = 320.0;
    const LONGEST: f64 = 1000.0;
    let [width, height] = view.lens.size_px().map(f64::from);
    let pixels = points.iter().filter_map(|point| view.project(*point));
    let (low, high) = pixels.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), pixel| {
        let pixel = pixel.clamp(DVec2::ZERO, DVec2::new(width, height));
        (low.min(pixel), high.max(pixel))
    });
    let extent = (high - low).max_element().max(0.0);
    (extent / EXTENT).max(width.max(height) / LONGEST).round().max(1.0)
}
