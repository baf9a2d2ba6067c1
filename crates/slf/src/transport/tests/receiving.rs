use super::*;
use crate::{Irradiance, IrradianceOptions};
use scene::{Environment, EnvironmentMap};

/// Spots of a floor, a pixel each.
fn spots() -> Vec<Spot> {
    let place = |k: u32| DVec2::new(f64::from(k % 8), f64::from(k / 8)) + 0.5;
    let spot = |k: u32| Spot {
        // A square within the first triangle.
        point: SurfacePoint { triangle: 0, barycentric: DVec2::splat(0.1) + place(k) * 0.04 },
        pixel: place(k),
    };
    (0..64).map(spot).collect()
}

/// A bright upper half of the sky, and a sun.
fn sky() -> World {
    let (width, height) = (32u32, 16u32);
    let mut texels: Vec<[f32; 3]> =
        (0..width * height).map(|k| if k / width < height / 2 { [0.5; 3] } else { [0.1; 3] }).collect();
    texels[(3 * width + 11) as usize] = [60.0; 3];
    let map = EnvironmentMap { name: "sky".into(), width, height, texels };
    World { environment: Environment::Map(Arc::new(map)), ..World::uniform(Vec3::ZERO) }
}

#[test]
fn what_is_told_is_what_a_point_finds_by_itself() {
    let gloss = |roughness: f32| Material {
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar { factor: 0.0, texture: None },
            roughness: Scalar { factor: roughness, texture: None },
        },
        specular: Scalar { factor: 1.0, texture: None },
        ..grey()
    };
    let directional = light(LightKind::Directional, DVec3::ZERO, DVec3::new(-0.6, -0.8, 0.0));
    let point = light(LightKind::Point, DVec3::new(0.5, 3.0, 0.2), DVec3::ZERO);
    for lights in [vec![], vec![directional.clone()], vec![point.clone()], vec![directional, point]] {
        for material in [grey(), gloss(0.8)] {
            let scene = scene_of(&[floor(material)], &lights);
            let options =
                TransportOptions { paths: 2048, light_samples: 2048, ..TransportOptions::default() };
            let tracer = Arc::new(Tracer::new(Arc::new(scene)));
            let transport = Transport::new(tracer, sky(), options);
            let solved = IrradianceOptions { patches: 200, rays: 64 };
            let kept = Irradiance::solve(&transport, solved, &Unwatched).unwrap();
            let transport = transport.with_irradiance(Arc::new(kept));
            let spots = spots();
            let told = transport.received(&spots, ABOVE);
            for (spot, received) in spots.iter().zip(told).step_by(9) {
                assert!(received.is_some(), "nothing shades {spot:?}");
                let among = |received| Among { received, ..Among::alone(7) };
                let leaving = |received| transport.leaving_among(spot.point, ABOVE, among(received)).own;
                let (found, expected) = (leaving(received), leaving(None));
                let off = (found - expected).abs().max_element() / expected.max_element();
                assert!(off < 0.02, "{} lights: {found}, not {expected}", lights.len());
            }
        }
    }
}
