//! The stage: a scene with its atlas, ready for rays and dabs.

mod surface_colors;

use crate::error::DocumentError;
use crate::first_view::first_view;
use crate::input::{Input, load_capture, picture_atlas};
use crate::picking::SurfaceHit;
use crate::scene_file::{add_floor, atlas_error, load_variant};
use atlas::{Atlas, TexelMap, UnwrapOptions};
use focus::{Canvas, FocusMap, SurfaceGraph};
use glam::{DVec2, DVec3};
use lens::FocusOffset;
use light::{LitScene, Steps, light_hash};
use progress::Progress;
use project::{CaptureChoices, SplatsFile, surface_to_bytes};
use relief::DepthStroke;
use scene::{BackFaces, Scene, SplatEdit, World};
use std::sync::{Arc, OnceLock};
use surface_colors::surface_colors;
use trace::Tracer;

/// Scenes of at least this many triangles take a second or more to unwrap, and are announced before they can be painted on.
const LARGE_SCENE_TRIANGLES: usize = 50_000;

/// A scene that can be painted on.
pub struct Stage {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Lowest and highest corner of the scene's bounding box.
    pub bounds: (DVec3, DVec3),
    /// The atlas: where triangles lie in the focus map.
    pub atlas: Arc<Atlas>,
    /// The scene ready for ray tracing, with its light.
    pub lit: Arc<LitScene>,
    /// The map from texels back to the surface.
    pub texels: Arc<TexelMap>,
    /// The canvas that dabs are painted on.
    pub canvas: Arc<Canvas>,
    /// The strokes that repaired the depth from which the surface was made.
    pub depth_strokes: Arc<Vec<DepthStroke>>,
    light_hash: OnceLock<[u8; 32]>,
    surface_bytes: OnceLock<Vec<u8>>,
    surface_graph: OnceLock<Arc<SurfaceGraph>>,
    /// Shared by stages that differ in their world alone.
    surface: Arc<SurfaceIdentity>,
}

/// Stands for all of a stage but its world.
#[derive(Default)]
struct SurfaceIdentity;

/// Whether paint on one scene fits the other: the same triangles in the same order, of the same nodes.
fn is_same_surface(a: &Scene, b: &Scene) -> bool {
    let part_key = |part: &scene::Part| (part.node, part.triangles.clone());
    a.positions == b.positions
        && a.triangles == b.triangles
        && a.parts.iter().map(part_key).eq(b.parts.iter().map(part_key))
}

/// The canvas, its texels with positions and neighbours, of a scene in its atlas.
pub fn build_canvas(scene: &Scene, atlas: &Atlas, texels: &TexelMap) -> Canvas {
    let texel_at = |index: u32| [index % atlas.width, index / atlas.width];
    let gutters: Vec<_> = texels.dilations.iter().map(|d| [texel_at(d.texel), texel_at(d.source)]).collect();
    Canvas::new(scene, atlas, &texels.texels, &gutters)
}

impl Stage {
    /// The surface at a position in the atlas, (0, 0) its upper left corner, (1, 1) its lower right: the centroid of the texel there. `None`
    /// where the atlas is empty.
    pub fn surface_at(&self, position: DVec2) -> Option<SurfaceHit> {
        let texel = position * DVec2::new(self.atlas.width.into(), self.atlas.height.into());
        let inside = texel.cmpge(DVec2::ZERO).all();
        let texel = self.texels.texel_at(texel.x as u32, texel.y as u32).filter(|_| inside)?;
        let position = texel.centroid.position(&self.scene);
        let normal = self.scene.area_normal(texel.centroid.triangle).normalize_or_zero();
        Some(SurfaceHit { point: texel.centroid, position, normal, distance: 0.0 })
    }

    /// A checksum of everything in the scene that emits, blocks or reflects light. The first call takes a while.
    pub fn light_hash(&self) -> &[u8; 32] {
        self.light_hash.get_or_init(|| light_hash(&self.scene, self.lit.options()))
    }

    /// The surface as a graph, along which strokes spread. The first call takes a while: where photographs light the scene,
    /// it waits for their light, since the graph must not depend on when it is made.
    ///
    /// # Errors
    /// Photographs cannot be used, or `progress` was cancelled.
    pub fn surface_graph(&self, progress: &dyn Progress) -> Result<Arc<SurfaceGraph>, DocumentError> {
        if let Some(graph) = self.surface_graph.get() {
            return Ok(graph.clone());
        }
        let light = self.lit.photograph_light(&progress::Stage::named(progress, "photographs", 0.0, 0.4))?;
        let colors = surface_colors(&self.scene, &self.texels, &self.canvas, light.as_deref());
        let linking = progress::Stage::named(progress, "neighbours", 0.4, 1.0);
        let graph = SurfaceGraph::new(&self.canvas, &colors, &linking)?;
        Ok(self.surface_graph.get_or_init(|| Arc::new(graph)).clone())
    }

    /// The surface as stored in a project.
    pub(crate) fn surface_bytes(&self) -> &[u8] {
        self.surface_bytes.get_or_init(|| surface_to_bytes(&self.scene))
    }

    /// The stage with back faces shown or not.
    ///
    /// # Errors
    /// `progress` was cancelled.
    pub fn with_back_faces(
        &self,
        back_faces: BackFaces,
        progress: &dyn Progress,
    ) -> Result<Self, DocumentError> {
        self.with_scene(Scene { back_faces, ..(*self.scene).clone() }, progress)
    }

    /// The stage in another world; `None` for the scene's own.
    ///
    /// # Errors
    /// `progress` was cancelled.
    pub fn with_world(&self, world: Option<World>, progress: &dyn Progress) -> Result<Self, DocumentError> {
        let lit = self.lit.in_world(world);
        let is_same_surface = lit.scene().floor_color() == self.scene.floor_color();
        let surface = if is_same_surface { self.surface.clone() } else { Arc::default() };
        Ok(Self { surface, ..self.with_lit_scene(lit, progress)? })
    }

    /// Whether `other` is the same scene, in another world at most.
    pub fn differs_in_world_alone(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.surface, &other.surface)
    }

    /// The stage in another variant of its file, which is read again; `None` for its own materials. Atlas and paint still fit.
    ///
    /// # Errors
    /// The file cannot be read, has no such variant or has changed, or `progress` was cancelled.
    pub fn with_variant(
        &self,
        variant: Option<&str>,
        progress: &dyn Progress,
    ) -> Result<Self, DocumentError> {
        let before = &self.scene;
        let splats = before.splats.as_ref().and_then(|splats| SplatsFile::of_scene(splats));
        let loaded = load_variant(&before.path, variant, splats.as_ref(), progress)?;
        let mut reloaded = Arc::unwrap_or_clone(loaded);
        if let Some(floor) = &before.floor {
            reloaded.world = before.world.clone();
            reloaded.set_floor(floor.is_shown);
        }
        if !is_same_surface(before, &reloaded) {
            return Err(DocumentError::bad_file(
                &before.path,
                "has changed since it was opened (open it again)",
            ));
        }
        let scene = Scene {
            back_faces: before.back_faces,
            world: before.world.clone(),
            embedded_world: before.embedded_world.clone(),
            ..reloaded
        };
        let canvas = Arc::new(self.canvas.with_part_owners(&scene));
        Ok(Self { canvas, ..self.with_scene(scene, progress)? })
    }

    /// The stage with its Gaussian splats moved or hidden. Atlas and paint still fit.
    ///
    /// # Errors
    /// The edit is not valid, or `progress` was cancelled.
    pub fn with_splat_edit(&self, edit: &SplatEdit, progress: &dyn Progress) -> Result<Self, DocumentError> {
        if !edit.is_valid() {
            let what = "splats cannot be placed so (give finite numbers, and sizes and distances above 0)";
            return Err(DocumentError::bad_file(&self.scene.path, what));
        }
        let mut scene = (*self.scene).clone();
        scene.edit_splats(edit.clone());
        progress.check()?;
        let depth_strokes = self.depth_strokes.clone();
        Ok(Self { depth_strokes, ..Self::new(self.relit(Arc::new(scene)), self.atlas.clone(), progress)? })
    }

    /// The stage with a floor that catches shadows, or without. The first time the atlas gets rows at the bottom; after that it keeps them.
    ///
    /// # Errors
    /// The scene casts no shadow, the atlas has no room, or `progress` was cancelled.
    pub fn with_floor(&self, is_shown: bool, progress: &dyn Progress) -> Result<Self, DocumentError> {
        let (mut scene, path) = ((*self.scene).clone(), &self.scene.path);
        let atlas = match add_floor(&mut scene, is_shown, path)? {
            Some(floor) => {
                let atlas = (*self.atlas).clone().with_floor(&scene, &floor);
                Arc::new(atlas.map_err(|error| atlas_error(path, error))?)
            }
            None => self.atlas.clone(),
        };
        progress.check()?;
        Self::new(self.relit(Arc::new(scene)), atlas, progress)
    }

    /// The stage with its surface made anew from the picture and its depth, which are read again, with the depth strokes of `choices`. Paint
    /// still fits.
    ///
    /// # Errors
    /// The files cannot be read or have changed, or the work was cancelled.
    pub fn with_depth_repaired(
        &self,
        choices: &CaptureChoices,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        let before = &self.scene;
        let reloaded = load_capture(&before.path, choices, &self.lit.resources().cache, steps)?.scene;
        let scene = Arc::new(Scene {
            world: before.world.clone(),
            embedded_world: before.embedded_world.clone(),
            back_faces: before.back_faces,
            ..Arc::unwrap_or_clone(reloaded)
        });
        let atlas = picture_atlas(&scene)
            .filter(|atlas| [atlas.width, atlas.height] == [self.atlas.width, self.atlas.height]);
        let atlas = atlas.ok_or_else(|| {
            DocumentError::bad_file(&before.path, "has changed since it was opened (open it again)")
        })?;
        let progress = steps.begin("preparing");
        progress.check()?;
        let stage = Self::new(self.relit(scene), Arc::new(atlas), &*progress)?;
        Ok(Self { depth_strokes: Arc::new(choices.depth_strokes.clone()), ..stage })
    }

    /// Another scene with light modelled in the same way.
    fn relit(&self, scene: Arc<Scene>) -> Arc<LitScene> {
        LitScene::new(Arc::new(Tracer::new(scene)), self.lit.options(), self.lit.resources())
    }

    /// The same surface with another appearance or light.
    fn with_scene(&self, scene: Scene, progress: &dyn Progress) -> Result<Self, DocumentError> {
        progress.check()?;
        self.with_lit_scene(self.relit(Arc::new(scene)), progress)
    }

    fn with_lit_scene(&self, lit: Arc<LitScene>, progress: &dyn Progress) -> Result<Self, DocumentError> {
        progress.check()?;
        let scene = lit.scene().clone();
        let (atlas, texels, canvas) = (self.atlas.clone(), self.texels.clone(), self.canvas.clone());
        lit.set_atlas(&atlas);
        let (bounds, depth_strokes) = (self.bounds, self.depth_strokes.clone());
        let (light_hash, surface_graph) = (OnceLock::new(), OnceLock::new());
        let surface_bytes = self.surface_bytes.clone();
        Ok(Self {
            scene,
            bounds,
            atlas,
            lit,
            texels,
            canvas,
            depth_strokes,
            light_hash,
            surface_bytes,
            surface_graph,
            surface: Arc::default(),
        })
    }

    /// Prepares a scene with its atlas, without depth strokes.
    ///
    /// # Errors
    /// `progress` was cancelled.
    pub fn new(
        lit: Arc<LitScene>,
        atlas: Arc<Atlas>,
        progress: &dyn Progress,
    ) -> Result<Self, DocumentError> {
        progress.check()?;
        let scene = lit.scene().clone();
        lit.set_atlas(&atlas);
        let texels = Arc::new(atlas.texel_map(&scene));
        progress.report(0.5);
        progress.check()?;
        let canvas = Arc::new(build_canvas(&scene, &atlas, &texels));
        progress.report(1.0);
        let (bounds, depth_strokes, light_hash) = (scene.bounds(), Arc::default(), OnceLock::new());
        let (surface_bytes, surface_graph) = (OnceLock::new(), OnceLock::new());
        Ok(Self {
            bounds,
            scene,
            atlas,
            lit,
            texels,
            canvas,
            depth_strokes,
            light_hash,
            surface_bytes,
            surface_graph,
            surface: Arc::default(),
        })
    }

    /// The stage of an input, and its focus map. A large scene is announced to `steps` before it can be painted on.
    pub(crate) fn from_input(
        input: &Input,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<(Self, FocusMap), DocumentError> {
        let lit = LitScene::new(Arc::new(Tracer::new(input.scene.clone())), input.light, &input.resources);
        let project = input.project.as_ref();
        let is_large = input.scene.triangles.len() >= LARGE_SCENE_TRIANGLES;
        let is_unwrapped = project.is_some_and(|project| project.atlas.is_some());
        let announce = || {
            let is_painted = project.is_some_and(|project| project.focus_map.is_some());
            let camera = match input.has_own_camera() {
                true => input.camera.clone(),
                false => first_view(lit.tracer(), &input.camera).camera,
            };
            steps.scene_ready(&lit, &camera, is_painted);
        };
        if is_large && !is_unwrapped {
            announce();
        }
        let atlas = input.atlas(unwrap, steps)?;
        if is_large && is_unwrapped {
            lit.set_atlas(&atlas);
            announce();
        }
        let map = match project.and_then(|project| project.focus_map.clone()) {
            Some(map) => map,
            None => {
                let mut map = FocusMap::new(atlas.width, atlas.height, FocusOffset::STANDARD);
                map.background = project.map_or(FocusOffset::STANDARD, |project| project.background_focus);
                map
            }
        };
        input.check_map_size(&map, &atlas)?;
        let mut stage = Self::new(lit, atlas, &*steps.begin("preparing"))?;
        let choices = project.and_then(|project| project.capture.as_ref()).or(input.capture.as_ref());
        stage.depth_strokes = choices.map(|choices| choices.depth_strokes.clone()).unwrap_or_default().into();
        Ok((stage, map))
    }

    /// Traces rays in the scene.
    pub fn tracer(&self) -> &Arc<Tracer> {
        self.lit.tracer()
    }
}
