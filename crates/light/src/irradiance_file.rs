//! Irradiance cached on disk, so that it is not solved for again.
//!
//! A file belongs to a scene (everything in it that emits, blocks or scatters light) in a world. It holds linear RGB per patch, first all
//! direct, then all indirect, as little-endian `f32`; then a byte that is 1 if light was cut off before it died away.

use crate::disk_cache::CacheSection;
use crate::options::LightOptions;
use crate::scene_hashes::light_hash;
use glam::Vec3;
use scene::{Environment, Scene, World};
use sha2::{Digest, Sha256};
use slf::{Irradiance, IrradianceOptions, IrradianceSolution};

/// A file takes about a megabyte.
pub(super) const SECTION: CacheSection = CacheSection { name: "light", budget_bytes: 256 << 20 };

/// Counts the solvers whose results differ.
const SOLVER_VERSION: u32 = 4;

/// Hashes everything that the irradiance of a scene in a world depends on.
pub(super) fn hash_inputs(
    hash: &mut Sha256,
    scene: &Scene,
    world: &World,
    light: LightOptions,
    options: IrradianceOptions,
) {
    hash.update(SOLVER_VERSION.to_le_bytes());
    hash.update(light_hash(scene, light));
    hash.update(format!("{world:?} {options:?}"));
    if let Environment::Map(map) = &world.environment {
        hash.update(bytemuck::cast_slice(&map.texels));
    }
}

/// The irradiance of a scene from the bytes of a file; `None` if the number of patches differs.
pub(super) fn from_bytes(
    bytes: &[u8],
    scene: &Scene,
    world: &World,
    options: IrradianceOptions,
) -> Option<Irradiance> {
    let number = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let all: Vec<Vec3> = bytes
        .chunks_exact(12)
        .map(|rgb| Vec3::new(number(rgb), number(&rgb[4..]), number(&rgb[8..])))
        .collect();
    let (direct, indirect) = all.split_at(all.len() / 2);
    let is_cut_off = bytes.len() % 12 == 1 && bytes.ends_with(&[1]);
    let solution = IrradianceSolution { direct: direct.to_vec(), indirect: indirect.to_vec(), is_cut_off };
    Irradiance::from_solution(scene, world, options, solution)
}

/// The bytes of the file.
pub(super) fn to_bytes(irradiance: &Irradiance) -> Vec<u8> {
    let IrradianceSolution { direct, indirect, is_cut_off } = irradiance.solution();
    let numbers = [direct, indirect].into_iter().flatten().flat_map(|value| value.to_array());
    numbers.flat_map(f32::to_le_bytes).chain([u8::from(*is_cut_off)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use progress::Unwatched;
    use scene::Material;
    use slf::{Transport, TransportOptions};
    use std::sync::Arc;
    use test_scenes::{Mesh, scene_of};
    use trace::Tracer;

    const OPTIONS: IrradianceOptions = IrradianceOptions { patches: 50, rays: 8 };

    fn solved(world: &World) -> (Arc<Scene>, Irradiance) {
        let triangle = Mesh::triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);
        let scene = scene_of([(triangle, Material::lambertian_white())]);
        let tracer = Arc::new(Tracer::new(scene.clone()));
        let transport = Transport::new(tracer, world.clone(), TransportOptions::default());
        (scene, Irradiance::solve(&transport, OPTIONS, &Unwatched).unwrap())
    }

    #[test]
    fn irradiance_round_trips_bit_for_bit_and_other_options_are_rejected() {
        let world = World::uniform(Vec3::ONE);
        let (scene, irradiance) = solved(&world);
        let bytes = to_bytes(&irradiance);
        let again = from_bytes(&bytes, &scene, &world, OPTIONS).unwrap();
        assert_eq!(again.solution(), irradiance.solution());
        // With other options, the number of patches differs.
        assert!(from_bytes(&bytes, &scene, &world, IrradianceOptions { patches: 5, rays: 8 }).is_none());
        let origin = |world: &World| {
            let mut hash = Sha256::new();
            hash_inputs(&mut hash, &scene, world, LightOptions::default(), OPTIONS);
            hash.finalize()
        };
        assert_ne!(origin(&World { strength: 2.0, ..world.clone() }), origin(&world));
    }
}
