//! All lobes of a point together.

mod glass;
mod odds;

use odds::{Choice, Odds};

use crate::albedo::Gloss;
use crate::fresnel::{dielectric_reflectance, reflectance_of_ior, rise, schlick, schlick_mean};
use crate::ggx::{Ggx, SMOOTHEST};
use crate::interface::{RoughGlass, refracted};
use crate::{Frame, Interface, Scattering, Split, Surface, sheen};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, TAU};

/// How a point scatters light.
///
/// A coat lies over sheen, and that over a mixture of metal, of a dielectric over a diffuse ground, and of glass. What an upper
/// lobe mirrors is missing beneath it, for the eye and for the light alike: the diffuse ground is coupled,
/// (1 − E(o))(1 − E(i))/(1 − Ē), which keeps all energy; beneath coat and sheen the smaller of both shares is left, which
/// loses some. Both are reciprocal, as glTF's own mixing by the angle of one direction is not.
#[derive(Clone, Debug)]
pub struct Bsdf<'a> {
    surface: Surface,
    frame: Frame,
    interface: &'a Interface,
    /// Solid glass that is rough.
    rough_glass: Option<Box<RoughGlass>>,
    ggx: Ggx,
    coat: Ggx,
    /// F0 of the metal and of the dielectric; F90 of the latter is its specular factor.
    f0: [DVec3; 2],
    /// Shares of metal, of the dielectric over its ground, and of glass.
    shares: [f64; 3],
}

/// A direction that light was found to come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattered {
    /// Toward where the light comes from.
    pub incident: DVec3,
    /// Value times cosine over density: what of the light from there is sent on, of both parts.
    pub weight: Split,
    /// 1/sr; none of a mirror or clear glass, whose direction no other way of sampling finds.
    pub density: Option<f64>,
    /// Whether it crossed the surface.
    pub crosses: bool,
}

/// Seen from where: the frame that faces the eye, and the eye in it.
struct Seen {
    frame: Frame,
    o: DVec3,
    from_front: bool,
}

const COAT_F0: f64 = 0.04;

impl<'a> Bsdf<'a> {
    /// Of a point's material as it lies there. `interface` says what lies on either side: of the material's own index of
    /// refraction, or of the media that meet.
    pub fn new(surface: &Surface, frame: Frame, interface: &'a Interface) -> Self {
        let f0 = reflectance_of_ior(surface.ior) * surface.specular_color;
        let dielectric = (f0.min(DVec3::ONE)) * surface.specular;
        let [metal, glass] = [surface.metallic, surface.transmission];
        Self {
            surface: *surface,
            frame,
            interface,
            rough_glass: Self::rough_glass(surface, interface),
            ggx: Ggx::new(surface.roughness, surface.anisotropy),
            coat: Ggx::new(surface.clearcoat.map_or(0.0, |coat| coat.roughness), 0.0),
            f0: [surface.base_color, dielectric],
            shares: [metal, (1.0 - metal) * (1.0 - glass), (1.0 - metal) * glass],
        }
    }

    fn rough_glass(surface: &Surface, interface: &Interface) -> Option<Box<RoughGlass>> {
        let is_glass = surface.transmission > 0.0 && surface.metallic < 1.0 && !surface.is_thin;
        let is_rough = !Ggx::new(surface.roughness, 0.0).is_smooth();
        let is_needed = is_glass && is_rough && surface.scattering == Scattering::Multiple;
        is_needed.then(|| Box::new(interface.rough(surface.roughness)))
    }

    fn seen(&self, outgoing: DVec3) -> Seen {
        let frame = self.frame.facing(outgoing);
        let from_front = self.frame.geometric.dot(outgoing) >= 0.0;
        Seen { o: frame.local(outgoing), frame, from_front }
    }

    /// Light sent toward `outgoing` for light from `incident`, 1/sr, without the cosine; mirrors and clear glass, which have
    /// no finite value, are left out.
    pub fn evaluate(&self, outgoing: DVec3, incident: DVec3) -> Split {
        let seen = self.seen(outgoing);
        self.value(&seen, incident)
    }

    /// The density, 1/sr, with which [`Self::sample`] finds `incident`.
    pub fn density(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        let seen = self.seen(outgoing);
        self.density_of(&seen, &self.odds(&seen), incident)
    }

    /// Draws where light comes from, by uniform numbers in [0, 1). `None` where the drawn way carries nothing.
    pub fn sample(&self, outgoing: DVec3, u: [f64; 3]) -> Option<Scattered> {
        let seen = self.seen(outgoing);
        if seen.o.z <= 0.0 {
            return None;
        }
        let odds = self.odds(&seen);
        let place = DVec2::new(u[1], u[2]);
        let (choice, rest) = odds.choose(u[0])?;
        let o = seen.o;
        let (i, crosses) = match choice {
            Choice::Coat if self.coat.is_smooth() => {
                return self.mirrored(&seen, self.coat_mirror(o) / odds.coat);
            }
            Choice::Coat => (mirror(o, self.coat.visible_normal(o, place)), false),
            Choice::Gloss if self.ggx.is_smooth() => {
                return self.mirrored(&seen, self.gloss_mirror(o) / odds.gloss);
            }
            Choice::Gloss => (mirror(o, self.ggx.visible_normal(o, place)), false),
            Choice::Spread => (cosine_weighted(place), false),
            Choice::Through => (-cosine_weighted(place), true),
            Choice::Returned => self.come_back(&seen, rest, place),
            Choice::Glass => {
                let eta = self.eta(&seen);
                let is_clear = self.is_clear(eta);
                let h = if is_clear { DVec3::Z } else { self.ggx.visible_normal(o, place) };
                let crosses = rest >= dielectric_reflectance(o.dot(h), eta);
                let i = match (crosses, self.surface.is_thin) {
                    (false, _) => mirror(o, h),
                    (true, true) => flipped(mirror(o, h)),
                    (true, false) => refracted(o, h, eta)?,
                };
                if is_clear {
                    return self.clear(&seen, odds.glass, !crosses, i);
                }
                (i, crosses)
            }
        };
        // A facet may send light into the surface: what meets others next is in what multiple scattering gives back.
        if crosses != (i.z < 0.0) {
            return None;
        }
        let incident = seen.frame.world(i);
        let density = self.density_of(&seen, &odds, incident);
        let value = self.value(&seen, incident);
        let weight = value * (i.z.abs() / density);
        let is_something = density > 0.0 && density.is_finite() && value.total() != DVec3::ZERO;
        is_something.then_some(Scattered { incident, weight, density: Some(density), crosses: i.z < 0.0 })
    }

    /// What is sent toward `outgoing` of light from everywhere, at most 1: in closed form, from tables. Of both parts.
    pub fn albedo(&self, outgoing: DVec3) -> Split {
        let seen = self.seen(outgoing);
        let o = seen.o;
        if o.z <= 0.0 {
            return Split::default();
        }
        let [metal, dielectric, glass] = self.shares;
        let (under_coat, under_sheen) = (1.0 - self.coat_albedo(o), 1.0 - self.sheen_albedo(o));
        let shares = self.gloss_shares(o);
        let lost = self.lost(shares);
        let mut all = Split::mirrored(self.f0[0] * shares.x + shares.y, self.ggx.mean_alpha()) * metal;
        all += Split::own(self.multiple(0) * lost) * metal;
        let f90 = DVec3::splat(self.surface.specular);
        all += Split::mirrored(self.f0[1] * shares.x + f90 * shares.y, self.ggx.mean_alpha()) * dielectric;
        all += Split::own(self.multiple(1) * lost) * dielectric;
        let ground = DVec3::ONE - self.dielectric_albedo(o);
        let share = self.surface.diffuse_transmission;
        let color = self.surface.base_color * (1.0 - share) + self.surface.diffuse_transmission_color * share;
        all += Split::own(ground * color) * dielectric;
        let mirrors = self.glass_mirrors(&seen);
        let tint = self.surface.base_color * (1.0 - mirrors);
        all += (Split::mirrored(DVec3::splat(mirrors), self.ggx.mean_alpha()) + Split::carried(tint)) * glass;
        all = all * under_sheen;
        if let Some(cloth) = self.surface.sheen {
            all += Split::own(cloth.color * sheen::albedo(o.z, cloth.roughness));
        }
        all * under_coat + Split::mirrored(DVec3::splat(self.coat_albedo(o)), self.coat.mean_alpha())
    }

    /// How coverage is shared between what is own and what is carried: by what either sends back in all, the mean of its
    /// channels. Sums to 1; all own where nothing is sent at all.
    pub fn coverage_shares(&self, outgoing: DVec3) -> [f64; 2] {
        let albedo = self.albedo(outgoing);
        let [own, carried] = [albedo.own, albedo.carried].map(|part| part.element_sum());
        if own + carried > 0.0 { [own / (own + carried), carried / (own + carried)] } else { [1.0, 0.0] }
    }

    fn eta(&self, seen: &Seen) -> f64 {
        // A pane has the same medium on either side of it.
        self.interface.eta(seen.from_front || self.surface.is_thin)
    }

    fn gloss_table(&self) -> Gloss {
        Gloss { roughness: self.surface.roughness, anisotropy: self.surface.anisotropy }
    }

    /// Whether glass lets light through in one direction: it is smooth, or bends nothing, so that its facets make no
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
        match self.ggx.is_smooth() {
            true => DVec2::new(20.0, 1.0) / 21.0,
            false => self.gloss_table().mean_shares(),
        }
    }

    /// What single scattering loses of white light.
    fn lost(&self, shares: DVec2) -> f64 {
        let is_kept = self.surface.scattering == Scattering::Single || self.ggx.is_smooth();
        if is_kept { 0.0 } else { (1.0 - shares.element_sum()).max(0.0) }
    }

    /// What of the lost light comes back from metal (0) or the dielectric (1): F̄²Ē/(1 − F̄(1 − Ē)) (Kulla and Conty 2017).
    fn multiple(&self, which: usize) -> DVec3 {
        let f90 = if which == 0 { DVec3::ONE } else { DVec3::splat(self.surface.specular) };
        let (mean, kept) = (schlick_mean(self.f0[which], f90), self.mean_gloss_shares().element_sum());
        mean * mean * kept / (DVec3::ONE - mean * (1.0 - kept))
    }

    /// All that the dielectric's surface sends back, so that its ground does not get it.
    fn dielectric_albedo(&self, w: DVec3) -> DVec3 {
        let shares = self.gloss_shares(w);
        self.f0[1] * shares.x + self.surface.specular * shares.y + self.multiple(1) * self.lost(shares)
    }

    fn mean_dielectric_albedo(&self) -> DVec3 {
        let shares = self.mean_gloss_shares();
        self.f0[1] * shares.x + self.surface.specular * shares.y + self.multiple(1) * self.lost(shares)
    }

    fn coat_albedo(&self, w: DVec3) -> f64 {
        let Some(coat) = self.surface.clearcoat else { return 0.0 };
        let shares = if self.coat.is_smooth() {
            DVec2::new(1.0 - rise(w.z.abs()), rise(w.z.abs()))
        } else {
            Gloss { roughness: coat.roughness, anisotropy: 0.0 }.shares(w)
        };
        coat.factor * (COAT_F0 * shares.x + shares.y)
    }

    fn sheen_albedo(&self, w: DVec3) -> f64 {
        self.surface
            .sheen
            .map_or(0.0, |cloth| cloth.color.max_element() * sheen::albedo(w.z.abs(), cloth.roughness))
    }

    /// What coat and sheen leave of what lies beneath, for both directions.
    fn beneath(&self, o: DVec3, i: DVec3) -> f64 {
        let left = |of: &dyn Fn(DVec3) -> f64| (1.0 - of(o)).min(1.0 - of(i));
        left(&|w| self.coat_albedo(w)) * left(&|w| self.sheen_albedo(w))
    }

    fn value(&self, seen: &Seen, incident: DVec3) -> Split {
        let (o, i) = (seen.o, seen.frame.local(incident));
        let same_side = seen.frame.geometric.dot(incident) > 0.0;
        // No light from behind, whatever the shading normal says.
        if o.z <= 0.0 || i.z == 0.0 || same_side != (i.z > 0.0) {
            return Split::default();
        }
        let beneath = self.beneath(o, i);
        if !same_side {
            return (self.across(seen, o, i) + self.diffuse_across(o, i)) * beneath;
        }
        let mut value = (self.gloss(o, i) + self.diffuse(o, i) + self.glass(seen, o, i)) * beneath;
        if let Some(cloth) = self.surface.sheen {
            let left = (1.0 - self.coat_albedo(o)).min(1.0 - self.coat_albedo(i));
            value += Split::own(cloth.color * sheen::value(o, i, cloth.roughness) * left);
        }
        if let (Some(coat), false, Some(h)) = (self.surface.clearcoat, self.coat.is_smooth(), half(o, i)) {
            let mirrored = COAT_F0 + (1.0 - COAT_F0) * rise(o.dot(h));
            let light = coat.factor * mirrored * microfacets(&self.coat, o, i, h);
            value += Split::mirrored(DVec3::splat(light), self.coat.mean_alpha());
        }
        value * seen.frame.terminator(incident)
    }

    /// Metal and the dielectric's surface.
    fn gloss(&self, o: DVec3, i: DVec3) -> Split {
        let [metal, dielectric, _] = self.shares;
        if self.ggx.is_smooth() || metal + dielectric == 0.0 {
            return Split::default();
        }
        let lost = self.lost(self.gloss_shares(o)) * self.lost(self.gloss_shares(i));
        let mean = self.lost(self.mean_gloss_shares());
        let spread = if lost > 0.0 { lost * FRAC_1_PI / mean } else { 0.0 };
        let multiple = (self.multiple(0) * metal + self.multiple(1) * dielectric) * spread;
        let single =
            half(o, i).map_or(DVec3::ZERO, |h| self.mirrored_at(o.dot(h)) * microfacets(&self.ggx, o, i, h));
        Split::mirrored(single, self.ggx.mean_alpha()) + Split::own(multiple)
    }

    /// What facets of metal and dielectric mirror at an angle.
    fn mirrored_at(&self, cos: f64) -> DVec3 {
        let [metal, dielectric, _] = self.shares;
        let f90 = DVec3::splat(self.surface.specular);
        schlick(self.f0[0], DVec3::ONE, cos) * metal + schlick(self.f0[1], f90, cos) * dielectric
    }

    /// The coupling of a ground beneath the dielectric's surface.
    fn coupled(&self, o: DVec3, i: DVec3) -> DVec3 {
        let over = |w| DVec3::ONE - self.dielectric_albedo(w);
        let mean = DVec3::ONE - self.mean_dielectric_albedo();
        // A surface that mirrors all leaves nothing to its ground.
        DVec3::select(mean.cmpgt(DVec3::ZERO), over(o) * over(i) / mean, DVec3::ZERO) * FRAC_1_PI
    }

    fn diffuse(&self, o: DVec3, i: DVec3) -> Split {
        let share = self.shares[1] * (1.0 - self.surface.diffuse_transmission);
        if share == 0.0 {
            return Split::default();
        }
        Split::own(self.surface.base_color * self.coupled(o, i)) * share
    }

    fn diffuse_across(&self, o: DVec3, i: DVec3) -> Split {
        let share = self.shares[1] * self.surface.diffuse_transmission;
        if share == 0.0 {
            return Split::default();
        }
        Split::own(self.surface.diffuse_transmission_color * self.coupled(o, flipped(i))) * share
    }

    fn coat_mirror(&self, o: DVec3) -> DVec3 {
        DVec3::splat(self.coat_albedo(o))
    }

    fn gloss_mirror(&self, o: DVec3) -> DVec3 {
        self.mirrored_at(o.z) * self.beneath(o, o)
    }

    /// A mirror's direction.
    fn mirrored(&self, seen: &Seen, weight: DVec3) -> Option<Scattered> {
        self.single(seen, mirror(seen.o, DVec3::Z), Split::carried(weight))
    }

    fn single(&self, seen: &Seen, i: DVec3, weight: Split) -> Option<Scattered> {
        let incident = seen.frame.world(i);
        let same_side = seen.frame.geometric.dot(incident) > 0.0;
        let is_there = same_side == (i.z > 0.0) && weight.total() != DVec3::ZERO;
        is_there.then_some(Scattered { incident, weight, density: None, crosses: i.z < 0.0 })
    }

    fn odds(&self, seen: &Seen) -> Odds {
        let o = seen.o;
        let [metal, dielectric, glass] = self.shares;
        let mean = |color: DVec3| color.element_sum() / 3.0;
        let shares = self.gloss_shares(o);
        let lost = self.lost(shares);
        let (coat, cloth) = (self.coat_albedo(o), self.sheen_albedo(o));
        let beneath = (1.0 - coat) * (1.0 - cloth);
        let gloss = self.f0[0] * (metal * shares.x) + metal * shares.y;
        let gloss = gloss + (self.f0[1] * shares.x + self.surface.specular * shares.y) * dielectric;
        let multiple = (self.multiple(0) * metal + self.multiple(1) * dielectric) * lost;
        let ground = (DVec3::ONE - self.dielectric_albedo(o)) * dielectric;
        let share = self.surface.diffuse_transmission;
        let on_this_side = mean(multiple + ground * self.surface.base_color * (1.0 - share));
        let beyond = mean(ground * self.surface.diffuse_transmission_color * share);
        let glass_lost = self.glass_lost(seen).lost * glass;
        Odds {
            coat,
            gloss: mean(gloss) * beneath,
            glass: (glass - glass_lost) * beneath,
            spread: on_this_side * beneath + cloth * (1.0 - coat),
            through: beyond * beneath,
            returned: glass_lost * beneath,
        }
        .shared()
    }

    fn density_of(&self, seen: &Seen, odds: &Odds, incident: DVec3) -> f64 {
        let (o, i) = (seen.o, seen.frame.local(incident));
        if o.z <= 0.0 {
            return 0.0;
        }
        let eta = self.eta(seen);
        let is_clear = self.is_clear(eta);
        let of_mirror = |ggx: &Ggx, h: DVec3| ggx.density_of_visible(o, h) / (4.0 * o.dot(h));
        let returned =
            if odds.returned > 0.0 { odds.returned * self.density_of_returned(seen, i) } else { 0.0 };
        if i.z > 0.0 {
            let mut density = odds.spread * i.z * FRAC_1_PI + returned;
            let Some(h) = half(o, i) else { return density };
            if odds.coat > 0.0 && !self.coat.is_smooth() {
                density += odds.coat * of_mirror(&self.coat, h);
            }
            if odds.gloss > 0.0 && !self.ggx.is_smooth() {
                density += odds.gloss * of_mirror(&self.ggx, h);
            }
            if odds.glass > 0.0 && !is_clear {
                density += odds.glass * dielectric_reflectance(o.dot(h), eta) * of_mirror(&self.ggx, h);
            }
            return density;
        }
        let mut density = odds.through * -i.z * FRAC_1_PI + returned;
        if odds.glass > 0.0 && !is_clear {
            density += odds.glass * self.density_across(seen, i);
        }
        density
    }
}

/// Half way between two directions on one side; none where they are opposite.
fn half(o: DVec3, i: DVec3) -> Option<DVec3> {
    (o + i).try_normalize().filter(|h| h.z > 0.0 && o.dot(*h) > 0.0)
}

fn mirror(o: DVec3, h: DVec3) -> DVec3 {
    h * (2.0 * o.dot(h)) - o
}

/// On the other side.
fn flipped(w: DVec3) -> DVec3 {
    DVec3::new(w.x, w.y, -w.z)
}

fn cosine_weighted(u: DVec2) -> DVec3 {
    let (sin, cos) = (TAU * u.x).sin_cos();
    let flat = u.y.sqrt();
    DVec3::new(flat * cos, flat * sin, (1.0 - u.y).max(0.0).sqrt())
}

/// D·G₂/(4 cos cos): what facets that mirror all send on.
fn microfacets(ggx: &Ggx, o: DVec3, i: DVec3, h: DVec3) -> f64 {
    ggx.density_of_normals(h) * ggx.seen_from_both(o, i) / (4.0 * o.z * i.z)
}
