//! What comes along a path: it is followed from surface to surface, as far as its light is not known.

use super::known::{Known, Reached};
use super::{Path, Step, Transport, heuristic};
use crate::material_point::{MaterialPoint, emitted};
use glam::DVec3;
use material::{Bsdf, Split};
use trace::Hit;

/// What a path found.
pub(super) struct Arriving {
    /// Light that came straight from where lights are drawn, too.
    pub drawn: DVec3,
    /// Other light.
    pub other: DVec3,
    /// How far the first surface is.
    pub distance: f64,
    /// Where what arrives at diffuse lobes is known, and what of that is sent on.
    pub onward: Option<(Reached, DVec3)>,
}

/// After so many scatterings Russian roulette begins.
const SURE_SCATTERINGS: u32 = 3;
/// The share of paths that check what is known, where it is to be checked. Fewer cost less and tell it with more noise: measured in
/// rooms of grey and of white walls, an eighth takes up to twice the time for the same error, a half as much as all would.
const CHECKED: f64 = 1.0 / 2.0;

impl Transport {
    /// The radiance that arrives along a step, and all that comes after it as far as it is not known.
    pub(super) fn arriving(&self, mut step: Step, path: &mut Path, mut known: Known<'_>) -> Arriving {
        let scene = self.scene();
        let most = self.world.bounces.unwrap_or(u32::MAX);
        let mut found =
            Arriving { drawn: DVec3::ZERO, other: DVec3::ZERO, distance: f64::INFINITY, onward: None };
        let mut throughput = DVec3::ONE;
        let mut widest = step.density;
        for scatterings in 1u32.. {
            let hit = self.tracer.first_met(step.from, step.direction);
            let length = hit.map_or(f64::INFINITY, |hit| hit.t);
            throughput *= self.media.attenuation(&path.inside, length);
            let Some(Hit { point, t }) = hit else {
                let of_light = self.lights.density_of_environment(&self.world, step.direction);
                let light = throughput * self.world.radiance(step.direction).as_dvec3();
                let often = path.lights.sky;
                found.add(light, step.density, [of_light, often], scatterings);
                return found;
            };
            if scatterings == 1 {
                found.distance = t;
            }
            let outgoing = -step.direction;
            let shines = emitted(scene, point, outgoing).as_dvec3();
            if shines != DVec3::ZERO {
                let place = point.position(scene);
                let of_light = self.lights.density_of_emitter(point.triangle, place, step.position);
                let often = path.lights.lamps;
                found.add(throughput * shines, step.density, [of_light, often], scatterings);
            }
            if scatterings > most || scene.material_of(point.triangle).unlit {
                return found;
            }
            let mut at = MaterialPoint::of(scene, point, self.options.scattering);
            if let (Known::All(_), Some(density)) = (known, widest) {
                at.surface = at.surface.no_sharper_than(as_seen_by(density));
            }
            throughput *= self.disperse(&at, path);
            let is_front = at.frame.geometric.dot(outgoing) >= 0.0;
            let interface = self.media.interface(at.material, &path.inside, is_front);
            let bsdf = Bsdf::new(&at.surface, at.frame, interface);
            let lobes = bsdf.toward(outgoing);
            let scattered = match known.reached(scene, point, is_front, t) {
                None => {
                    found.other += throughput * self.direct(point, &at, &lobes, path).total();
                    let Some(scattered) = lobes.sample(path.random.next3()) else { return found };
                    throughput *= scattered.weight.total();
                    scattered
                }
                Some(reached) => {
                    // What is own is known; what is carried is followed.
                    let Split { own, carried } = lobes.albedo();
                    let [of_own, of_carried] = [own, carried].map(DVec3::element_sum);
                    if of_carried > 0.0 {
                        found.other += throughput * self.direct_carried(point, &at, &lobes, path);
                    }
                    let ends = of_own / (of_own + of_carried);
                    if of_carried == 0.0 || path.random.next() < ends {
                        if of_carried > 0.0 {
                            throughput /= ends;
                        }
                        let checks = known.is_to_be_checked() && path.random.next() < CHECKED;
                        let told = if checks { 1.0 - 1.0 / CHECKED } else { 1.0 };
                        found.onward = (of_own > 0.0).then_some((reached, throughput * own * told));
                        if of_own == 0.0 || !known.is_to_be_checked() {
                            return found;
                        }
                        found.other += throughput * self.direct(point, &at, &lobes, path).own;
                        if !checks {
                            return found;
                        }
                        (known, throughput) = (Known::Nothing, throughput / CHECKED);
                        let Some(scattered) = lobes.sample(path.random.next3()) else { return found };
                        throughput *= scattered.weight.own;
                        scattered
                    } else {
                        let Some(scattered) = lobes.sample_sharp(path.random.next3()) else { return found };
                        throughput *= scattered.weight.carried / (1.0 - ends);
                        scattered
                    }
                }
            };
            if scatterings >= SURE_SCATTERINGS || throughput == DVec3::ZERO {
                let lives = throughput.max_element().min(0.95);
                if path.random.next() >= lives {
                    return found;
                }
                throughput /= lives;
            }
            step = self.step(point, &at, &scattered, path);
            widest = match (widest, step.density) {
                (Some(so_far), Some(density)) => Some(so_far.min(density)),
                (so_far, density) => so_far.or(density),
            };
        }
        found
    }
}

impl Arriving {
    /// Light that comes from where it is known.
    pub fn sent_on(&self) -> DVec3 {
        self.onward.as_ref().map_or(DVec3::ZERO, |(reached, share)| *share * reached.irradiance.as_dvec3())
    }

    /// Light that was found after so many scatterings by a direction of some density; lights find it with another, and are drawn
    /// so often for the first direction.
    fn add(&mut self, light: DVec3, density: Option<f64>, [of_light, often]: [f64; 2], scatterings: u32) {
        let drawn = if scatterings == 1 { of_light * often } else { of_light };
        let light = light * density.map_or(1.0, |own| heuristic(own, drawn));
        let sum = if scatterings == 1 && of_light > 0.0 { &mut self.drawn } else { &mut self.other };
        *sum += light;
    }
}

/// How rough what is reflected may be taken for, perceptually, where a lobe reflects it that is so wide: of a density, 1/sr, in the
/// direction it was drawn in. A lamp in a mirror in rough metal is then found by drawing lamps, and not by chance, for a little
/// blur of what is blurred anyway (path space regularisation, Kaplanyan and Dachsbacher 2013; the widths are those of Cycles).
fn as_seen_by(density: f64) -> f64 {
    let alpha = 0.5 * (1.0 - density).max(0.0).sqrt();
    alpha.sqrt()
}
