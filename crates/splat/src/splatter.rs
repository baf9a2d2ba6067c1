//! The picture as a running integer sum that single samples can leave and enter.

mod on_card;

use crate::balance::{Balance, Scaled};
use crate::bands::Pace;
use crate::draw::Pen;
use crate::drawn::{BlockList, Changes, Scene};
use crate::lens_in_use::{LensInUse, Tolerance};
use crate::nodes::{Nodes, Scale};
use crate::paint::{Paint, STANDARD};
use crate::partition::{Parts, Pixels, Share};
use crate::resolve::{BLACK, Overflow, Room, Window};
use crate::seen::{Seen, seen};
use crate::shape::Shape;
use crate::stencil::Stencils;
use crate::sums::{RESOLVE_ROWS, SumMarks, Sums};
use lens::{Aperture, Camera, FocusOffset, Picture};
use on_card::Card;
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use salf::Salf;
use scene::SurfaceField;
use std::ops::Range;
use std::sync::Arc;

/// Why a picture could not be summed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplatError {
    /// Nobody wants it any more.
    #[error("cancelled")]
    Cancelled,
    /// The integer sum could overflow.
    #[error("the scene's radiance is too high to be summed exactly (keep the brightest light below 1e6)")]
    Overflow,
}

impl From<Cancelled> for SplatError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<Overflow> for SplatError {
    fn from(_: Overflow) -> Self {
        Self::Overflow
    }
}

/// A SALF being looked at: sums that follow the focus as it is painted.
pub struct Splatter {
    salf: Arc<Salf>,
    /// The hierarchy, which twins share; none if a sample is too bright.
    nodes: Option<Arc<Nodes>>,
    tolerance: Tolerance,
    /// Whether paint changes what it moves and nothing else.
    is_live: bool,
    aperture: Arc<ApertureInUse>,
    lens: LensInUse,
    paint: Paint,
    sums: Sums,
    /// Of [`RESOLVE_ROWS`] rows each, of what is free and of what shares the rest.
    marks: Vec<[SumMarks; 2]>,
    /// What was drawn of each block when all was summed last; room for what is.
    lists: Vec<BlockList>,
    /// How long that took.
    pace: Pace,
    /// Room for what changes.
    changes: Changes,
    /// What each pixel's sums are multiplied by.
    shares: Vec<Share>,
    /// What gives back the light that shares take.
    balance: Balance,
    /// The lens whose standard picture they are those of, and whether the gains that evening needs are among those found.
    shares_of: Option<(LensInUse, bool)>,
    picture: Picture,
    card: Card,
}

/// What depends on the aperture's shape, and on how far it is stopped down from the baked one.
struct ApertureInUse {
    aperture: Aperture,
    stop: f64,
    stencils: Stencils,
    seen: Vec<Seen>,
}

impl ApertureInUse {
    fn new(aperture: &Aperture, stop: f64, nodes: Option<&Nodes>) -> Self {
        let shape = Shape::new(aperture);
        // A pinhole sees what its chief ray sees.
        let seen = nodes.map_or_else(Vec::new, |nodes| seen(nodes, &shape, stop.max(1e-3)));
        Self { aperture: aperture.clone(), stop, stencils: Stencils::new(shape), seen }
    }
}

impl ApertureInUse {
    /// What nodes are drawn with.
    fn pen<'a>(&'a self, nodes: &'a Nodes, lens: &LensInUse) -> Pen<'a> {
        Pen::new(nodes, &self.stencils, &self.seen, self.stop, lens.detail)
    }

    /// What is summed of `camera`'s picture.
    fn scene<'a>(
        &'a self,
        nodes: &'a Nodes,
        lens: &'a LensInUse,
        paint: &'a Paint,
        camera: &Camera,
    ) -> Scene<'a> {
        Scene { pen: self.pen(nodes, lens), lens, paint, size: [camera.width, camera.height] }
    }
}

impl Splatter {
    /// Prepares to render `salf`. The picture is black until [`Self::render`].
    pub fn new(salf: Arc<Salf>) -> Self {
        let nodes = Nodes::new(&salf, Scale::FINEST).map(Arc::new);
        let aperture = ApertureInUse::new(&salf.camera.aperture, 1.0, nodes.as_deref());
        Self::of(salf, nodes, Arc::new(aperture))
    }

    /// Another one of the same light field, with sums of its own: quick to make, since the hierarchy is shared. It renders as
    /// one that is new, on the same card.
    pub fn twin(&self) -> Self {
        let mut twin = Self::of(self.salf.clone(), self.nodes.clone(), self.aperture.clone());
        twin.use_card_of(self);
        twin.set_live(self.is_live);
        twin
    }

    fn of(salf: Arc<Salf>, nodes: Option<Arc<Nodes>>, aperture: Arc<ApertureInUse>) -> Self {
        let camera = &salf.camera;
        let (width, height) = (camera.width as usize, camera.height as usize);
        let tolerance = Tolerance::default();
        let shape = &aperture.stencils.shape;
        let has_bright = nodes.as_ref().is_some_and(|nodes| nodes.has_bright);
        let sums = Sums::new([width, height], has_bright);
        let rows_of_chunk = |first: usize| first as i32..(first + RESOLVE_ROWS).min(height) as i32;
        let chunks = (0..height).step_by(RESOLVE_ROWS).map(rows_of_chunk);
        Self {
            lens: LensInUse::new(camera.optics(), shape, tolerance),
            aperture,
            tolerance,
            is_live: false,
            paint: Paint::default(),
            marks: chunks.map(|rows| sums.marks(rows)).collect(),
            sums,
            lists: Vec::new(),
            pace: Pace::default(),
            changes: Changes::default(),
            shares: vec![Share::NONE; width * height],
            balance: Balance::none([width, height]),
            shares_of: None,
            picture: Picture::black(camera.width, camera.height),
            card: Card::default(),
            nodes,
            salf,
        }
    }

    /// How coarse the sum may be.
    pub fn tolerance(&self) -> Tolerance {
        self.tolerance
    }

    /// Sets how coarse the sum may be, from the next [`Self::render`] on.
    pub fn set_tolerance(&mut self, tolerance: Tolerance) {
        self.tolerance = tolerance;
    }

    /// Sets whether pictures are live (no, by default): paint then changes what it moves and nothing else, so that an update
    /// makes no more of the picture than that.
    ///
    /// Others are finished: of one without any paint the coverage is evened out, to 1 but for holes; of one that is painted
    /// what shares is scaled until the light is all that was thrown at it. The two differ by the ripple of finite samples; once divided
    /// by their coverage, by nothing but how they give light back ([`crate::balance`]). From the next [`Self::render`] on.
    pub fn set_live(&mut self, is_live: bool) {
        self.is_live = is_live;
    }

    /// Whether the picture is evened out.
    fn is_evened(&self) -> bool {
        !self.is_live && self.paint.is_standard()
    }

    /// Whether all that sharing takes is given back as the scene is painted.
    fn is_balanced(&self) -> bool {
        !self.is_live && !self.paint.is_standard()
    }

    /// What cuts the aperture's image in all sizes that paint may give it, on any thread, while this goes on. Otherwise a size
    /// is cut when it is first seen, a third of a millisecond each: the first dabs would wait for that.
    pub fn prepare(&self) -> impl FnOnce(&dyn Progress) + Send + use<> {
        let aperture = self.aperture.clone();
        move |progress| aperture.stencils.cut_all(progress)
    }

    /// The light field.
    pub fn salf(&self) -> &Arc<Salf> {
        &self.salf
    }

    /// The picture as it now is, or was when it was [fetched](Self::fetch) last.
    pub fn picture(&self) -> &Picture {
        &self.picture
    }

    /// Bytes of the hierarchy and of the sums, a card's and the lists of what is drawn among them; the light field's own
    /// are not.
    pub fn bytes(&self) -> [usize; 2] {
        let [nodes, sums] = self.card.bytes();
        let lists: usize = self.lists.iter().map(BlockList::bytes).sum();
        let marks: usize =
            self.marks.iter().flatten().map(|(dim, bright)| dim.bytes() + bright.bytes()).sum();
        [
            nodes + self.nodes.as_ref().map_or(0, |nodes| nodes.bytes()),
            sums + self.sums.bytes() + self.balance.bytes() + lists + self.changes.bytes() + marks,
        ]
    }

    /// Sums the whole picture for a lens (`camera` may differ from the baked one in focus distance, aperture shape and a
    /// smaller aperture radius, nothing else) and a focus.
    ///
    /// After an error the picture is that of before, but the sums are not: render again before updating.
    pub fn render(
        &mut self,
        camera: &Camera,
        focus: &dyn SurfaceField<FocusOffset>,
        progress: &dyn Progress,
    ) -> Result<(), SplatError> {
        self.take_up(camera);
        let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
        self.paint = Paint::look_up(nodes, &self.salf.samples, focus);
        self.card.forget_paint();
        self.sum(progress)
    }

    /// Sums the whole picture for another lens, with the focus of before.
    pub fn refocus(&mut self, camera: &Camera, progress: &dyn Progress) -> Result<(), SplatError> {
        self.take_up(camera);
        let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
        assert_eq!(self.paint.blocks.len(), nodes.blocks.len(), "refocus follows a render");
        self.sum(progress)
    }

    /// Puts on a lens.
    fn take_up(&mut self, camera: &Camera) {
        let (optics, baked_radius) = (camera.optics(), self.salf.camera.aperture_radius);
        let stop = LensInUse::stop(&optics, baked_radius);
        if (&self.aperture.aperture, self.aperture.stop) != (&camera.aperture, stop) {
            self.aperture = Arc::new(ApertureInUse::new(&camera.aperture, stop, self.nodes.as_deref()));
            self.shares_of = None;
            self.card.forget_aperture();
        }
        self.lens = LensInUse::new(optics, &self.aperture.stencils.shape, self.tolerance);
    }

    /// Sums all and resolves the picture; on the processor once the card is lost.
    fn sum(&mut self, progress: &dyn Progress) -> Result<(), SplatError> {
        self.take_up_card();
        self.card.begin();
        let summed = self.sum_all(progress);
        if !self.drop_lost_card() {
            return summed;
        }
        self.sum_all(progress)
    }

    fn sum_all(&mut self, progress: &dyn Progress) -> Result<(), SplatError> {
        let is_painted = !self.paint.is_standard();
        let has_shares = self.has_shares();
        let standard = Stage::new(progress, 0.0, if is_painted { 0.5 } else { 1.0 });
        let painted = Stage::new(progress, if has_shares { 0.0 } else { 0.5 }, 1.0);
        if !has_shares {
            self.shares_of = None;
            let wanted = if is_painted { Wanted::Shares } else { Wanted::SharesAndPicture };
            // Where most is painted, summing all of it again is less work than painting over, and so it is on a card.
            let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
            let is_painted_over =
                is_painted && !self.card.has_sums() && self.paint.is_of_less_than_half(nodes);
            let summed = if is_painted_over { Summed::ToPaintOver } else { Summed::Standard };
            self.in_finest_integers(|splatter| {
                splatter.sum_nodes(summed, &standard)?;
                splatter.resolve(splatter.frame(), wanted)
            })?;
            self.shares_of = Some((self.lens.clone(), self.is_evened()));
            if !is_painted || is_painted_over && self.paint_over()? {
                return Ok(());
            }
        }
        self.in_finest_integers(|splatter| {
            splatter.sum_nodes(Summed::Painted, &painted)?;
            splatter.resolve(splatter.frame(), Wanted::Picture)
        })
    }

    /// Whether the shares are those of the lens, and all gains that are needed are known.
    fn has_shares(&self) -> bool {
        let is_known = |(lens, has_gains_of_all): &(LensInUse, bool)| {
            *lens == self.lens && (*has_gains_of_all || !self.is_evened())
        };
        self.shares_of.as_ref().is_some_and(is_known)
    }

    /// Does `work` with the finest integers that hold its sums.
    fn in_finest_integers(
        &mut self,
        work: impl Fn(&mut Self) -> Result<(), SplatError>,
    ) -> Result<(), SplatError> {
        let mut scale = Some(Scale::FINEST);
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

    fn sum_nodes(&mut self, summed: Summed, progress: &dyn Progress) -> Result<(), SplatError> {
        if let Some(summed) = self.sum_nodes_on_card(summed, progress) {
            return summed;
        }
        let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
        let paint = summed.paint(&self.paint);
        let then = (summed == Summed::ToPaintOver).then_some(&self.paint);
        let scene = self.aperture.scene(nodes, &self.lens, paint, &self.salf.camera);
        scene.list_all(then, &mut self.lists, &mut self.changes);
        Ok(self.sums.set(&scene.pen, &self.lists, &mut self.pace, progress)?)
    }

    /// Moves the given samples, in any order, to where `focus` now sends them. Returns the rows and columns of the picture
    /// outside of which nothing changed.
    ///
    /// Equal, bit for bit, to a render from scratch. Cost grows with the number of samples and the size of their splats.
    pub fn update(
        &mut self,
        focus: &dyn SurfaceField<FocusOffset>,
        samples: &[u32],
    ) -> Result<[Range<u32>; 2], SplatError> {
        let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
        assert_eq!(self.paint.blocks.len(), nodes.blocks.len(), "update follows a render");
        let mut leaves: Vec<u32> =
            samples.iter().map(|&sample| nodes.node_of_sample[sample as usize]).collect();
        leaves.par_sort_unstable();
        self.card.begin();
        let before = self.paint.update(nodes, &leaves, &self.salf.samples, focus);
        self.card.forget_paint();
        let scene = self.aperture.scene(nodes, &self.lens, &self.paint, &self.salf.camera);
        let before = before.iter().map(|(block, paint)| (*block, paint.as_deref()));
        self.changes.find(&scene, &before.collect::<Vec<_>>());
        let mut window = self.changes.window(nodes, self.salf.camera.width);
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

    /// Makes the changes that were found to the sums, and some rows and columns of the picture.
    fn change(&mut self, window: [Range<u32>; 2]) -> Result<(), SplatError> {
        if let Some(changed) = self.change_on_card() {
            changed?;
        } else {
            let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
            let pen = self.aperture.pen(nodes, &self.lens);
            self.sums.change(&pen, &self.changes, &self.pace);
        }
        self.resolve(window, Wanted::Picture)
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
    fn resolve(&mut self, [rows, columns]: [Range<u32>; 2], wanted: Wanted) -> Result<(), SplatError> {
        if rows.is_empty() || columns.is_empty() {
            return Ok(());
        }
        if let Some(resolved) = self.resolve_on_card(rows.clone(), wanted) {
            return resolved;
        }
        if !wanted.has_shares() {
            if !self.is_balanced() {
                return self.resolve_here([rows, columns], wanted);
            }
            // All of the picture: it is not live.
            self.resolve_here(self.frame(), Wanted::Shared)?;
            self.balance.find_rest();
            return self.resolve_here(self.frame(), Wanted::PictureOverShared);
        }
        // What is evened out is only multiplied by the gains, once they are known.
        self.balance.forget();
        let may_scale = wanted.has_picture() && self.is_evened();
        self.resolve_here([rows.clone(), columns.clone()], if may_scale { wanted } else { Wanted::Shares })?;
        self.balance.settle();
        match wanted {
            Wanted::SharesAndPicture if !may_scale => self.resolve_here([rows, columns], Wanted::Picture),
            Wanted::SharesAndPicture => {
                self.balance.gains.scale(&mut self.picture.radiance);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The same on the processor, with the gains as they are.
    fn resolve_here(&mut self, [rows, columns]: [Range<u32>; 2], wanted: Wanted) -> Result<(), SplatError> {
        let nodes = self.nodes.as_ref().ok_or(SplatError::Overflow)?;
        let width = self.salf.camera.width as usize;
        // The same chunks whatever rows are asked for.
        let chunks = rows.start as usize / RESOLVE_ROWS..(rows.end as usize).div_ceil(RESOLVE_ROWS);
        let (sums, knots) = (&self.sums, &self.balance.knots);
        let (gains, rest) = (&self.balance.gains, self.balance.rest);
        let is_evened = self.is_evened();
        // Shares need none; gains of all of the light do.
        let wants_colour = wanted != Wanted::Shares || is_evened;
        let scaled = if is_evened { Scaled::All } else { Scaled::Sharing };
        let radiance = self.picture.radiance.par_chunks_mut(RESOLVE_ROWS * width);
        let coverage = self.picture.coverage.par_chunks_mut(RESOLVE_ROWS * width);
        let shares = self.shares.par_chunks_mut(RESOLVE_ROWS * width);
        let of_knots = self.balance.rows.par_chunks_mut(RESOLVE_ROWS * knots.columns());
        let of_spans = self.balance.shared.par_chunks_mut(RESOLVE_ROWS * knots.spans());
        let sums_of_rows = of_knots.zip(of_spans);
        let all = radiance.zip(coverage).zip(shares.zip(sums_of_rows)).zip(&mut self.marks).enumerate();
        let chunks = all.skip(chunks.start).take(chunks.len());
        chunks.try_for_each_init(
            Room::default,
            |room, (chunk, (((radiance, coverage), (shares, (of_knots, of_spans))), marks))| {
                let first = (chunk * RESOLVE_ROWS) as u32;
                let here = rows.start.max(first)..rows.end.min(first + (coverage.len() / width) as u32);
                let signed = |range: &Range<u32>| range.start as i32..range.end as i32;
                let window = Window { rows: signed(&here), columns: signed(&columns) };
                let [free_marks, sharing_marks] = marks;
                let [mut free, mut sharing] = [None, None];
                if wanted.has_free() {
                    let rows = sums.free.rows(nodes, &window, free_marks, room)?;
                    free = Some(if wants_colour { rows } else { rows.of_coverage() });
                }
                if wanted.has_sharing() {
                    sharing = Some(sums.sharing.rows(nodes, &window, sharing_marks, room)?);
                }
                let mut lines = [room.take(columns.len()), room.take(columns.len())];
                lines.iter_mut().for_each(|line| line.fill(BLACK));
                for row in here {
                    for (rows, line) in [&mut free, &mut sharing].into_iter().zip(&mut lines) {
                        rows.as_mut().map_or(Ok(()), |rows| rows.read(row as i32, line))?;
                    }
                    let parts = Parts { free: &lines[0], sharing: &lines[1] };
                    let at = (row - first) as usize;
                    let here = at * width + columns.start as usize..at * width + columns.end as usize;
                    let shares = &mut shares[here.clone()];
                    if wanted.has_shares() {
                        parts.find_shares(shares);
                        let sums = &mut of_knots[at * knots.columns()..][..knots.columns()];
                        knots.sum_row(parts, shares, sums, is_evened);
                    }
                    let pixels = Pixels {
                        first: columns.start as usize,
                        radiance: &mut radiance[here.clone()],
                        coverage: &mut coverage[here],
                    };
                    let gains = || gains.of_row(row as usize, scaled);
                    match wanted {
                        Wanted::Shares => (),
                        Wanted::SharesAndPicture => parts.join(shares, None, is_evened, pixels),
                        Wanted::Picture => parts.join(shares, Some(&gains()), is_evened, pixels),
                        Wanted::Shared => {
                            let sums = &mut of_spans[at * knots.spans()..][..knots.spans()];
                            parts.share(shares, &gains(), pixels, sums);
                        }
                        Wanted::PictureOverShared => parts.join_shared(rest, pixels),
                    }
                }
                lines.into_iter().for_each(|line| room.give_back(line));
                [free, sharing].into_iter().flatten().for_each(|rows| rows.give_back(room));
                Ok(())
            },
        )
    }

    /// All rows and columns.
    fn frame(&self) -> [Range<u32>; 2] {
        [0..self.salf.camera.height, 0..self.salf.camera.width]
    }
}

/// What is summed.
#[derive(Clone, Copy, PartialEq)]
enum Summed {
    /// All, with nothing painted.
    Standard,
    /// The same; and the changes that make it all as it is painted are found.
    ToPaintOver,
    /// All as it is painted.
    Painted,
}

impl Summed {
    /// What the nodes are painted with while they are summed, of what they are to be painted with.
    fn paint(self, paint: &Paint) -> &Paint {
        if self == Self::Painted { paint } else { &STANDARD }
    }
}

/// What is made of the sums.
#[derive(Clone, Copy, PartialEq)]
enum Wanted {
    /// What each pixel is multiplied by, from the sums of the standard picture.
    Shares,
    Picture,
    /// Both, before the gains are known.
    SharesAndPicture,
    /// Only the light that shares, in the place of the picture; and how much it is.
    Shared,
    /// The picture, in the place of the light that shares.
    PictureOverShared,
}

impl Wanted {
    fn has_shares(self) -> bool {
        matches!(self, Self::Shares | Self::SharesAndPicture)
    }

    fn has_picture(self) -> bool {
        matches!(self, Self::Picture | Self::SharesAndPicture)
    }

    fn has_free(self) -> bool {
        self != Self::Shared
    }

    fn has_sharing(self) -> bool {
        self != Self::PictureOverShared
    }
}

#[cfg(test)]
mod tests;
