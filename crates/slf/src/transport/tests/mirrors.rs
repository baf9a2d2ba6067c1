//! A mirror shows the unpainted lens's picture of the mirrored scene, whatever is painted on the mirror.

use super::*;
use lens::{Camera, FocusOffset};
use scene::SurfaceField;
use trace::truth::{self, TruthOptions};

struct Painted(FocusOffset);

impl SurfaceField<FocusOffset> for Painted {
    fn at(&self, _point: SurfacePoint) -> FocusOffset {
        self.0
    }
    fn at_infinity(&self) -> FocusOffset {
        self.0
    }
}

fn picture(scene: Scene, focus: FocusOffset) -> Vec<[f32; 3]> {
    let camera = Camera {
        width: 48,
        height: 32,
        yfov: 0.8,
        focus_distance: 6.0,
        aperture_radius: 0.15,
        sensor_height: 0.05,
        ..Camera::default()
    };
    let tracer = Arc::new(Tracer::new(Arc::new(scene)));
    let world = World::uniform(Vec3::splat(0.05));
    let light =
        Transport::new(tracer.clone(), world, TransportOptions { paths: 1, ..TransportOptions::default() });
    let options = TruthOptions { samples_per_pixel: 256, ..TruthOptions::default() };
    truth::render(&tracer, &light, &Painted(focus), &camera, &options, &Unwatched).unwrap().picture.radiance
}

/// Glowing cards at several depths that face the camera; mirrored in the plane z = −4 if `is_mirrored`.
fn cards(is_mirrored: bool) -> Vec<Rectangle> {
    let place = |z: f64| if is_mirrored { -8.0 - z } else { z };
    [(-0.6, 0.1, 1.0, 1.0), (0.4, -0.9, 2.0, 0.5), (0.9, 0.6, 5.0, 2.0)]
        .map(|(x, y, z, glow)| {
            let material = Material {
                emissive: Vec3::new(glow, glow * 0.5, 0.3),
                base_color: Vec4::ZERO,
                double_sided: true,
                ..Material::lambertian_white()
            };
            Rectangle(DVec3::new(x, y, place(z)), DVec3::X * 0.7, DVec3::Y * 0.5, material)
        })
        .into()
}

fn psnr(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let squares =
        a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| f64::from(a.min(1.0) - b.min(1.0)).powi(2));
    -10.0 * (squares.sum::<f64>() / (3 * a.len()) as f64).log10()
}

#[test]
fn a_mirror_shows_the_ordinary_picture_of_the_mirrored_scene() {
    let mirror = Material {
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar::constant(1.0),
            roughness: Scalar::constant(0.0),
        },
        ..Material::default()
    };
    let plane =
        || Rectangle(DVec3::new(-40.0, -40.0, -4.0), DVec3::X * 80.0, DVec3::Y * 80.0, mirror.clone());
    // The cards lie behind the camera.
    let in_mirror = |focus| {
        let mut walls = cards(false);
        walls.push(plane());
        picture(scene_of(&walls, &[]), focus)
    };
    let straight = picture(scene_of(&cards(true), &[]), FocusOffset::STANDARD);
    for focus in [FocusOffset::STANDARD, FocusOffset::new(1.2, 1.0), FocusOffset::new(0.9, 0.0)] {
        let decibel = psnr(&in_mirror(focus), &straight);
        assert!(decibel > 40.0, "{focus:?}: {decibel} dB");
    }
    // Control: paint on what is seen directly does change its picture.
    let painted = picture(scene_of(&cards(true), &[]), FocusOffset::new(1.2, 1.0));
    assert!(psnr(&painted, &straight) < 35.0);
}
