//! Irradiance kept from one run of the program to the next: light that was solved for once is not solved for again.
//!
//! A file is named by a checksum of all of the scene that gives, blocks or scatters light, the world, and the build of the program.
//! It holds a number for each patch and colour, direct and indirect, f32 little endian, behind a checksum of them.

use super::store::build;
use crate::document::light_hash;
use atomic_write_file::AtomicWriteFile;
use glam::Vec3;
use scene::{Environment, Scene, World};
use sha2::{Digest, Sha256};
use slf::{Irradiance, IrradianceOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Files that are kept: the light of so many scenes and worlds, a megabyte each.
const FILES: usize = 200;
/// A file is not larger.
const MOST_BYTES: u64 = 64 << 20;

/// The file of the irradiance of a scene in a world; none where builds of the program cannot be told apart.
pub(super) fn path(
    folder: &Path,
    scene: &Scene,
    world: &World,
    options: IrradianceOptions,
) -> Option<PathBuf> {
    let mut hash = Sha256::new();
    hash.update(build()?);
    hash.update(light_hash(scene));
    hash.update(format!("{world:?} {options:?}"));
    if let Environment::Map(map) = &world.environment {
        hash.update(bytemuck::cast_slice(&map.texels));
    }
    let name: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    Some(folder.join(name).with_extension("light"))
}

/// Reads the irradiance of a scene. What cannot be read is as good as none.
pub(super) fn read(
    path: &Path,
    scene: &Scene,
    world: &World,
    options: IrradianceOptions,
) -> Option<Irradiance> {
    if std::fs::metadata(path).ok()?.len() > MOST_BYTES {
        return None;
    }
    let bytes = std::fs::read(path).ok()?;
    let (sum, values) = bytes.split_at_checked(32)?;
    if Sha256::digest(values).as_slice() != sum {
        return None;
    }
    // It was looked for: it goes last. Where that cannot be noted, it goes by when it was written.
    let _ =
        std::fs::File::options().write(true).open(path).and_then(|file| file.set_modified(SystemTime::now()));
    let number = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let all: Vec<Vec3> = values
        .chunks_exact(12)
        .map(|rgb| Vec3::new(number(rgb), number(&rgb[4..]), number(&rgb[8..])))
        .collect();
    let (direct, indirect) = all.split_at(all.len() / 2);
    Irradiance::of_values(scene, world, options, [direct.to_vec(), indirect.to_vec()])
}

/// Keeps irradiance. That it cannot be kept only costs time later.
pub(super) fn write(path: &Path, irradiance: &Irradiance) {
    let numbers = irradiance.values().into_iter().flatten().flat_map(|value| value.to_array());
    let values: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
    let Some(folder) = path.parent() else { return };
    let written = std::fs::create_dir_all(folder).and_then(|()| {
        let mut file = AtomicWriteFile::open(path)?;
        file.write_all(&Sha256::digest(&values))?;
        file.write_all(&values)?;
        file.commit()
    });
    if written.is_ok() {
        tidy(folder);
    }
}

/// Removes the files beyond the number that is kept that were not looked for the longest.
fn tidy(folder: &Path) {
    let Ok(listing) = std::fs::read_dir(folder) else { return };
    let mut files: Vec<_> = listing
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "light"))
        .filter_map(|path| Some((path.metadata().ok()?.modified().ok()?, path)))
        .collect();
    files.sort();
    let beyond = files.len().saturating_sub(FILES);
    for (_, path) in &files[..beyond] {
        let _ = std::fs::remove_file(path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use progress::Unwatched;
    use slf::{Transport, TransportOptions};
    use std::sync::Arc;
    use trace::Tracer;

    const OPTIONS: IrradianceOptions = IrradianceOptions { patches: 50, rays: 8 };

    fn solved(world: &World) -> (Arc<Scene>, Irradiance) {
        let material = scene::Material::of_lambert();
        let scene = Arc::new(Scene {
            positions: vec![glam::DVec3::ZERO, glam::DVec3::X, glam::DVec3::Y],
            triangles: vec![scene::Triangle { vertices: [0, 1, 2], part: 0 }],
            parts: vec![scene::Part {
                node: 0,
                material: 0,
                triangles: 0..1,
                has_uv: [false; 2],
                mirrored: false,
            }],
            nodes: vec![scene::Node { name: "triangle".into(), index: 0, world: glam::DMat4::IDENTITY }],
            materials: vec![material],
            ..Scene::default()
        });
        let tracer = Arc::new(Tracer::new(scene.clone()));
        let transport = Transport::new(tracer, world.clone(), TransportOptions::default());
        (scene, Irradiance::solve(&transport, OPTIONS, &Unwatched).unwrap())
    }

    #[test]
    fn light_comes_back_bit_by_bit_and_no_other_does() {
        let folder = tempfile::tempdir().unwrap();
        let world = World::uniform(Vec3::ONE);
        let (scene, irradiance) = solved(&world);
        let path_of = |world: &World| path(folder.path(), &scene, world, OPTIONS).unwrap();
        let at = path_of(&world);
        assert!(read(&at, &scene, &world, OPTIONS).is_none());
        write(&at, &irradiance);
        let again = read(&at, &scene, &world, OPTIONS).unwrap();
        assert_eq!(again.values(), irradiance.values());
        assert_ne!(path_of(&World { strength: 2.0, ..world.clone() }), at);
        // Of other options it has another number of patches; a damaged one is none.
        assert!(read(&at, &scene, &world, IrradianceOptions { patches: 5, rays: 8 }).is_none());
        let mut bytes = std::fs::read(&at).unwrap();
        bytes[40] ^= 1;
        std::fs::write(&at, &bytes).unwrap();
        assert!(read(&at, &scene, &world, OPTIONS).is_none());
        std::fs::write(&at, &bytes[..7]).unwrap();
        assert!(read(&at, &scene, &world, OPTIONS).is_none());
    }
}
