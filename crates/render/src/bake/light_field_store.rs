//! Light fields kept from one run of the program to the next, so that what was baked once is not baked again.
//!
//! A light field is found by what it was baked from: all of the scene that gives or blocks light, the camera but for what
//! may differ (see [`crate::light_field::serves`]), and the very build of the program. They are `.salf` files in a folder of
//! their own; when that holds too much, those go that were not looked for the longest.

use crate::bake::salf_file::write_salf;
use document::Stage;
use lens::{Aperture, Camera};
use light::{build_id, evict_oldest};
use salf::{Carried, Salf, SalfFile};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

/// Bytes that the folder may hold: half a dozen light fields of 1920 × 1080 pixels.
const BUDGET_BYTES: u64 = 2 << 30;

/// Passes that light is refined by, one after the other, each in place of the one before.
pub const LIGHT_PASSES: [u32; 5] = [4, 16, 64, 256, 1024];

/// What is baked in less time is baked again.
const SHORTEST_BAKE: Duration = Duration::from_secs(2);

/// A folder of light fields.
#[derive(Clone, Debug)]
pub struct LightFieldStore {
    folder: PathBuf,
    budget_bytes: u64,
    shortest_bake: Duration,
}

impl LightFieldStore {
    /// Light fields in `folder`, which is made when there is one to keep.
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, budget_bytes: BUDGET_BYTES, shortest_bake: SHORTEST_BAKE }
    }

    /// The same store, which keeps what took at least `shortest_bake` to bake.
    pub fn with_shortest_bake(self, shortest_bake: Duration) -> Self {
        Self { shortest_bake, ..self }
    }

    /// The file of a light field whose light was refined by so many passes; none where builds of the program cannot be told apart.
    fn file(&self, stage: &Stage, camera: &Camera, light_passes: u32) -> Option<PathBuf> {
        let mut hash = Sha256::new();
        hash.update(build_id()?);
        hash.update(format!("{:?}", compatibility_key(camera)));
        hash.update(stage.light_hash());
        hash.update(light_passes.to_le_bytes());
        let name = hex::encode(hash.finalize());
        Some(self.folder.join(name).with_extension("salf"))
    }

    /// Whether there is a light field of the stage for `camera`.
    pub fn has(&self, stage: &Stage, camera: &Camera) -> bool {
        self.file(stage, camera, 0).is_some_and(|file| file.exists())
    }

    /// The light field of the stage for `camera`, if one is kept that reaches at least `least_margin_px` beyond the frame and tells
    /// carried light as finely as is wanted: of those the one whose light was refined most, and by how many passes. One that cannot be
    /// read is as good as none.
    pub fn find(
        &self,
        stage: &Stage,
        camera: &Camera,
        least_margin_px: f64,
        carried: Carried,
    ) -> Option<(Salf, u32)> {
        let passes = LIGHT_PASSES.into_iter().rev().chain([0]);
        passes.into_iter().find_map(|passes| {
            Some((self.find_with_passes(stage, camera, passes, least_margin_px, carried)?, passes))
        })
    }

    fn find_with_passes(
        &self,
        stage: &Stage,
        camera: &Camera,
        light_passes: u32,
        least_margin_px: f64,
        carried: Carried,
    ) -> Option<Salf> {
        let path = self.file(stage, camera, light_passes)?;
        let file = File::open(&path).ok()?;
        // It was looked for: it goes last. Where that cannot be noted, it goes by when it was written.
        let _ = file.set_modified(SystemTime::now());
        let salf_file = SalfFile::read(BufReader::with_capacity(1 << 20, file)).ok()?;
        let salf = Arc::into_inner(salf_file.salf)?;
        let fits = compatibility_key(&salf.camera) == compatibility_key(camera)
            && salf_file.triangles as usize == stage.scene.triangles.len()
            && f64::from(salf.margin_px) >= least_margin_px
            && salf.carried >= carried;
        fits.then_some(salf)
    }

    /// Keeps a light field that took `bake` to make, on a thread of its own. That it cannot be kept only costs time later.
    pub fn save(&self, stage: &Arc<Stage>, salf: &Arc<Salf>, light_passes: u32, bake: Duration) {
        if bake < self.shortest_bake {
            return;
        }
        let (store, stage, salf) = (self.clone(), stage.clone(), salf.clone());
        let write = move || store.write(&stage, &salf, light_passes);
        let _ = std::thread::Builder::new().name("keeping light field".into()).spawn(write);
    }

    fn write(&self, stage: &Stage, salf: &Arc<Salf>, light_passes: u32) {
        let Some(path) = self.file(stage, &salf.camera, light_passes) else { return };
        let has_folder = std::fs::create_dir_all(&self.folder).is_ok();
        if has_folder && write_salf(&path, &stage.scene.path, &stage.scene, salf).is_ok() {
            evict_oldest(&self.folder, "salf", self.budget_bytes, &path);
        }
    }
}

/// What all cameras have in common that a light field serves, but for smaller apertures.
fn compatibility_key(camera: &Camera) -> Camera {
    Camera { focus_distance: f64::INFINITY, aperture: Aperture::default(), ..camera.clone() }
}
