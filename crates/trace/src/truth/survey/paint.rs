//! What the common samples of pixels whose light paint moves should suit.

use super::super::sheared::{Level, Spread};
use super::survey_hit::{SurveyHit, WITHIN, is_uniform, scatter, widest_gap};
use glam::Vec3;
use numerics::upper_median;

/// Which share of the pixels that paint decides something in must agree for the common samples to suit them: the others
/// would be worse off than without an order.
const AGREEING: f64 = 0.9;

/// What there is to decide in a pixel whose light paint moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Paint {
    /// All hits have the same radiance.
    Nothing,
    /// Several circles of confusion, or light that moves unlike.
    Mixed,
    /// One edge or texture.
    Decides {
        /// The signed radius as painted, px.
        radius_px: f64,
        /// What of that is paint.
        moved_px: f64,
    },
}

impl Paint {
    /// What there is to decide where paint moves light: which part of it, front or behind, lands where. What is in front
    /// decides; what is black lands unseen.
    pub fn classify(hits: &[SurveyHit]) -> Self {
        if is_uniform(hits) {
            return Self::Nothing;
        }
        let mut by_radius = hits.to_vec();
        by_radius.sort_by(|a, b| a.radius_px.total_cmp(&b.radius_px));
        let (front, behind) = by_radius.split_at(widest_gap(&by_radius));
        let edge_px = front[front.len() / 2].radius_px;
        let moved_px = |part: &[SurveyHit]| {
            let moves: Vec<f64> =
                part.iter().filter(|hit| hit.light != Vec3::ZERO).map(|hit| hit.moved_px).collect();
            (!moves.is_empty()).then(|| moves[moves.len() / 2])
        };
        let is_one_light = behind.is_empty() || scatter(front) + scatter(behind) < WITHIN * scatter(hits);
        match (moved_px(front), moved_px(behind)) {
            (Some(moved_px), None) | (None, Some(moved_px)) if is_one_light => {
                Self::Decides { radius_px: edge_px + moved_px, moved_px }
            }
            (Some(front), Some(behind))
                if is_one_light && Level::from_radius(front).is_near(Level::from_radius(behind)) =>
            {
                Self::Decides { radius_px: edge_px + front, moved_px: front }
            }
            _ => Self::Mixed,
        }
    }
}

/// What suits nearly all pixels that paint decides something in, if anything does.
pub(super) fn common_spread(paints: impl Iterator<Item = Paint>) -> Option<Spread> {
    let deciding: Vec<Paint> = paints.filter(|paint| *paint != Paint::Nothing).collect();
    let median = |of: fn(f64, f64) -> f64| {
        let mut values: Vec<f64> = deciding
            .iter()
            .filter_map(|paint| match *paint {
                Paint::Decides { radius_px, moved_px } => Some(of(radius_px, moved_px)),
                _ => None,
            })
            .collect();
        upper_median(&mut values)
    };
    let (radius, moved) = (median(|radius, _| radius)?, median(|_, moved| moved)?);
    let (level, by) = (Level::from_radius(radius), Level::from_radius(moved));
    let agrees = |paint: &&Paint| match **paint {
        Paint::Decides { radius_px, moved_px } => {
            Level::from_radius(radius_px).is_near(level) && Level::from_radius(moved_px).is_near(by)
        }
        _ => false,
    };
    let agreeing = deciding.iter().filter(agrees).count();
    (agreeing as f64 >= AGREEING * deciding.len() as f64).then_some(Spread { level, moved_px: moved })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{rays, survey_hits};
    use super::*;

    #[test]
    fn paint_is_suited_where_nearly_all_of_it_is_alike() {
        let rays = rays();
        // An edge that stands at radius 1 and is moved by 2 before what is moved by something else.
        let paint = |behind: f32, moved_behind: f64| {
            let mut looks = survey_hits(&rays, [1.0, 4.0], 0.7, |_| behind);
            looks
                .iter_mut()
                .for_each(|look| look.moved_px = if look.light.x == 5.0 { 2.0 } else { moved_behind });
            Paint::classify(&looks)
        };
        let decides = Paint::Decides { radius_px: 3.0, moved_px: 2.0 };
        assert_eq!((paint(0.0, 7.0), paint(1.0, 2.0)), (decides, decides));
        assert_eq!(paint(1.0, 7.0), Paint::Mixed);
        assert_eq!(paint(5.0, 2.0), Paint::Nothing);
        let (nothing, other) = (Paint::Nothing, Paint::Mixed);
        let spread = Some(Spread { level: Level::from_radius(3.0), moved_px: 2.0 });
        let mostly: Vec<_> =
            (0..40).map(|k| if k % 20 == 7 { other } else { decides }).chain([nothing; 90]).collect();
        assert_eq!(common_spread(mostly.into_iter()), spread);
        let often: Vec<_> = (0..40).map(|k| if k % 5 == 2 { other } else { decides }).collect();
        assert_eq!(common_spread(often.into_iter()), None);
        assert_eq!(common_spread([nothing].into_iter()), None);
    }
}
