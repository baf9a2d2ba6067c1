//! The scene at a time: posed by the animation of its file, with a matching atlas.
//!
//! Atlas and paint belong to the surface at rest. A triangle keeps its place in the atlas wherever it moves, so that a texel stays on its
//! piece of surface ([`posed_atlas`]).

use crate::error::RenderError;
use atlas::Atlas;
use document::build_canvas;
use focus::{Canvas, Focus, FocusMap, FocusSource};
use glam::{DVec2, DVec3, Vec2};
use lens::FocusOffset;
use light::{LightOptions, LitScene, Resources, content_hash};
use progress::Progress;
use scene::{AnimatedScene, AnimationTime, PosedScene, RestTriangle, Scene, SurfacePoint};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};
use trace::Tracer;

/// A scene at a time.
pub(crate) struct SceneInTime {
    /// The scene.
    pub scene: Arc<Scene>,
    /// A hash of everything that emits, blocks or reflects light.
    pub hash: [u8; 32],
    /// The rest triangle of each triangle; `None` if all are in place.
    at_rest: Option<Vec<Option<RestTriangle>>>,
    /// The current triangle of each rest triangle, and whether it is flipped; computed on first use.
    now: OnceLock<HashMap<u32, (u32, bool)>>,
    lit: OnceLock<Arc<LitScene>>,
    light: LightOptions,
    resources: Resources,
    atlas: OnceLock<Arc<Atlas>>,
    canvas: OnceLock<Canvas>,
}

impl SceneInTime {
    /// A scene that is not moved from where its file has it.
    pub fn at_rest(lit: Arc<LitScene>) -> Self {
        let scene = lit.scene().clone();
        let still = Self::new(scene, None, &lit);
        let _ = still.lit.set(lit);
        still
    }

    fn new(scene: Arc<Scene>, at_rest: Option<Vec<Option<RestTriangle>>>, like: &LitScene) -> Self {
        let (light, resources) = (like.options(), like.resources().clone());
        let hash = content_hash(&scene, light);
        let (now, lit, atlas, canvas) = Default::default();
        Self { scene, hash, at_rest, now, lit, light, resources, atlas, canvas }
    }

    /// The scene at `moment`, its light modelled as that of `like`.
    ///
    /// # Errors
    /// The animation is faulty, or `progress` asks to stop.
    pub fn moved(
        moving: &AnimatedScene,
        moment: &AnimationTime,
        like: &LitScene,
        progress: &dyn Progress,
    ) -> Result<Self, RenderError> {
        let posed = moving.pose_at(moment, progress)?;
        let is_in_place =
            posed.matches_rest() && posed.scene.triangles.len() == moving.rest().triangles.len();
        let PosedScene { scene, rest_triangles: at_rest } = posed;
        Ok(Self::new(Arc::new(scene), (!is_in_place).then_some(at_rest), like))
    }

    /// The scene ready for rays, with its light.
    pub fn lit(&self) -> &Arc<LitScene> {
        self.lit.get_or_init(|| {
            LitScene::new(Arc::new(Tracer::new(self.scene.clone())), self.light, &self.resources)
        })
    }

    /// The atlas of this scene, derived from the atlas of the scene at rest, which must be the same in every call.
    pub fn atlas(&self, rest: &Arc<Atlas>) -> &Arc<Atlas> {
        self.atlas.get_or_init(|| match &self.at_rest {
            None => rest.clone(),
            Some(at_rest) => Arc::new(posed_atlas(rest, &self.scene, at_rest)),
        })
    }

    /// The canvas of [`Self::atlas`]: positions of its texels.
    pub fn canvas(&self, rest: &Arc<Atlas>) -> &Canvas {
        self.canvas.get_or_init(|| {
            let atlas = self.atlas(rest);
            build_canvas(&self.scene, atlas, &atlas.texel_map(&self.scene))
        })
    }

    /// The current position of a point of the surface at rest; `None` if it is hidden.
    pub fn position(&self, point: SurfacePoint) -> Option<DVec3> {
        let here = match &self.at_rest {
            None => point,
            Some(at_rest) => {
                let (triangle, is_turned) =
                    *self.now.get_or_init(|| current_triangles(at_rest)).get(&point.triangle)?;
                let DVec2 { x, y } = point.barycentric;
                SurfacePoint {
                    triangle,
                    barycentric: if is_turned { DVec2::new(y, x) } else { point.barycentric },
                }
            }
        };
        here.checked_position(&self.scene)
    }

    /// The focus of the scene at rest, carried over to the current surface. `painted`, if given, replaces the focus map. Surfaces that
    /// were hidden at rest have the standard focus.
    pub fn focus(&self, rest: &Focus, painted: Option<&Arc<FocusMap>>) -> Focus {
        let now = |source: &FocusSource| match source {
            FocusSource::Atlas { atlas, map } => {
                FocusSource::Atlas { atlas: self.atlas(atlas).clone(), map: painted.unwrap_or(map).clone() }
            }
            FocusSource::Triangles(values) => FocusSource::Triangles(self.of_triangles(values)),
            other => other.clone(),
        };
        let source = |part: &scene::Part| match &self.at_rest {
            None => Some(now(&rest.parts[rest.scene.triangles[part.triangles.start as usize].part as usize])),
            Some(at_rest) => {
                let triangles = part.triangles.start as usize..part.triangles.end as usize;
                let rest_triangle = at_rest[triangles].iter().flatten().next()?;
                Some(now(&rest.parts[rest.scene.triangles[rest_triangle.triangle as usize].part as usize]))
            }
        };
        let nowhere = FocusSource::Constant(FocusOffset::STANDARD);
        let parts = self.scene.parts.iter().map(|part| source(part).unwrap_or(nowhere.clone())).collect();
        let background = painted.map_or(rest.background, |map| map.background);
        Focus { scene: self.scene.clone(), parts, background }
    }

    /// The values of the current triangles, of those at rest.
    fn of_triangles(&self, values: &Arc<[FocusOffset]>) -> Arc<[FocusOffset]> {
        let Some(at_rest) = &self.at_rest else { return values.clone() };
        let value = |rest: &Option<RestTriangle>| {
            rest.map_or(FocusOffset::STANDARD, |rest| values[rest.triangle as usize])
        };
        at_rest.iter().map(value).collect()
    }
}

/// The current triangle of each rest triangle, and whether its winding is flipped.
fn current_triangles(at_rest: &[Option<RestTriangle>]) -> HashMap<u32, (u32, bool)> {
    let place =
        |(now, rest): (u32, &Option<RestTriangle>)| rest.map(|rest| (rest.triangle, (now, rest.is_flipped)));
    (0..).zip(at_rest).filter_map(place).collect()
}

/// The atlas of a posed scene: its triangles have the same places as in the atlas at rest, whose hash it keeps. Triangles that were hidden
/// at rest cover no texel.
fn posed_atlas(rest: &Atlas, scene: &Scene, at_rest: &[Option<RestTriangle>]) -> Atlas {
    let mut charts: HashMap<(Option<u32>, u32), u32> = HashMap::new();
    let (mut corners, mut chart_of, mut part_of_chart) = (Vec::new(), Vec::new(), Vec::new());
    for (triangle, rest_triangle) in scene.triangles.iter().zip(at_rest) {
        let [a, b, c] = rest_triangle
            .map_or([Vec2::ZERO; 3], |rest_triangle| rest.corners[rest_triangle.triangle as usize]);
        corners.push(if rest_triangle.is_some_and(|rest_triangle| rest_triangle.is_flipped) {
            [a, c, b]
        } else {
            [a, b, c]
        });
        let chart = (
            rest_triangle.map(|rest_triangle| rest.chart_of[rest_triangle.triangle as usize]),
            triangle.part,
        );
        chart_of.push(*charts.entry(chart).or_insert_with(|| {
            part_of_chart.push(triangle.part);
            part_of_chart.len() as u32 - 1
        }));
    }
    let atlas = Atlas::new([rest.width, rest.height], corners, chart_of, &part_of_chart, rest.density);
    Atlas { hash: rest.hash.clone(), ..atlas }
}

#[cfg(test)]
mod tests {
    use super::*;
    use atlas::UnwrapOptions;
    use document::load_scene;
    use progress::Unwatched;
    use scene::{LoadOptions, SurfaceField};

    #[test]
    fn every_point_keeps_its_paint_wherever_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("moving.glb");
        // What is hidden later stands first, so that all that follows has another number then.
        let [wall, card, dot] = crate::tiny_glb::QUADS;
        std::fs::write(&file, crate::tiny_glb::moving(&[wall, card, dot, wall])).unwrap();
        let rest = load_scene(&file, &Unwatched).unwrap();
        let atlas = Arc::new(Atlas::unwrap(&rest, &UnwrapOptions::default(), &Unwatched).unwrap());
        let mut map = FocusMap::new(atlas.width, atlas.height, FocusOffset::STANDARD);
        for y in 0..atlas.height {
            (0..atlas.width).for_each(|x| map.set(x, y, [x as f32 * 0.01, y as f32 / atlas.height as f32]));
        }
        let painted = Focus::from_atlas_map(rest.clone(), atlas.clone(), Arc::new(map));
        let light = LightOptions::default();
        let still = LitScene::new(Arc::new(Tracer::new(rest.clone())), light, &Resources::default());
        let moving = AnimatedScene::open(rest.clone(), &LoadOptions::default(), &Unwatched).unwrap();
        let moment = AnimationTime { animation: None, seconds: 0.75 };
        let now = SceneInTime::moved(&moving, &moment, &still, &Unwatched).unwrap();
        assert_eq!((rest.triangles.len(), now.scene.triangles.len()), (8, 6), "the dot is hidden");
        let focus = now.focus(&painted, None);
        let by_triangle = (0..8).map(|k| FocusOffset::new(f64::from(k), 0.5)).collect();
        let parts = vec![FocusSource::Triangles(by_triangle); rest.parts.len()];
        let by_triangle = Focus { parts, ..painted.clone() };
        let at_rest = now.at_rest.clone().unwrap();
        let mut moved = 0;
        for (triangle, rest_triangle) in (0..).zip(at_rest) {
            for barycentric in [[0.2, 0.3], [0.0, 0.0], [0.9, 0.05]].map(DVec2::from_array) {
                let here = SurfacePoint { triangle, barycentric };
                let there = SurfacePoint { triangle: rest_triangle.unwrap().triangle, barycentric };
                assert_eq!(focus.at(here), painted.at(there));
                assert_eq!(now.focus(&by_triangle, None).at(here), by_triangle.at(there));
                assert_eq!(now.position(there), Some(here.position(&now.scene)));
                moved += u32::from(here.position(&now.scene) != there.position(&rest));
            }
        }
        assert_eq!(moved, 6, "the card's points, and no others");
        let of_dot = SurfacePoint { triangle: 4, barycentric: DVec2::ZERO };
        assert_eq!(now.position(of_dot), None);
        // Its texels are where the surface is: a curve over depth follows the card.
        let canvas = now.canvas(&atlas);
        let depth = |part: u32, canvas: &Canvas| {
            let of_part = canvas.texels().filter(|texel| texel.part == part);
            of_part.map(|texel| texel.position.x).fold(f64::NEG_INFINITY, f64::max)
        };
        let still = SceneInTime::at_rest(still);
        let displacement = depth(1, canvas) - depth(1, still.canvas(&atlas));
        assert!((displacement - 0.375).abs() < 0.05, "{displacement}");
    }
}
