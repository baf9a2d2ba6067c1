//! How bright a scene is for a screen.

use salf::Salf;

/// Light that is at most so bright needs no darker display.
const COMFORTABLE_RADIANCE: f32 = 4.0;

/// What the bright parts of a scene are shown as, 1 being the screen's white.
const TARGET_BRIGHTNESS: f32 = 0.8;

/// By how many stops a scene must be shown darker for its bright parts not to be burnt out; none if they are not. Lights in files
/// are often in the units of a photographer's world, where a room has hundreds.
pub(crate) fn darkening_stops(salf: &Salf) -> Option<f32> {
    const RUN_STRIDE: usize = 7;
    let samples = salf.samples.runs().step_by(RUN_STRIDE).flat_map(|run| run.iter());
    let surfaces = samples.filter(|sample| sample.surface.is_some() && sample.weight > 0.0);
    let mut lights: Vec<(f32, f32)> =
        surfaces.map(|sample| (sample.radiance.max_element(), sample.weight)).collect();
    lights.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f32 = lights.iter().map(|(_, weight)| weight).sum();
    // Four fifths of the picture are no brighter.
    let mut below = 0.0;
    let bright = lights.iter().find(|(_, weight)| {
        below += weight;
        below >= 0.8 * all
    })?;
    (bright.0 > COMFORTABLE_RADIANCE).then(|| ((TARGET_BRIGHTNESS / bright.0).log2() * 2.0).round() / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, Vec2, Vec3};
    use lens::Camera;
    use salf::{Sample, Visibility};
    use scene::SurfacePoint;

    #[test]
    fn what_would_be_burnt_out_is_shown_darker() {
        let stops = |lights: &[f32]| {
            let sample = |&light: &f32| Sample {
                center: Vec2::ZERO,
                half_size: Vec2::splat(0.5),
                inverse_depth: 1.0,
                weight: 1.0,
                tilt: Vec2::ZERO,
                radiance: Vec3::splat(light),
                surface: Some(SurfacePoint { triangle: 0, barycentric: DVec2::ZERO }),
                is_carried: false,
                visibility: Visibility::Open,
            };
            let samples = lights.iter().map(sample).collect();
            darkening_stops(&Salf::with_samples(Camera::default(), samples))
        };
        assert_eq!(stops(&[]), None);
        assert_eq!(stops(&[0.5, 0.7, 0.2, 0.9, 0.4]), None);
        // A few lamps burn out anyway.
        assert_eq!(stops(&[0.5, 0.7, 0.2, 0.9, 900.0]), None);
        assert_eq!(stops(&[100.0, 90.0, 102.4, 80.0, 3.0]), Some(-7.0));
    }
}
