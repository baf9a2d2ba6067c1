//! Tone mapping: compressing bright radiance to the range of a screen.

use crate::picture::ocio_views::OcioViews;
use scene::linear_from_srgb;
use serde::{Deserialize, Serialize};

/// A tone curve. Input and output are linear RGB with Rec. 709 primaries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum ToneCurve {
    /// None: clipped at white.
    #[default]
    Clip,
    /// Khronos PBR Neutral: preserves colours, rolls off highlights.
    Neutral,
    /// AgX: rolls off everything; bright colours become paler, as on film.
    Agx,
    /// A view of the OpenColorIO configuration in `$OCIO`, by its number ([`OcioViews`]). Clips if there is no such view.
    Ocio(u16),
}

impl ToneCurve {
    /// All curves except those of `$OCIO`, in menu order.
    pub const ALL: [Self; 3] = [Self::Clip, Self::Neutral, Self::Agx];

    /// The name, for menus.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clip => "None",
            Self::Neutral => "PBR Neutral",
            Self::Agx => "AgX",
            Self::Ocio(view) => OcioViews::from_environment().name(view).unwrap_or("None"),
        }
    }

    /// The next of [`Self::ALL`], cyclically.
    pub fn next(self) -> Self {
        let at = Self::ALL.iter().position(|curve| *curve == self).unwrap_or(0);
        Self::ALL[(at + 1) % Self::ALL.len()]
    }

    /// Maps linear radiance to linear light of the screen, in [0, 1]. [`Self::Clip`] returns its input.
    pub fn map(self, rgb: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Clip => rgb,
            Self::Neutral => neutral(rgb.map(|c| c.max(0.0))),
            Self::Agx => agx(rgb.map(|c| c.max(0.0))),
            // Decoded as by an sRGB screen.
            Self::Ocio(view) => OcioViews::from_environment()
                .shown(view, rgb)
                .map_or(rgb, |sent| sent.map(|c| linear_from_srgb(c.into()))),
        }
    }
}

fn largest(rgb: [f32; 3]) -> f32 {
    rgb[0].max(rgb[1]).max(rgb[2])
}

/// Khronos PBR Neutral Tone Mapper, specification of 2024: subtracts the Fresnel reflection of 4 %, compresses peaks above 0.76 by a
/// hyperbola, and desaturates compressed colours.
fn neutral(rgb: [f32; 3]) -> [f32; 3] {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = rgb[0].min(rgb[1]).min(rgb[2]);
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let color = rgb.map(|c| c - offset);
    let peak = largest(color);
    if peak < START {
        return color;
    }
    let d = 1.0 - START;
    let new_peak = 1.0 - d * d / (peak + d - START);
    let share = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    color.map(|c| {
        let c = c * new_peak / peak;
        c + (new_peak - c) * share
    })
}

/// AgX (Sobotka 2022) with the polynomial of Wrensch (2023): moves the primaries inwards, applies an S curve to 16.5 stops of log2
/// radiance, and moves the primaries outwards. Its display encoding is a power of 2.2, undone here.
fn agx(rgb: [f32; 3]) -> [f32; 3] {
    const INSET: [[f32; 3]; 3] = [
        [0.842_479_06, 0.078_433_6, 0.079_223_745],
        [0.042_328_242, 0.878_468_64, 0.079_166_13],
        [0.042_375_654, 0.078_433_6, 0.879_143],
    ];
    const OUTSET: [[f32; 3]; 3] = [
        [1.196_879, -0.098_020_88, -0.099_029_74],
        [-0.052_896_85, 1.151_903_1, -0.098_961_18],
        [-0.052_971_635, -0.098_043_45, 1.151_073_7],
    ];
    const MIN_EV: f32 = -12.473_93;
    const MAX_EV: f32 = 4.026_069;
    let times = |m: [[f32; 3]; 3], v: [f32; 3]| m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
    let encoded = times(INSET, rgb).map(|c| {
        let x = ((c.log2().clamp(MIN_EV, MAX_EV)) - MIN_EV) / (MAX_EV - MIN_EV);
        let (x2, x4) = (x * x, x * x * x * x);
        15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232
    });
    times(OUTSET, encoded).map(|c| c.clamp(0.0, 1.0).powf(2.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(curve: ToneCurve, level: f32) -> f32 {
        let [r, g, b] = curve.map([level; 3]);
        assert!((r - g).abs() < 2e-3 && (g - b).abs() < 2e-3, "grey stays grey: {r} {g} {b}");
        g
    }

    #[test]
    fn every_curve_rises_and_stays_on_the_screen() {
        for curve in [ToneCurve::Neutral, ToneCurve::Agx] {
            let mut last = -1.0;
            for k in 0..400 {
                let level = grey(curve, (k as f32 / 20.0 - 12.0).exp2());
                assert!(level >= last && (0.0..=1.0).contains(&level), "{curve:?} {k}: {level} after {last}");
                last = level;
            }
            assert!(last > 0.95, "{curve:?}: {last}");
        }
        assert_eq!(ToneCurve::Clip.map([7.0, 0.5, 0.0]), [7.0, 0.5, 0.0]);
    }

    /// Values of the Khronos specification and of the AgX polynomial, worked out by hand.
    #[test]
    fn reference_values() {
        // 0.5 lies beneath the shoulder: only the reflection of 0.04 is taken off.
        assert!((grey(ToneCurve::Neutral, 0.5) - 0.46).abs() < 1e-6);
        // 1: peak 0.96, d 0.24, 1 − 0.0576/0.44.
        assert!((grey(ToneCurve::Neutral, 1.0) - 0.869_090_9).abs() < 1e-5);
        // Middle grey: log2 0.18 is 0.605955 of the range; the polynomial there, to the power of 2.2.
        let x = (0.18f64.log2() + 12.47393) / 16.5;
        let y = 15.5 * x.powi(6) - 40.14 * x.powi(5) + 31.96 * x.powi(4) - 6.868 * x.powi(3)
            + 0.4298 * x * x
            + 0.1191 * x
            - 0.00232;
        assert!((f64::from(grey(ToneCurve::Agx, 0.18)) - y.powf(2.2)).abs() < 2e-3, "{y}");
        let saturated = ToneCurve::Agx.map([8.0, 0.0, 0.0]);
        assert!(saturated[1] > 0.05, "bright red pales: {saturated:?}");
        assert_eq!(ToneCurve::Clip.next().next().next(), ToneCurve::Clip);
    }
}
