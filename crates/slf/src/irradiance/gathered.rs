//! Irradiance of small patches, gathered from solved ones once it is asked for.
//!
//! What a patch's rays find depends on nothing but the scene, its world, the patch and the solved patches that they end
//! at: it is the same whoever asks first, on whichever thread, and whatever was gathered before.

use super::patches::{Patch, Patches};
use super::place::Place;
use super::smoothing::smoothed_indirect;
use super::solved::SolvedPatches;
use glam::Vec3;
use scene::Scene;
use std::sync::OnceLock;

/// Finds the light that arrives at patches, by rays.
pub(crate) trait PatchGatherer {
    /// The scene of the patches.
    fn scene(&self) -> &Scene;
    /// How often light may be scattered; `None`: until it has died away.
    fn bounces(&self) -> Option<u32>;
    /// Irradiance/π from sampled lights.
    fn direct_light(&self, patches: &Patches, patch: &Patch, rays: u32) -> Vec3;
    /// All other light, with that of the solved patches.
    fn indirect_light(
        &self,
        solved: &SolvedPatches,
        patches: &Patches,
        patch: &Patch,
        rays: u32,
    ) -> IndirectLight;
}

/// Patches whose light is gathered when it is first asked for.
#[derive(Debug)]
pub(crate) struct GatheredPatches {
    pub patches: Patches,
    /// Rays per patch.
    rays: u32,
    direct: Vec<OnceLock<Vec3>>,
    indirect: Vec<OnceLock<IndirectLight>>,
    /// By patch: indirect irradiance/π, averaged with that of its neighbours.
    smoothed: Vec<OnceLock<Vec3>>,
}

/// Indirect light of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct IndirectLight {
    /// Irradiance/π.
    pub light: Vec3,
    /// Harmonic mean of the distances of what the rays hit, scene units; infinite in the open.
    pub distance: f32,
}

/// What was gathered, by patch: with it, none of it needs to be gathered again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GatheredIrradiance {
    /// Irradiance/π (linear RGB radiance units) from sampled lights.
    pub direct: Vec<(u32, Vec3)>,
    /// Irradiance/π of all other light, and the harmonic mean of the distances that its rays went, scene units.
    pub indirect: Vec<(u32, Vec3, f32)>,
}

impl GatheredIrradiance {
    /// The number of values.
    pub fn count(&self) -> usize {
        self.direct.len() + self.indirect.len()
    }
}

impl GatheredPatches {
    /// Patches of which none is gathered yet.
    pub fn new(patches: Patches, rays: u32) -> Self {
        fn unset<T>(count: usize) -> Vec<OnceLock<T>> {
            (0..count).map(|_| OnceLock::new()).collect()
        }
        let count = patches.all().len();
        Self { patches, rays, direct: unset(count), indirect: unset(count), smoothed: unset(count) }
    }

    /// The memory that they take, in bytes.
    pub fn bytes(&self) -> usize {
        self.patches.bytes()
            + size_of_val(&*self.direct)
            + size_of_val(&*self.indirect)
            + size_of_val(&*self.smoothed)
    }

    /// What is gathered so far.
    pub fn all_gathered(&self) -> GatheredIrradiance {
        let direct = (0..).zip(&self.direct).filter_map(|(patch, light)| Some((patch, *light.get()?)));
        let indirect = (0..).zip(&self.indirect).filter_map(|(patch, indirect)| {
            let IndirectLight { light, distance } = *indirect.get()?;
            Some((patch, light, distance))
        });
        GatheredIrradiance { direct: direct.collect(), indirect: indirect.collect() }
    }

    /// Sets the patches that none is known of yet to what was gathered before; `false` if one does not exist or is not finite.
    pub fn restore(&self, gathered: &GatheredIrradiance) -> bool {
        let set_direct = |&(patch, light): &(u32, Vec3)| {
            let place = self.direct.get(patch as usize).filter(|_| light.is_finite());
            place.map(|place| place.set(light)).is_some()
        };
        let set_indirect = |&(patch, light, distance): &(u32, Vec3, f32)| {
            let is_valid = light.is_finite() && distance >= 0.0;
            let place = self.indirect.get(patch as usize).filter(|_| is_valid);
            place.map(|place| place.set(IndirectLight { light, distance })).is_some()
        };
        gathered.direct.iter().all(set_direct) && gathered.indirect.iter().all(set_indirect)
    }

    /// Indirect irradiance/π at a place; `None` if no patch covers it.
    pub fn indirect(
        &self,
        gatherer: &impl PatchGatherer,
        solved: &SolvedPatches,
        place: &Place,
    ) -> Option<Vec3> {
        self.patches.interpolate(place, |patch| self.smoothed_of(gatherer, solved, patch))
    }

    /// Direct and indirect irradiance/π at a place; `None` if no patch covers it.
    pub fn total(
        &self,
        gatherer: &impl PatchGatherer,
        solved: &SolvedPatches,
        place: &Place,
    ) -> Option<Vec3> {
        self.patches.interpolate(place, |patch| {
            self.direct_of(gatherer, patch) + self.smoothed_of(gatherer, solved, patch)
        })
    }

    fn direct_of(&self, gatherer: &impl PatchGatherer, patch: usize) -> Vec3 {
        let gather = || gatherer.direct_light(&self.patches, &self.patches.all()[patch], self.rays);
        *self.direct[patch].get_or_init(gather)
    }

    fn smoothed_of(&self, gatherer: &impl PatchGatherer, solved: &SolvedPatches, patch: usize) -> Vec3 {
        *self.smoothed[patch].get_or_init(|| {
            smoothed_indirect(&self.patches, patch, |patch| {
                let IndirectLight { light, distance } = self.indirect_of(gatherer, solved, patch);
                (light, f64::from(distance))
            })
        })
    }

    fn indirect_of(
        &self,
        gatherer: &impl PatchGatherer,
        solved: &SolvedPatches,
        patch: usize,
    ) -> IndirectLight {
        let gather = || gatherer.indirect_light(solved, &self.patches, &self.patches.all()[patch], self.rays);
        *self.indirect[patch].get_or_init(gather)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Irradiance, IrradianceOptions, Transport, TransportOptions};
    use glam::{DVec2, DVec3};
    use progress::Unwatched;
    use rayon::prelude::*;
    use scene::{Material, SurfacePoint, World};
    use std::sync::Arc;
    use test_scenes::{Mesh, scene_of};
    use trace::Tracer;

    /// A grey wall that glows.
    fn wall() -> Material {
        Material {
            base_color: Vec3::splat(0.5).extend(1.0),
            emissive: Vec3::ONE,
            ..Material::lambertian_white()
        }
    }

    /// A ball over a slab, and places on both.
    fn room() -> (Transport, Vec<Place>) {
        let slab = Mesh::cuboid(DVec3::new(-1.0, -0.1, -1.0), DVec3::new(1.0, 0.0, 1.0));
        let ball = Mesh::sphere(DVec3::new(0.0, 0.3, 0.0), 0.2, 12);
        let scene = scene_of([(slab, Material::lambertian_white()), (ball, Material::lambertian_white())]);
        let places = (0..scene.triangles.len() as u32).step_by(5).map(|triangle| {
            let point = SurfacePoint { triangle, barycentric: DVec2::splat(0.3) };
            Place::new(&scene, point, true)
        });
        let places = places.collect();
        let tracer = Arc::new(Tracer::new(scene));
        (Transport::new(tracer, World::studio(), TransportOptions::default()), places)
    }

    #[test]
    fn a_patch_has_the_same_light_whoever_asks_first() {
        let (transport, places) = room();
        let options = IrradianceOptions { patches: 3000, rays: 16 };
        let solve = || Irradiance::solve(&transport, options, &Unwatched).unwrap();
        let of = |irradiance: &Irradiance, place: &Place| irradiance.total(&transport, place).unwrap();
        let forward = solve();
        let expected: Vec<Vec3> = places.iter().map(|place| of(&forward, place)).collect();
        assert!(expected.iter().all(|light| light.min_element() > 0.0));
        let backward = solve();
        let mut lights: Vec<Vec3> = places.iter().rev().map(|place| of(&backward, place)).collect();
        lights.reverse();
        assert_eq!(lights, expected);
        assert_eq!(backward.gathered(), forward.gathered());
        let at_once = solve();
        let lights: Vec<Vec3> = places.par_iter().map(|place| of(&at_once, place)).collect();
        assert_eq!(lights, expected);
        // Some of it is known from before.
        let half = solve();
        places.iter().step_by(2).for_each(|place| {
            half.indirect(&transport, place);
        });
        let restored = solve();
        assert!(restored.restore(&half.gathered()));
        assert!((1..forward.gathered().count()).contains(&restored.gathered().count()));
        let lights: Vec<Vec3> = places.iter().map(|place| of(&restored, place)).collect();
        assert_eq!(lights, expected);
    }

    #[test]
    fn light_bounces_as_often_as_if_all_patches_were_solved() {
        for bounces in [Some(0), Some(1), Some(2), None] {
            let mean = |patches: u32| {
                let world = World { bounces, ..World::studio() };
                let tracer = Arc::new(Tracer::new(scene_of([(
                    Mesh::cuboid(-DVec3::ONE, DVec3::ONE).turned(),
                    wall(),
                )])));
                let transport = Transport::new(tracer, world, TransportOptions::default());
                let options = IrradianceOptions { patches, rays: 32 };
                let irradiance = Irradiance::solve(&transport, options, &Unwatched).unwrap();
                assert_eq!(irradiance.gathered.is_some(), patches > 1500);
                let places = (0..12u32).map(|triangle| {
                    let point = SurfacePoint { triangle, barycentric: DVec2::new(0.3, 0.4) };
                    Place::new(transport.scene(), point, true)
                });
                places.map(|place| f64::from(irradiance.indirect(&transport, &place).unwrap().x)).sum::<f64>()
                    / 12.0
            };
            let (gathered, solved) = (mean(6000), mean(1500));
            assert!((gathered - solved).abs() <= 0.02 * solved, "{bounces:?}: {gathered}, not {solved}");
        }
    }

    #[test]
    fn what_no_patch_can_have_is_not_restored() {
        let (transport, _) = room();
        let irradiance =
            Irradiance::solve(&transport, IrradianceOptions { patches: 3000, rays: 4 }, &Unwatched).unwrap();
        let direct = |patch, light| GatheredIrradiance { direct: vec![(patch, light)], indirect: Vec::new() };
        let indirect =
            |distance| GatheredIrradiance { direct: Vec::new(), indirect: vec![(0, Vec3::ONE, distance)] };
        for wrong in [
            direct(u32::MAX, Vec3::ONE),
            direct(0, Vec3::splat(f32::NAN)),
            indirect(f32::NAN),
            indirect(-1.0),
        ] {
            assert!(!irradiance.restore(&wrong), "{wrong:?}");
        }
        assert!(irradiance.restore(&indirect(f32::INFINITY)));
    }
}
