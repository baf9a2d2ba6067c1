//! The surface light field: radiance that leaves a surface point.
//!
//! | type | source of the radiance |
//! | --- | --- |
//! | [`Transport`] | path tracing, optionally with cached [`Irradiance`] |
//! | [`PhotographLight`] | photographs, resampled to the texels of an atlas |
//! | [`DirectPhotographs`] | photographs, looked up anew for every point |
//!
//! All three implement [`trace::Radiance`].
//!
//! | module | what it holds |
//! | --- | --- |
//! | `material_point` | the material and shading frame of a surface point |
//! | `lights` | light sampling: `punctual` (point, spot, directional), `emitters` (emissive triangles, chosen by `light_tree`), `environment_light` (by `cumulative_tables`) |
//! | `media` | the nested media a path is in |
//! | `path_random` | random numbers of paths |
//! | `transport` | path tracing |
//! | `irradiance`, `irradiance_solver` | the irradiance cache, and its solution bounce by bounce; `open_sky`: irradiance of an unoccluded sky |
//! | `light_interpolation` | incident light of many picture points interpolated from a few |
//! | `photographs` | light from photographs |
//!
//! ```
//! use glam::{DVec2, DVec3, Vec3};
//! use progress::Unwatched;
//! use scene::{LoadOptions, Scene, SurfaceMesh, SurfacePoint, World};
//! use slf::{Irradiance, IrradianceOptions, Transport, TransportOptions};
//! use std::sync::Arc;
//! use trace::{Radiance, Tracer};
//!
//! // A triangle under a uniform sky of radiance 1.
//! let positions = vec![DVec3::ZERO, DVec3::Z, DVec3::X];
//! let mesh = SurfaceMesh { positions, triangles: vec![[0, 1, 2]], ..SurfaceMesh::default() };
//! let scene = Scene::from_mesh(mesh, &LoadOptions::default())?;
//! let (tracer, world) = (Arc::new(Tracer::new(Arc::new(scene))), World::uniform(Vec3::ONE));
//! let transport = Transport::new(tracer, world, TransportOptions::default());
//!
//! // Cache the indirect light, then evaluate a point toward an eye above it.
//! let irradiance = Irradiance::solve(&transport, IrradianceOptions { patches: 16, rays: 16 }, &Unwatched)?;
//! let transport = transport.with_irradiance(Arc::new(irradiance));
//! let point = SurfacePoint { triangle: 0, barycentric: DVec2::splat(0.25) };
//! let radiance = transport.outgoing(point, DVec3::Y);
//! assert!(radiance.own.is_finite() && radiance.own.min_element() > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bounce_limit;
mod cumulative_tables;
mod emitters;
mod environment_light;
mod irradiance;
mod irradiance_solver;
mod light_interpolation;
mod light_tree;
mod lights;
mod material_point;
mod media;
mod open_sky;
mod path_random;
mod photographs;
mod punctual;
mod transport;

pub use bounce_limit::{BounceLimit, MAX_BOUNCES};
pub use irradiance::gathered::GatheredIrradiance;
pub use irradiance::solved::IrradianceSolution;
pub use irradiance::{Irradiance, IrradianceOptions};
pub use material::Scattering;
pub use photographs::{
    DirectPhotographs, Exposure, LightTexture, PhotographError, PhotographLight, PhotographModel,
    PhotographOptions, Poses,
};
pub use transport::{Transport, TransportOptions};
