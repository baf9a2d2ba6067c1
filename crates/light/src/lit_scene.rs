//! A scene that is ready for rays, with its light: the one place that chooses where radiance comes from.

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
use slf::{PhotographLight, Transport};
use std::sync::Arc;
use trace::{Radiance, Tracer};

/// Light that leaves a scene.
pub type SceneLight = Arc<dyn Radiance + Send + Sync>;

/// Paths and light samples of a point of the light field, where irradiance is cached: a sample has several points.
const PATHS: u32 = 2;
const LIGHT_SAMPLES: u32 = 16;

/// Light samples of a point of a picture that is soon replaced.
const ROUGH_LIGHT_SAMPLES: u32 = 4;

/// A scene that is ready for rays, and all light that was solved for in it. Shared by reference count: work that goes on in the background
/// stops when the last owner is gone.
pub struct LitScene {
    tracer: Arc<Tracer>,
    options: LightOptions,
    resources: Resources,
    irradiance: IrradianceCache,
    /// Where photographs light the scene.
    photographs: Option<PhotographLightCache>,
    cancel: CancelToken,
}

impl Drop for LitScene {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}

impl LitScene {
    /// The scene in `tracer`, of whose light nothing is known yet.
    pub fn new(tracer: Arc<Tracer>, options: LightOptions, resources: &Resources) -> Arc<Self> {
        let cancel = CancelToken::default();
        let photographs = !tracer.scene().views.is_empty();
        let photographs =
            photographs.then(|| PhotographLightCache::new(&tracer, options, resources, &cancel));
        let (irradiance, resources) = (IrradianceCache::default(), resources.clone());
        Arc::new(Self { tracer, options, resources, irradiance, photographs, cancel })
    }

    /// What answers rays.
    pub fn tracer(&self) -> &Arc<Tracer> {
        &self.tracer
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        self.tracer.scene()
    }

    /// How light is modelled.
    pub fn options(&self) -> LightOptions {
        self.options
    }

    /// What work on the scene may use.
    pub fn resources(&self) -> &Resources {
        &self.resources
    }

    /// The light that leaves the scene, for a camera: that of its photographs, if it has any. The first time in a world it is solved for,
    /// which `progress` watches; then it serves every camera. Rough light of photographs is that of the bare surface as long as theirs is
    /// not there.
    ///
    /// # Errors
    /// Photographs cannot be used, or `progress` says to stop.
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
        let light_samples = if quality == LightQuality::Rough { ROUGH_LIGHT_SAMPLES } else { LIGHT_SAMPLES };
        let paths = if let LightQuality::Refined { passes } = quality { passes } else { PATHS };
        let transport = self.transport(camera, paths, light_samples);
        if !self.has_lit_surfaces() {
            return Ok(Arc::new(transport));
        }
        let inputs = IrradianceInputs {
            tracer: &self.tracer,
            options: self.options,
            resources: &self.resources,
            cancel: &self.cancel,
        };
        let irradiance = self.irradiance.wait(&self.world(camera), quality, &inputs, progress)?;
        Ok(Arc::new(match quality {
            LightQuality::Refined { .. } => transport.with_control_variate(irradiance),
            LightQuality::Rough | LightQuality::Fine => transport.with_irradiance(irradiance),
        }))
    }

    /// The light as far as it is there now: without irradiance, where that is not solved for yet, it is unbiased and noisy.
    pub fn available(&self, camera: &Camera) -> SceneLight {
        let photographs = self.photographs.as_ref();
        if let Some(light) = photographs.and_then(PhotographLightCache::available_lookup) {
            return light;
        }
        let transport = self.transport(camera, PATHS, LIGHT_SAMPLES);
        Arc::new(match self.irradiance.available(&self.world(camera)) {
            Some(irradiance) => transport.with_irradiance(irradiance),
            None => transport,
        })
    }

    /// Light for a first picture: of photographs, if theirs is on disk; else that of the bare surface, with nothing solved and nothing
    /// begun: unbiased and noisy.
    pub fn quick(&self, camera: &Camera, progress: &dyn Progress) -> SceneLight {
        if let Some(photographs) = self.photographs.as_ref().filter(|photographs| photographs.is_on_disk())
            && let Ok(light) = photographs.wait_for_lookup(progress)
        {
            return light;
        }
        Arc::new(self.transport(camera, 4 * PATHS, ROUGH_LIGHT_SAMPLES))
    }

    /// Light for the ground truth: whole paths, without cached irradiance; of photographs what they show. The ground truth shades many
    /// points a pixel, so that a path each suffices.
    ///
    /// # Errors
    /// Photographs cannot be used, or `progress` says to stop.
    pub fn ground_truth(&self, camera: &Camera, progress: &dyn Progress) -> Result<SceneLight, LightError> {
        match &self.photographs {
            Some(photographs) => photographs.wait_for_lookup(progress),
            None => Ok(Arc::new(self.transport(camera, 1, LIGHT_SAMPLES))),
        }
    }

    /// Whether photographs light the scene.
    pub fn is_photographed(&self) -> bool {
        self.photographs.is_some()
    }

    /// Whether light can be refined: some surface scatters it, and no photographs show it.
    pub fn can_be_refined(&self) -> bool {
        !self.is_photographed() && self.has_lit_surfaces()
    }

    /// Has light from photographs kept at the texels of an atlas; without one the scene is unwrapped for it. The first atlas counts.
    pub fn set_atlas(&self, atlas: &Arc<Atlas>) {
        if let Some(photographs) = &self.photographs {
            photographs.set_atlas(atlas);
        }
    }

    /// Light from photographs as soon as it is there; `None` for a scene without.
    ///
    /// # Errors
    /// Photographs cannot be used, or `progress` says to stop.
    pub fn photograph_light(
        &self,
        progress: &dyn Progress,
    ) -> Result<Option<Arc<PhotographLight>>, LightError> {
        self.photographs.as_ref().map(|photographs| photographs.wait(progress)).transpose()
    }

    /// Light from photographs, if it is there; nothing is begun.
    pub fn solved_photograph_light(&self) -> Option<Arc<PhotographLight>> {
        self.photographs.as_ref()?.if_solved()
    }

    /// Whether any surface scatters light at all.
    fn has_lit_surfaces(&self) -> bool {
        let scene = self.scene();
        scene.parts.iter().any(|part| !scene.materials[part.material as usize].unlit)
    }

    fn world(&self, camera: &Camera) -> World {
        let background = camera.background.map(|background| DVec3::from_array(background).as_vec3());
        World::from_scene(self.scene(), background)
    }

    fn transport(&self, camera: &Camera, paths: u32, light_samples: u32) -> Transport {
        transport_without_cache(&self.tracer, self.world(camera), self.options, paths, light_samples)
    }
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
        // Nobody keeps anything without a folder.
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
