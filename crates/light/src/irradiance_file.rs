//! Irradiance cached on disk, so that it is not solved for again.
//!
//! A file belongs to a scene (everything in it that emits, blocks or scatters light) in a world. All of it is little-endian; numbers of light are
//! linear RGB as `f32`.
//!
//! | what | form |
//! | --- | --- |
//! | the number of patches that were solved | `u32` |
//! | their direct light, then their indirect light | three numbers a patch |
//! | 1 if light was cut off before it died away | `u8` |
//! | the number of smaller patches whose direct light was gathered | `u32` |
//! | the patch, and its direct light | `u32`, three numbers |
//! | until the end: the patch, its indirect light and the mean distance of what it sees | `u32`, four numbers |

use crate::disk_cache::CacheSection;
use crate::options::LightOptions;
use crate::scene_hashes::light_hash;
use glam::Vec3;
use scene::{Environment, Scene, World};
use sha2::{Digest, Sha256};
use slf::{GatheredIrradiance, Irradiance, IrradianceOptions, IrradianceSolution};

/// A file takes about a megabyte.
pub(super) const SECTION: CacheSection = CacheSection { name: "light", budget_bytes: 256 << 20 };

/// Counts the solvers whose results differ.
const SOLVER_VERSION: u32 = 5;

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

/// The irradiance of a scene from the bytes of a file; `None` if they are not those of such a file, or the number of patches differs.
pub(super) fn from_bytes(
    bytes: &[u8],
    scene: &Scene,
    world: &World,
    options: IrradianceOptions,
) -> Option<Irradiance> {
    let mut bytes = bytes;
    let count = read_u32(&mut bytes)? as usize;
    // Not more than there are, whatever is said.
    let mut values = |count: usize| (0..count).map(|_| read_rgb(&mut bytes)).collect::<Option<Vec<Vec3>>>();
    let (direct, indirect) = (values(count)?, values(count)?);
    let is_cut_off = bytes.split_off_first()? == &1;
    let solution = IrradianceSolution { direct, indirect, is_cut_off };
    let irradiance = Irradiance::from_solution(scene, world, options, solution)?;
    let mut gathered = GatheredIrradiance::default();
    for _ in 0..read_u32(&mut bytes)? {
        gathered.direct.push((read_u32(&mut bytes)?, read_rgb(&mut bytes)?));
    }
    while !bytes.is_empty() {
        gathered.indirect.push((read_u32(&mut bytes)?, read_rgb(&mut bytes)?, read_f32(&mut bytes)?));
    }
    irradiance.restore(&gathered).then_some(irradiance)
}

fn read_u32(bytes: &mut &[u8]) -> Option<u32> {
    bytes.split_off(..4)?.try_into().ok().map(u32::from_le_bytes)
}

fn read_f32(bytes: &mut &[u8]) -> Option<f32> {
    read_u32(bytes).map(f32::from_bits)
}

fn read_rgb(bytes: &mut &[u8]) -> Option<Vec3> {
    Some(Vec3::new(read_f32(bytes)?, read_f32(bytes)?, read_f32(bytes)?))
}

/// The bytes of the file.
pub(super) fn to_bytes(irradiance: &Irradiance) -> Vec<u8> {
    let rgb = |value: &Vec3| value.to_array().map(f32::to_le_bytes).concat();
    let IrradianceSolution { direct, indirect, is_cut_off } = irradiance.solution();
    let mut bytes = (direct.len() as u32).to_le_bytes().to_vec();
    bytes.extend(direct.iter().chain(indirect).flat_map(rgb));
    bytes.push(u8::from(*is_cut_off));
    let GatheredIrradiance { direct, indirect } = irradiance.gathered();
    bytes.extend((direct.len() as u32).to_le_bytes());
    for (patch, light) in &direct {
        bytes.extend([&patch.to_le_bytes()[..], &rgb(light)].concat());
    }
    for (patch, light, distance) in &indirect {
        bytes.extend([&patch.to_le_bytes()[..], &rgb(light), &distance.to_le_bytes()].concat());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};
    use progress::Unwatched;
    use scene::{Material, SurfacePoint};
    use slf::{Transport, TransportOptions};
    use std::sync::Arc;
    use test_scenes::{Mesh, scene_of};
    use trace::{Radiance, Tracer};

    /// More than are solved.
    const OPTIONS: IrradianceOptions = IrradianceOptions { patches: 4000, rays: 8 };

    fn solved(world: &World) -> (Transport, Irradiance) {
        let triangle = Mesh::triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);
        let tracer = Arc::new(Tracer::new(scene_of([(triangle, Material::lambertian_white())])));
        let transport = Transport::new(tracer, world.clone(), TransportOptions::default());
        let irradiance = Irradiance::solve(&transport, OPTIONS, &Unwatched).unwrap();
        (transport, irradiance)
    }

    #[test]
    fn irradiance_round_trips_bit_for_bit_and_other_files_are_rejected() {
        let world = World::uniform(Vec3::ONE);
        let (transport, irradiance) = solved(&world);
        let scene = transport.scene().clone();
        let read = |bytes: &[u8], options| from_bytes(bytes, &scene, &world, options);
        let unseen = to_bytes(&irradiance);
        assert_eq!(read(&unseen, OPTIONS).unwrap().gathered(), GatheredIrradiance::default());
        // Somebody looks.
        let irradiance = Arc::new(irradiance);
        let lit = transport.with_irradiance(irradiance.clone());
        for k in 1..8 {
            let point = SurfacePoint { triangle: 0, barycentric: DVec2::splat(f64::from(k) / 16.0) };
            lit.outgoing(point, DVec3::new(0.3, 0.2, 2.0));
        }
        let bytes = to_bytes(&irradiance);
        let again = read(&bytes, OPTIONS).unwrap();
        assert_eq!(again.solution(), irradiance.solution());
        assert!(again.gathered().count() > 7);
        assert_eq!(again.gathered(), irradiance.gathered());
        // With other options, the number of patches differs.
        assert!(read(&bytes, IrradianceOptions { patches: 5, rays: 8 }).is_none());
        for length in [0, 3, unseen.len() - 1, bytes.len() - 1] {
            assert!(read(&bytes[..length], OPTIONS).is_none(), "{length} bytes");
        }
        let mut endless = bytes.clone();
        endless[..4].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(read(&endless, OPTIONS).is_none());
        let origin = |world: &World| {
            let mut hash = Sha256::new();
            hash_inputs(&mut hash, &scene, world, LightOptions::default(), OPTIONS);
            hash.finalize()
        };
        assert_ne!(origin(&World { strength: 2.0, ..world.clone() }), origin(&world));
    }
}
