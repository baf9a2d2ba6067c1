//! The picture as a running integer sum that single samples can leave and enter.

mod aperture_in_use;
#[cfg(feature = "gpu")]
mod card;
#[cfg(not(feature = "gpu"))]
#[path = "splatter/no_card.rs"]
mod card;
mod character_in_use;
mod colours;
mod error;
mod mattes;
#[cfg(feature = "gpu")]
mod on_card;
mod resolve_steps;
mod resolver;
mod wide_images;

pub use error::SplatError;
pub use mattes::{Mattes, SETS};
pub use wide_images::WideImage;

use crate::bands::Pace;
use crate::draw::Pen;
use crate::draw_list::{BlockList, Changes};
use crate::lens_in_use::{LensInUse, Tolerance};
use crate::node_view::DraftScale;
use crate::nodes::{Nodes, Scale};
use crate::paint::{FocusOfSamples, Paint};
use crate::sums::Sums;
pub(crate) use aperture_in_use::ApertureInUse;
use card::Card;
use character_in_use::CharacterInUse;
use lens::{Camera, FocusOffset, GREEN, Picture};
use progress::{Progress, Stage};
use resolve_steps::{Finish, ResolveOutput, SummedPaint};
use resolver::Resolver;
use salf::Salf;
use salf::tree::LEVELS;
use std::mem::swap;
use std::ops::Range;
use std::sync::Arc;
use surface::SurfaceField;

/// The picture of a SALF as running sums that follow the focus as it is painted.
pub struct Splatter {
    salf: Arc<Salf>,
    /// How often the picture's sides are halved: 0, but for a [draft](Self::draft).
    halvings: u8,
    /// Columns and rows of the picture.
    size: [u32; 2],
    /// The hierarchy, which twins share; none if a sample is too bright.
    nodes: Option<Arc<Nodes>>,
    tolerance: Tolerance,
    /// Whether paint changes what it moves and nothing else.
    is_live: bool,
    aperture: Arc<ApertureInUse>,
    lens: LensInUse,
    paint: Paint,
    sums: Sums,
    /// What was drawn of each block when all was summed last; room for what is.
    lists: Vec<BlockList>,
    /// How long that took.
    pace: Pace,
    /// Room for what changes.
    changes: Changes,
    /// What makes the picture of the sums.
    resolver: Resolver,
    /// What of the lens's character it is drawn with.
    character: CharacterInUse,
    /// The colour channel whose focus it has.
    channel: usize,
    /// The pictures of red and blue, where the lens focuses them unlike green.
    colours: Option<Box<[Splatter; 2]>>,
    /// The lens of whose standard picture the shares are, and whether they include the gains for evening.
    shares_of: Option<(LensInUse, bool)>,
    card: Card,
}

impl Splatter {
    /// Prepares to render `salf`. The picture is black until [`Self::render`].
    pub fn new(salf: Arc<Salf>) -> Self {
        let nodes = Nodes::new(&salf, Scale::FINEST).map(Arc::new);
        let aperture = ApertureInUse::new(&salf.camera.aperture, 1.0, nodes.as_deref());
        Self::with_nodes(salf, nodes, Arc::new(aperture), 0)
    }

    /// Another splatter of the same light field, with sums of its own: quick to make, since the hierarchy is shared. It starts like a
    /// new one, on the same card.
    pub fn twin(&self) -> Self {
        let mut twin = self.halved(self.halvings);
        twin.card = self.card.twin();
        twin
    }

    /// A splatter of the same light field whose picture's sides are halved so often (at least once): what is painted, it
    /// [takes over](Self::take_paint_of). What is alike within its pixels is drawn as one, so that each halving takes less than half of the
    /// time. It works on the processor.
    pub fn draft(&self, halvings: u8) -> Self {
        self.halved(halvings.clamp(1, LEVELS as u8 - 1))
    }

    /// The same light field, hierarchy and paint without the sums, which take most of the memory.
    pub fn without_sums(self) -> Self {
        let twin = self.twin();
        Self { paint: self.paint, ..twin }
    }

    /// The same, whose sums' memory passes to `next`, a splatter that is to be summed instead, if it is one of the same size. Neither has
    /// valid sums then.
    pub fn without_sums_but_for(mut self, next: &mut Self) -> Self {
        let has_bright = |splatter: &Self| splatter.nodes.as_ref().is_some_and(|nodes| nodes.has_bright);
        let is_alike = (self.size, has_bright(&self)) == (next.size, has_bright(next));
        if !is_alike || self.card.has_sums() || next.card.has_sums() {
            return self.without_sums();
        }
        swap(&mut self.sums, &mut next.sums);
        swap(&mut self.resolver, &mut next.resolver);
        swap(&mut self.lists, &mut next.lists);
        swap(&mut self.changes, &mut next.changes);
        (self.shares_of, next.shares_of) = (None, None);
        Self { colours: None, ..self }
    }

    fn halved(&self, halvings: u8) -> Self {
        let mut new =
            Self::with_nodes(self.salf.clone(), self.nodes.clone(), self.aperture.clone(), halvings);
        new.set_live(self.is_live);
        new
    }

    fn with_nodes(
        salf: Arc<Salf>,
        nodes: Option<Arc<Nodes>>,
        aperture: Arc<ApertureInUse>,
        halvings: u8,
    ) -> Self {
        let size = [salf.camera.width, salf.camera.height].map(|side| side.div_ceil(1 << halvings));
        let [width, height] = size.map(|side| side as usize);
        let tolerance = Tolerance::default();
        let shape = &aperture.stencils.shape;
        let has_bright = nodes.as_ref().is_some_and(|nodes| nodes.has_bright);
        let sums = Sums::new([width, height], has_bright);
        Self {
            lens: LensInUse::new(salf.camera.optics(), shape, tolerance),
            size,
            halvings,
            aperture,
            tolerance,
            is_live: false,
            paint: Paint::default(),
            resolver: Resolver::new([width, height], &sums),
            sums,
            lists: Vec::new(),
            pace: Pace::default(),
            changes: Changes::default(),
            shares_of: None,
            character: CharacterInUse::default(),
            channel: GREEN,
            colours: None,
            card: Card::default(),
            nodes,
            salf,
        }
    }

    /// How coarse the sum may be, as set by [`Self::set_tolerance`].
    pub fn tolerance(&self) -> Tolerance {
        self.tolerance
    }

    /// Sets how coarse the sum may be. Effective from the next [`Self::render`] on.
    pub fn set_tolerance(&mut self, tolerance: Tolerance) {
        self.tolerance = tolerance;
    }

    /// Sets whether pictures are live (no, by default): a stroke then changes only the pixels that it moves light from or to, so
    /// that an update resolves no more of the picture than that.
    ///
    /// Pictures that are not live are finished: without any paint, the coverage is evened out to 1 (except in holes); with paint, the
    /// light of sharing samples is scaled so that the total light is preserved. Live and finished pictures differ by the ripple
    /// of finite samples; divided by their coverage, only by how light is balanced (`balance`). Takes effect at the next
    /// [`Self::render`].
    pub fn set_live(&mut self, is_live: bool) {
        self.is_live = is_live;
    }

    /// How the light of sharing samples is finished.
    fn finish(&self) -> Finish {
        match self.is_live {
            true => Finish::Live,
            false if self.paint.is_standard() => Finish::Evened,
            false => Finish::Balanced,
        }
    }

    /// Returns a task that cuts the aperture's images in all sizes, to be run on any thread meanwhile. Otherwise a size is cut when it
    /// is first used, a third of a millisecond each, and the first dabs wait for it.
    pub fn prepare(&self) -> impl FnOnce(&dyn Progress) + Send + use<> {
        let aperture = self.aperture.clone();
        move |progress| aperture.stencils.cut_all(progress)
    }

    /// The light field that is drawn.
    pub fn salf(&self) -> &Arc<Salf> {
        &self.salf
    }

    /// The current picture or, if it stays on a card, the one that was [fetched](Self::fetch_picture) last.
    pub fn picture(&self) -> &Picture {
        &self.resolver.picture
    }

    /// Bytes of the hierarchy and of the sums, including those on a card and the lists of drawn nodes, without the light field.
    pub fn bytes(&self) -> [usize; 2] {
        let [nodes, sums] = self.card.bytes();
        let lists: usize = self.lists.iter().map(BlockList::bytes).sum();
        let colours: usize =
            self.colours.iter().flat_map(|colours| &**colours).map(|colour| colour.bytes()[1]).sum();
        [
            nodes + self.nodes.as_ref().map_or(0, |nodes| nodes.bytes()),
            colours + sums + self.sums.bytes() + self.resolver.bytes() + lists + self.changes.bytes(),
        ]
    }

    /// Gives back the room that is kept from one sum to the next, about 50 bytes a sample; the next one makes it again.
    pub fn release_room(&mut self) {
        (self.lists, self.changes) = (Vec::new(), Changes::default());
        self.colours.iter_mut().flat_map(|colours| &mut **colours).for_each(Self::release_room);
    }

    /// Sums the whole picture for a lens (`camera` may differ from the baked one in focus distance, aperture shape, character and a
    /// smaller aperture radius, nothing else) and a focus. A lens with a character is summed on the processor.
    ///
    /// After an error the picture is unchanged, but the sums are not: render again before updating.
    ///
    /// # Errors
    /// [`SplatError::Cancelled`] if `progress` is cancelled; [`SplatError::Overflow`] if the picture is too bright for its integers.
    pub fn render(
        &mut self,
        camera: &Camera,
        focus: &dyn SurfaceField<FocusOffset>,
        progress: &dyn Progress,
    ) -> Result<(), SplatError> {
        self.look_up_paint(focus);
        self.refocus(camera, progress)
    }

    /// Looks up the focus of every sample, for the next [`Self::refocus`].
    pub fn look_up_paint(&mut self, focus: &dyn SurfaceField<FocusOffset>) {
        let salf = self.salf.clone();
        self.take_focus(FocusOfSamples::of_surface(&salf.samples, focus));
    }

    /// Takes over the focus of every sample, in their order, for the next [`Self::refocus`]: where it is known without their addresses.
    /// [`salf::SampleFocus`] gives it.
    ///
    /// # Panics
    /// If it is that of another number of samples.
    pub fn set_focus_of_samples(&mut self, focus: &[FocusOffset]) {
        assert_eq!(focus.len(), self.salf.samples.len(), "a focus for each sample");
        self.take_focus(FocusOfSamples::Samples(focus));
    }

    fn take_focus(&mut self, focus: FocusOfSamples) {
        if let Some(nodes) = &self.nodes {
            self.set_paint(Paint::sample(nodes, focus));
        }
    }

    /// Looks up again the focus of the given samples, in any order, for the next [`Self::refocus`].
    ///
    /// # Panics
    /// If no paint was looked up before.
    pub fn update_paint(&mut self, focus: &dyn SurfaceField<FocusOffset>, samples: &[u32]) {
        let Some(nodes) = &self.nodes else { return };
        assert!(self.has_paint(), "paint is updated after it was looked up");
        let mut paint = self.paint.clone();
        let focus = FocusOfSamples::of_surface(&self.salf.samples, focus);
        paint.update(nodes, &nodes.leaves_of(samples), focus);
        self.set_paint(paint);
    }

    /// Takes over what `other`, of the same light field, has of the paint, and shares its hierarchy.
    pub fn take_paint_of(&mut self, other: &Self) {
        self.nodes = other.nodes.clone();
        self.set_paint(other.paint.clone());
    }

    /// Whether paint was looked up before.
    pub fn has_paint(&self) -> bool {
        self.nodes.as_ref().is_some_and(|nodes| self.paint.blocks.len() == nodes.blocks.len())
    }

    fn set_paint(&mut self, paint: Paint) {
        for colour in self.colours.iter_mut().flat_map(|colours| &mut **colours) {
            colour.set_paint(paint.clone());
        }
        self.paint = paint;
        self.card.invalidate_paint();
    }

    /// Sums the whole picture for the lens of `camera`, with the paint of before.
    ///
    /// # Panics
    /// If nothing was rendered before, and no paint looked up.
    ///
    /// # Errors
    /// [`SplatError::Cancelled`] if `progress` is cancelled; [`SplatError::Overflow`] if the picture is too bright
    /// for its integers.
    pub fn refocus(&mut self, camera: &Camera, progress: &dyn Progress) -> Result<(), SplatError> {
        self.set_lens(camera);
        assert!(self.nodes.is_none() || self.has_paint(), "refocus follows a render");
        self.sum(&self.green_stage(progress))?;
        let refocus = |colour: &mut Self, progress: &dyn Progress| {
            colour.set_lens(camera);
            colour.sum(progress)?;
            Ok(colour.frame())
        };
        self.draw_colours(self.frame(), progress, refocus)?;
        Ok(())
    }

    /// Puts on a lens.
    fn set_lens(&mut self, camera: &Camera) {
        let [width, height] = self.size;
        let camera = &Camera { width, height, ..camera.clone() };
        let (optics, baked_radius) = (camera.optics(), self.salf.camera.aperture_radius);
        let stop = LensInUse::stop(&optics, baked_radius);
        if (&self.aperture.aperture, self.aperture.stop) != (&camera.aperture, stop) {
            self.aperture = Arc::new(self.aperture.changed(&camera.aperture, stop, self.nodes.as_deref()));
            self.shares_of = None;
            self.card.invalidate_aperture();
        }
        let plain = LensInUse::new(optics, &self.aperture.stencils.shape, self.tolerance);
        let has_character = !camera.character.is_neutral();
        let lens = if has_character { plain.with_character(camera, self.channel) } else { plain };
        self.lens = if self.halvings == 0 { lens } else { lens.for_draft(self.draft_scale()) };
        // A card draws the discs of plain lenses.
        if self.card.bypass(has_character) {
            self.shares_of = None;
        }
        self.character.set(camera, &self.aperture, &self.lens, self.nodes.as_deref());
        self.set_colours(camera);
    }

    /// Sums all and resolves the picture; on the processor once the card is lost.
    fn sum(&mut self, progress: &dyn Progress) -> Result<(), SplatError> {
        if let Some(nodes) = &self.nodes {
            self.card.upload_nodes(nodes, self.size.map(|side| side as usize));
        }
        self.card.begin();
        let summed = self.sum_all(progress);
        if !self.drop_lost_card() {
            return summed;
        }
        self.sum_all(progress)
    }

    fn sum_all(&mut self, progress: &dyn Progress) -> Result<(), SplatError> {
        // Shares and gains are those of a lens whose aperture is neither cut nor weighed.
        let is_shaped = self.character.shaper().is_some();
        let is_painted = !self.paint.is_standard();
        let is_summed_again = is_painted || is_shaped;
        let has_shares = self.has_shares();
        let standard = Stage::new(progress, 0.0, if is_summed_again { 0.5 } else { 1.0 });
        let painted = Stage::new(progress, if has_shares { 0.0 } else { 0.5 }, 1.0);
        if !has_shares {
            self.shares_of = None;
            let output =
                if is_summed_again { ResolveOutput::Shares } else { ResolveOutput::SharesAndPicture };
            // Where most is painted, summing all of it again is less work than painting over, and so it is on a card.
            let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
            let is_painted_over =
                is_painted && !is_shaped && !self.card.has_sums() && self.paint.is_of_less_than_half(nodes);
            let summed = if is_painted_over { SummedPaint::ToPaintOver } else { SummedPaint::Standard };
            self.in_finest_integers(|splatter| {
                splatter.sum_nodes(summed, &standard)?;
                splatter.resolve(splatter.frame(), output)
            })?;
            self.shares_of = Some((self.lens.clone(), self.finish() == Finish::Evened));
            if !is_summed_again || is_painted_over && self.paint_over()? {
                return Ok(());
            }
        }
        self.in_finest_integers(|splatter| {
            splatter.sum_nodes(SummedPaint::Painted, &painted)?;
            splatter.resolve(splatter.frame(), ResolveOutput::Picture)
        })
    }

    /// Whether the shares belong to the current lens, and all needed gains have been computed.
    fn has_shares(&self) -> bool {
        let is_current = |(lens, has_gains_of_all): &(LensInUse, bool)| {
            *lens == self.lens && (*has_gains_of_all || self.finish() != Finish::Evened)
        };
        self.shares_of.as_ref().is_some_and(is_current)
    }

    /// Does `work` with the finest integers that hold its sums.
    fn in_finest_integers(
        &mut self,
        work: impl Fn(&mut Self) -> Result<(), SplatError>,
    ) -> Result<(), SplatError> {
        // A draft's sums are hardly larger than those of the picture, whose hierarchy it shares.
        let shared = self.nodes.as_ref().filter(|_| self.halvings > 0);
        let mut scale = Some(shared.map_or(Scale::FINEST, |nodes| nodes.scale));
        while let (Some(finest), Some(nodes)) = (scale, &mut self.nodes) {
            if nodes.scale != finest {
                Arc::make_mut(nodes).rescale(finest);
            }
            match work(self) {
                Err(SplatError::Overflow) => scale = finest.coarser(),
                other => return other,
            }
        }
        Err(SplatError::Overflow)
    }

    fn sum_nodes(&mut self, summed: SummedPaint, progress: &dyn Progress) -> Result<(), SplatError> {
        let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
        let paint = summed.paint(&self.paint);
        let mut scene = self.aperture.scene(nodes, &self.lens, paint, self.size);
        if summed == SummedPaint::Painted {
            scene.pen.shaper = self.character.shaper();
        }
        if let Some(summed) = self.card.sum(&scene, progress) {
            return summed;
        }
        let then = (summed == SummedPaint::ToPaintOver).then_some(&self.paint);
        scene.list_all(then, &mut self.lists, &mut self.changes);
        Ok(self.sums.set(&scene.pen, &self.lists, &mut self.pace, progress)?)
    }

    /// Moves the given samples, in any order, to where `focus` now sends them. Returns the rows and columns of the picture
    /// outside of which nothing changed.
    ///
    /// Equal, bit for bit, to a render from scratch. Cost grows with the number of samples and the size of their splats.
    ///
    /// # Errors
    /// [`SplatError::Overflow`] if the picture is too bright for its integers.
    pub fn update(
        &mut self,
        focus: &dyn SurfaceField<FocusOffset>,
        samples: &[u32],
    ) -> Result<[Range<u32>; 2], SplatError> {
        let salf = self.salf.clone();
        self.update_focus(FocusOfSamples::of_surface(&salf.samples, focus), samples)
    }

    /// The same where the focus of every sample is known: `focus` is that of all of them, `samples` those whose focus has changed.
    ///
    /// # Panics
    /// If it is that of another number of samples.
    ///
    /// # Errors
    /// [`SplatError::Overflow`] if the picture is too bright for its integers.
    pub fn update_samples(
        &mut self,
        focus: &[FocusOffset],
        samples: &[u32],
    ) -> Result<[Range<u32>; 2], SplatError> {
        assert_eq!(focus.len(), self.salf.samples.len(), "a focus for each sample");
        self.update_focus(FocusOfSamples::Samples(focus), samples)
    }

    fn update_focus(
        &mut self,
        focus: FocusOfSamples,
        samples: &[u32],
    ) -> Result<[Range<u32>; 2], SplatError> {
        let window = self.update_channel(focus, samples)?;
        self.draw_colours(window, &progress::Unwatched, |colour, _| colour.update_channel(focus, samples))
    }

    /// The same of the one channel that it shows.
    fn update_channel(
        &mut self,
        focus: FocusOfSamples,
        samples: &[u32],
    ) -> Result<[Range<u32>; 2], SplatError> {
        let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
        assert_eq!(self.paint.blocks.len(), nodes.blocks.len(), "update follows a render");
        self.card.begin();
        let before = self.paint.update(nodes, &nodes.leaves_of(samples), focus);
        self.card.invalidate_paint();
        let scene = self.aperture.scene(nodes, &self.lens, &self.paint, self.size);
        let before = before.iter().map(|(block, paint)| (*block, paint.as_deref()));
        self.changes.update(&scene, &before.collect::<Vec<_>>());
        let mut window = self.changes.window(&scene.pen, self.size[0]);
        // Once nothing is painted any more, the picture is evened.
        if nodes.scale != Scale::FINEST || !self.has_shares() {
            return self.sum_again();
        }
        if !self.is_live {
            window = self.frame();
        }
        match self.change(window.clone()) {
            Ok(()) => Ok(window),
            Err(SplatError::Overflow) => self.sum_again(),
            Err(_) if self.drop_lost_card() => self.sum_again(),
            Err(other) => Err(other),
        }
    }

    /// Applies the listed changes to the sums, and resolves some rows and columns of the picture.
    fn change(&mut self, window: [Range<u32>; 2]) -> Result<(), SplatError> {
        let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
        let pen = Pen { shaper: self.character.shaper(), ..self.aperture.pen(nodes, &self.lens) };
        match self.card.change(&pen, &self.changes) {
            Some(changed) => changed?,
            None => self.sums.change(&pen, &self.changes, &self.pace),
        }
        self.resolve(window, ResolveOutput::Picture)
    }

    /// Paints over the sums of the standard picture. Returns whether that could be done.
    fn paint_over(&mut self) -> Result<bool, SplatError> {
        if self.nodes.as_ref().is_none_or(|nodes| nodes.scale != Scale::FINEST) {
            return Ok(false);
        }
        match self.change(self.frame()) {
            Err(SplatError::Overflow) => Ok(false),
            other => other.map(|()| true),
        }
    }

    /// Sums all with the paint as it is.
    fn sum_again(&mut self) -> Result<[Range<u32>; 2], SplatError> {
        self.sum(&progress::Unwatched)?;
        Ok(self.frame())
    }

    /// Integrates the sums in some rows and columns; on a card in whole rows.
    fn resolve(&mut self, [rows, columns]: [Range<u32>; 2], output: ResolveOutput) -> Result<(), SplatError> {
        if rows.is_empty() || columns.is_empty() {
            return Ok(());
        }
        if self.card.has_sums() {
            return self.resolve_on_card(rows, output);
        }
        let finish = self.finish();
        let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
        let window = [rows, columns];
        self.resolver.resolve(nodes, &self.sums, window.clone(), output, finish)?;
        if output.has_picture() {
            self.character.darken(&mut self.resolver.picture, window);
        }
        Ok(())
    }

    /// The same on the card.
    fn resolve_on_card(&mut self, rows: Range<u32>, output: ResolveOutput) -> Result<(), SplatError> {
        let finish = self.finish();
        let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
        if output.has_shares() {
            self.resolver.balance.gains = self.card.find_shares(nodes)?;
        }
        if output.has_picture() {
            let Resolver { balance, picture, .. } = &mut self.resolver;
            self.card.make_picture(nodes, rows, finish, &balance.gains, picture)?;
        }
        Ok(())
    }

    /// Goes on without a card that was lost. Returns whether one was.
    fn drop_lost_card(&mut self) -> bool {
        let was_lost = self.card.is_lost();
        if was_lost {
            self.card.replace(None);
            self.shares_of = None;
        }
        was_lost
    }

    /// How large its picture is beside that of the light field.
    fn draft_scale(&self) -> DraftScale {
        let of_field = [self.salf.camera.width, self.salf.camera.height];
        let sides = [0, 1].map(|axis| f64::from(self.size[axis]) / f64::from(of_field[axis]));
        DraftScale { halvings: self.halvings, sides }
    }

    /// All rows and columns.
    fn frame(&self) -> [Range<u32>; 2] {
        [0..self.size[1], 0..self.size[0]]
    }
}

#[cfg(test)]
mod tests;
