//! Light fields stored on disk, so that they need not be baked again in the next run of the program.
//!
//! The key of a light field is a hash of what it was baked from: everything in the scene that emits or blocks light, the camera except
//! for what may differ (see [`crate::is_compatible`]), what it was baked on, and the build of the program. Light fields are `.salf` files in one folder; when
//! they exceed a budget, the least recently used are removed.

use crate::bake::salf_file::write_salf;
use document::Stage;
use lens::{Aperture, Camera, Character};
use light::{build_id, evict_oldest, mark_used};
use salf::{BakedOn, Carried, Salf, SalfFile};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Maximum size of the folder: about six light fields of 1920 × 1080 pixels.
const BUDGET_BYTES: u64 = 2 << 30;

/// Light fields that take less time to bake than this are not stored.
const SHORTEST_BAKE: Duration = Duration::from_secs(2);

/// A folder of baked light fields.
#[derive(Clone, Debug)]
pub struct LightFieldStore {
    folder: PathBuf,
    budget_bytes: u64,
    shortest_bake: Duration,
}

impl LightFieldStore {
    /// Numbers of passes by which the light of a light field is refined. Each result replaces the one before.
    pub const LIGHT_PASSES: [u32; 5] = [4, 16, 64, 256, 1024];

    /// A store in `folder`, which is created when the first light field is saved.
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, budget_bytes: BUDGET_BYTES, shortest_bake: SHORTEST_BAKE }
    }

    /// Stores only light fields that took at least `shortest_bake` to bake.
    pub fn with_shortest_bake(self, shortest_bake: Duration) -> Self {
        Self { shortest_bake, ..self }
    }

    /// The file of a light field whose light was refined by `light_passes` passes. `None` if the build of the program has no identifier.
    fn file(&self, stage: &Stage, camera: &Camera, light_passes: u32, on: BakedOn) -> Option<PathBuf> {
        let mut hash = Sha256::new();
        hash.update(build_id()?);
        hash.update(format!("{:?}", compatibility_key(camera)));
        hash.update(stage.light_hash());
        hash.update(light_passes.to_le_bytes());
        if on == BakedOn::Card {
            hash.update(on.name());
        }
        let name = hex::encode(hash.finalize());
        Some(self.folder.join(name).with_extension("salf"))
    }

    /// Whether there is an unrefined light field of the stage for `camera` that was baked on this.
    pub fn has(&self, stage: &Stage, camera: &Camera, on: BakedOn) -> bool {
        self.file(stage, camera, 0, on).is_some_and(|file| file.exists())
    }

    /// Loads the most refined light field of the stage for `camera` whose margin is at least `min_margin_px` pixels and whose carried
    /// light is at least as fine as `carried`, baked on this device. Also returns its number of light passes. Files that cannot be read are ignored.
    pub fn find(
        &self,
        stage: &Stage,
        camera: &Camera,
        min_margin_px: f64,
        carried: Carried,
        on: BakedOn,
    ) -> Option<(Salf, u32)> {
        let passes = Self::LIGHT_PASSES.into_iter().rev().chain([0]);
        passes.into_iter().find_map(|passes| {
            let path = self.file(stage, camera, passes, on)?;
            Some((Self::load(&path, stage, camera, min_margin_px, carried)?, passes))
        })
    }

    fn load(
        path: &Path,
        stage: &Stage,
        camera: &Camera,
        min_margin_px: f64,
        carried: Carried,
    ) -> Option<Salf> {
        let file = File::open(path).ok()?;
        mark_used(path);
        let salf_file = SalfFile::read(BufReader::with_capacity(1 << 20, file)).ok()?;
        let salf = Arc::into_inner(salf_file.salf)?;
        let fits = compatibility_key(&salf.camera) == compatibility_key(camera)
            && salf_file.triangles as usize == stage.scene.triangles.len()
            && f64::from(salf.margin_px) >= min_margin_px
            && salf.carried >= carried;
        fits.then_some(salf)
    }

    /// Saves a light field that took `bake` to bake, on another thread. Failures are ignored: they only cost time later.
    pub fn save(&self, stage: &Arc<Stage>, salf: &Arc<Salf>, light_passes: u32, bake: Duration) {
        if bake < self.shortest_bake {
            return;
        }
        let (store, stage, salf) = (self.clone(), stage.clone(), salf.clone());
        let write = move || store.write(&stage, &salf, light_passes);
        let _ = std::thread::Builder::new().name("light field store".into()).spawn(write);
    }

    fn write(&self, stage: &Stage, salf: &Arc<Salf>, light_passes: u32) {
        let Some(path) = self.file(stage, &salf.camera, light_passes, salf.baked_on) else { return };
        let has_folder = std::fs::create_dir_all(&self.folder).is_ok();
        if has_folder && write_salf(&path, &stage.scene.path, &stage.scene, salf).is_ok() {
            evict_oldest(&self.folder, "salf", self.budget_bytes, &path);
        }
    }
}

/// What all cameras that a light field is compatible with have in common, apart from smaller apertures.
fn compatibility_key(camera: &Camera) -> Camera {
    Camera {
        focus_distance: f64::INFINITY,
        aperture: Aperture::default(),
        character: Character::default(),
        ..camera.clone()
    }
}
