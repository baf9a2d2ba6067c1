//! How a surface scatters light: glTF's materials as sums of lobes that can be evaluated and sampled, with their probability densities.
//! No rays, no textures.
//!
//! * [`Surface`]: the material at one point, after texture lookup. [`Frame`]: the normals and the tangent there.
//! * [`Bsdf`]: the lobes of both. Directions point away from the surface; `outgoing` is where light goes to (the eye),
//!   `incident` where it comes from. Values are in 1/sr, without the cosine.
//! * [`Split`]: scattered light in two parts: what obeys the paint (*own*: diffuse light and rough gloss) and what does not
//!   (*carried*: mirrored and transmitted light).
//! * `ggx`: microfacets. `fresnel`: the reflectance of an interface. `albedo`: the directional albedo of a lobe, tabulated.
//!   `interface`: the two sides of glass. `sheen`: cloth. `film`: iridescence. `coat_axes`: the orientation of a clearcoat.
//!
//! Energy is conserved: what single scattering on microfacets loses is returned by reciprocal lobes (Kulla and Conty 2017), and
//! what an upper lobe reflects is taken from the layers beneath it, on the way in and on the way out. [`Scattering::Single`] is
//! glTF's appendix B to the letter, to compare with renderers that implement that.
//!
//! ```
//! use glam::DVec3;
//! use material::{Bsdf, Frame, Interface, Surface};
//!
//! let interface = Interface::from_ior(1.5);
//! let surface = Surface { metallic: 0.0, roughness: 0.5, ..Surface::default() };
//! let bsdf = Bsdf::new(&surface, Frame::flat(DVec3::Z), &interface);
//! let scattered = bsdf.sample(DVec3::Z, [0.9, 0.25, 0.75]).expect("light from above");
//! assert!(scattered.incident.z > 0.0 && scattered.weight.total().min_element() > 0.0);
//! assert!(bsdf.albedo(DVec3::Z).total().max_element() <= 1.0);
//! ```

mod albedo;
mod bsdf;
mod coat_axes;
mod fibonacci_lattice;
mod film;
mod frame;
mod fresnel;
mod ggx;
mod interface;
mod lambertian;
mod sheen;
mod split;
mod surface;

pub use bsdf::outgoing::OutgoingBsdf;
pub use bsdf::{Bsdf, Parts, Scattered};
pub use film::Film;
pub use frame::Frame;
pub use fresnel::{dielectric_reflectance, reflectance_of_ior, schlick};
pub use interface::Interface;
pub use lambertian::Lambertian;
pub use split::Split;
pub use surface::{Clearcoat, Scattering, Sheen, Surface, attenuation, dispersed_ior};
