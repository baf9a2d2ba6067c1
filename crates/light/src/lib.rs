//! The light of a scene as a value.
//!
//! A [`LitScene`] is a scene ready for ray tracing, together with the light solved for in it: irradiance by world (`irradiance_cache`), and
//! light from photographs (`photograph_light_cache`). Its owners share the results; when the last owner drops it, its background work
//! stops. With a [`DiskCache`], results outlive the program.
//!
//! The source of radiance is chosen in `lit_scene.rs`, and nowhere else.
//!
//! ```
//! use light::{LightOptions, LightQuality, LitScene, Resources};
//! use progress::Unwatched;
//! use std::sync::Arc;
//! use trace::Radiance;
//!
//! let tracer = Arc::new(trace::Tracer::new(Arc::new(scene::Scene::default())));
//! let lit = LitScene::new(tracer, LightOptions::default(), &Resources::default());
//! let radiance = lit.solve(&lens::Camera::default(), LightQuality::Fine, &Unwatched)?;
//! assert!(radiance.environment(glam::DVec3::Z).is_finite());
//! # Ok::<(), light::LightError>(())
//! ```

mod atlas_cache;
mod disk_cache;
mod error;
mod irradiance_cache;
mod irradiance_file;
mod light_errors;
mod lit_scene;
mod options;
mod photograph_light_cache;
mod resources;
mod scene_hashes;
mod steps;
#[cfg(test)]
#[path = "../../session/tests/tiny_glb/mod.rs"]
#[allow(dead_code, reason = "shared with other tests, which use all of it")]
mod tiny_glb;

pub use atlas_cache::load_or_unwrap_atlas;
pub use disk_cache::{CacheEntry, CacheSection, DiskCache, build_id, evict_oldest, mark_used};
pub use error::LightError;
pub use light_errors::LightErrors;
pub use lit_scene::{LitScene, SceneLight};
pub use options::{LightOptions, LightQuality, PhotoLookup};
pub use resources::Resources;
pub use scene_hashes::{content_hash, light_hash};
pub use slf::{PhotographLight, Scattering};
pub use steps::Steps;
