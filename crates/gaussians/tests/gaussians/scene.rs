//! Small scenes, the same on every machine: arithmetic and square roots only.

use gaussians::{Axes, CloudBuilder, CloudTraits, GaussianCloud, Splat};
use glam::{DMat4, Quat, Vec3};
use lens::{Camera, FocusOffset};

/// Numbers that look random (Knuth's MMIX).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 32
    }

    /// In [0, 1), 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1u32 << 24) as f32
    }

    pub fn between(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * self.unit()
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }
}

/// `count` splats of all shapes and colours before [`camera`], of a degree.
pub fn scattered(count: usize, degree: u32) -> GaussianCloud {
    let mut random = Random(7);
    let mut builder = CloudBuilder::new(degree, count);
    let coefficients = builder.coefficients_each();
    for _ in 0..count {
        let mut centered = |reach: f32| random.between(-reach, reach);
        let splat = Splat {
            mean: Vec3::new(centered(1.0), centered(0.8), 2.5 + centered(0.7)),
            rotation: Quat::from_xyzw(centered(1.0), centered(1.0), centered(1.0), 0.3 + centered(0.2))
                .normalize(),
            log_scale: Vec3::new(-2.3 + centered(0.5), -2.8 + centered(0.5), -4.0 + centered(1.0)),
            opacity: 0.6 + centered(0.35),
            base_color: Vec3::new(centered(1.5), centered(1.5), centered(1.5)),
        };
        let coefficients: Vec<f32> = (0..coefficients).map(|_| centered(0.3)).collect();
        builder.push(splat, &coefficients);
    }
    builder.finish(CloudTraits::default())
}

/// A wall, a ball with a lobe of gloss, three bars close to the lens, and haze: what a wide aperture looks past, and through.
pub fn still_life() -> GaussianCloud {
    let mut random = Random(3);
    let mut builder = CloudBuilder::new(1, 1024);
    let mut push = |mean: Vec3, normal: Vec3, size: f32, opacity: f32, color: Vec3, lobe: Vec3| {
        let splat = Splat {
            mean,
            rotation: Quat::from_rotation_arc(Vec3::Z, normal.normalize()),
            log_scale: log_scale(size),
            opacity,
            base_color: (color - 0.5) / 0.282_094_8,
        };
        let coefficients: Vec<f32> =
            [lobe.y, lobe.z, lobe.x].into_iter().flat_map(|k| [k, k, 0.5 * k]).collect();
        builder.push(splat, &coefficients);
    };
    // Three layers, so that next to nothing of the background is visible.
    for layer in 0..3 {
        for row in 0..15 {
            for column in 0..19 {
                let shade = if (row / 2 + column / 2) % 2 == 0 { 0.8 } else { 0.25 };
                let color = Vec3::new(shade, 0.7 * shade, random.between(0.2, 0.6));
                let offset = layer as f32 * 0.12;
                let mean = Vec3::new((column as f32 - 9.5) * 0.25, (row as f32 - 7.5) * 0.25, 4.0) + offset;
                push(mean, Vec3::NEG_Z, 0.27, 0.97, color, Vec3::ZERO);
            }
        }
    }
    let mut on_ball = 0;
    while on_ball < 120 {
        let mut side = || random.between(-1.0, 1.0);
        let direction = Vec3::new(side(), side(), side());
        if direction.length_squared() > 1.0 || direction.length_squared() < 0.1 {
            continue;
        }
        on_ball += 1;
        let direction = direction.normalize();
        let color = Vec3::new(0.9, 0.4, 0.15) * (0.6 - 0.4 * direction.y);
        push(Vec3::new(-0.25, 0.1, 2.6) + 0.42 * direction, direction, 0.14, 0.93, color, 0.4 * direction);
    }
    for bar in 0..3 {
        for step in 0..18 {
            let mean = Vec3::new((bar as f32 - 1.0) * 0.22, (step as f32 - 8.5) * 0.06, 1.2);
            push(mean, Vec3::NEG_Z, 0.05, 0.97, Vec3::new(0.1, 0.3, 0.2 + 0.2 * bar as f32), Vec3::ZERO);
        }
    }
    for _ in 0..25 {
        let mut side = || random.between(-1.0, 1.0);
        let mean = Vec3::new(0.8 * side(), 0.6 * side(), 2.5 + side());
        let color = Vec3::splat(0.5 + 0.4 * side());
        push(mean, Vec3::new(side(), side(), 1.5), 0.2, 0.1, color, Vec3::ZERO);
    }
    builder.finish(CloudTraits { axes: Axes::RIGHT_DOWN_FORWARD, ..CloudTraits::default() })
}

/// ln of a flat splat's scales: two of 0.7 sizes, one of 0.05, with logarithms of powers of two alone, which are exact everywhere.
fn log_scale(size: f32) -> Vec3 {
    // The nearest 64th of an octave, by comparison of squares.
    let octaves = |target: f32| {
        let (mut value, mut steps) = (1.0f64, 0i32);
        const STEP: f64 = 1.010_889_286_051_700_5;
        while value > f64::from(target) {
            value /= STEP;
            steps -= 1;
        }
        (f64::from(steps) * std::f64::consts::LN_2 / 64.0) as f32
    };
    Vec3::new(octaves(0.7 * size), octaves(0.7 * size), octaves(0.05 * size))
}

/// A camera that looks along +z of the file, with y down.
pub fn camera() -> Camera {
    Camera {
        width: 48,
        height: 36,
        yfov: 0.7,
        focus_distance: 2.6,
        aperture_radius: 0.12,
        sensor_height: 0.024,
        camera_to_world: DMat4::from_diagonal(glam::DVec4::new(1.0, -1.0, -1.0, 1.0)),
        background: Some([0.0; 3]),
        ..Camera::default()
    }
}

/// Paint: the wall sharp, and half of the ball out of focus.
pub fn focus(cloud: &GaussianCloud) -> Vec<FocusOffset> {
    let offset = |mean: &Vec3| match mean {
        mean if mean.z > 3.9 => FocusOffset::SHARP,
        mean if mean.z > 2.0 && mean.z < 3.2 && mean.x < -0.25 => FocusOffset::new(1.025, 1.0),
        _ => FocusOffset::STANDARD,
    };
    cloud.means().iter().map(offset).collect()
}
