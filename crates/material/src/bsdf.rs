//! All lobes of a point together.

mod coat;
mod glass;
mod lobe_probabilities;
pub(crate) mod outgoing;

use lobe_probabilities::{Lobe, LobeProbabilities};

use crate::albedo::Gloss;
use crate::coat_axes::CoatAxes;
use crate::fresnel::{dielectric_reflectance, reflectance_of_ior, rise, schlick, schlick_mean};
use crate::ggx::{Ggx, SMOOTHEST};
use crate::interface::{RoughGlass, refracted};
use crate::{Frame, Interface, Scattering, Split, Surface, sheen};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, TAU};

/// How a point scatters light.
///
/// A clearcoat lies over sheen, and sheen over a mixture of metal, of a dielectric over a diffuse ground, and of glass. What an upper
/// lobe reflects is missing beneath it, on the way in and on the way out: the diffuse ground is coupled by
/// (1 − E(o))(1 − E(i))/(1 − Ē), which conserves energy; beneath coat and sheen the smaller of both shares is transmitted, which
/// loses a little. Both are reciprocal, unlike clearcoat mixing by the angle of one direction. [`Scattering::Single`] is glTF's
/// appendix B to the letter instead.
#[derive(Clone, Debug)]
pub struct Bsdf<'a> {
    surface: Surface,
    frame: Frame,
    interface: &'a Interface,
    /// Rough solid glass.
    rough_glass: Option<Box<RoughGlass>>,
    ggx: Ggx,
    coat: Ggx,
    /// F0 of the metal and of the dielectric; the F90 of the latter is its specular factor.
    f0: [DVec3; 2],
    /// Shares of metal, of the dielectric over its ground, and of glass.
    shares: [f64; 3],
    /// Hemispherical means of the gloss; `None` where nothing is glossy.
    means: Option<Means>,
}

/// What does not depend on directions.
#[derive(Clone, Copy, Debug)]
struct Means {
    /// A and B over the cosine-weighted hemisphere.
    shares: DVec2,
    /// The share of the lost light that multiple scattering returns, for metal and for the dielectric.
    multiple: [DVec3; 2],
    /// The share that the dielectric's surface transmits to its ground, over the cosine-weighted hemisphere.
    beneath: DVec3,
}

/// A direction, and the reflectance of the upper lobes toward it.
#[derive(Clone, Copy, Debug)]
struct Side {
    w: DVec3,
    /// F0 of the metal and of the dielectric.
    f0: [DVec3; 2],
    /// A and B of the gloss.
    shares: DVec2,
    /// The share that the dielectric's surface transmits to its ground.
    beneath: DVec3,
    coat: f64,
    sheen: f64,
}

/// A sampled incident direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattered {
    /// The direction that the light comes from.
    pub incident: DVec3,
    /// Value times cosine over density: the share of the light from there that is scattered, in both parts.
    pub weight: Split,
    /// 1/sr; `None` for a mirror or clear glass, whose direction no other sampling technique can produce.
    pub density: Option<f64>,
    /// Whether the light crosses the surface.
    pub crosses: bool,
}

/// The outgoing side: the frame that faces the eye, and the outgoing direction in it.
struct OutgoingFrame {
    frame: Frame,
    o: DVec3,
    side: Side,
    /// The axes of the clearcoat, in the frame.
    coat: CoatAxes,
    from_front: bool,
}

/// Scattered light, 1/sr, by how it is sampled best.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parts {
    /// Lobes as wide as a hemisphere: diffuse reflection, sheen, multiple scattering on facets. It is own light.
    pub spread: DVec3,
    /// All others.
    pub sharp: Split,
}

impl<'a> Bsdf<'a> {
    /// The BSDF of a point's material in a frame. `interface` describes the media on either side: given by the material's own index of
    /// refraction, or by the media that meet.
    pub fn new(surface: &Surface, frame: Frame, interface: &'a Interface) -> Self {
        let f0 = reflectance_of_ior(surface.ior) * surface.specular_color;
        let dielectric = (f0.min(DVec3::ONE)) * surface.specular;
        let [metal, glass] = [surface.metallic, surface.transmission];
        let mut bsdf = Self {
            surface: *surface,
            frame,
            interface,
            rough_glass: Self::rough_glass(surface, interface),
            ggx: Ggx::new(surface.roughness, surface.anisotropy),
            coat: Ggx::new(surface.clearcoat.map_or(0.0, |coat| coat.roughness), 0.0),
            f0: [surface.base_color, dielectric],
            shares: [metal, (1.0 - metal) * (1.0 - glass), (1.0 - metal) * glass],
            means: None,
        };
        let is_glossy = metal > 0.0 || (bsdf.shares[1] > 0.0 && surface.specular > 0.0);
        bsdf.means = is_glossy.then(|| bsdf.mean_gloss());
        bsdf
    }

    fn mean_gloss(&self) -> Means {
        let shares = match self.ggx.is_smooth() {
            true => DVec2::new(20.0, 1.0) / 21.0,
            false => self.gloss_table().mean_shares(),
        };
        let reflected = shares.element_sum();
        // F̄²Ē/(1 − F̄(1 − Ē)) (Kulla and Conty 2017).
        let multiple = [0, 1].map(|which| {
            let f90 = if which == 0 { DVec3::ONE } else { DVec3::splat(self.surface.specular) };
            let mean = self.mean_mirrored(which, f90);
            mean * mean * reflected / (DVec3::ONE - mean * (1.0 - reflected))
        });
        let back =
            self.mean_f0(1) * shares.x + self.surface.specular * shares.y + multiple[1] * self.lost(shares);
        Means { shares, multiple, beneath: DVec3::ONE - back }
    }

    fn rough_glass(surface: &Surface, interface: &Interface) -> Option<Box<RoughGlass>> {
        let is_glass = surface.transmission > 0.0 && surface.metallic < 1.0 && !surface.is_thin;
        let is_rough = !Ggx::new(surface.roughness, 0.0).is_smooth();
        let is_needed = is_glass && is_rough && surface.scattering == Scattering::Multiple;
        is_needed.then(|| Box::new(interface.rough(surface.roughness)))
    }

    /// F0 of the metal and of the dielectric; it depends on the cosine where there is a thin film.
    fn f0_at(&self, cos: f64) -> [DVec3; 2] {
        self.surface.film.map_or(self.f0, |film| self.f0.map(|f0| film.f0(f0, cos)))
    }

    /// F0 averaged over all facets that are visible from a direction: rough ones present themselves less askew than
    /// the surface does.
    fn f0_toward(&self, w: DVec3) -> [DVec3; 2] {
        let alpha = if self.ggx.is_smooth() { 0.0 } else { self.ggx.mean_alpha() };
        self.f0_at((w.z.abs() + alpha) / (1.0 + alpha))
    }

    /// The mean of `value_at` over the cosine-weighted hemisphere.
    fn hemisphere_mean(value_at: impl Fn(f64) -> DVec3) -> DVec3 {
        const STEPS: usize = 12;
        // cos² is uniform there.
        (0..STEPS).map(|k| value_at(((k as f64 + 0.5) / STEPS as f64).sqrt())).sum::<DVec3>() / STEPS as f64
    }

    fn mean_f0(&self, which: usize) -> DVec3 {
        self.surface.film.map_or(self.f0[which], |_| Self::hemisphere_mean(|cos| self.f0_at(cos)[which]))
    }

    fn mean_mirrored(&self, which: usize, f90: DVec3) -> DVec3 {
        let f0 = self.f0[which];
        self.surface.film.map_or_else(
            || schlick_mean(f0, f90),
            |film| Self::hemisphere_mean(|cos| schlick(film.f0(f0, cos), f90, cos)),
        )
    }

    fn outgoing_frame(&self, outgoing: DVec3) -> OutgoingFrame {
        let frame = self.frame.facing(outgoing);
        let from_front = self.frame.geometric.dot(outgoing) >= 0.0;
        let o = frame.local(outgoing);
        let coat = CoatAxes::new(&frame);
        OutgoingFrame { o, side: self.side(o, &coat), frame, coat, from_front }
    }

    fn side(&self, w: DVec3, coat: &CoatAxes) -> Side {
        let (mut shares, mut beneath, f0) = (DVec2::ZERO, DVec3::ONE, self.f0_toward(w));
        if let Some(means) = &self.means {
            shares = self.gloss_shares(w);
            let multiple = means.multiple[1] * self.lost(shares);
            let back = f0[1] * shares.x + self.surface.specular * shares.y + multiple;
            beneath = (DVec3::ONE - back).clamp(DVec3::ZERO, DVec3::ONE);
        }
        Side { w, f0, shares, beneath, coat: self.coat_albedo(coat.local(w)), sheen: self.sheen_albedo(w) }
    }

    /// Light scattered toward `outgoing` of light from `incident`, 1/sr, without the cosine. Mirrors and clear glass, which have no
    /// finite value, are left out.
    pub fn evaluate(&self, outgoing: DVec3, incident: DVec3) -> Split {
        let view = self.outgoing_frame(outgoing);
        self.value(&view, incident)
    }

    /// The density, 1/sr, with which [`Self::sample`] generates the unit direction `incident` toward `outgoing`;
    /// without mirrors, whose density is infinite.
    pub fn density(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        let view = self.outgoing_frame(outgoing);
        self.density_of(&view, &self.lobe_probabilities(&view), incident)
    }

    /// Samples an incident direction from uniform numbers in [0, 1). `None` where the sampled direction carries no
    /// light.
    pub fn sample(&self, outgoing: DVec3, u: [f64; 3]) -> Option<Scattered> {
        self.toward(outgoing).sample(u)
    }

    fn sample_lobes(
        &self,
        view: &OutgoingFrame,
        probabilities: &LobeProbabilities,
        u: [f64; 3],
    ) -> Option<Scattered> {
        if view.o.z <= 0.0 {
            return None;
        }
        let place = DVec2::new(u[1], u[2]);
        let (lobe, rest) = probabilities.select(u[0])?;
        let o = view.o;
        let (i, crosses) = match lobe {
            Lobe::Coat if self.coat.is_smooth() => {
                return self.mirrored_by_coat(view, probabilities.coat);
            }
            Lobe::Coat => (self.sample_coat(view, place), false),
            Lobe::Gloss if self.ggx.is_smooth() => {
                return self.mirrored(view, self.gloss_mirror(view) / probabilities.gloss);
            }
            Lobe::Gloss => (mirror(o, self.ggx.visible_normal(o, place)), false),
            Lobe::Spread => (cosine_weighted(place), false),
            Lobe::Through => (-cosine_weighted(place), true),
            Lobe::Returned => self.sample_returned(view, rest, place),
            Lobe::Glass => {
                let eta = self.eta(view);
                let is_clear = self.is_clear(eta);
                let h = if is_clear { DVec3::Z } else { self.ggx.visible_normal(o, place) };
                let crosses = rest >= dielectric_reflectance(o.dot(h), eta);
                let i = match (crosses, self.surface.is_thin) {
                    (false, _) => mirror(o, h),
                    (true, true) => flipped(mirror(o, h)),
                    (true, false) => refracted(o, h, eta)?,
                };
                if is_clear {
                    return self.clear(view, probabilities.glass, !crosses, i);
                }
                (i, crosses)
            }
        };
        // A facet may reflect light into the surface: light that meets further facets is part of the
        // multiple-scattering lobe.
        if crosses != (i.z < 0.0) {
            return None;
        }
        let incident = view.frame.world(i);
        let density = self.density_of(view, probabilities, incident);
        let value = self.value(view, incident);
        let weight = value * (i.z.abs() / density);
        let is_something = density > 0.0 && density.is_finite() && value.total() != DVec3::ZERO;
        is_something.then_some(Scattered { incident, weight, density: Some(density), crosses: i.z < 0.0 })
    }

    /// The share of light from everywhere that is scattered toward `outgoing`, at most 1, in both parts: in closed
    /// form, from tables.
    pub fn albedo(&self, outgoing: DVec3) -> Split {
        self.albedo_toward(&self.outgoing_frame(outgoing))
    }

    fn albedo_toward(&self, view: &OutgoingFrame) -> Split {
        let (o, side) = (view.o, &view.side);
        if o.z <= 0.0 {
            return Split::default();
        }
        let [metal, dielectric, glass] = self.shares;
        let (under_coat, under_sheen) = (1.0 - side.coat, 1.0 - side.sheen);
        let shares = side.shares;
        let lost = self.lost(shares);
        let mut all =
            Split::mirrored((side.f0[0] * shares.x + shares.y).max(DVec3::ZERO), self.ggx.mean_alpha())
                * metal;
        all += Split::own(self.multiple(0) * lost) * metal;
        let f90 = DVec3::splat(self.surface.specular);
        all +=
            Split::mirrored((side.f0[1] * shares.x + f90 * shares.y).max(DVec3::ZERO), self.ggx.mean_alpha())
                * dielectric;
        all += Split::own(self.multiple(1) * lost) * dielectric;
        let ground = side.beneath;
        let share = self.surface.diffuse_transmission;
        let color = self.surface.base_color * (1.0 - share) + self.surface.diffuse_transmission_color * share;
        all += Split::own(ground * color) * dielectric;
        let mirrors = self.glass_mirrors(view);
        let tint = self.surface.base_color * (1.0 - mirrors);
        all += (Split::mirrored(DVec3::splat(mirrors), self.ggx.mean_alpha()) + Split::carried(tint)) * glass;
        all = all * under_sheen;
        if let Some(cloth) = self.surface.sheen {
            all += Split::own(cloth.color * sheen::albedo(o.z, cloth.roughness));
        }
        all * under_coat + Split::mirrored(DVec3::splat(side.coat), self.coat.mean_alpha())
    }

    /// How coverage is shared between own and carried light: by the albedo of either, averaged over the channels. Sums to 1; all own where
    /// nothing is scattered at all.
    pub fn coverage_shares(&self, outgoing: DVec3) -> [f64; 2] {
        self.shares_of(self.albedo(outgoing))
    }

    fn shares_of(&self, albedo: Split) -> [f64; 2] {
        let [own, carried] = [albedo.own, albedo.carried].map(|part| part.element_sum());
        if own + carried > 0.0 { [own / (own + carried), carried / (own + carried)] } else { [1.0, 0.0] }
    }

    fn eta(&self, view: &OutgoingFrame) -> f64 {
        // A pane has the same medium on either side.
        self.interface.eta(view.from_front || self.surface.is_thin)
    }

    fn gloss_table(&self) -> Gloss {
        Gloss { roughness: self.surface.roughness, anisotropy: self.surface.anisotropy }
    }

    /// Whether glass transmits light in one direction only: it is smooth, or does not refract, so that its facets make no
    /// difference.
    fn is_clear(&self, eta: f64) -> bool {
        let bends = if self.surface.is_thin { 1.0 } else { (eta - 1.0).abs() };
        self.ggx.is_smooth() || bends * self.ggx.mean_alpha() < SMOOTHEST
    }

    /// A and B of the gloss toward a direction.
    fn gloss_shares(&self, w: DVec3) -> DVec2 {
        if self.ggx.is_smooth() {
            return DVec2::new(1.0 - rise(w.z.abs()), rise(w.z.abs()));
        }
        self.gloss_table().shares(w)
    }

    fn mean_gloss_shares(&self) -> DVec2 {
        self.means.map_or_else(|| self.gloss_table().mean_shares(), |means| means.shares)
    }

    /// The share of white light that single scattering loses.
    fn lost(&self, shares: DVec2) -> f64 {
        let is_lossless = self.surface.scattering == Scattering::Single || self.ggx.is_smooth();
        if is_lossless { 0.0 } else { (1.0 - shares.element_sum()).max(0.0) }
    }

    /// The share of the lost light that multiple scattering returns, from metal (0) or the dielectric (1).
    fn multiple(&self, which: usize) -> DVec3 {
        self.means.map_or(DVec3::ZERO, |means| means.multiple[which])
    }

    fn sheen_albedo(&self, w: DVec3) -> f64 {
        self.surface
            .sheen
            .map_or(0.0, |cloth| cloth.color.max_element() * sheen::albedo(w.z.abs(), cloth.roughness))
    }

    /// The share that coat and sheen transmit to the layers beneath, for both directions.
    fn beneath(&self, o: &Side, i: &Side) -> f64 {
        (1.0 - o.coat).min(1.0 - i.coat) * (1.0 - o.sheen).min(1.0 - i.sheen)
    }

    fn value(&self, view: &OutgoingFrame, incident: DVec3) -> Split {
        let Parts { spread, sharp } = self.parts(view, incident);
        Split::own(spread) + sharp
    }

    fn parts(&self, view: &OutgoingFrame, incident: DVec3) -> Parts {
        let (o, i) = (view.o, view.frame.local(incident));
        let same_side = view.frame.geometric.dot(incident) > 0.0;
        // No light from behind, whatever the shading normal is.
        if o.z <= 0.0 || i.z == 0.0 || same_side != (i.z > 0.0) {
            return Parts::default();
        }
        let (eye, light) = (&view.side, &self.side(i, &view.coat));
        let beneath = self.beneath(eye, light);
        if !same_side {
            let sharp = (self.across(view, o, i) + self.diffuse_across(eye, light)) * beneath;
            return Parts { spread: DVec3::ZERO, sharp };
        }
        let mut spread = (self.multiple_value(eye, light) + self.diffuse(eye, light)) * beneath;
        let mut sharp = (self.gloss(eye, light) + self.glass(view, o, i)) * beneath;
        if let Some(cloth) = self.surface.sheen {
            let left = (1.0 - eye.coat).min(1.0 - light.coat);
            spread += cloth.color * sheen::value(o, i, cloth.roughness) * left;
        }
        sharp += self.coated(view, i);
        let share = view.frame.terminator(incident);
        Parts { spread: spread * share, sharp: sharp * share }
    }

    /// Gloss of metal and of the dielectric's surface.
    fn gloss(&self, eye: &Side, light: &Side) -> Split {
        if self.means.is_none() || self.ggx.is_smooth() {
            return Split::default();
        }
        let (o, i) = (eye.w, light.w);
        let single = half(o, i)
            .map_or(DVec3::ZERO, |h| self.mirrored_at(o.dot(h)) * self.microfacets(&self.ggx, o, i, h));
        Split::mirrored(single, self.ggx.mean_alpha())
    }

    /// The multiple-scattering lobe of their facets.
    fn multiple_value(&self, eye: &Side, light: &Side) -> DVec3 {
        let [metal, dielectric, _] = self.shares;
        let Some(means) = self.means.filter(|_| !self.ggx.is_smooth()) else { return DVec3::ZERO };
        let lost = self.lost(eye.shares) * self.lost(light.shares);
        let spread = if lost > 0.0 { lost * FRAC_1_PI / self.lost(means.shares) } else { 0.0 };
        (means.multiple[0] * metal + means.multiple[1] * dielectric) * spread
    }

    /// D·G₂/(4 cos cos): the microfacet lobe with a reflectance of 1.
    fn microfacets(&self, ggx: &Ggx, o: DVec3, i: DVec3, h: DVec3) -> f64 {
        let masking = match self.surface.scattering {
            Scattering::Multiple => ggx.correlated_masking_shadowing(o, i),
            Scattering::Single => ggx.uncorrelated_masking_shadowing(o, i),
        };
        ggx.density_of_normals(h) * masking / (4.0 * o.z * i.z)
    }

    /// The reflectance of metal and dielectric facets at an angle.
    fn mirrored_at(&self, cos: f64) -> DVec3 {
        let [metal, dielectric, _] = self.shares;
        let f90 = DVec3::splat(self.surface.specular);
        let [of_metal, of_dielectric] = self.f0_at(cos);
        let mirrored =
            schlick(of_metal, DVec3::ONE, cos) * metal + schlick(of_dielectric, f90, cos) * dielectric;
        mirrored.max(DVec3::ZERO)
    }

    /// The coupling of a diffuse ground beneath the dielectric's surface.
    fn coupled(&self, eye: &Side, light: &Side) -> DVec3 {
        let Some(means) = &self.means else { return DVec3::splat(FRAC_1_PI) };
        let both = eye.beneath * light.beneath / means.beneath;
        // A surface that reflects all light leaves nothing to its ground.
        DVec3::select(means.beneath.cmpgt(DVec3::ZERO), both, DVec3::ZERO) * FRAC_1_PI
    }

    fn diffuse(&self, eye: &Side, light: &Side) -> DVec3 {
        let share = self.shares[1] * (1.0 - self.surface.diffuse_transmission);
        if share == 0.0 {
            return DVec3::ZERO;
        }
        let ground = match self.surface.scattering {
            Scattering::Multiple => self.coupled(eye, light),
            Scattering::Single => self.left_by_facets(eye.w, light.w) * FRAC_1_PI,
        };
        self.surface.base_color * ground * share
    }

    /// The share that the dielectric's facets transmit to the ground as glTF's appendix B.3 mixes them: 1 − F, at the angle of the facet that
    /// would reflect one direction to the other.
    fn left_by_facets(&self, o: DVec3, i: DVec3) -> DVec3 {
        let Some(h) = half(o, i) else { return DVec3::ONE };
        let [_, f0] = self.f0_at(o.dot(h));
        DVec3::ONE - schlick(f0, DVec3::splat(self.surface.specular), o.dot(h))
    }

    fn diffuse_across(&self, eye: &Side, light: &Side) -> Split {
        let share = self.shares[1] * self.surface.diffuse_transmission;
        if share == 0.0 {
            return Split::default();
        }
        Split::own(self.surface.diffuse_transmission_color * self.coupled(eye, light)) * share
    }

    fn gloss_mirror(&self, view: &OutgoingFrame) -> DVec3 {
        let mirrored = self.side(mirror(view.o, DVec3::Z), &view.coat);
        self.mirrored_at(view.o.z) * self.beneath(&view.side, &mirrored)
    }

    /// The direction of a mirror.
    fn mirrored(&self, view: &OutgoingFrame, weight: DVec3) -> Option<Scattered> {
        self.single(view, mirror(view.o, DVec3::Z), Split::carried(weight))
    }

    fn single(&self, view: &OutgoingFrame, i: DVec3, weight: Split) -> Option<Scattered> {
        let incident = view.frame.world(i);
        let same_side = view.frame.geometric.dot(incident) > 0.0;
        let is_there = same_side == (i.z > 0.0) && weight.total() != DVec3::ZERO;
        is_there.then_some(Scattered { incident, weight, density: None, crosses: i.z < 0.0 })
    }

    fn lobe_probabilities(&self, view: &OutgoingFrame) -> LobeProbabilities {
        let [metal, dielectric, glass] = self.shares;
        let mean = |color: DVec3| color.element_sum() / 3.0;
        let Side { f0, shares, coat, sheen: cloth, .. } = view.side;
        let lost = self.lost(shares);
        let beneath = (1.0 - coat) * (1.0 - cloth);
        let gloss = f0[0] * (metal * shares.x) + metal * shares.y;
        let gloss = gloss + (f0[1] * shares.x + self.surface.specular * shares.y) * dielectric;
        let multiple = (self.multiple(0) * metal + self.multiple(1) * dielectric) * lost;
        let ground = view.side.beneath * dielectric;
        let share = self.surface.diffuse_transmission;
        let on_this_side = mean(multiple + ground * self.surface.base_color * (1.0 - share));
        let beyond = mean(ground * self.surface.diffuse_transmission_color * share);
        let glass_lost = self.glass_lost(view).lost * glass;
        LobeProbabilities {
            coat,
            gloss: mean(gloss) * beneath,
            glass: (glass - glass_lost) * beneath,
            spread: on_this_side * beneath + cloth * (1.0 - coat),
            through: beyond * beneath,
            returned: glass_lost * beneath,
        }
        .normalized()
    }

    fn density_of(&self, view: &OutgoingFrame, probabilities: &LobeProbabilities, incident: DVec3) -> f64 {
        let (o, i) = (view.o, view.frame.local(incident));
        if o.z <= 0.0 {
            return 0.0;
        }
        let eta = self.eta(view);
        let is_clear = self.is_clear(eta);
        let mirror_density = |ggx: &Ggx, h: DVec3| ggx.density_of_visible(o, h) / (4.0 * o.dot(h));
        let returned = if probabilities.returned > 0.0 {
            probabilities.returned * self.density_of_returned(view, i)
        } else {
            0.0
        };
        if i.z > 0.0 {
            let mut density = probabilities.spread * i.z * FRAC_1_PI + returned;
            if probabilities.coat > 0.0 {
                density += probabilities.coat * self.density_of_coat(view, i);
            }
            let Some(h) = half(o, i) else { return density };
            if probabilities.gloss > 0.0 && !self.ggx.is_smooth() {
                density += probabilities.gloss * mirror_density(&self.ggx, h);
            }
            if probabilities.glass > 0.0 && !is_clear {
                density += probabilities.glass
                    * dielectric_reflectance(o.dot(h), eta)
                    * mirror_density(&self.ggx, h);
            }
            return density;
        }
        let mut density = probabilities.through * -i.z * FRAC_1_PI + returned;
        if probabilities.glass > 0.0 && !is_clear {
            density += probabilities.glass * self.density_across(view, i);
        }
        density
    }
}

/// Halfway between two directions on one side; `None` where they are opposite.
fn half(o: DVec3, i: DVec3) -> Option<DVec3> {
    (o + i).try_normalize().filter(|h| h.z > 0.0 && o.dot(*h) > 0.0)
}

fn mirror(o: DVec3, h: DVec3) -> DVec3 {
    h * (2.0 * o.dot(h)) - o
}

/// The direction on the other side of the surface.
fn flipped(w: DVec3) -> DVec3 {
    DVec3::new(w.x, w.y, -w.z)
}

pub(crate) fn cosine_weighted(u: DVec2) -> DVec3 {
    let (sin, cos) = (TAU * u.x).sin_cos();
    let flat = u.y.sqrt();
    DVec3::new(flat * cos, flat * sin, (1.0 - u.y).max(0.0).sqrt())
}
