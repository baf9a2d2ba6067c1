//! Scattering at surfaces: energy, reciprocity, and sampling densities.

use crate::case::{Case, Effort, Verdict};
use crate::support::measure::worst;
use glam::DVec3;
use material::{Bsdf, Clearcoat, Film, Frame, Interface, Scattering, Sheen, Surface};
use progress::{Cancelled, Progress};
use std::f64::consts::{PI, TAU};
use test_scenes::Random;

pub const CASES: &[Case] = &[
    Case {
        name: "furnace of metal and plastic",
        reason: "A surface that reflects all light and absorbs none is as bright as its surroundings, at any \
                 roughness, from any direction.",
        control: "light scattered by facets more than once left out",
        check: white_furnace,
    },
    Case {
        name: "furnace of a ball of rough glass",
        reason: "A ball of clear glass in white light is white, after up to 64 bounces inside.",
        control: "light scattered by facets more than once left out",
        check: ball,
    },
    Case {
        name: "reciprocity",
        reason: "Scattering is reciprocal: f(o, i) = f(i, o), and f/n² across an interface.",
        control: "a base layer blended with the reflection above it by the angle of the eye alone",
        check: reciprocity,
    },
    Case {
        name: "lobes χ²",
        reason: "Directions are sampled with their stated density, tested in 576 cells of the sphere.",
        control: "the density times z + 1",
        check: densities,
    },
];

const COSINES: [f64; 5] = [0.02, 0.15, 0.4, 0.75, 1.0];

fn metal(roughness: f64) -> Surface {
    Surface { roughness, ..Surface::default() }
}

fn plastic(roughness: f64) -> Surface {
    Surface { metallic: 0.0, roughness, ..Surface::default() }
}

fn glass(roughness: f64) -> Surface {
    Surface { transmission: 1.0, is_thin: false, ..plastic(roughness) }
}

/// The direction with the given cosine to z and azimuth.
fn toward(cos: f64, azimuth: f64) -> DVec3 {
    let flat = (1.0 - cos * cos).max(0.0).sqrt();
    DVec3::new(flat * azimuth.cos(), flat * azimuth.sin(), cos)
}

/// Every kind of lobe.
fn every() -> Vec<Surface> {
    let color = DVec3::new(0.8, 0.4, 0.1);
    let clearcoat = Some(Clearcoat { factor: 0.8, roughness: 0.35 });
    let sheen = Some(Sheen { color: DVec3::new(0.9, 0.5, 0.2), roughness: 0.4 });
    let film = Some(Film { factor: 0.9, ior: 1.4, thickness: 380.0 });
    vec![
        metal(0.6),
        Surface { anisotropy: 0.7, ..metal(0.3) },
        Surface { base_color: color, ..plastic(0.4) },
        Surface { specular: 0.0, ..plastic(1.0) },
        glass(0.5),
        Surface { transmission: 0.7, base_color: color, ..plastic(0.5) },
        Surface { diffuse_transmission: 0.6, diffuse_transmission_color: color, ..plastic(0.6) },
        Surface { clearcoat, base_color: color, ..metal(0.5) },
        Surface { film, base_color: color, ..plastic(0.4) },
        Surface { sheen, base_color: color, ..plastic(0.9) },
    ]
}

/// Deviation from 1 of the mean outgoing radiance under radiance 1 from all directions.
fn furnace(surface: &Surface, cos: f64, count: u32) -> f64 {
    let interface = Interface::from_ior(surface.ior);
    let bsdf = Bsdf::new(surface, Frame::flat(DVec3::Z), &interface);
    // Roberts's sequence in three dimensions, which covers the cube more evenly than random numbers.
    const STEP: DVec3 = DVec3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3);
    let place = |k: u32| (STEP * f64::from(k) + 0.5).fract().to_array();
    let sent = (0..count).filter_map(|k| bsdf.sample(toward(cos, 0.3), place(k)));
    sent.map(|scattered| scattered.weight.total().x).sum::<f64>() / f64::from(count) - 1.0
}

fn white_furnace(effort: Effort, _: &dyn Progress) -> Result<Verdict, Cancelled> {
    let count = effort.choose(400_000, 100_000);
    let roughness = [0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0];
    let worst_gain = |surface: &dyn Fn(f64) -> Surface| {
        let all = roughness.iter().flat_map(|&roughness| COSINES.map(|cos| (surface(roughness), cos)));
        worst(all.map(|(surface, cos)| furnace(&surface, cos, count)))
    };
    let right = [worst_gain(&metal), worst_gain(&plastic)];
    let single = |surface: Surface| Surface { scattering: Scattering::Single, ..surface };
    let wrong = [
        worst_gain(&|roughness| single(metal(roughness))),
        worst_gain(&|roughness| single(plastic(roughness))),
    ];
    let limits = [("metal", 5e-3), ("plastic", 5e-3)];
    Ok(Verdict::new("1 ± 0.5 %, roughness 0.05 … 1, 5 directions each", limits, right, wrong))
}

fn ball(effort: Effort, _: &dyn Progress) -> Result<Verdict, Cancelled> {
    let count = effort.choose(200_000, 40_000);
    let brightness = |surface: Surface| {
        let interface = Interface::from_ior(surface.ior);
        let mut random = Random(7);
        let mut sum = 0.0;
        for _ in 0..count {
            // A unit ball; the eye looks along −x at a point of its disc.
            let [a, b, _] = random.three();
            let (r, angle) = (a.sqrt() * 0.99, b * TAU);
            let (y, z) = (r * angle.cos(), r * angle.sin());
            let mut place = DVec3::new((1.0 - y * y - z * z).sqrt(), y, z);
            let (mut outgoing, mut carried) = (DVec3::X, 1.0);
            for _ in 0..64 {
                let bsdf = Bsdf::new(&surface, Frame::flat(place), &interface);
                let Some(scattered) = bsdf.sample(outgoing, random.three()) else { break };
                carried *= scattered.weight.total().x;
                if scattered.incident.dot(place) > 0.0 {
                    sum += carried;
                    break;
                }
                // Through the ball to the other side; rounding must not accumulate away from its surface.
                place += scattered.incident * (-2.0 * place.dot(scattered.incident));
                place = place.normalize();
                outgoing = -scattered.incident;
            }
        }
        sum / f64::from(count) - 1.0
    };
    let right = worst([0.1, 0.5, 1.0].map(|roughness| brightness(glass(roughness))));
    let wrong = brightness(Surface { scattering: Scattering::Single, ..glass(1.0) });
    Ok(Verdict::new("1 ± 1 %, roughness 0.1 … 1", [("brightness − 1", 0.01)], [right], [wrong.abs()]))
}

fn reciprocity(effort: Effort, _: &dyn Progress) -> Result<Verdict, Cancelled> {
    let count = effort.choose(20_000, 2_000);
    let worst_of = |value: &dyn Fn(DVec3, DVec3) -> DVec3, beyond: Option<f64>| {
        let mut random = Random(3);
        worst((0..count).map(|_| {
            let [a, b, c] = random.three();
            let o = toward(0.02 + 0.98 * a, TAU * b);
            let i = toward(0.02 + 0.98 * c, TAU * random.unit());
            let i = if beyond.is_some() { DVec3::new(i.x, i.y, -i.z) } else { i };
            let (there, back) = (value(o, i) * beyond.unwrap_or(1.0), value(i, o));
            let scale = there.max(back).max_element();
            if scale > 1e-9 { (there - back).abs().max_element() / scale } else { 0.0 }
        }))
    };
    let worst_error = |surface: &Surface| {
        let interface = Interface::from_ior(surface.ior);
        let bsdf = Bsdf::new(surface, Frame::flat(DVec3::Z), &interface);
        let value = |o: DVec3, i: DVec3| bsdf.evaluate(o, i).total();
        let eta2 = if surface.is_thin { 1.0 } else { interface.eta(true).powi(2) };
        worst_of(&value, None).max(worst_of(&value, Some(eta2)))
    };
    let right = worst(every().iter().map(worst_error));
    let plastic = plastic(0.4);
    let interface = Interface::from_ior(plastic.ior);
    let bsdf = Bsdf::new(&plastic, Frame::flat(DVec3::Z), &interface);
    let mixed = |o: DVec3, i: DVec3| bsdf.evaluate(o, i).total() * (0.96 - 0.96 * (1.0 - o.z).powi(5));
    let expected = format!("alike to 1e-4, of {} materials", every().len());
    Ok(Verdict::new(expected, [("relative difference", 1e-4)], [right], [worst_of(&mixed, None)]))
}

/// Bands in z and sectors in azimuth of the cells in which directions are counted.
const SIDE: usize = 24;

fn densities(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let count = effort.choose(100_000, 20_000);
    let (mut right, mut wrong) = (Vec::new(), f64::INFINITY);
    for surface in every() {
        for cos in COSINES {
            progress.check()?;
            let [off, control] = deviations_of(&surface, cos, count);
            right.push(off.max(0.0));
            if surface.roughness >= 0.9 {
                wrong = wrong.min(control);
            }
        }
    }
    let expected = format!("of {} lobes and directions, the worst below 5 standard deviations", right.len());
    Ok(Verdict::new(expected, [("deviations", 5.0)], [worst(right)], [wrong]))
}

/// Deviation of χ² from its degrees of freedom in standard deviations, for the true density and a tilted one.
fn deviations_of(surface: &Surface, cos: f64, count: u32) -> [f64; 2] {
    let interface = Interface::from_ior(surface.ior);
    let bsdf = Bsdf::new(surface, Frame::flat(DVec3::Z), &interface);
    let outgoing = toward(cos, 0.3);
    let mut random = Random(11);
    let mut counts = vec![0.0; SIDE * SIDE];
    for _ in 0..count {
        let Some(scattered) = bsdf.sample(outgoing, random.three()) else { continue };
        let w = scattered.incident;
        let band = (((w.z + 1.0) / 2.0 * SIDE as f64) as usize).min(SIDE - 1);
        let sector = (((w.y.atan2(w.x) / TAU + 1.0).fract() * SIDE as f64) as usize).min(SIDE - 1);
        counts[band * SIDE + sector] += 1.0;
    }
    let mean = |cell: usize, n: usize| {
        let place = |k: usize| {
            let z = ((cell / SIDE) as f64 + ((k / n) as f64 + 0.5) / n as f64) * 2.0 / SIDE as f64 - 1.0;
            let azimuth = ((cell % SIDE) as f64 + ((k % n) as f64 + 0.5) / n as f64) / SIDE as f64 * TAU;
            bsdf.density(outgoing, toward(z.abs(), azimuth) * DVec3::new(1.0, 1.0, z.signum()))
        };
        (0..n * n).map(place).sum::<f64>() / (n * n) as f64 * 4.0 * PI / (SIDE * SIDE) as f64
    };
    // Finer quadrature where the density is high.
    let cell =
        |cell: usize| Some(mean(cell, 12)).filter(|&share| share <= 2e-3).unwrap_or_else(|| mean(cell, 56));
    let expected: Vec<f64> = (0..SIDE * SIDE).map(cell).collect();
    let tilted: Vec<f64> = (0..SIDE * SIDE).map(|k| expected[k] * ((k / SIDE) as f64 + 0.5)).collect();
    let scale = expected.iter().sum::<f64>() / tilted.iter().sum::<f64>();
    let chi2 = |shares: &dyn Fn(usize) -> f64| {
        let (mut chi2, mut cells, mut rest, mut rest_expected) = (0.0, 0.0f64, 0.0, 0.0);
        for (cell, observed) in counts.iter().enumerate() {
            let expected = shares(cell) * f64::from(count);
            if expected < 10.0 {
                (rest, rest_expected) = (rest + observed, rest_expected + expected);
            } else {
                // The integral of a cell is accurate to only a fifth of a percent.
                chi2 += (observed - expected).powi(2) / (expected + (2e-3 * expected).powi(2));
                cells += 1.0;
            }
        }
        if rest_expected > 10.0 {
            (chi2, cells) = (chi2 + (rest - rest_expected).powi(2) / rest_expected, cells + 1.0);
        }
        (chi2 - cells) / (2.0 * cells.max(1.0)).sqrt()
    };
    [chi2(&|cell| expected[cell]), chi2(&|cell| tilted[cell] * scale)]
}
