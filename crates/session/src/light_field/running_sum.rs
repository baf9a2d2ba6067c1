//! A baked light field with its running sum, and how the sum is brought up to date.

use crate::display::{PictureSource, Rectangle};
use crate::error::SessionError;
use crate::light_field::aperture_fit::{ApertureFit, is_spare_for};
use crate::light_field::changes::Changes;
use crate::light_field::draft::Draft;
use crate::light_field::margin_reach::MarginReach;
use crate::light_field::sample_index::SampleIndex;
use document::Stage;
use focus::Focus;
use graphics_card::Gpu;
use lens::{Camera, Picture};
use light::LightQuality;
use progress::{Progress, Stage as Share};
use render::{Modelled, is_compatible};
use salf::{BakeOptions, Carried, Salf};
use scene::SurfaceField;
use sight_on_card::CardSight;
use splat::{SplatError, Splatter, Tolerance};
use std::sync::Arc;
use std::time::Instant;
use trace::SightDevice;

/// The margin is baked this much wider than the paint needs, in picture heights, so that the next strokes find
/// room: a tenth of the height is a circle of confusion as wide as paint usually gives.
const MARGIN_HEADROOM: f64 = 0.1;

/// When more than this share of the samples move, a whole sum is quicker: it runs on all cores, and removes nothing.
const LARGEST_UPDATE: f64 = 0.25;

/// How to bring a sum up to date.
pub(crate) enum Plan {
    /// Move these samples.
    Move(Vec<u32>),
    /// Compute the whole sum.
    Whole,
}

/// How a sum was brought up to date.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum SumUpdate {
    /// It was up to date.
    Unchanged,
    /// Some samples were moved: the picture changed in this rectangle.
    Region(Rectangle),
    /// The whole sum was computed.
    Whole,
}

/// How a light field is baked and summed.
#[derive(Clone, Debug)]
pub(crate) struct FieldOptions {
    /// Minimum margin, px.
    pub least_margin_px: f64,
    /// Tolerance of its sums.
    pub tolerance: Tolerance,
    /// The graphics card to sum on; `None`: the processor.
    pub gpu: Option<Gpu>,
    /// The graphics card to bake on; `None`: the processor.
    pub bake_on: Option<Gpu>,
    /// Quality of the scene's light.
    pub light: LightQuality,
}

/// A baked light field with an index of its samples.
#[derive(Clone)]
pub(crate) struct BakedField {
    pub salf: Arc<Salf>,
    pub index: Arc<SampleIndex>,
}

/// A light field and its running sum.
pub(crate) struct LightField {
    splatter: Splatter,
    index: Arc<SampleIndex>,
    modelled: Modelled,
    /// Whether carried light may be where paint has moved it.
    has_moved_carried: bool,
    /// The lens of the sum; none while there is no valid sum.
    summed_camera: Option<Camera>,
    /// The picture of a lens that focuses colours unlike, with green's coverage for all: what the window shows normalised.
    one_coverage: Option<Picture>,
    /// Changes that the sum does not include yet.
    pending_changes: Changes,
    /// Which samples reach further than the margin; `None` until requested, and after a whole sum.
    reach: Option<MarginReach>,
    /// Time of the last whole sum, s.
    whole_seconds: f64,
    /// What draws drafts, once one was asked for.
    draft: Option<Draft>,
    /// Number of passes by which its light was refined; 0 for cached light.
    light_passes: u32,
}

/// Share of a bake's progress for solving light, which mostly was solved before.
const LIGHT_SHARE: f32 = 0.05;

impl LightField {
    /// Bakes a light field for `camera` and `focus`, with a margin that allows for some change.
    ///
    /// # Errors
    /// The light cannot be solved, or the work was cancelled.
    pub fn bake(
        stage: &Stage,
        camera: &Camera,
        focus: &Focus,
        field_options: FieldOptions,
        progress: &dyn Progress,
    ) -> Result<Self, SessionError> {
        let needed = BakeOptions::for_focus(stage.tracer(), camera, focus)
            .margin_px
            .max(field_options.least_margin_px);
        let margin_px = needed + MARGIN_HEADROOM * camera.height as f64;
        let is_rough = field_options.light == LightQuality::Rough;
        let splat_cells = if is_rough { BakeOptions::ROUGH_SPLAT_CELLS } else { BakeOptions::SPLAT_CELLS };
        let carried = Carried::for_focus(focus);
        let options = BakeOptions { margin_px, carried, splat_cells, ..BakeOptions::default() };
        let solving = Share::new(progress, 0.0, LIGHT_SHARE);
        let radiance = stage.lit.solve(camera, field_options.light, &solving)?;
        let baking = Share::new(progress, LIGHT_SHARE, 1.0);
        let sight = field_options.bake_on.map(CardSight::new);
        let device = sight.as_ref().map(|sight| sight as &dyn SightDevice);
        let (salf, _) = salf::bake_on(device, stage.tracer(), &*radiance, camera, &options, &baking)?;
        let passes = if let LightQuality::Refined { passes } = field_options.light { passes } else { 0 };
        Ok(Self {
            light_passes: passes,
            ..Self::from_salf(stage, Arc::new(salf), field_options.tolerance, field_options.gpu)
        })
    }

    /// The memory of the light field with its index, and of the sum, in bytes.
    pub fn bytes(&self) -> [usize; 2] {
        let [nodes, sums] = self.splatter.bytes();
        let draft = self.draft.as_ref().map_or(0, Draft::bytes);
        [self.index.bytes_with_samples() + nodes, sums + draft]
    }

    /// The light field, with the number of passes by which its light was refined.
    pub fn refined(self, light_passes: u32) -> Self {
        Self { light_passes, ..self }
    }

    /// Number of passes by which its light was refined; 0 for cached light.
    pub fn light_passes(&self) -> u32 {
        self.light_passes
    }

    /// The light field `salf`, baked before for `stage`; summed on `gpu`, or on the processor if `None`.
    pub fn from_salf(stage: &Stage, salf: Arc<Salf>, tolerance: Tolerance, gpu: Option<Gpu>) -> Self {
        let index = Arc::new(SampleIndex::new(salf.clone(), stage.atlas.clone()));
        let modelled = Modelled::with_texels(&salf, stage.tracer(), Some(&stage.texels.texels));
        Self::resting(salf, index, modelled, tolerance, gpu)
    }

    /// The same light field, hierarchy and paint without its sum, which is made again when it is needed.
    pub fn at_rest(self, gpu: Option<Gpu>) -> Self {
        self.resting_with(Splatter::without_sums, gpu)
    }

    /// The same; `next`, which is worked with instead, takes over the memory of the sum.
    pub fn at_rest_for(self, next: &mut Self, gpu: Option<Gpu>) -> Self {
        next.summed_camera = None;
        self.resting_with(|splatter| splatter.without_sums_but_for(&mut next.splatter), gpu)
    }

    fn resting_with(self, without_sums: impl FnOnce(Splatter) -> Splatter, gpu: Option<Gpu>) -> Self {
        let tolerance = self.splatter.tolerance();
        let splatter = without_sums(self.splatter);
        let resting = Self::with_splatter(splatter, self.index, self.modelled, tolerance, gpu);
        Self {
            whole_seconds: self.whole_seconds,
            pending_changes: self.pending_changes,
            has_moved_carried: self.has_moved_carried,
            ..resting.refined(self.light_passes)
        }
    }

    /// Looks up the paint of all samples, so that the next sum need not.
    pub fn look_up_paint(&mut self, focus: &Focus) {
        self.splatter.look_up_paint(focus);
        self.has_moved_carried = focus.affects_carried_light();
        self.pending_changes = Changes::default();
    }

    /// Takes the time that a whole sum of another light field of the same view took for that of its own, unless it knows better.
    pub fn expect_pace_of(&mut self, other: &Self) {
        if self.whole_seconds.is_infinite() {
            self.whole_seconds = other.whole_seconds;
        }
    }

    /// Looks up the paint that has changed.
    fn take_up_paint(&mut self, focus: &Focus) {
        match self.few_changed_samples(focus) {
            None => self.look_up_paint(focus),
            Some(samples) if samples.is_empty() => {}
            Some(samples) => {
                self.splatter.update_paint(focus, &samples);
                self.has_moved_carried |= focus.affects_carried_light();
                self.pending_changes = Changes::default();
            }
        }
    }

    /// A draft of the picture for a lens and a focus: smaller, so that it takes a twentieth of a second if possible. The sum itself is to be
    /// made again.
    ///
    /// # Errors
    /// The sum overflows, or the work was cancelled.
    pub fn sum_draft(
        &mut self,
        camera: &Camera,
        focus: &Focus,
        progress: &dyn Progress,
    ) -> Result<&Picture, SessionError> {
        self.summed_camera = None;
        self.take_up_paint(focus);
        Draft::sum(&mut self.draft, (&self.splatter, self.whole_seconds), camera, progress)
    }

    /// A light field that is not summed.
    pub(super) fn resting(
        salf: Arc<Salf>,
        index: Arc<SampleIndex>,
        modelled: Modelled,
        tolerance: Tolerance,
        gpu: Option<Gpu>,
    ) -> Self {
        Self::with_splatter(Splatter::new(salf), index, modelled, tolerance, gpu)
    }

    fn with_splatter(
        mut splatter: Splatter,
        index: Arc<SampleIndex>,
        modelled: Modelled,
        tolerance: Tolerance,
        gpu: Option<Gpu>,
    ) -> Self {
        splatter.set_tolerance(tolerance);
        // The first dab on it is to cost what any dab does.
        splatter.set_live(true);
        // Without a card, or one that works, the processor sums.
        splatter.use_gpu(gpu);
        splatter.keep_on_card(true);
        Self::unsummed(splatter, index, modelled)
    }

    fn unsummed(splatter: Splatter, index: Arc<SampleIndex>, modelled: Modelled) -> Self {
        Self {
            splatter,
            index,
            modelled,
            has_moved_carried: false,
            summed_camera: None,
            one_coverage: None,
            pending_changes: Changes::default(),
            reach: None,
            whole_seconds: f64::INFINITY,
            draft: None,
            light_passes: 0,
        }
    }

    /// The same light field and hierarchy, to be summed without tolerance.
    pub fn exact(&self) -> Self {
        let twin = Self::unsummed(self.splatter.twin(), self.index.clone(), self.modelled);
        twin.refined(self.light_passes)
    }

    /// See [`Splatter::release_room`].
    pub fn release_room(&mut self) {
        self.draft = None;
        self.splatter.release_room();
    }

    /// See [`Splatter::prepare`].
    pub fn prepare(&self) -> impl FnOnce(&dyn Progress) + Send + use<> {
        self.splatter.prepare()
    }

    /// Whether it is the same light field, whatever is painted on it.
    pub fn is_twin_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(self.splatter.salf(), other.splatter.salf())
    }

    /// The memory of its sums, in bytes; twins share all else.
    pub fn summing_bytes(&self) -> usize {
        let [_, sums] = self.splatter.bytes();
        sums
    }

    /// Sets how coarse sums may be: with another tolerance the next one is made whole.
    pub fn set_tolerance(&mut self, tolerance: Tolerance) {
        if tolerance != self.splatter.tolerance() {
            self.splatter.set_tolerance(tolerance);
            self.summed_camera = None;
        }
    }

    /// The size of its picture: columns and rows.
    pub fn size(&self) -> [u32; 2] {
        let camera = &self.splatter.salf().camera;
        [camera.width, camera.height]
    }

    /// Whether the light field holds all that `camera` sees.
    pub fn can_show(&self, camera: &Camera) -> bool {
        is_compatible(&self.splatter.salf().camera, camera)
    }

    /// How well its aperture fits that of `camera`; `None` if it cannot show what `camera` sees, not even with its aperture stretched.
    pub fn aperture_fit(&self, camera: &Camera) -> Option<ApertureFit> {
        ApertureFit::new(&self.splatter.salf().camera, camera)
    }

    /// Whether the lens of `camera` can be opened by a stop, and the light field still holds all that it sees.
    pub fn is_spare_for(&self, camera: &Camera) -> bool {
        is_spare_for(&self.splatter.salf().camera, camera)
    }

    /// Whether another bake would be better: paint or lens spreads light from further outside the
    /// frame, the aperture has become much smaller or larger than the one whose cells were looked through, or paint has come to move
    /// carried light, which was told only as finely as the ordinary lens shows it. The least margin, px, of that bake.
    ///
    /// Quick after an update; after a whole sum every sample is looked at, unless [`Self::survey`] has done it.
    pub fn rebake_margin_px(&mut self, camera: &Camera, focus: &Focus) -> Option<f64> {
        self.survey(camera, focus);
        let salf = self.splatter.salf();
        let exceeded = self.reach.as_ref().filter(|reach| reach.is_exceeded());
        let is_poor = ApertureFit::new(&salf.camera, camera).is_some_and(ApertureFit::is_poor);
        let needed_px = exceeded.map(|reach| reach.needed_px(salf, camera, focus));
        let is_coarse = salf.carried < Carried::for_focus(focus);
        needed_px.or((is_poor || is_coarse).then_some(0.0))
    }

    /// Looks how far samples reach, those of which that is not known. It must be summed for this lens and focus.
    pub fn survey(&mut self, camera: &Camera, focus: &Focus) {
        let salf = self.splatter.salf();
        match &mut self.reach {
            Some(reach) => reach.retest_moved(salf, camera, focus),
            None => self.reach = Some(MarginReach::survey(&self.splatter, camera)),
        }
    }

    /// Notes changes of the focus map, for the next update.
    pub fn note(&mut self, changes: &Changes) {
        self.pending_changes.join(changes);
    }

    /// What it takes to bring the sum to a lens, a focus and all changes.
    pub fn plan(&self, camera: &Camera, focus: &Focus) -> Plan {
        if self.summed_camera.as_ref() != Some(camera) {
            return Plan::Whole;
        }
        self.few_changed_samples(focus).map_or(Plan::Whole, Plan::Move)
    }

    /// The samples whose paint has changed since it was looked up; `None` if these are many, or it was never looked up.
    fn few_changed_samples(&self, focus: &Focus) -> Option<Vec<u32>> {
        let Changes::Texels(texels) = &self.pending_changes else { return None };
        if !self.splatter.has_paint() {
            return None;
        }
        let mut samples = self.index.samples_reading(texels);
        if self.has_moved_carried || focus.affects_carried_light() {
            samples.extend(self.index.carried_reading(texels));
        }
        let most = LARGEST_UPDATE * self.splatter.salf().samples.len() as f64;
        Some(samples).filter(|samples| samples.len() as f64 <= most)
    }

    /// Whether the sum shows this lens and all changes.
    pub fn is_up_to_date(&self, camera: &Camera) -> bool {
        self.summed_camera.as_ref() == Some(camera) && self.pending_changes.is_none()
    }

    /// Seconds that the last whole sum took; infinite before the first.
    pub fn whole_seconds(&self) -> f64 {
        self.whole_seconds
    }

    /// Brings the sum to a lens and a focus. After an error the next call makes the whole sum.
    ///
    /// # Errors
    /// The sum overflows, or the work was cancelled.
    pub fn update_sum(
        &mut self,
        camera: &Camera,
        focus: &Focus,
        progress: &dyn Progress,
    ) -> Result<SumUpdate, SessionError> {
        let plan = self.plan(camera, focus);
        self.execute_plan(plan, camera, focus, progress)
    }

    /// Brings the sum to a lens and a focus by `plan`, which was just made for them.
    ///
    /// # Errors
    /// The sum overflows, or the work was cancelled.
    pub fn execute_plan(
        &mut self,
        plan: Plan,
        camera: &Camera,
        focus: &Focus,
        progress: &dyn Progress,
    ) -> Result<SumUpdate, SessionError> {
        // Until all is through, the sum is of no lens.
        self.summed_camera = None;
        // A whole sum goes on without the card by itself.
        let is_summed_again = !matches!(plan, Plan::Whole) && self.splatter.leave_lost_card()?;
        let update = match plan {
            Plan::Move(samples) if samples.is_empty() && is_summed_again => SumUpdate::Whole,
            Plan::Move(samples) if samples.is_empty() => SumUpdate::Unchanged,
            Plan::Move(samples) => {
                let [rows, columns] = self.splatter.update(focus, &samples)?;
                if let Some(reach) = &mut self.reach {
                    reach.note_moved(&samples);
                }
                if is_summed_again { SumUpdate::Whole } else { SumUpdate::Region([columns, rows]) }
            }
            Plan::Whole => {
                self.reach = None;
                let start = Instant::now();
                self.take_up_paint(focus);
                self.splatter.refocus(camera, progress)?;
                self.whole_seconds = start.elapsed().as_secs_f64();
                SumUpdate::Whole
            }
        };
        self.pending_changes = Changes::default();
        self.has_moved_carried |= focus.affects_carried_light();
        self.summed_camera = Some(camera.clone());
        let picture = self.splatter.picture();
        let has_fringe = picture.colour_coverage.is_some();
        self.one_coverage = has_fringe.then(|| picture.clone().with_common_coverage());
        Ok(update)
    }

    /// The picture of the sum, where it was made.
    pub fn source(&self) -> PictureSource<'_> {
        let on_card = self.splatter.picture_on_card().map(PictureSource::OnCard);
        let in_memory = || self.one_coverage.as_ref().unwrap_or(self.splatter.picture());
        on_card.unwrap_or_else(|| PictureSource::InMemory(in_memory()))
    }

    /// The picture of the sum, brought back if it is on a card.
    ///
    /// # Errors
    /// The card is lost.
    pub fn fetch_picture(&mut self) -> Result<&Picture, SplatError> {
        self.splatter.fetch_picture()?;
        Ok(self.one_coverage.as_ref().unwrap_or(self.splatter.picture()))
    }

    /// The light field itself, and where its samples are.
    pub fn baked(&self) -> BakedField {
        BakedField { salf: self.splatter.salf().clone(), index: self.index.clone() }
    }

    /// Tolerance of its sums.
    pub fn tolerance(&self) -> Tolerance {
        self.splatter.tolerance()
    }

    /// What it holds, counted.
    pub fn modelled(&self) -> Modelled {
        self.modelled
    }
}

#[cfg(test)]
mod tests;
