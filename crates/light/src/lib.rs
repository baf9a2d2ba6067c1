//! The light of a scene as a value.
//!
//! A [`LitScene`] is a scene that is ready for rays together with the light that was solved for in it: irradiance by world
//! (`irradiance_cache`), light from photographs (`photograph_light_cache`). Whoever holds one shares what it knows; when the last one
//! goes, work that still goes on for it stops. Results outlive the program in a [`DiskCache`], if one is passed in.
//!
//! Where radiance comes from is chosen in `lit_scene.rs`, here and nowhere else.
//!
//! ```
//! use light::{LightOptions, LightQuality, LitScene, Resources};
//! use progress::Unwatched;
//! use std::sync::Arc;
//!
//! let tracer = Arc::new(trace::Tracer::new(Arc::new(scene::Scene::default())));
//! let lit = LitScene::new(tracer, LightOptions::default(), &Resources::default());
//! let radiance = lit.solve(&lens::Camera::default(), LightQuality::Fine, &Unwatched)?;
//! assert!(radiance.from_infinity(glam::DVec3::Z).is_finite());
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
mod tiny_glb;

pub use atlas_cache::load_or_unwrap_atlas;
pub use disk_cache::{CacheEntry, CacheSection, DiskCache, build_id, evict_oldest};
pub use error::LightError;
pub use light_errors::LightErrors;
pub use lit_scene::{LitScene, SceneLight};
pub use options::{LightOptions, LightQuality, PhotoLookup};
pub use slf::{PhotographLight, Scattering};
pub use resources::Resources;
pub use scene_hashes::{content_hash, light_hash};
pub use steps::Steps;
