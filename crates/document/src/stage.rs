//! What stays while a document is open: the scene, its atlas and what answers rays and dabs on it.

use crate::input::load_capture;
use crate::picking::SurfaceHit;
use crate::input::picture_atlas;
use light::{LitScene, light_hash};
use crate::error::DocumentError;
use light::Steps;
use atlas::{Atlas, AtlasError, TexelMap};
use focus::Canvas;
use glam::{DVec2, DVec3};
use progress::Progress;
use project::{CaptureChoices, surface_to_bytes};
use relief::DepthStroke;
use scene::{BackFaces, LoadOptions, Scene, SceneError, World};
use std::path::Path;
use std::sync::{Arc, OnceLock};
use trace::Tracer;

/// A scene that can be painted on.
pub struct Stage {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Lowest and highest corner of its box.
    pub bounds: (DVec3, DVec3),
    /// Where its triangles lie in the focus map.
    pub atlas: Arc<Atlas>,
    /// What answers rays, with its light.
    pub lit: Arc<LitScene>,
    /// The way back from texels to the surface.
    pub texels: Arc<TexelMap>,
    /// What dabs are painted on.
    pub canvas: Arc<Canvas>,
    /// The strokes that repaired the depth that the surface was made from.
    pub depth_strokes: Arc<Vec<DepthStroke>>,
    light_hash: OnceLock<[u8; 32]>,
    surface_bytes: OnceLock<Vec<u8>>,
}

impl From<SceneError> for DocumentError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Cancelled(_) => Self::Cancelled,
            other => Self::BadInput(other.to_string()),
        }
    }
}

/// What an error about the atlas of the scene at `path` means.
pub fn atlas_error(path: &Path, error: AtlasError) -> DocumentError {
    match error {
        AtlasError::Cancelled => DocumentError::Cancelled,
        AtlasError::Write { path, source } => DocumentError::io(&path, &source),
        other => DocumentError::bad_file(path, other),
    }
}

/// Reads a scene within the usual limits.
pub fn load_scene(path: &Path, progress: &dyn Progress) -> Result<Arc<Scene>, DocumentError> {
    Ok(load_variant(path, None, progress)?)
}

/// The same in one of its variants; none: in its own materials.
pub(crate) fn load_variant(
    path: &Path,
    variant: Option<&str>,
    progress: &dyn Progress,
) -> Result<Arc<Scene>, SceneError> {
    let options = LoadOptions { variant: variant.map(String::from), ..LoadOptions::default() };
    Ok(Arc::new(scene::load(path, &options, progress)?))
}

/// Whether what is painted on one scene fits the other: the same triangles in the same order, of the same nodes.
fn is_same_surface(a: &Scene, b: &Scene) -> bool {
    let part_key = |part: &scene::Part| (part.node, part.triangles.clone());
    a.positions == b.positions
        && a.triangles == b.triangles
        && a.parts.iter().map(part_key).eq(b.parts.iter().map(part_key))
}

/// The canvas of a scene in its atlas.
pub fn build_canvas(scene: &Scene, atlas: &Atlas, texels: &TexelMap) -> Canvas {
    let texel_at = |index: u32| [index % atlas.width, index / atlas.width];
    let gutters: Vec<_> = texels.dilations.iter().map(|d| [texel_at(d.texel), texel_at(d.source)]).collect();
    Canvas::new(scene, atlas, &texels.texels, &gutters)
}

impl Stage {
    /// The surface at a position in the atlas laid flat, (0, 0) its upper left corner, (1, 1) its lower right: the middle
    /// of what the texel there covers.
    pub fn surface_at(&self, position: DVec2) -> Option<SurfaceHit> {
        let texel = position * DVec2::new(self.atlas.width.into(), self.atlas.height.into());
        let inside = texel.cmpge(DVec2::ZERO).all();
        let texel = self.texels.texel_at(texel.x as u32, texel.y as u32).filter(|_| inside)?;
        let position = texel.centroid.position(&self.scene);
        let normal = self.scene.area_normal(texel.centroid.triangle).normalize_or_zero();
        Some(SurfaceHit { point: texel.centroid, position, normal, distance: 0.0 })
    }

    /// A checksum of everything in the scene that gives, blocks or reflects light; the first call takes a while.
    pub fn light_hash(&self) -> &[u8; 32] {
        self.light_hash.get_or_init(|| light_hash(&self.scene, self.lit.options()))
    }

    /// The surface as a project holds it.
    pub fn surface_bytes(&self) -> &[u8] {
        self.surface_bytes.get_or_init(|| surface_to_bytes(&self.scene))
    }

    /// The same with faces seen from behind, or not.
    pub fn with_back_faces(
        &self,
        back_faces: BackFaces,
        progress: &dyn Progress,
    ) -> Result<Self, DocumentError> {
        self.with_scene(Scene { back_faces, ..(*self.scene).clone() }, progress)
    }

    /// The same in another world; none: the scene's own.
    pub fn with_world(&self, world: Option<World>, progress: &dyn Progress) -> Result<Self, DocumentError> {
        self.with_scene(Scene { world, ..(*self.scene).clone() }, progress)
    }

    /// The same in another variant of its file, which is read again; none: in its own materials. Atlas and paint still fit.
    pub fn with_variant(&self, variant: Option<&str>, progress: &dyn Progress) -> Result<Self, DocumentError> {
        let before = &self.scene;
        let reloaded = load_variant(&before.path, variant, progress)?;
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
            ..Arc::unwrap_or_clone(reloaded)
        };
        let canvas = Arc::new(self.canvas.with_part_owners(&scene));
        Ok(Self { canvas, ..self.with_scene(scene, progress)? })
    }

    /// The surface made anew from the picture and its depth, which are read again, with other strokes. Paint still fits.
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

    /// Another scene with its light modelled in the same way.
    fn relit(&self, scene: Arc<Scene>) -> Arc<LitScene> {
        LitScene::new(Arc::new(Tracer::new(scene)), self.lit.options(), self.lit.resources())
    }

    /// The same surface, seen or lit in another way.
    fn with_scene(&self, scene: Scene, progress: &dyn Progress) -> Result<Self, DocumentError> {
        progress.check()?;
        let scene = Arc::new(scene);
        let lit = self.relit(scene.clone());
        progress.check()?;
        let (atlas, texels, canvas) = (self.atlas.clone(), self.texels.clone(), self.canvas.clone());
        lit.set_atlas(&atlas);
        let (bounds, depth_strokes) = (self.bounds, self.depth_strokes.clone());
        let light_hash = OnceLock::new();
        let surface_bytes = self.surface_bytes.clone();
        Ok(Self { scene, bounds, atlas, lit, texels, canvas, depth_strokes, light_hash, surface_bytes })
    }

    /// Prepares a scene whose atlas is known, and whose depth is as it was found.
    ///
    /// # Errors
    /// `progress` says to stop.
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
        let surface_bytes = OnceLock::new();
        Ok(Self { bounds, scene, atlas, lit, texels, canvas, depth_strokes, light_hash, surface_bytes })
    }

    /// What answers rays.
    pub fn tracer(&self) -> &Arc<Tracer> {
        self.lit.tracer()
    }
}
