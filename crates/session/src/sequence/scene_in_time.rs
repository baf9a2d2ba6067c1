//! The scene at a time: moved as its file says, with the atlas that goes along.
//!
//! Atlas and paint belong to the surface at rest: a triangle keeps its place in the atlas wherever it is, so that a texel stays on its
//! piece of surface ([`posed_atlas`]).

use crate::document::{canvas_of, light_hash};
use crate::error::SessionError;
use atlas::Atlas;
use focus::{Canvas, Focus, FocusMap, FocusSource};
use glam::{DVec2, DVec3, Vec2};
use lens::FocusOffset;
use progress::Progress;
use scene::{Moment, MovingScene, Posed, RestTriangle, Scene, SurfacePoint};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};
use trace::Tracer;

/// A scene as it is at a time.
pub(super) struct SceneInTime {
    /// The scene.
    pub scene: Arc<Scene>,
    /// A checksum of all that gives, blocks or reflects light.
    pub hash: [u8; 32],
    /// Of each triangle the one at rest; nothing where all are in their places.
    at_rest: Option<Vec<Option<RestTriangle>>>,
    /// Of each triangle at rest where it is now; found when it is asked for first.
    now: OnceLock<HashMap<u32, (u32, bool)>>,
    tracer: OnceLock<Arc<Tracer>>,
    atlas: OnceLock<Arc<Atlas>>,
    canvas: OnceLock<Canvas>,
}

impl SceneInTime {
    /// A scene at rest; `tracer` answers its rays.
    pub fn at_rest(tracer: Arc<Tracer>) -> Self {
        let scene = tracer.scene().clone();
        let still = Self::new(scene, None);
        let _ = still.tracer.set(tracer);
        still
    }

    fn new(scene: Arc<Scene>, at_rest: Option<Vec<Option<RestTriangle>>>) -> Self {
        let hash = light_hash(&scene);
        let (now, tracer, atlas, canvas) = Default::default();
        Self { scene, hash, at_rest, now, tracer, atlas, canvas }
    }

    /// The scene at a moment.
    pub fn moved(
        moving: &MovingScene,
        moment: &Moment,
        progress: &dyn Progress,
    ) -> Result<Self, SessionError> {
        let posed = moving.at(moment, progress)?;
        let is_in_place =
            posed.has_all_in_place() && posed.scene.triangles.len() == moving.rest().triangles.len();
        let Posed { scene, at_rest } = posed;
        Ok(Self::new(Arc::new(scene), (!is_in_place).then_some(at_rest)))
    }

    /// What answers its rays.
    pub fn tracer(&self) -> &Arc<Tracer> {
        self.tracer.get_or_init(|| Arc::new(Tracer::new(self.scene.clone())))
    }

    /// Where its triangles lie in an atlas of the scene at rest, always the same one.
    pub fn atlas(&self, rest: &Arc<Atlas>) -> &Arc<Atlas> {
        self.atlas.get_or_init(|| match &self.at_rest {
            None => rest.clone(),
            Some(at_rest) => Arc::new(posed_atlas(rest, &self.scene, at_rest)),
        })
    }

    /// Where the texels of that atlas are.
    pub fn canvas(&self, rest: &Arc<Atlas>) -> &Canvas {
        self.canvas.get_or_init(|| {
            let atlas = self.atlas(rest);
            canvas_of(&self.scene, atlas, &atlas.texel_map(&self.scene))
        })
    }

    /// Where a point of the surface at rest is now; nothing where it is not shown.
    pub fn position(&self, point: SurfacePoint) -> Option<DVec3> {
        let here = match &self.at_rest {
            None => point,
            Some(at_rest) => {
                let (triangle, is_turned) = *self.now.get_or_init(|| places(at_rest)).get(&point.triangle)?;
                let DVec2 { x, y } = point.barycentric;
                SurfacePoint {
                    triangle,
                    barycentric: if is_turned { DVec2::new(y, x) } else { point.barycentric },
                }
            }
        };
        ((here.triangle as usize) < self.scene.triangles.len()).then(|| here.position(&self.scene))
    }

    /// The focus of the scene at rest where its surface is now; `painted`, if given, is what is painted now. What was hidden at rest has
    /// the ordinary lens's.
    pub fn focus(&self, rest: &Focus, painted: Option<&Arc<FocusMap>>) -> Focus {
        let now = |source: &FocusSource| match source {
            FocusSource::Atlas { atlas, map } => {
                FocusSource::Atlas { atlas: self.atlas(atlas).clone(), map: painted.unwrap_or(map).clone() }
            }
            other => other.clone(),
        };
        let source = |part: &scene::Part| match &self.at_rest {
            None => Some(now(&rest.parts[rest.scene.triangles[part.triangles.start as usize].part as usize])),
            Some(at_rest) => {
                let triangles = part.triangles.start as usize..part.triangles.end as usize;
                let known = at_rest[triangles].iter().flatten().next()?;
                Some(now(&rest.parts[rest.scene.triangles[known.triangle as usize].part as usize]))
            }
        };
        let nowhere = FocusSource::Constant(FocusOffset::STANDARD);
        let parts = self.scene.parts.iter().map(|part| source(part).unwrap_or(nowhere.clone())).collect();
        let background = painted.map_or(rest.background, |map| map.background);
        Focus { scene: self.scene.clone(), parts, background }
    }
}

/// Of each triangle at rest where it is now, and whether its corners are turned.
fn places(at_rest: &[Option<RestTriangle>]) -> HashMap<u32, (u32, bool)> {
    let place =
        |(now, rest): (u32, &Option<RestTriangle>)| rest.map(|rest| (rest.triangle, (now, rest.is_turned)));
    (0..).zip(at_rest).filter_map(place).collect()
}

/// The atlas of a scene in motion: its triangles where they lie in that of the scene at rest, whose name (hash) it keeps. What was hidden
/// at rest lies in no texel.
fn posed_atlas(rest: &Atlas, scene: &Scene, at_rest: &[Option<RestTriangle>]) -> Atlas {
    let mut charts: HashMap<(Option<u32>, u32), u32> = HashMap::new();
    let (mut corners, mut chart_of, mut part_of_chart) = (Vec::new(), Vec::new(), Vec::new());
    for (triangle, known) in scene.triangles.iter().zip(at_rest) {
        let [a, b, c] = known.map_or([Vec2::ZERO; 3], |known| rest.corners[known.triangle as usize]);
        corners.push(if known.is_some_and(|known| known.is_turned) { [a, c, b] } else { [a, b, c] });
        let chart = (known.map(|known| rest.chart_of[known.triangle as usize]), triangle.part);
        chart_of.push(*charts.entry(chart).or_insert_with(|| {
            part_of_chart.push(triangle.part);
            part_of_chart.len() as u32 - 1
        }));
    }
    let atlas = Atlas::new([rest.width, rest.height], corners, chart_of, &part_of_chart, rest.density);
    Atlas { hash: rest.hash.clone(), ..atlas }
}
