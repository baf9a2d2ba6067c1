//! A stroke: dabs at equal distances along the path of the pointer on the surface.

use crate::brush::PageBrush;
use crate::history::Change;
use crate::sample_places::SamplePlaces;
use glam::{DVec2, DVec3};
use lens::{Camera, FocusOffset};
use std::collections::HashMap;

/// Distance between dabs, as a fraction of the radius.
const SPACING: f64 = 0.25;
/// A segment with more dabs than this is a jump between two surfaces.
const MOST_DABS_A_STEP: f64 = 4096.0;

/// A stroke in progress.
pub struct Stroke {
    brush: PageBrush,
    target: FocusOffset,
    /// Radius of a dab, world units.
    radius: f64,
    last: Option<DVec3>,
    until_next_dab: f64,
    /// How strongly each painted sample was painted, in (0, 1], and its focus before.
    painted: HashMap<u32, (f64, FocusOffset)>,
}

impl Stroke {
    pub fn new(brush: PageBrush, target: FocusOffset, radius: f64) -> Self {
        Self { brush, target, radius, last: None, until_next_dab: 0.0, painted: HashMap::new() }
    }

    /// Radius of a dab, world units.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// What it paints.
    pub fn target(&self) -> FocusOffset {
        self.target
    }

    /// Draws on to a point of the world. Returns the samples whose focus it changed, in order.
    pub fn extend(
        &mut self,
        to: DVec3,
        places: &SamplePlaces,
        camera: &Camera,
        focus: &mut [FocusOffset],
    ) -> Vec<u32> {
        let spacing = SPACING * self.radius;
        let mut changed = Vec::new();
        let from = self.last.replace(to);
        match from.map(|from| (from, from.distance(to))) {
            Some((from, length)) if length <= MOST_DABS_A_STEP * spacing => {
                let mut along = self.until_next_dab;
                while along <= length {
                    let share = if length > 0.0 { along / length } else { 1.0 };
                    self.dab(from.lerp(to, share), places, camera, focus, &mut changed);
                    along += spacing;
                }
                self.until_next_dab = along - length;
            }
            _ => {
                self.dab(to, places, camera, focus, &mut changed);
                self.until_next_dab = spacing;
            }
        }
        changed.sort_unstable();
        changed.dedup();
        changed
    }

    /// The pointer left the surface: the next point begins a path of its own.
    pub fn lift(&mut self) {
        self.last = None;
    }

    /// What it changed.
    pub fn changes(self, focus: &[FocusOffset]) -> Vec<Change> {
        let change = |(sample, (_, before)): (u32, (f64, FocusOffset))| Change {
            sample,
            before,
            after: focus[sample as usize],
        };
        let mut changes: Vec<_> = self.painted.into_iter().map(change).collect();
        changes.sort_unstable_by_key(|change| change.sample);
        changes
    }

    fn dab(
        &mut self,
        center: DVec3,
        places: &SamplePlaces,
        camera: &Camera,
        focus: &mut [FocusOffset],
        changed: &mut Vec<u32>,
    ) {
        let [least, most] = self.bounds(center, camera);
        for place in places.within(least, most) {
            let distance = place.position(camera).distance(center) / self.radius;
            let share = self.brush.falloff(distance);
            let value = &mut focus[place.sample as usize];
            let (painted, before) = self.painted.get(&place.sample).copied().unwrap_or((0.0, *value));
            if share > painted {
                self.painted.insert(place.sample, (share, before));
                let mix = |from: f64, to: f64| from + (to - from) * share;
                *value =
                    FocusOffset::new(mix(before.t, self.target.t), mix(before.anchor, self.target.anchor));
                changed.push(place.sample);
            }
        }
    }

    /// A rectangle of the picture, px, that a dab's sphere lies in: all of it where the sphere reaches the camera.
    fn bounds(&self, center: DVec3, camera: &Camera) -> [[f32; 2]; 2] {
        let point = camera.camera_from_world(center);
        let nearest = point.z - self.radius;
        if nearest <= 0.0 {
            return [[f32::MIN; 2], [f32::MAX; 2]];
        }
        let tan_half_yfov = (camera.yfov / 2.0).tan();
        let pixel = |x: f64, y: f64, z: f64| camera.pixel_from_q(DVec2::new(x, y) / (z * tan_half_yfov));
        let (mut least, mut most) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for z in [nearest, point.z + self.radius] {
            for side in [-self.radius, self.radius] {
                let corner = pixel(point.x + side, point.y + side, z);
                (least, most) = (least.min(corner), most.max(corner));
            }
        }
        [least, most].map(|corner| corner.as_vec2().to_array())
    }
}
