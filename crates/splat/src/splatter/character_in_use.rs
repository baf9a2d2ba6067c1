//! What of a lens's character a picture is drawn with.

use super::aperture_in_use::ApertureInUse;
use crate::character::shaper::Shaper;
use crate::lens_in_use::LensInUse;
use crate::nodes::Nodes;
use glam::DVec2;
use lens::{Camera, Picture, Vignetting};
use std::ops::Range;

/// The character of the lens that is put on; by default none.
#[derive(Default)]
pub struct CharacterInUse {
    shaper: Option<Shaper>,
    /// The camera that the shaper is made for, focused anywhere.
    shaped_for: Option<Camera>,
    darkening: Option<Darkening>,
}

/// How a summed picture darkens.
struct Darkening {
    camera: Camera,
    vignetting: Option<Vignetting>,
    /// What a larger picture's light is spread to.
    density: f32,
}

impl CharacterInUse {
    /// Puts on the character of a camera's lens, for a picture of `nodes`.
    pub fn set(
        &mut self,
        camera: &Camera,
        aperture: &ApertureInUse,
        lens: &LensInUse,
        nodes: Option<&Nodes>,
    ) {
        if camera.character.is_neutral() {
            *self = Self::default();
            return;
        }
        let shaped_for = Camera { focus_distance: 1.0, ..camera.clone() };
        if self.shaped_for.as_ref() != Some(&shaped_for) {
            let nearest = nodes.map_or(0.0, |nodes| {
                nodes.nodes.iter().fold(0.0, |most: f32, node| most.max(node.inverse_depth))
            });
            let size = lens.magnification.map_or(1.0, |magnification| 1.0 + magnification.lateral);
            self.shaper = Shaper::new(camera, &aperture.stencils.shape, aperture.stop, size, nearest);
            self.shaped_for = Some(shaped_for);
        }
        let density = lens.magnification.map_or(1.0, |magnification| magnification.density());
        let vignetting = camera.vignetting();
        let darkens = vignetting.is_some() || density != 1.0;
        self.darkening = darkens.then(|| Darkening { camera: camera.clone(), vignetting, density });
    }

    /// What cuts and weighs the aperture, if anything does.
    pub fn shaper(&self) -> Option<&Shaper> {
        self.shaper.as_ref()
    }

    /// Darkens some rows and columns of a picture that was summed.
    pub fn darken(&self, picture: &mut Picture, [rows, columns]: [Range<u32>; 2]) {
        let Some(Darkening { camera, vignetting, density }) = &self.darkening else { return };
        for row in rows {
            for column in columns.clone() {
                let pixel = row as usize * picture.width as usize + column as usize;
                let (mut light, mut coverage) = (*density, picture.coverage[pixel] * density);
                if let Some(vignetting) = vignetting {
                    let place = DVec2::new(f64::from(column), f64::from(row)) + 0.5;
                    let at = vignetting.at(camera.q_from_pixel(place));
                    light *= at.angle;
                    coverage = at.coverage(coverage);
                }
                picture.radiance[pixel] = picture.radiance[pixel].map(|channel| channel * light);
                picture.coverage[pixel] = coverage;
            }
        }
    }
}
