//! Lights that are drawn for spots, the same ones for all.

use super::asked::Asked;
use crate::lights::LightSample;
use crate::path_random::PathRandom;
use crate::spots::Seen;
use crate::transport::Transport;
use glam::{DVec3, Vec3};

/// How often sky and lamps are drawn where a spot sees all of them, or none, over how often for a point asked alone.
const LIGHTS: u32 = 4;

/// How often where it sees some.
const LIGHTS_IN_PENUMBRA: u32 = 8;

/// Directions of the sky that tell what an unshaded gloss sends: no rays are traced for these.
const SKY_DIRECTIONS: u32 = 512;

/// So many punctual lights are all asked; of more so many are drawn.
const PUNCTUAL: usize = 64;

/// What the lights are drawn by.
pub(in crate::transport) const SEED: u64 = 0x5eed_0f5b_0751_1157;

/// What directions are, in which gloss and lamps are looked for.
pub(in crate::transport) const LOOKING: u64 = 0xa115_7075_100c_a11c;

/// A light that was drawn for a spot and stands above its horizon.
pub(super) struct Drawn {
    pub sample: LightSample,
    pub is_seen: bool,
}

/// All that were.
pub(super) struct Drawing {
    pub lights: Vec<Drawn>,
    /// How often sky and lamps were.
    pub of_areas: u32,
    /// And how often punctual lights.
    of_punctual: u32,
    pub seen: Seen,
}

/// The kinds of light that [`Seen`] tells of.
const SKY: usize = 0;
const LAMPS: usize = 1;
const PUNCTUAL_LIGHTS: usize = 2;

/// The kind of a light, and its bit among those of its kind: of those drawn by turns, or of the scene's.
fn bit(sample: &LightSample, turn: u32) -> (usize, u64) {
    let of = |number: u32| 1 << (number % u64::BITS);
    match sample.number {
        Some(number) => (PUNCTUAL_LIGHTS, of(number as u32)),
        None if sample.is_near => (LAMPS, of(turn)),
        None => (SKY, of(turn)),
    }
}

impl Transport {
    /// Directions of the sky, the first of them those that are drawn for spots. Empty where none is drawn.
    pub(super) fn sky(&self) -> &[LightSample] {
        self.sky.get_or_init(|| {
            let mut sky = Vec::new();
            for turn in 0..SKY_DIRECTIONS {
                let mut random = PathRandom::new(SEED, turn);
                let draw = || random.next();
                let mut keep = |sample: LightSample| sky.extend(sample.is_of_sky().then_some(sample));
                self.lights.sample_areas(self.scene(), &self.world, DVec3::ZERO, draw, &mut keep);
            }
            sky
        })
    }
}

impl Asked<'_> {
    /// Draws lights for a spot, more of them where it sees some of the sky or of the lamps and others not.
    pub fn draw(&self, spot: usize) -> Drawing {
        let of_punctual = self.punctual_draws();
        let mut drawing = Drawing { lights: Vec::new(), of_areas: 0, of_punctual, seen: Seen::default() };
        for turn in 0..of_punctual {
            self.visit_punctual(spot, turn, |sample| drawing.add(self, spot, sample, turn));
        }
        if self.transport.lights.has_areas() {
            let [few, many] = [LIGHTS, LIGHTS_IN_PENUMBRA].map(|times| times * self.light_samples());
            drawing.of_areas = few;
            (0..few).for_each(|turn| drawing.add_areas(self, spot, turn));
            if drawing.seen.is_mixed(SKY) || drawing.seen.is_mixed(LAMPS) {
                drawing.of_areas = many;
                (few..many).for_each(|turn| drawing.add_areas(self, spot, turn));
            }
        }
        drawing
    }

    /// Whether a spot sees the lights of one turn otherwise than some spots that agree about them.
    pub fn sees_otherwise(&self, spot: usize, turn: usize, agreed: &Seen) -> Option<bool> {
        // An odd step takes turns with all of a power of two.
        const STEP: usize = 37;
        let [of_areas, of_punctual] =
            [self.compared(), self.punctual_draws()].map(|draws| ((turn * STEP) % draws as usize) as u32);
        let mut differs = None;
        let mut compare = |sample: LightSample, turn: u32| {
            let (kind, bit) = bit(&sample, turn);
            if agreed.above[kind] & bit != 0 && self.places[spot].normal.dot(sample.from) > 0.0 {
                let sees = self.sees(spot, &sample);
                *differs.get_or_insert(false) |= sees != (agreed.seen[kind] & bit != 0);
            }
        };
        self.visit_areas(spot, of_areas, |sample| compare(sample, of_areas));
        let of_all = self.transport.lights.punctual_count();
        // All of a few are one turn: each in its own.
        let is_of_turn =
            |sample: &LightSample| of_all > PUNCTUAL || sample.number == Some(turn % of_all.max(1));
        self.visit_punctual(spot, of_punctual, |sample| {
            if is_of_turn(&sample) {
                compare(sample, of_punctual);
            }
        });
        differs
    }

    /// By how many draws of sky and lamps neighbours are compared.
    fn compared(&self) -> u32 {
        (LIGHTS * self.light_samples()).min(u64::BITS)
    }

    /// How often punctual lights are drawn.
    fn punctual_draws(&self) -> u32 {
        if self.transport.lights.punctual_count() <= PUNCTUAL { 1 } else { PUNCTUAL as u32 }
    }

    fn visit_areas(&self, spot: usize, turn: u32, visit: impl FnMut(LightSample)) {
        let (transport, position) = (self.transport, self.places[spot].position);
        let mut random = PathRandom::new(SEED, turn);
        let draw = || random.next();
        transport.lights.sample_areas(transport.scene(), &transport.world, position, draw, visit);
    }

    fn visit_punctual(&self, spot: usize, turn: u32, visit: impl FnMut(LightSample)) {
        let (transport, position) = (self.transport, self.places[spot].position);
        let mut random = PathRandom::new(!SEED, turn);
        let draw = || random.next();
        transport.lights.sample_punctual(transport.scene(), position, PUNCTUAL, draw, visit);
    }

    /// Whether nothing stands between a spot and a light.
    fn sees(&self, spot: usize, light: &LightSample) -> bool {
        !self.transport.tracer.occluded(self.spots[spot].point, light.source)
    }
}

impl Drawing {
    /// One over how often lights of the kind of this one were drawn.
    pub fn share(&self, sample: &LightSample) -> f64 {
        let draws = if sample.number.is_some() { self.of_punctual } else { self.of_areas };
        1.0 / f64::from(draws)
    }

    fn add_areas(&mut self, asked: &Asked, spot: usize, turn: u32) {
        asked.visit_areas(spot, turn, |sample| self.add(asked, spot, sample, turn));
    }

    fn add(&mut self, asked: &Asked, spot: usize, sample: LightSample, turn: u32) {
        if asked.places[spot].normal.dot(sample.from) <= 0.0 || sample.light == Vec3::ZERO {
            return;
        }
        let (kind, bit) = bit(&sample, turn);
        let is_seen = asked.sees(spot, &sample);
        if turn < asked.compared() {
            self.seen.above[kind] |= bit;
            self.seen.seen[kind] |= if is_seen { bit } else { 0 };
        }
        self.lights.push(Drawn { sample, is_seen });
    }
}
