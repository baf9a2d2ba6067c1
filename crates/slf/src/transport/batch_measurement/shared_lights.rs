//! Light samples shared by all points of a batch.

use super::point_batch::PointBatch;
use crate::light_interpolation::LightVisibility;
use crate::lights::LightSample;
use crate::path_random::PathRandom;
use crate::transport::Transport;
use glam::Vec3;

/// Samples of sky and emitters, over those of a single point, where a point sees all of them or none.
const LIGHTS_FACTOR: u32 = 4;

/// The same in penumbrae, where a point sees some of them.
const PENUMBRA_LIGHTS_FACTOR: u32 = 8;

/// Number of sky directions that give the light of unoccluded gloss; no rays are traced for them.
const SKY_DIRECTIONS: u32 = 512;

/// Up to this many punctual lights are all used; of more, this many are sampled.
const MAX_PUNCTUAL_ENUMERATED: usize = 64;

/// Seed of light samples.
pub(in crate::transport) const LIGHT_SEED: u64 = 0x5eed_0f5b_0751_1157;

/// Seed of directions sampled from lobes.
pub(in crate::transport) const DIRECTION_SEED: u64 = 0xa115_7075_100c_a11c;

/// A sampled light above a point's horizon.
pub(super) struct SampledLight {
    pub sample: LightSample,
    pub is_visible: bool,
}

/// All light samples of a point.
pub(super) struct LightDraws {
    pub lights: Vec<SampledLight>,
    /// Number of samples of sky and emitters.
    pub area_draws: u32,
    /// Number of samples of punctual lights.
    punctual_draws: u32,
    pub visibility: LightVisibility,
}

/// Kinds of light in [`LightVisibility`].
const SKY: usize = 0;
const EMITTERS: usize = 1;
const PUNCTUAL_LIGHTS: usize = 2;

/// The kind of a light, and its bit among those of its kind: by turn, or by the scene's numbering.
fn kind_and_bit(sample: &LightSample, turn: u32) -> (usize, u64) {
    let turn_bit = |number: u32| 1 << (number % u64::BITS);
    match sample.punctual_index {
        Some(number) => (PUNCTUAL_LIGHTS, turn_bit(number as u32)),
        None if sample.is_near => (EMITTERS, turn_bit(turn)),
        None => (SKY, turn_bit(turn)),
    }
}

impl Transport {
    /// Sampled directions of the sky, the first of which are those used for points. Empty if the sky is not sampled.
    pub(super) fn sky_samples(&self) -> &[LightSample] {
        self.sky_samples.get_or_init(|| {
            let sample = |turn| self.lights.sample_sky(PathRandom::new(LIGHT_SEED, turn).next2());
            (0..SKY_DIRECTIONS).filter_map(sample).collect()
        })
    }
}

impl PointBatch<'_> {
    /// Samples lights for a point, more of them if it sees only part of the sky or of the emitters.
    pub fn sample_lights(&self, index: usize) -> LightDraws {
        let punctual_draws = self.punctual_draws();
        let mut draws = LightDraws {
            lights: Vec::new(),
            area_draws: 0,
            punctual_draws,
            visibility: LightVisibility::default(),
        };
        for turn in 0..punctual_draws {
            self.visit_punctual(index, turn, |sample| draws.add(self, index, sample, turn));
        }
        if self.transport.lights.has_areas() {
            let [regular, in_penumbra] =
                [LIGHTS_FACTOR, PENUMBRA_LIGHTS_FACTOR].map(|times| times * self.lights_per_point());
            draws.area_draws = regular;
            (0..regular).for_each(|turn| draws.add_areas(self, index, turn));
            if draws.visibility.is_mixed(SKY) || draws.visibility.is_mixed(EMITTERS) {
                draws.area_draws = in_penumbra;
                (regular..in_penumbra).for_each(|turn| draws.add_areas(self, index, turn));
            }
        }
        draws
    }

    /// Whether the visibility of the lights of one turn differs from what some points agree on.
    pub fn compare_visibility(&self, index: usize, turn: usize, agreed: &LightVisibility) -> Option<bool> {
        // An odd step visits all residues of a power of two.
        const STEP: usize = 37;
        let [area_turn, punctual_turn] = [self.compared_draws(), self.punctual_draws()]
            .map(|count| ((turn * STEP) % count as usize) as u32);
        let mut differs = None;
        let mut compare = |sample: LightSample, turn: u32| {
            let (kind, bit) = kind_and_bit(&sample, turn);
            if agreed.above_horizon[kind] & bit != 0 && self.places[index].normal.dot(sample.direction) > 0.0
            {
                let is_visible = self.is_visible(index, &sample);
                *differs.get_or_insert(false) |= is_visible != (agreed.visible[kind] & bit != 0);
            }
        };
        self.visit_areas(index, area_turn, |sample| compare(sample, area_turn));
        let light_count = self.transport.lights.punctual_count();
        // If all lights are enumerated, each has a turn of its own.
        let is_of_turn = |sample: &LightSample| {
            light_count > MAX_PUNCTUAL_ENUMERATED || sample.punctual_index == Some(turn % light_count.max(1))
        };
        self.visit_punctual(index, punctual_turn, |sample| {
            if is_of_turn(&sample) {
                compare(sample, punctual_turn);
            }
        });
        differs
    }

    /// Number of samples of sky and emitters by which neighbours are compared.
    fn compared_draws(&self) -> u32 {
        (LIGHTS_FACTOR * self.lights_per_point()).min(u64::BITS)
    }

    /// Number of samples of punctual lights.
    fn punctual_draws(&self) -> u32 {
        if self.transport.lights.punctual_count() <= MAX_PUNCTUAL_ENUMERATED {
            1
        } else {
            MAX_PUNCTUAL_ENUMERATED as u32
        }
    }

    fn visit_areas(&self, index: usize, turn: u32, mut visit: impl FnMut(LightSample)) {
        let (lights, position) = (&self.transport.lights, self.places[index].position);
        let known_sky = self.sky_samples.get(turn as usize);
        if let Some(sky) = known_sky {
            visit(lights.sky_at(sky, position));
            if !lights.has_emitters() {
                return;
            }
        }
        let mut random = PathRandom::new(LIGHT_SEED, turn);
        let scene = self.transport.scene();
        if known_sky.is_some() {
            // The sky has these.
            random.next2();
            lights.sample_emitters(scene, position, || random.next(), visit);
        } else {
            lights.sample_areas(scene, position, || random.next(), visit);
        }
    }

    fn visit_punctual(&self, index: usize, turn: u32, visit: impl FnMut(LightSample)) {
        let (transport, position) = (self.transport, self.places[index].position);
        let mut random = PathRandom::new(!LIGHT_SEED, turn);
        let draw = || random.next();
        transport.lights.sample_punctual(transport.scene(), position, MAX_PUNCTUAL_ENUMERATED, draw, visit);
    }

    /// Whether the segment between a point and a light is unoccluded.
    fn is_visible(&self, index: usize, light: &LightSample) -> bool {
        !self.transport.tracer.is_occluded(self.points[index].point, light.source)
    }
}

impl LightDraws {
    /// Reciprocal of the number of samples of this kind of light: its share of their mean.
    pub fn share(&self, sample: &LightSample) -> f64 {
        let count = if sample.punctual_index.is_some() { self.punctual_draws } else { self.area_draws };
        1.0 / f64::from(count)
    }

    fn add_areas(&mut self, batch: &PointBatch, index: usize, turn: u32) {
        batch.visit_areas(index, turn, |sample| self.add(batch, index, sample, turn));
    }

    fn add(&mut self, batch: &PointBatch, index: usize, sample: LightSample, turn: u32) {
        if batch.places[index].normal.dot(sample.direction) <= 0.0 || sample.light == Vec3::ZERO {
            return;
        }
        let (kind, bit) = kind_and_bit(&sample, turn);
        let is_visible = batch.is_visible(index, &sample);
        if turn < batch.compared_draws() {
            self.visibility.above_horizon[kind] |= bit;
            self.visibility.visible[kind] |= if is_visible { bit } else { 0 };
        }
        self.lights.push(SampledLight { sample, is_visible });
    }
}
