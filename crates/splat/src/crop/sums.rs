//! The sums of a crop.

use super::Crop;
use super::integers::{Integers, Kind};
use super::picture::{self, CropFacts, CropPicture, Inner};
use super::row::CropForm;
use crate::bands::Pace;
use crate::draw_list::{BlockList, Changes, Scene};
use crate::lens_in_use::{LensInUse, Tolerance};
use crate::nodes::{Nodes, Scale};
use crate::paint::{FocusOfSamples, Paint, STANDARD};
use crate::resolve::Overflow;
use crate::resolve::partition::Share;
use crate::splatter::{ApertureInUse, SETS};
use crate::sums::Sums;
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use salf::Salf;
use salf::tree::BLOCK_PX;
use surface::SurfaceField;

/// The crop to sum, and how.
#[derive(Clone, Copy)]
pub struct CropOptions<'a> {
    /// The camera of the whole picture: the one that the light field is baked for.
    pub camera: &'a Camera,
    /// The part of it.
    pub crop: Crop,
    /// How coarse the sum may be.
    pub tolerance: Tolerance,
    /// How fine its integers may be.
    pub integers: Integers,
    /// Whether anything in the whole picture may be painted. Otherwise the crop stores fewer numbers.
    pub may_be_painted: bool,
    /// The number of mattes to draw first, of [`SETS`] sets of samples each.
    pub mattes: usize,
}

/// Why a crop could not be summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CropError {
    /// The progress was cancelled.
    Cancelled,
    /// Integers of this kind do not hold it: take coarser ones.
    TooFine(Kind),
    /// A sample is too bright to be summed.
    TooBright,
}

impl From<Cancelled> for CropError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// The sets of a matte that a sample belongs to, by its index in its part of the light field.
pub type SetsOfSample<'a> = dyn Fn(u32) -> [bool; SETS] + Sync + 'a;

/// The sums of a crop of a picture, to which parts of its light field are added.
pub struct CropSums<'a> {
    options: CropOptions<'a>,
    /// The crop and what is summed around it.
    outer: Crop,
    lens: LensInUse,
    aperture: ApertureInUse,
    /// The picture's, until it is made.
    picture: Option<PictureSums>,
    /// What each pixel's sums are multiplied by, once the picture is made.
    shares: Vec<Share>,
    mattes: Vec<Sums>,
    has_bright: bool,
    facts: CropFacts,
    lists: Vec<BlockList>,
    changes: Changes,
    pace: Pace,
}

struct PictureSums {
    standard: Sums,
    /// Once something is painted; until then they are the same.
    painted: Option<Sums>,
}

impl<'a> CropSums<'a> {
    /// How far around a crop sums must be complete, px: its pixels are made of coarser levels' around them.
    pub fn near_px(tolerance: Tolerance) -> i32 {
        // Without joint nodes there is only the finest level.
        if tolerance == Tolerance::NONE { 0 } else { 5 * BLOCK_PX }
    }

    /// How far from there light of nodes on coarser levels may be spread, px, beside their images.
    pub fn blur_px(tolerance: Tolerance) -> i32 {
        if tolerance == Tolerance::NONE { 0 } else { 5 * BLOCK_PX }
    }

    /// Empty sums of a crop.
    pub fn new(options: CropOptions<'a>) -> Self {
        let CropOptions { camera, crop, tolerance, .. } = options;
        let (near, block) = (Self::near_px(tolerance) as u32, BLOCK_PX as u32);
        let whole = [camera.width, camera.height];
        let first = crop.corner.map(|first| first.saturating_sub(near) / block * block);
        let end = [0, 1].map(|axis| {
            let end = crop.corner[axis] + crop.size[axis] + near;
            (end.div_ceil(block) * block).min(whole[axis])
        });
        let outer = Crop { corner: first, size: [end[0] - first[0], end[1] - first[1]] };
        // The light field is the camera's: nothing is stopped down.
        let aperture = ApertureInUse::new(&camera.aperture, 1.0, None);
        let lens = LensInUse::new(camera.optics(), &aperture.stencils.shape, tolerance);
        let mut new = Self {
            options,
            outer,
            lens,
            aperture,
            picture: None,
            shares: Vec::new(),
            mattes: Vec::new(),
            has_bright: false,
            facts: CropFacts::empty(options.integers),
            lists: Vec::new(),
            changes: Changes::default(),
            pace: Pace::default(),
        };
        new.picture = Some(PictureSums { standard: new.empty(), painted: None });
        if options.may_be_painted && options.integers.standard != options.integers.painted {
            let painted = new.empty();
            new.picture.as_mut().map(|sums| sums.painted.insert(painted));
        }
        new.begin_mattes(options.mattes);
        new
    }

    fn empty(&self) -> Sums {
        Sums::new(self.outer.size.map(|side| side as usize), self.has_bright)
    }

    /// Starts another set of mattes: all parts of the light field have to be added again.
    pub fn begin_mattes(&mut self, count: usize) {
        self.mattes = (0..count).map(|_| self.empty()).collect();
    }

    /// Adds a part of the light field. `is_black` selects samples that send no light but still cover what lies behind them; `sets` are
    /// the sets of each matte in turn.
    ///
    /// # Errors
    /// [`CropError::Cancelled`] if `progress` is cancelled.
    pub fn add(
        &mut self,
        salf: &Salf,
        focus: &dyn SurfaceField<FocusOffset>,
        is_black: Option<&(dyn Fn(u32) -> bool + Sync)>,
        sets: &[&SetsOfSample],
        progress: &dyn Progress,
    ) -> Result<(), CropError> {
        let corner = self.outer.corner.map(|px| px as i32);
        let mut nodes = Nodes::from_corner(salf, Scale::FINEST, corner).ok_or(CropError::TooBright)?;
        self.facts.brightest = self.facts.brightest.max(nodes.brightest);
        if nodes.nodes.is_empty() {
            return Ok(());
        }
        if nodes.has_bright && !self.has_bright {
            self.has_bright = true;
            let of_picture = self.picture.iter_mut().flat_map(|sums| {
                let PictureSums { standard, painted } = sums;
                std::iter::once(standard).chain(painted)
            });
            of_picture.chain(&mut self.mattes).for_each(Sums::ensure_bright);
        }
        self.aperture.set_nodes(&nodes);
        let paint = Paint::sample(&nodes, FocusOfSamples::of_surface(&salf.samples, focus));
        let is_painted = !paint.is_standard();
        self.facts.is_painted |= is_painted;
        if let Some(is_black) = is_black {
            nodes.relight(&|sample, rgb| if is_black(sample) { [0.0; 3] } else { rgb });
        }
        let integers = self.options.integers;
        if let Some(mut sums) = self.picture.take() {
            if is_painted && sums.painted.is_none() {
                sums.painted = Some(sums.standard.clone());
            }
            nodes.rescale(integers.scale(Kind::Standard));
            self.draw(&mut sums.standard, &nodes, &STANDARD, progress)?;
            if let Some(painted) = &mut sums.painted {
                nodes.rescale(integers.scale(Kind::Painted));
                self.draw(painted, &nodes, &paint, progress)?;
            }
            self.picture = Some(sums);
        }
        nodes.rescale(integers.scale(Kind::Painted));
        for (index, sets) in sets.iter().enumerate() {
            nodes.relight(&|sample, _| sets(sample).map(|is_in| if is_in { 1.0 } else { 0.0 }));
            let mut sums = std::mem::take(&mut self.mattes);
            self.draw(&mut sums[index], &nodes, &paint, progress)?;
            self.mattes = sums;
        }
        Ok(())
    }

    fn draw(
        &mut self,
        sums: &mut Sums,
        nodes: &Nodes,
        paint: &Paint,
        progress: &dyn Progress,
    ) -> Result<(), CropError> {
        let pen = self.aperture.pen(nodes, &self.lens);
        let scene = Scene { pen, lens: &self.lens, paint, size: self.outer.size };
        scene.list_all(None, &mut self.lists, &mut self.changes);
        Ok(sums.add(&scene.pen, &self.lists, &mut self.pace, progress)?)
    }

    /// Where the crop lies in what is summed.
    fn inner(&self) -> Inner {
        let Crop { corner, size } = self.options.crop;
        Inner::new([corner[0] - self.outer.corner[0], corner[1] - self.outer.corner[1]], size)
    }

    /// The crop's contribution to the picture: once, after all parts of the light field have been added.
    ///
    /// # Errors
    /// [`CropError::TooFine`] or [`CropError::TooBright`] if the integers of the sums overflow.
    pub fn picture(&mut self) -> Result<CropPicture, CropError> {
        let taken = self.picture.take();
        let sums = taken.unwrap_or_else(|| PictureSums { standard: self.empty(), painted: None });
        let PictureSums { standard, painted } = sums;
        let (inner, integers, brightest) = (self.inner(), self.options.integers, self.facts.brightest);
        let quanta = |kind| integers.scale(kind).quanta(brightest);
        let too_fine = |kind| move |Overflow| CropError::TooFine(kind);
        let form = if self.options.may_be_painted { CropForm::Parts } else { CropForm::Evened };
        let mut made = picture::standard(&standard, quanta(Kind::Standard), inner, form)
            .map_err(too_fine(Kind::Standard))?;
        self.facts.largest = [made.largest; 2];
        self.shares = std::mem::take(&mut made.shares);
        if let Some(painted) = &painted {
            drop(standard);
            let quanta = quanta(Kind::Painted);
            self.facts.largest[1] = picture::painted(painted, quanta, inner, &mut made.numbers)
                .map_err(too_fine(Kind::Painted))?;
        }
        Ok(CropPicture { form, numbers: made.numbers, knots: made.knots, facts: self.facts })
    }

    /// A matte, after the picture: the coverage of its sets as red, green and blue, and that of all.
    ///
    /// # Errors
    /// [`CropError::TooFine`] or [`CropError::TooBright`] if the integers of the sums overflow.
    pub fn matte(&self, index: usize) -> Result<Picture, CropError> {
        let quanta = self.options.integers.scale(Kind::Painted).quanta(self.facts.brightest);
        picture::matte(&self.mattes[index], quanta, self.inner(), &self.shares)
            .map_err(|Overflow| CropError::TooFine(Kind::Painted))
    }
}
