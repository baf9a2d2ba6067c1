//! How a surface scatters light: glTF's materials as sums of lobes that can be evaluated, sampled and told their density.
//! No rays, no textures.
//!
//! * [`Surface`]: what a material says at one point, textures looked up. [`Frame`]: how the surface lies there.
//! * [`Bsdf`]: the lobes of both. Directions point away from the surface; `outgoing` is where light goes to (the eye),
//!   `incident` where it comes from. Values are in 1/sr, without the cosine.
//! * [`Split`]: what obeys the paint (*own*: scattered diffusely, and rough gloss) and what does not (*carried*: mirrored, let
//!   through).
//! * `ggx`: microfacets. `fresnel`: what an interface mirrors. `albedo`: what a lobe sends back in all, tabulated. `interface`: the
//!   two sides of glass. `sheen`: cloth. `film`: iridescence. `coat_axes`: how a coat lies.
//!
//! Energy is neither made nor lost: what single scattering on microfacets loses is given back by reciprocal lobes (Kulla and
//! Conty 2017), and what an upper lobe mirrors is taken from what lies beneath it on both ways. [`Scattering::Single`] is
//! glTF's appendix B to the letter, to compare with renderers that do so.

mod albedo;
mod bsdf;
mod coat_axes;
mod film;
mod frame;
mod fresnel;
mod ggx;
mod interface;
mod lobes;
mod points;
mod sheen;
mod surface;

pub use bsdf::toward::OutgoingBsdf;
pub use bsdf::{Bsdf, Parts, Scattered};
pub use film::Film;
pub use frame::Frame;
pub use fresnel::{dielectric_reflectance, reflectance_of_ior, schlick};
pub use interface::Interface;
pub use lobes::Split;
pub use surface::{Clearcoat, Scattering, Sheen, Surface, attenuation, dispersed_ior};
