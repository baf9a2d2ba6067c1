//! The values of a focus: as they are read for arrays, and what they mean to a picture.

use atlas::{Atlas, TexelMap, UnwrapOptions};
use document::Input;
use focus::{Focus, FocusMap, FocusSource};
use lens::FocusOffset;
use light::Steps;
use render::RenderError;
use scene::{Scene, SurfaceField};
use std::path::Path;
use std::sync::Arc;

/// What the elements of the arrays are.
#[derive(Clone)]
pub enum Over {
    /// Texels of the atlas.
    Atlas(Arc<Atlas>, Arc<TexelMap>),
    /// Parts of the scene.
    Part,
    /// Triangles of the scene.
    Triangle,
    /// Gaussian splats; with the sources that all parts had, of which those without splats keep theirs.
    Splat(Vec<FocusSource>),
}

impl Over {
    /// The kinds by name.
    pub const NAMES: [&str; 4] = ["atlas", "part", "triangle", "splat"];

    /// Its name, one of [`Self::NAMES`].
    pub fn name(&self) -> &'static str {
        match self {
            Self::Atlas(..) => "atlas",
            Self::Part => "part",
            Self::Triangle => "triangle",
            Self::Splat(_) => "splat",
        }
    }

    /// The shape of the arrays, of this scene.
    pub fn shape(&self, scene: &Scene) -> Vec<usize> {
        match self {
            Self::Atlas(atlas, _) => vec![atlas.height as usize, atlas.width as usize],
            Self::Part => vec![scene.parts.len()],
            Self::Triangle => vec![scene.triangles.len()],
            Self::Splat(_) => vec![scene.splats.as_ref().map_or(0, |splats| splats.cloud.len())],
        }
    }
}

/// The values of a [`crate::focus::Focus`] outside its arrays.
pub struct FocusValues {
    pub scene: Arc<Scene>,
    pub over: Over,
    pub t: Vec<f32>,
    pub anchor: Vec<f32>,
    pub gloss: Vec<f32>,
    pub background: FocusOffset,
}

impl FocusValues {
    /// The focus of `file`, or that of the input's project, over the elements of this name.
    ///
    /// # Errors
    /// The file cannot be read, the scene cannot be unwrapped or has no such elements, or the focus differs within one of them.
    pub fn read(
        input: &Input,
        file: Option<&Path>,
        over: &str,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<Self, RenderError> {
        let focus = input.focus(file, unwrap, steps)?;
        let bad_file = |what: &str| RenderError::bad_file(file.unwrap_or(&input.path), what);
        match over {
            "part" => {
                let value = |source: &FocusSource| match source {
                    FocusSource::Constant(value) => Some(*value),
                    FocusSource::Triangles(_) | FocusSource::Uv { .. } | FocusSource::Atlas { .. } => None,
                };
                let values: Option<Vec<_>> = focus.parts.iter().map(value).collect();
                let differs = || bad_file("its focus differs within parts (use over=\"atlas\")");
                Ok(Self::of_elements(&focus, Over::Part, &values.ok_or_else(differs)?))
            }
            "triangle" => {
                let bounds = |triangle: u32| focus.bounds(triangle).filter(|[low, high]| low == high);
                let value = |triangle: u32| bounds(triangle).map(|[value, _]| value);
                let values: Option<Vec<_>> = (0..focus.scene.triangles.len() as u32).map(value).collect();
                let differs = || bad_file("its focus differs within triangles (use over=\"atlas\")");
                Ok(Self::of_elements(&focus, Over::Triangle, &values.ok_or_else(differs)?))
            }
            "splat" => {
                let what = "the scene has no Gaussian splats (use over=\"atlas\", \"part\" or \"triangle\")";
                let none = || RenderError::bad_file(&input.path, what);
                let splats = focus.scene.splats.as_ref().ok_or_else(none)?;
                let splat = |splat: u32| focus.at(splats.address(splat));
                let values: Vec<_> = (0..splats.cloud.len() as u32).map(splat).collect();
                Ok(Self::of_elements(&focus, Over::Splat(focus.parts.clone()), &values))
            }
            _ => Self::of_atlas(input, &focus, unwrap, steps),
        }
    }

    fn of_elements(focus: &Focus, over: Over, values: &[FocusOffset]) -> Self {
        let numbers = |number: fn(&FocusOffset) -> f64| values.iter().map(|v| number(v) as f32).collect();
        Self {
            scene: focus.scene.clone(),
            over,
            t: numbers(|value| value.t),
            anchor: numbers(|value| value.anchor),
            gloss: numbers(|value| value.gloss),
            background: focus.background,
        }
    }

    fn of_atlas(
        input: &Input,
        focus: &Focus,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<Self, RenderError> {
        let painted = focus.parts.iter().find_map(|source| match source {
            FocusSource::Atlas { atlas, map } => Some((atlas.clone(), map.clone())),
            FocusSource::Constant(_) | FocusSource::Triangles(_) | FocusSource::Uv { .. } => None,
        });
        let atlas = match &painted {
            Some((atlas, _)) => atlas.clone(),
            None => input.atlas(unwrap, steps)?,
        };
        let scene = focus.scene.clone();
        let texels = Arc::new(atlas.texel_map(&scene));
        let map = painted.map_or_else(|| Arc::new(focus.bake(&texels)), |(_, map)| map);
        let (t, anchor): (Vec<_>, _) = map.to_rows().into_iter().map(|[t, anchor]| (t, anchor)).unzip();
        let gloss = map.gloss_rows().unwrap_or_else(|| vec![0.0; t.len()]);
        let background = focus.background;
        Ok(Self { scene, over: Over::Atlas(atlas, texels), t, anchor, gloss, background })
    }

    /// The focus; `None` if a value is not finite or out of range.
    pub fn evaluate(self) -> Option<Focus> {
        let Self { scene, over, t, anchor, gloss, background } = self;
        if let Over::Atlas(atlas, texels) = over {
            let rows: Vec<_> = t.into_iter().zip(anchor).map(|(t, anchor)| [t, anchor]).collect();
            let mut map = FocusMap::from_rows(atlas.width, atlas.height, &rows, background)?;
            // Without gloss the map's tiles stay blank, and carried light is not drawn twice.
            let is_matt = gloss.iter().all(|gloss| *gloss == 0.0);
            if !(is_matt || map.set_gloss_rows(&gloss)) || !map.is_valid() {
                return None;
            }
            map.fill_gutters(&texels);
            return Some(Focus::from_atlas_map(scene, atlas, Arc::new(map)));
        }
        let offset = |((t, anchor), gloss): ((f32, f32), f32)| {
            FocusOffset::new(t.into(), anchor.into()).with_gloss(gloss.into())
        };
        let values: Vec<FocusOffset> = t.into_iter().zip(anchor).zip(gloss).map(offset).collect();
        if !values.iter().chain([&background]).all(|value| value.is_valid()) {
            return None;
        }
        let parts = match over {
            Over::Atlas(..) | Over::Part => values.into_iter().map(FocusSource::Constant).collect(),
            Over::Triangle => vec![FocusSource::Triangles(values.into()); scene.parts.len()],
            Over::Splat(mut parts) => {
                let splats = scene.splats.as_ref()?.triangles();
                let surfaces = std::iter::repeat_n(FocusOffset::STANDARD, splats.start as usize);
                let part = scene.triangles[splats.start as usize].part;
                parts[part as usize] = FocusSource::Triangles(surfaces.chain(values).collect());
                parts
            }
        };
        Some(Focus { scene, parts, background })
    }
}
