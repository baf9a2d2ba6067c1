//! The engine: a light field with a lens, paint and a picture.

use crate::brush::PageBrush;
use crate::error::EngineError;
use crate::field_of_page::FieldOfPage;
use crate::first_surfaces::{FirstSurface, FirstSurfaces};
use crate::history::History;
use crate::sample_places::{SamplePlaces, world_point};
use crate::stroke::Stroke;
use glam::DVec2;
use lens::blur_scale::paint_code;
use lens::{Aperture, ApertureShape, Camera, Exposure, FocusOffset, Picture};
use numerics::screen_level;
use progress::Unwatched;
use splat::{Splatter, Tolerance};

/// How often the sides of a draft are halved.
const DRAFT_HALVINGS: u8 = 1;

/// A lens that visitors choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensChoice {
    /// 1/s, 1/length; 0 at infinity.
    pub inverse_distance: f64,
    /// The aperture radius as a share of the exported one, in (0, 1].
    pub aperture_share: f64,
    /// The aperture's shape.
    pub aperture: ApertureChoice,
    /// Whether it focuses as painted, or as an ordinary lens.
    pub is_painted: bool,
}

/// The shape of the aperture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ApertureChoice {
    /// As it was exported.
    Exported,
    /// A disc.
    Disc,
    /// Straight blades, in [3, 64].
    Blades(u32),
}

/// A picture as screens show it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ScreenPixels {
    /// Columns and rows.
    pub size: [u32; 2],
    /// 8-bit sRGB and 255, row by row from the top.
    pub pixels: Vec<[u8; 4]>,
}

/// A light field with a lens, paint and a picture.
pub struct Engine {
    splatter: Splatter,
    draft: Splatter,
    /// The exported camera, with the lens in use.
    camera: Camera,
    exported: Camera,
    exposure: Exposure,
    gain: f32,
    /// Of every sample.
    focus: Vec<FocusOffset>,
    /// Whether it is shown, or the ordinary lens.
    is_painted: bool,
    /// Whether the full picture is that of lens and paint.
    is_current: bool,
    surfaces: FirstSurfaces,
    /// Found with the first stroke.
    places: Option<SamplePlaces>,
    stroke: Option<Stroke>,
    /// Samples that are painted and not drawn yet.
    undrawn: Vec<u32>,
    history: History,
    screen: ScreenPixels,
}

impl Engine {
    /// How coarse the sums are: that of the window.
    pub const TOLERANCE: Tolerance = Tolerance::VIEWING;

    /// Opens a light field. Nothing is drawn yet.
    pub fn new(field: FieldOfPage) -> Self {
        let focus = field.focus_of_samples();
        let surfaces = FirstSurfaces::new(&field.salf);
        let exported = field.salf.camera.clone();
        let mut splatter = Splatter::new(field.salf);
        splatter.set_tolerance(Self::TOLERANCE);
        splatter.set_focus_of_samples(&focus);
        let mut draft = splatter.draft(DRAFT_HALVINGS);
        draft.set_tolerance(Self::TOLERANCE);
        Self {
            draft,
            splatter,
            camera: exported.clone(),
            exported,
            exposure: field.exposure,
            gain: field.gain,
            focus,
            is_painted: true,
            is_current: false,
            surfaces,
            places: None,
            stroke: None,
            undrawn: Vec::new(),
            history: History::default(),
            screen: ScreenPixels::default(),
        }
    }

    /// The exported camera.
    pub fn exported_camera(&self) -> &Camera {
        &self.exported
    }

    /// What was drawn last.
    pub fn screen(&self) -> &ScreenPixels {
        &self.screen
    }

    /// The reciprocal distances, 1/length, of the farthest and the nearest that surfaces or the exported camera's focus are at.
    pub fn range(&self) -> [f64; 2] {
        let own = self.exported.optics().inverse_focus_distance;
        let [farthest, nearest] = self.surfaces.range().unwrap_or([own; 2]);
        [farthest.min(own), nearest.max(own)]
    }

    /// Puts on a lens and draws; a draft has half the columns and rows.
    ///
    /// # Errors
    /// The lens cannot be used, or the picture cannot be summed.
    pub fn refocus(&mut self, lens: LensChoice, is_draft: bool) -> Result<(), EngineError> {
        let shape = match lens.aperture {
            ApertureChoice::Exported => self.exported.aperture.clone(),
            ApertureChoice::Disc => Aperture::default(),
            ApertureChoice::Blades(blades) => {
                let rotation = std::f64::consts::FRAC_PI_2;
                Aperture::from(ApertureShape::Polygon { blades, rotation, roundness: 0.0 })
            }
        };
        // `min` would make NaN 1.
        let share = if lens.aperture_share > 1.0 { 1.0 } else { lens.aperture_share };
        let camera = Camera {
            focus_distance: 1.0 / lens.inverse_distance,
            aperture_radius: self.exported.aperture_radius * share,
            aperture: shape,
            ..self.exported.clone()
        };
        camera.validate()?;
        self.camera = camera;
        if self.is_painted != lens.is_painted || !self.undrawn.is_empty() {
            self.undrawn.clear();
            self.show_paint(lens.is_painted);
        }
        self.is_current = false;
        if !is_draft {
            return self.draw();
        }
        self.draft.take_paint_of(&self.splatter);
        self.draft.refocus(&self.camera, &Unwatched)?;
        self.screen.show(self.draft.picture(), self.exposure, self.gain);
        Ok(())
    }

    /// Shows the focus as painted, or as an ordinary lens has it, with the next picture.
    fn show_paint(&mut self, is_painted: bool) {
        self.is_painted = is_painted;
        self.is_current = false;
        if is_painted {
            self.splatter.set_focus_of_samples(&self.focus);
        } else {
            self.splatter.set_focus_of_samples(&vec![FocusOffset::STANDARD; self.focus.len()]);
        }
    }

    /// The focus of a sample, as it is shown.
    fn shown_focus(&self, sample: u32) -> FocusOffset {
        if self.is_painted { self.focus[sample as usize] } else { FocusOffset::STANDARD }
    }

    /// How the first surface of each pixel is painted, row by row from the top ([`lens::blur_scale::paint_code`], of blur at the anchor).
    pub fn paint_map(&self) -> Vec<u8> {
        let optics = self.exported.optics();
        let code = |surface: &Option<FirstSurface>| {
            let focus = surface.map(|surface| self.focus[surface.sample as usize]);
            let painted = focus.filter(|focus| !focus.is_standard());
            let circle_px =
                |focus: FocusOffset| 2.0 * optics.splat_radius_px((focus.t - 1.0) / optics.image_distance);
            paint_code(painted.map(circle_px))
        };
        self.surfaces.iter().map(code).collect()
    }

    /// What is at a place of the picture, from 0 at the upper left to 1: the reciprocal distance that makes it sharp, 1/length, or none where
    /// paint alone decides; `None` where there is no surface.
    pub fn sharp_inverse_distance(&self, x: f64, y: f64) -> Option<Option<f64>> {
        let FirstSurface { inverse_depth, sample } = self.surfaces.at(x, y)?;
        let focus = self.shown_focus(sample);
        Some(self.exported.optics().sharp_inverse_focus_distance(inverse_depth.into(), focus))
    }

    /// Begins a stroke on the surface at a place of the picture. Returns whether there is one. It is drawn by [`Self::draw_stroke`], and paint
    /// is shown.
    pub fn begin_stroke(&mut self, brush: PageBrush, x: f64, y: f64) -> bool {
        self.end_stroke();
        let Some(surface) = self.surfaces.at(x, y) else { return false };
        if !self.is_painted {
            self.show_paint(true);
        }
        let optics = self.exported.optics();
        let length_per_px = optics.tan_half_yfov / optics.half_height_px / f64::from(surface.inverse_depth);
        let target = brush.paint.target(&optics);
        self.stroke = Some(Stroke::new(brush, target, brush.radius_px * length_per_px));
        self.extend_stroke(x, y);
        true
    }

    /// Radius in world units and focus of the stroke in progress.
    pub fn stroke_facts(&self) -> Option<(f64, FocusOffset)> {
        self.stroke.as_ref().map(|stroke| (stroke.radius(), stroke.target()))
    }

    /// Goes on to another place; beside all surfaces, the stroke is lifted.
    pub fn extend_stroke(&mut self, x: f64, y: f64) {
        let Some(stroke) = &mut self.stroke else { return };
        let Some(surface) = self.surfaces.at(x, y) else {
            stroke.lift();
            return;
        };
        let pixel = DVec2::new(x * f64::from(self.exported.width), y * f64::from(self.exported.height));
        let point = world_point(&self.exported, pixel, 1.0 / f64::from(surface.inverse_depth));
        let places = self.places.get_or_insert_with(|| SamplePlaces::new(&self.splatter.salf().samples));
        self.undrawn.extend(stroke.extend(point, places, &self.exported, &mut self.focus));
    }

    /// Draws what was painted since.
    ///
    /// # Errors
    /// The picture cannot be summed.
    pub fn draw_stroke(&mut self) -> Result<(), EngineError> {
        let mut samples = std::mem::take(&mut self.undrawn);
        samples.sort_unstable();
        samples.dedup();
        self.repaint(&samples)
    }

    /// Ends the stroke, so that it can be undone. Returns whether it changed anything.
    pub fn end_stroke(&mut self) -> bool {
        let Some(stroke) = self.stroke.take() else { return false };
        let changes = stroke.changes(&self.focus);
        let has_changed = !changes.is_empty();
        if has_changed {
            self.history.push(changes);
        }
        has_changed
    }

    /// Undoes the last stroke.
    ///
    /// # Errors
    /// The picture cannot be summed.
    pub fn undo(&mut self) -> Result<(), EngineError> {
        self.end_stroke();
        self.draw_stroke()?;
        let changed = self.history.undo(&mut self.focus);
        self.repaint(&changed)
    }

    /// Does again the stroke that was undone last.
    ///
    /// # Errors
    /// The picture cannot be summed.
    pub fn redo(&mut self) -> Result<(), EngineError> {
        self.end_stroke();
        self.draw_stroke()?;
        let changed = self.history.redo(&mut self.focus);
        self.repaint(&changed)
    }

    /// How many strokes can be undone, and how many done again.
    pub fn history_lengths(&self) -> [usize; 2] {
        self.history.lengths()
    }

    /// Draws the focus of some samples, which has changed.
    fn repaint(&mut self, samples: &[u32]) -> Result<(), EngineError> {
        if samples.is_empty() && self.is_current {
            return Ok(());
        }
        if !self.is_painted || !self.is_current {
            self.show_paint(true);
            return self.draw();
        }
        self.splatter.update_samples(&self.focus, samples)?;
        self.screen.show(self.splatter.picture(), self.exposure, self.gain);
        Ok(())
    }

    fn draw(&mut self) -> Result<(), EngineError> {
        self.splatter.refocus(&self.camera, &Unwatched)?;
        self.is_current = true;
        self.screen.show(self.splatter.picture(), self.exposure, self.gain);
        Ok(())
    }
}

impl ScreenPixels {
    /// Shows a picture as `render` writes PNGs.
    fn show(&mut self, picture: &Picture, exposure: Exposure, gain: f32) {
        let common = picture.colour_coverage.is_some().then(|| picture.clone().with_common_coverage());
        let picture = common.as_ref().unwrap_or(picture);
        let pixel = |(radiance, coverage): (&[f32; 3], &f32)| {
            let scale = exposure.scale(gain, *coverage);
            let [r, g, b] = radiance.map(|light| screen_level(light * scale));
            [r, g, b, u8::MAX]
        };
        self.size = [picture.width, picture.height];
        self.pixels.clear();
        self.pixels.extend(picture.radiance.iter().zip(&picture.coverage).map(pixel));
    }
}
