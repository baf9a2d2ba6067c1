//! Samples follow their density, and dangerous inputs give finite numbers.

use crate::lobes::{Random, all, glass, interface, metal, plastic, toward};
use glam::DVec3;
use material::{Bsdf, Clearcoat, Frame, Interface, Sheen, Surface};
use std::f64::consts::{PI, TAU};

const COSINES: [f64; 5] = [0.02, 0.15, 0.4, 0.75, 1.0];
/// Bands of z and sectors of azimuth that directions are counted in.
const BANDS: usize = 24;
const SECTORS: usize = 24;
const COUNT: usize = 100_000;

fn cell_of(w: DVec3) -> usize {
    let band = ((w.z + 1.0) / 2.0 * BANDS as f64) as usize;
    let sector = ((w.y.atan2(w.x) / TAU + 1.0).fract() * SECTORS as f64) as usize;
    band.min(BANDS - 1) * SECTORS + sector.min(SECTORS - 1)
}

/// The expected share of directions in each cell, from a density.
fn expected(density: &dyn Fn(DVec3) -> f64) -> Vec<f64> {
    let solid_angle = 4.0 * PI / (BANDS * SECTORS) as f64;
    let mean = |index: usize, n: usize| {
        let (band, sector) = (index / SECTORS, index % SECTORS);
        let place = |k: usize| {
            let z = (band as f64 + ((k / n) as f64 + 0.5) / n as f64) * 2.0 / BANDS as f64 - 1.0;
            let azimuth = (sector as f64 + ((k % n) as f64 + 0.5) / n as f64) / SECTORS as f64 * TAU;
            density(toward(z.abs(), azimuth) * DVec3::new(1.0, 1.0, z.signum()))
        };
        (0..n * n).map(place).sum::<f64>() / (n * n) as f64 * solid_angle
    };
    // Cells with many samples are integrated finely.
    let cell = |index: usize| match mean(index, 12) {
        share if share > 2e-3 => mean(index, 56),
        share => share,
    };
    (0..BANDS * SECTORS).map(cell).collect()
}

/// χ² over its degrees of freedom, in standard deviations.
fn deviations(counts: &[f64], expected: &[f64]) -> f64 {
    let (mut chi2, mut cells) = (0.0, 0.0);
    let (mut rest, mut rest_expected) = (0.0, 0.0);
    for (count, share) in counts.iter().zip(expected) {
        let expected_value = share * COUNT as f64;
        if expected_value < 10.0 {
            rest += count;
            rest_expected += expected_value;
        } else {
            // The integral of a cell is accurate to 0.2 % only.
            chi2 += (count - expected_value).powi(2) / (expected_value + (2e-3 * expected_value).powi(2));
            cells += 1.0;
        }
    }
    if rest_expected > 10.0 {
        chi2 += (rest - rest_expected).powi(2) / rest_expected;
        cells += 1.0;
    }
    let freedom: f64 = cells;
    (chi2 - freedom) / (2.0 * freedom.max(1.0)).sqrt()
}

/// The deviation of the samples from their density, in standard deviations: for the density as it is, and for one that is wrong
/// by a cosine, where the lobe is wide enough to show it.
fn drawn(name: &str, surface: &Surface, frame: Frame, cos: f64) -> (f64, Option<f64>) {
    let interface = interface(surface);
    let bsdf = Bsdf::new(surface, frame, &interface);
    let outgoing = toward(cos, 0.3);
    let mut random = Random(11);
    let mut counts = vec![0.0; BANDS * SECTORS];
    let mut lost = 0.0;
    for _ in 0..COUNT {
        match bsdf.sample(outgoing, random.three()) {
            Some(scattered) => counts[cell_of(scattered.incident)] += 1.0,
            None => lost += 1.0,
        }
    }
    let expected = expected(&|w| bsdf.density(outgoing, w));
    let sum: f64 = expected.iter().sum();
    assert!((sum + lost / COUNT as f64 - 1.0).abs() < 0.015, "{name}, cos {cos}: {sum}, lost {lost}");
    let tilted = |k: usize| expected[k] * ((k / SECTORS) as f64 + 0.5);
    let total: f64 = (0..expected.len()).map(tilted).sum();
    let wrong: Vec<f64> = (0..expected.len()).map(|k| tilted(k) / total * sum).collect();
    let occupied = expected.iter().filter(|share| **share * COUNT as f64 > 100.0).count();
    let control = (occupied > 2 * SECTORS).then(|| deviations(&counts, &wrong));
    (deviations(&counts, &expected), control)
}

#[test]
fn samples_follow_their_density() {
    let test = |(name, surface): &(&str, Surface)| {
        for cos in COSINES {
            let (off, control) = drawn(name, surface, Frame::flat(DVec3::Z), cos);
            assert!(off < 5.0, "{name}, cos {cos}: {off} standard deviations");
            assert!(control.is_none_or(|off| off > 5.0), "{name}, cos {cos}: the control passes");
        }
    };
    let surfaces = all();
    let (some, others) = surfaces.split_at(surfaces.len() / 2);
    std::thread::scope(|threads| {
        threads.spawn(|| some.iter().for_each(test));
        others.iter().for_each(test);
    });
}

/// A frame under a coat whose normal leans by about 20° toward +x.
fn bumped() -> Frame {
    Frame::flat(DVec3::Z).coated(DVec3::new(0.36, 0.05, 1.0).normalize())
}

#[test]
fn a_coat_with_its_own_normal_map_reflects_about_its_own_normal() {
    // Smooth, over black: it reflects about its own normal, and the surface beneath about the other one.
    let coat = Some(Clearcoat { factor: 1.0, roughness: 0.0 });
    let black = Surface { clearcoat: coat, base_color: DVec3::ZERO, ..metal(1.0) };
    let interface = interface(&black);
    let outgoing = toward(0.8, 0.3);
    let mirrored = |frame: Frame| {
        let bsdf = Bsdf::new(&black, frame, &interface);
        let mut random = Random(3);
        let drawn = (0..200).filter_map(|_| bsdf.sample(outgoing, random.three()));
        drawn.filter(|scattered| scattered.density.is_none()).collect::<Vec<_>>()
    };
    let about = |normal: DVec3| normal * (2.0 * normal.dot(outgoing)) - outgoing;
    let samples = mirrored(bumped());
    assert!(
        !samples.is_empty() && samples.iter().all(|one| one.incident.distance(about(bumped().coat)) < 1e-12)
    );
    // The control: a normal map of the surface beneath is not the coat's.
    let beneath = Frame::new(DVec3::Z, bumped().coat, DVec3::X).coated(DVec3::Z);
    let samples = mirrored(beneath);
    assert!(!samples.is_empty() && samples.iter().all(|one| one.incident.distance(about(DVec3::Z)) < 1e-12));
    assert!(about(DVec3::Z).distance(about(bumped().coat)) > 0.3, "the two are apart");

    // A rough coat: samples follow the density, weights the evaluation, and no light is created.
    for roughness in [0.3, 0.6] {
        let coat = Some(Clearcoat { factor: 1.0, roughness });
        for surface in [Surface { clearcoat: coat, ..black }, Surface { clearcoat: coat, ..plastic(0.5) }] {
            let bsdf = Bsdf::new(&surface, bumped(), &interface);
            for cos in COSINES {
                let (off, _) = drawn("bumped coat", &surface, bumped(), cos);
                assert!(off < 5.0, "roughness {roughness}, cos {cos}: {off} standard deviations");
                let outgoing = toward(cos, 0.3);
                let mut random = Random(17);
                let mut sent = 0.0;
                for _ in 0..20_000 {
                    let Some(scattered) = bsdf.sample(outgoing, random.three()) else { continue };
                    let density = bsdf.density(outgoing, scattered.incident);
                    let value = bsdf.evaluate(outgoing, scattered.incident).total();
                    let expected_value = value * scattered.incident.z.abs() / density;
                    let off = (expected_value - scattered.weight.total()).abs().max_element();
                    assert!(
                        off < 1e-9 * expected_value.max_element().max(1.0),
                        "roughness {roughness}: {off}"
                    );
                    sent += scattered.weight.total().x / 20_000.0;
                }
                assert!(sent < 1.02, "roughness {roughness}, cos {cos}: {sent}");
            }
            // The control: the density of a coat without a normal map.
            let flat = Bsdf::new(&surface, Frame::flat(DVec3::Z), &interface);
            let outgoing = toward(0.75, 0.3);
            let at = about(bumped().coat);
            let [own, other] = [&bsdf, &flat].map(|bsdf| bsdf.density(outgoing, at));
            assert!((own / other - 1.0).abs() > 0.02, "roughness {roughness}: {own} and {other}");
        }
    }
}

#[test]
fn a_weight_is_value_times_cosine_over_density() {
    for (name, surface) in all() {
        let interface = interface(&surface);
        let frame = Frame::new(DVec3::Z, DVec3::new(0.2, -0.1, 1.0).normalize(), DVec3::X);
        let bsdf = Bsdf::new(&surface, frame, &interface);
        let mut random = Random(5);
        for _ in 0..2000 {
            let outgoing = toward(random.next(), TAU * random.next());
            let Some(scattered) = bsdf.sample(outgoing, random.three()) else { continue };
            let Some(density) = scattered.density else { continue };
            let evaluated_density = bsdf.density(outgoing, scattered.incident);
            assert!(
                (evaluated_density / density - 1.0).abs() < 1e-9,
                "{name}: {evaluated_density} and {density}"
            );
            let cos = frame.normal.dot(scattered.incident).abs();
            let expected_value = bsdf.evaluate(outgoing, scattered.incident).total() * cos / density;
            let off = (expected_value - scattered.weight.total()).abs().max_element();
            // The shading normal is bent for some directions; the cosine is the bent one's then.
            if frame.normal.dot(outgoing) > 0.1 {
                assert!(off < 1e-6 * expected_value.max_element().max(1.0), "{name}: {off}");
            }
        }
    }
}

#[test]
fn mirrors_and_clear_glass_have_no_density() {
    for (surface, crosses) in
        [(metal(0.0), false), (glass(0.0), true), (Surface { is_thin: true, ..glass(0.0) }, true)]
    {
        let interface = interface(&surface);
        let bsdf = Bsdf::new(&surface, Frame::flat(DVec3::Z), &interface);
        let outgoing = toward(0.6, 0.0);
        let mut random = Random(1);
        let mut has_crossed = false;
        for _ in 0..200 {
            let scattered = bsdf.sample(outgoing, random.three()).expect("nothing is lost");
            assert_eq!(scattered.density, None);
            assert_eq!(scattered.weight.own, DVec3::ZERO, "a mirror's picture keeps the lens's focus");
            has_crossed |= scattered.crosses;
            if !scattered.crosses {
                assert!(scattered.incident.distance(DVec3::new(-0.8, 0.0, 0.6)) < 1e-12);
            } else if surface.is_thin {
                assert!(scattered.incident.distance(-outgoing) < 1e-12, "a pane bends nothing");
            } else {
                let sin = scattered.incident.truncate().length();
                assert!((sin - 0.8 / 1.5).abs() < 1e-12, "Snell's law: {sin}");
            }
        }
        assert_eq!(has_crossed, crosses);
        assert_eq!(bsdf.evaluate(outgoing, DVec3::new(-0.8, 0.0, 0.6)).total(), DVec3::ZERO);
    }
    // From inside, beyond the critical angle, reflection is total.
    let surface = glass(0.0);
    let interface = interface(&surface);
    let bsdf = Bsdf::new(&surface, Frame::flat(DVec3::Z), &interface);
    let mut random = Random(2);
    for _ in 0..100 {
        let scattered = bsdf.sample(toward(0.5, 0.0) * DVec3::new(1.0, 1.0, -1.0), random.three()).unwrap();
        assert!(!scattered.crosses && scattered.incident.z < 0.0);
        assert!((scattered.weight.total() - DVec3::ONE).length() < 1e-12);
    }
}

/// No light comes from behind, whatever the shading normal is, and visible surfaces are never black because of it.
#[test]
fn shading_normals_let_nothing_through_and_darken_nothing() {
    for bend in [0.3, 1.0, 3.0] {
        let normal = DVec3::new(bend, 0.0, 1.0).normalize();
        for surface in [plastic(0.5), metal(0.3), plastic(1.0)] {
            let interface = interface(&surface);
            let bsdf = Bsdf::new(&surface, Frame::new(DVec3::Z, normal, DVec3::Y), &interface);
            let mut random = Random(9);
            let mut sent = 0.0;
            const COUNT: u32 = 4000;
            // Seen from the side that the shading normal leans away from.
            let outgoing = toward(0.2, PI);
            for _ in 0..COUNT {
                let Some(scattered) = bsdf.sample(outgoing, random.three()) else { continue };
                assert!(scattered.incident.z > 0.0 && !scattered.crosses);
                sent += scattered.weight.total().x;
                let behind = scattered.incident * DVec3::new(1.0, 1.0, -1.0);
                assert_eq!(bsdf.evaluate(outgoing, behind).total(), DVec3::ZERO);
            }
            assert!(sent / f64::from(COUNT) > 0.05, "bent by {bend}: {}", sent / f64::from(COUNT));
        }
    }
}

#[test]
fn dangerous_inputs_give_numbers() {
    let mut surfaces: Vec<Surface> = all().into_iter().map(|(_, surface)| surface).collect();
    for roughness in [0.0, 1e-4, 1e-3, 1e-2, 1.0] {
        surfaces.extend([metal(roughness), plastic(roughness), glass(roughness)]);
        for ior in [1.0, 1.0 + 1e-9, 100.0] {
            surfaces.push(Surface { ior, ..glass(roughness) });
        }
        surfaces.push(Surface { anisotropy: 1.0, ..metal(roughness) });
        surfaces.push(Surface { base_color: DVec3::ZERO, ..plastic(roughness) });
        surfaces.push(Surface { specular: 1.0, specular_color: DVec3::splat(1e9), ..plastic(roughness) });
        let coat = Some(Clearcoat { factor: 1.0, roughness });
        let sheen = Some(Sheen { color: DVec3::ONE, roughness });
        surfaces.push(Surface { clearcoat: coat, sheen, ..plastic(0.5) });
    }
    let mut random = Random(4);
    for surface in surfaces {
        for interface in [Interface::from_ior(surface.ior), Interface::between(surface.ior, 1.0)] {
            let frames = [
                Frame::flat(DVec3::Z),
                Frame::new(DVec3::Z, DVec3::new(5.0, 0.0, 1.0).normalize(), DVec3::Z),
                Frame::new(DVec3::Z, -DVec3::Z, DVec3::X),
            ];
            for frame in frames {
                let bsdf = Bsdf::new(&surface, frame, &interface);
                for cos in [1.0, 0.5, 1e-3, 1e-6, 1e-12, 0.0, -1e-6, -0.5, -1.0f64] {
                    let outgoing =
                        toward(cos.abs(), 1.0) * DVec3::new(1.0, 1.0, if cos < 0.0 { -1.0 } else { 1.0 });
                    let fine = |x: f64| x.is_finite() && x >= 0.0;
                    let all_fine = |v: DVec3| v.to_array().into_iter().all(fine);
                    assert!(all_fine(bsdf.albedo(outgoing).total()), "{surface:?} {cos}");
                    for _ in 0..20 {
                        if let Some(scattered) = bsdf.sample(outgoing, random.three()) {
                            let weight = scattered.weight.total();
                            assert!(
                                all_fine(weight) && weight.max_element() < 1.01e4,
                                "{surface:?} {cos}: {weight}"
                            );
                            assert!((scattered.incident.length() - 1.0).abs() < 1e-6, "{surface:?} {cos}");
                        }
                        let incident = toward(random.next(), TAU * random.next());
                        for incident in [incident, -incident, outgoing, -outgoing, DVec3::X] {
                            assert!(
                                all_fine(bsdf.evaluate(outgoing, incident).total()),
                                "{surface:?} {cos} {incident}"
                            );
                            assert!(fine(bsdf.density(outgoing, incident)), "{surface:?} {cos} {incident}");
                        }
                    }
                }
            }
        }
    }
}
