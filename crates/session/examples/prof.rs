use lens::{Camera, FocusOffset};
use scene::{SurfaceField, SurfacePoint};
use splat::*;
use std::path::Path;
use std::time::Instant;
struct U;
impl SurfaceField<FocusOffset> for U {
    fn at(&self, _: SurfacePoint) -> FocusOffset {
        FocusOffset::STANDARD
    }
    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }
}
// prof SALF SCENE FOCUS|-|project REPS SHARE...
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let reps: usize = a[4].parse().unwrap();
    let salf = if let Ok(d) = a[1].parse::<f64>() {
        std::sync::Arc::new(plane(d))
    } else {
        salf::SalfFile::read(std::io::BufReader::new(std::fs::File::open(&a[1]).unwrap())).unwrap().salf
    };
    let input;
    let focus: Box<dyn SurfaceField<FocusOffset>> = if a[3] == "-" {
        Box::new(U)
    } else {
        input = session::Input::open(Path::new(&a[2]), &progress::Unwatched).unwrap();
        let f = if a[3] == "project" { None } else { Some(Path::new(&a[3])) };
        Box::new(input.focus(f, &atlas::UnwrapOptions::default(), &progress::Unwatched).unwrap())
    };
    let t = Instant::now();
    let mut s = Splatter::new(salf.clone());
    println!(
        "hierarchy {:.0} ms, {} samples, bytes {:?}",
        t.elapsed().as_secs_f64() * 1e3,
        salf.samples.len(),
        s.bytes()
    );
    let cam = salf.camera.clone();
    let ref_path = std::path::PathBuf::from(format!("{}{}.conv", a[1], if a[3] == "-" { "u" } else { "p" }));
    let conv: Vec<[f32; 3]> = if ref_path.exists() {
        let b = std::fs::read(&ref_path).unwrap();
        b.chunks_exact(12)
            .map(|c| [0, 1, 2].map(|k| f32::from_le_bytes(c[4 * k..4 * k + 4].try_into().unwrap())))
            .collect()
    } else {
        s.set_tolerance(Tolerance::NONE);
        s.render(&cam, &*focus, &progress::Unwatched).unwrap();
        let p: Vec<[f32; 3]> = s.picture().radiance.iter().map(|p| (*p).into()).collect();
        std::fs::write(&ref_path, p.iter().flatten().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())
            .unwrap();
        p
    };
    for share in &a[5..] {
        s.set_tolerance(Tolerance { share_of_circle: share.parse().unwrap() });
        s.render(&cam, &*focus, &progress::Unwatched).unwrap();
        let n = conv.len() as f64 * 3.0;
        let e: f64 = s
            .picture()
            .radiance
            .iter()
            .zip(&conv)
            .map(|(a, b)| {
                let a: [f32; 3] = (*a).into();
                (0..3).map(|c| (a[c].clamp(0., 1.) as f64 - b[c].clamp(0., 1.) as f64).powi(2)).sum::<f64>()
            })
            .sum();
        let mut ts = vec![];
        for k in 0..reps {
            let mut c = cam.clone();
            c.focus_distance *= 1.0 + 1e-12 * (k + 1) as f64;
            let t = Instant::now();
            s.refocus(&c, &progress::Unwatched).unwrap();
            ts.push(t.elapsed().as_secs_f64() * 1e3);
        }
        ts.sort_by(|a, b| a.total_cmp(b));
        let db = -10.0 * (e / n).log10();
        let merit = 10f64.powf(db / 15.0) / ts[reps / 2];
        println!(
            "share {share}: median {:.1} ms min {:.1}, {db:.2} dB, merit {merit:.1}",
            ts[reps / 2],
            ts[0]
        );
    }
}
fn plane(d: f64) -> salf::Salf {
    use glam::{Vec2, Vec3};
    use salf::{Domain, Salf, Sample, Visibility};
    let camera =
        Camera { width: 1920, height: 1080, focus_distance: 1e9, aperture_radius: 0.1, ..Camera::default() };
    let depth = (d / 2.0 / camera.optics().splat_radius_px(1.0).abs()) as f32;
    let domain = Domain::new(1920, 1080, d / 2.0);
    let mut samples = vec![];
    for cell in domain.block_rows().into_iter().flatten() {
        let half = cell.side as f32 / 2.0;
        let h = |k: i32| {
            ((cell.corner.x.wrapping_mul(7919) ^ cell.corner.y.wrapping_mul(104729) ^ k * 7717) & 255) as f32
                / 300.0
                + 0.1
        };
        samples.push(Sample {
            center: cell.corner.as_vec2() + half,
            half_size: Vec2::splat(half),
            inverse_depth: depth,
            weight: (cell.side * cell.side) as f32,
            tilt: Vec2::ZERO,
            radiance: Vec3::new(h(1), h(2), h(3)),
            surface: None,
            visibility: Visibility::Open,
        });
    }
    Salf { camera, margin_px: domain.margin as u32, samples: samples.into() }
}
