//! Pictures of lenses that focus colours unlike: red and blue are pictures of their own, whose sums follow the paint as green's do.

use super::{SplatError, Splatter};
use lens::{Camera, GREEN};
use progress::{Progress, Stage};
use std::ops::Range;

/// Red and blue.
const OTHERS: [usize; 2] = [0, 2];

impl Splatter {
    /// Makes the pictures of red and blue, if the lens of `camera` needs them.
    pub(super) fn set_colours(&mut self, camera: &Camera) {
        if self.channel != GREEN {
            return;
        }
        if !camera.character.has_fringe() {
            self.colours = None;
            self.resolver.picture.colour_coverage = None;
            return;
        }
        if self.colours.is_none() {
            let of_channel = |channel| Self { channel, paint: self.paint.clone(), ..self.twin() };
            self.colours = Some(Box::new(OTHERS.map(of_channel)));
        }
        for colour in self.colours.iter_mut().flat_map(|colours| &mut **colours) {
            (colour.tolerance, colour.is_live) = (self.tolerance, self.is_live);
        }
    }

    /// The part of the work that green's picture is.
    pub(super) fn green_stage<'p>(&self, progress: &'p dyn Progress) -> Stage<'p> {
        Stage::new(progress, 0.0, if self.colours.is_some() { 1.0 / 3.0 } else { 1.0 })
    }

    /// Does `work` for red and for blue, and puts what they show in `window`, and in the windows that it returns, into the picture.
    /// Returns the rows and columns of all.
    pub(super) fn draw_colours(
        &mut self,
        window: [Range<u32>; 2],
        progress: &dyn Progress,
        work: impl Fn(&mut Self, &dyn Progress) -> Result<[Range<u32>; 2], SplatError>,
    ) -> Result<[Range<u32>; 2], SplatError> {
        let Some(mut colours) = self.colours.take() else { return Ok(window) };
        let mut windows = vec![window];
        for (colour, begin) in colours.iter_mut().zip([1.0 / 3.0, 2.0 / 3.0]) {
            windows.push(work(colour, &Stage::new(progress, begin, begin + 1.0 / 3.0))?);
        }
        let [rows, columns] =
            [0, 1].map(|axis| crate::draw_list::hull(windows.iter().map(|window| window[axis].clone())));
        let picture = &mut self.resolver.picture;
        let coverage = picture.colour_coverage.get_or_insert_with(|| vec![[0.0; 2]; picture.coverage.len()]);
        for row in rows.clone() {
            for column in columns.clone() {
                let pixel = row as usize * picture.width as usize + column as usize;
                for (k, (colour, channel)) in colours.iter().zip(OTHERS).enumerate() {
                    let own = &colour.resolver.picture;
                    picture.radiance[pixel][channel] = own.radiance[pixel][channel];
                    coverage[pixel][k] = own.coverage[pixel];
                }
            }
        }
        self.colours = Some(colours);
        Ok([rows, columns])
    }
}
