//! A scene ready for ray tracing, with its light: the one place that chooses the source of radiance.

use crate::error::LightError;
use crate::irradiance_cache::{IrradianceCache, IrradianceInputs, transport_without_cache};
use crate::options::{LightOptions, LightQuality};
use crate::photograph_light_cache::PhotographLightCache;
use crate::resources::Resources;
use atlas::Atlas;
use glam::DVec3;
use jobs::CancelToken;
use lens::Camera;
use progress::Progress;
use scene::{Scene, World};
use slf::{BounceLimit, Irradiance, PhotographLight, Transport};
use std::sync::{Arc, Mutex, PoisonError};
use trace::{Radiance, Tracer};

/// The radiance that leaves a scene.
pub type SceneLight = Arc<dyn Radiance + Send + Sync>;

/// Paths per point of the light field, where irradiance is cached. A sample has several points.
const PATHS: u32 = 2;
/// Light samples per point of the light field.
const LIGHT_SAMPLES: u32 = 16;

/// Light samples per point of a picture that is soon replaced.
const ROUGH_LIGHT_SAMPLES: u32 = 4;

/// A scene ready for ray tracing, and all light solved for in it. It is shared by reference count: background work stops when the last
/// owner drops it.
pub struct LitScene {
    tracer: Arc<Tracer>,
    options: LightOptions,
    resources: Resources,
    irradiance: IrradianceCache,
    /// The last one, for the next picture in the same world.
    rough_light: Mutex<Option<RoughLight>>,
    /// `Some` if photographs light the scene.
    photographs: Option<PhotographLightCache>,
    bounce_limit: BounceLimit,
    cancel: CancelToken,
}

/// Rough light of a world.
struct RoughLight {
    world: World,
    /// What it was made from; none where nothing scatters light.
    irradiance: Option<Arc<Irradiance>>,
    light: SceneLight,
}

impl RoughLight {
    fn is_of(&self, world: &World, irradiance: Option<&Arc<Irradiance>>) -> bool {
        let is_same = match (&self.irradiance, irradiance) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        is_same && self.world == *world
    }
}

impl Drop for LitScene {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}

impl LitScene {
    /// The scene in `tracer`, with no light solved for yet.
    pub fn new(tracer: Arc<Tracer>, options: LightOptions, resources: &Resources) -> Arc<Self> {
        Self::with_irradiance_cache(tracer, options, resources, IrradianceCache::default())
    }

    fn with_irradiance_cache(
        tracer: Arc<Tracer>,
        options: LightOptions,
        resources: &Resources,
        irradiance: IrradianceCache,
    ) -> Arc<Self> {
        let cancel = CancelToken::default();
        let photographs = !tracer.scene().views.is_empty();
        let photographs =
            photographs.then(|| PhotographLightCache::new(&tracer, options, resources, &cancel));
        let (rough_light, bounce_limit) = (Mutex::default(), BounceLimit::default());
        let resources = resources.clone();
        Arc::new(Self {
            tracer,
            options,
            resources,
            irradiance,
            rough_light,
            photographs,
            bounce_limit,
            cancel,
        })
    }

    /// The scene in another world (none: its own): what is solved for worlds of the same lighting still holds.
    pub fn in_world(&self, world: Option<World>) -> Arc<Self> {
        let mut scene = Scene { world, ..(**self.scene()).clone() };
        scene.color_floor();
        let is_same_surface = scene.floor_color() == self.scene().floor_color();
        let irradiance = if is_same_surface { self.irradiance.solved() } else { Default::default() };
        let scene = Arc::new(scene);
        Self::with_irradiance_cache(Arc::new(Tracer::new(scene)), self.options, &self.resources, irradiance)
    }

    /// The tracer, by which rays are traced in the scene.
    pub fn tracer(&self) -> &Arc<Tracer> {
        &self.tracer
    }

    /// The scene that is lit.
    pub fn scene(&self) -> &Arc<Scene> {
        self.tracer.scene()
    }

    /// The options by which light is modelled.
    pub fn options(&self) -> LightOptions {
        self.options
    }

    /// What work on the scene may use.
    pub fn resources(&self) -> &Resources {
        &self.resources
    }

    /// The memory of the cached irradiance, in bytes; light from photographs is not counted.
    pub fn irradiance_bytes(&self) -> usize {
        self.irradiance.bytes()
    }

    /// The light that leaves the scene, for a camera; light from photographs, if the scene has any. It is solved for once per world, reporting
    /// to `progress`, and then serves every camera. As long as light from photographs is not solved, rough light is that of the bare surface.
    ///
    /// # Errors
    /// Photographs cannot be used, or `progress` was cancelled.
    pub fn solve(
        &self,
        camera: &Camera,
        quality: LightQuality,
        progress: &dyn Progress,
    ) -> Result<SceneLight, LightError> {
        if let Some(photographs) = &self.photographs {
            match (photographs.available_lookup(), quality) {
                (Some(light), _) => return Ok(light),
                (None, LightQuality::Rough) if !photographs.is_on_disk() => {}
                (None, _) => return photographs.wait_for_lookup(progress),
            }
        }
        let world = self.world(camera);
        let irradiance = if self.has_lit_surfaces() {
            Some(self.irradiance.wait(&world, quality, &self.irradiance_inputs(), progress)?)
        } else {
            None
        };
        if irradiance.as_ref().is_some_and(|irradiance| irradiance.solution().is_cut_off) {
            self.bounce_limit.reach();
        }
        Ok(match quality {
            LightQuality::Rough => self.rough_light(world, irradiance),
            LightQuality::Fine => with_irradiance(self.transport(world, PATHS, LIGHT_SAMPLES), irradiance),
            LightQuality::Refined { passes } => {
                let transport = self.transport(world, passes, LIGHT_SAMPLES);
                Arc::new(match irradiance {
                    Some(irradiance) => transport.with_control_variate(irradiance),
                    None => transport,
                })
            }
        })
    }

    /// Rough light, as long as it was made from the same. Each of the pictures that follow a camera asks for it.
    fn rough_light(&self, world: World, irradiance: Option<Arc<Irradiance>>) -> SceneLight {
        let mut last = self.rough_light.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(last) = last.as_ref().filter(|last| last.is_of(&world, irradiance.as_ref())) {
            return last.light.clone();
        }
        let transport = self.transport(world.clone(), PATHS, ROUGH_LIGHT_SAMPLES);
        let light = with_irradiance(transport, irradiance.clone());
        *last = Some(RoughLight { world, irradiance, light: light.clone() });
        light
    }

    /// Begins to solve for the rough light of a camera's world in the background, so that it is soon there.
    pub fn start_rough(&self, camera: &Camera) {
        if self.photographs.is_none() && self.has_lit_surfaces() {
            self.irradiance.start_rough(&self.world(camera), &self.irradiance_inputs());
        }
    }

    /// The light that is available now. Where irradiance is not solved yet, it is unbiased and noisy.
    pub fn available(&self, camera: &Camera) -> SceneLight {
        let photographs = self.photographs.as_ref();
        if let Some(light) = photographs.and_then(PhotographLightCache::available_lookup) {
            return light;
        }
        let world = self.world(camera);
        let irradiance = self.irradiance.available(&world);
        with_irradiance(self.transport(world, PATHS, LIGHT_SAMPLES), irradiance)
    }

    /// Light for a first picture: from photographs, if that is cached on disk; otherwise the unbiased, noisy light of the bare surface, for
    /// which nothing has to be solved or started.
    pub fn quick(&self, camera: &Camera, progress: &dyn Progress) -> SceneLight {
        if let Some(photographs) = self.photographs.as_ref().filter(|photographs| photographs.is_on_disk())
            && let Ok(light) = photographs.wait_for_lookup(progress)
        {
            return light;
        }
        Arc::new(self.transport(self.world(camera), 4 * PATHS, ROUGH_LIGHT_SAMPLES))
    }

    /// Light for the ground truth: complete paths without cached irradiance, or light from photographs. The ground truth shades many points
    /// per pixel, so that one path per point suffices.
    ///
    /// # Errors
    /// Photographs cannot be used, or `progress` was cancelled.
    pub fn ground_truth(&self, camera: &Camera, progress: &dyn Progress) -> Result<SceneLight, LightError> {
        match &self.photographs {
            Some(photographs) => photographs.wait_for_lookup(progress),
            None => Ok(Arc::new(self.transport(self.world(camera), 1, LIGHT_SAMPLES))),
        }
    }

    /// Whether light that was solved or traced so far was cut off after [`slf::MAX_BOUNCES`] before it had died away: it cannot get out
    /// of a closed room that absorbs next to nothing.
    pub fn is_cut_off(&self) -> bool {
        self.bounce_limit.is_reached()
    }

    /// Whether photographs light the scene.
    pub fn is_photographed(&self) -> bool {
        self.photographs.is_some()
    }

    /// Whether light can be refined: some surface scatters light, and no photographs supply it.
    pub fn can_be_refined(&self) -> bool {
        !self.is_photographed() && self.has_lit_surfaces()
    }

    /// Sets the atlas at whose texels light from photographs is stored. Only the first call has an effect; without one, the scene is
    /// unwrapped.
    pub fn set_atlas(&self, atlas: &Arc<Atlas>) {
        if let Some(photographs) = &self.photographs {
            photographs.set_atlas(atlas);
        }
    }

    /// Waits for the light from photographs; `None` for a scene without photographs.
    ///
    /// # Errors
    /// Photographs cannot be used, or `progress` was cancelled.
    pub fn photograph_light(
        &self,
        progress: &dyn Progress,
    ) -> Result<Option<Arc<PhotographLight>>, LightError> {
        self.photographs.as_ref().map(|photographs| photographs.wait(progress)).transpose()
    }

    /// The light from photographs, if it is solved; nothing is started.
    pub fn solved_photograph_light(&self) -> Option<Arc<PhotographLight>> {
        self.photographs.as_ref()?.if_solved()
    }

    /// Whether any surface scatters light.
    fn has_lit_surfaces(&self) -> bool {
        let scene = self.scene();
        scene.parts.iter().any(|part| !scene.materials[part.material as usize].unlit)
    }

    fn irradiance_inputs(&self) -> IrradianceInputs<'_> {
        IrradianceInputs {
            tracer: &self.tracer,
            options: self.options,
            resources: &self.resources,
            cancel: &self.cancel,
        }
    }

    fn world(&self, camera: &Camera) -> World {
        let background = camera.background.map(|background| DVec3::from_array(background).as_vec3());
        World::from_scene(self.scene(), background)
    }

    fn transport(&self, world: World, paths: u32, light_samples: u32) -> Transport {
        transport_without_cache(&self.tracer, world, self.options, paths, light_samples)
            .with_bounce_limit(self.bounce_limit.clone())
    }
}

fn with_irradiance(transport: Transport, irradiance: Option<Arc<Irradiance>>) -> SceneLight {
    Arc::new(match irradiance {
        Some(irradiance) => transport.with_irradiance(irradiance),
        None => transport,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disk_cache::DiskCache;
    use jobs::Background;
    use progress::Unwatched;
    use scene::Material;
    use std::path::Path;
    use test_scenes::{Mesh, scene_of};

    /// A lit triangle.
    fn tracer() -> Arc<Tracer> {
        let triangle = Mesh::triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);
        Arc::new(Tracer::new(scene_of([(triangle, Material::lambertian_white())])))
    }

    fn files_in(folder: &Path) -> usize {
        let sections = std::fs::read_dir(folder).into_iter().flatten().flatten();
        sections.map(|section| std::fs::read_dir(section.path()).unwrap().count()).sum()
    }

    #[test]
    fn two_caches_with_different_folders_work_side_by_side() {
        let (one, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let lit_in = |folder: &Path| {
            let cache = DiskCache::in_folder(folder);
            let resources = Resources { cache, background: Background::Inline };
            LitScene::new(tracer(), LightOptions::default(), &resources)
        };
        let camera = Camera::default();
        let first = lit_in(one.path());
        first.solve(&camera, LightQuality::Fine, &Unwatched).unwrap();
        assert_eq!((files_in(one.path()), files_in(other.path())), (1, 0));
        let second = lit_in(other.path());
        second.solve(&camera, LightQuality::Fine, &Unwatched).unwrap();
        assert_eq!((files_in(one.path()), files_in(other.path())), (1, 1));
        // Another world of the same scene is another entry, in the same folder.
        let dusk = Camera { background: Some([0.1, 0.0, 0.2]), ..camera };
        first.solve(&dusk, LightQuality::Fine, &Unwatched).unwrap();
        assert_eq!((files_in(one.path()), files_in(other.path())), (2, 1));
        // Without a folder, nothing is stored.
        let none = LitScene::new(tracer(), LightOptions::default(), &Resources::default());
        none.solve(&dusk, LightQuality::Fine, &Unwatched).unwrap();
    }

    #[test]
    fn work_stops_with_the_last_owner() {
        let lit = LitScene::new(tracer(), LightOptions::default(), &Resources::default());
        let (cancel, again) = (lit.cancel.clone(), lit.clone());
        drop(lit);
        assert!(!cancel.is_cancelled(), "somebody still has it");
        drop(again);
        assert!(cancel.is_cancelled());
    }
}
