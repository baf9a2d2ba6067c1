//! Thumbnails of files, for file managers.

use crate::error::RenderError;
use crate::picture::tone::Tone;
use document::InputKind;
use lens::{Exposure, FocusOffset};
use progress::Progress;
use project::Thumbnail;
use salf::SalfFile;
use scene::{SurfaceField, SurfacePoint};
use splat::Splatter;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Reads the thumbnail of a project, or draws that of a light field, without its scene: a sandboxed file manager may not have access to it.
///
/// # Errors
/// The file is neither a project nor a light field, cannot be read, or is a project that was saved without a picture; or the work was
/// cancelled.
pub fn read_thumbnail(path: &Path, progress: &dyn Progress) -> Result<Thumbnail, RenderError> {
    let none = |what: &str| Err(RenderError::bad_file(path, what));
    match InputKind::from_path(path)? {
        InputKind::Project => match Thumbnail::read(path)? {
            Some(thumbnail) => Ok(thumbnail),
            None => none("was saved without a picture (open it in the window and save it)"),
        },
        InputKind::LightField => {
            let file = File::open(path).map_err(|error| RenderError::io(path, &error))?;
            let read =
                SalfFile::read(BufReader::new(file)).map_err(|error| RenderError::bad_file(path, error))?;
            let camera = read.salf.camera.clone();
            let mut splatter = Splatter::new(read.salf);
            splatter.render(&camera, &OrdinaryLens, progress)?;
            let picture = splatter.picture();
            let tone = Tone { exposure: Exposure::Normalise, ..Tone::default() };
            Ok(Thumbnail::from_linear(picture.width, picture.height, tone.displayed(picture)))
        }
        InputKind::Scene | InputKind::Capture | InputKind::Splats => {
            none("contains no thumbnail (give a project or a light field)")
        }
    }
}

/// Standard focus, for any scene.
struct OrdinaryLens;

impl SurfaceField<FocusOffset> for OrdinaryLens {
    fn at(&self, _point: SurfacePoint) -> FocusOffset {
        FocusOffset::STANDARD
    }

    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }

    fn affects_carried_light(&self) -> bool {
        false
    }
}
