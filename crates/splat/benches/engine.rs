//! Times the engine on a baked light field: `cargo bench -p splat --bench engine -- X.salf [OUT.pfm]`.

use lens::{FocusOffset, Picture};
use progress::Unwatched;
use rayon::prelude::*;
use salf::SalfFile;
use scene::{SurfaceField, SurfacePoint};
use splat::{Splatter, Tolerance};
use std::fs::File;
use std::io::BufReader;
use std::time::Instant;

/// Paint by triangle: none, absolute and sharp, or shifted.
struct Painted(bool);

impl SurfaceField<FocusOffset> for Painted {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        if !self.0 {
            return FocusOffset::STANDARD;
        }
        match point.triangle / 512 % 4 {
            0 => FocusOffset::STANDARD,
            1 => FocusOffset::SHARP,
            2 => FocusOffset::new(1.02, 0.5),
            _ => FocusOffset::new(0.98, 0.0),
        }
    }
    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }
}

fn main() {
    let files: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let file = SalfFile::read(BufReader::new(File::open(&files[0]).expect("a file"))).expect("a light field");
    let salf = file.salf;
    let camera = salf.camera.clone();
    let copy = copy_seconds(camera.width as usize * camera.height as usize);
    let report = |what: &str, seconds: f64| {
        println!("{what:<42} {:>10.1} ms {:>9.1} F", seconds * 1e3, seconds / copy);
    };
    report("copy one frame (F)", copy);
    let start = Instant::now();
    let mut splatter = Splatter::new(salf.clone());
    report("hierarchy", start.elapsed().as_secs_f64());
    println!("bytes of hierarchy and sums: {:?}", splatter.bytes().map(|bytes| bytes >> 20));
    for painted in [false, true] {
        splatter.set_tolerance(Tolerance::NONE);
        splatter.render(&camera, &Painted(painted), &Unwatched).expect("in range");
        let seconds = time(|| splatter.refocus(&camera, &Unwatched).expect("in range"));
        report(&format!("converged, painted {painted}"), seconds);
        let converged = splatter.picture().clone();
        let coverage = &converged.coverage;
        let beyond = coverage.iter().filter(|c| (**c - 1.0).abs() > 0.005).count();
        println!("  coverage beyond 0.5 %: {:.3} %", 100.0 * beyond as f64 / coverage.len() as f64);
        if let (Some(file), false) = (files.get(1), painted) {
            write_pfm(file, &converged);
            if let Some(file) = files.get(2) {
                let mut c = converged.clone();
                c.radiance = c.coverage.iter().map(|&c| [c; 3]).collect();
                write_pfm(file, &c);
            }
        }
        for share in [0.125, 0.25, 0.5] {
            splatter.set_tolerance(Tolerance { share_of_circle: share });
            splatter.render(&camera, &Painted(painted), &Unwatched).expect("in range");
            let seconds =
                median((0..5).map(|_| time(|| splatter.refocus(&camera, &Unwatched).expect("in range"))));
            report(&format!("share {share}, painted {painted}"), seconds);
            println!("  {:?}", splatter.drawn_nodes());
            println!("  {:.1} dB against converged", psnr(splatter.picture(), &converged));
        }
    }
    let changed: Vec<u32> = (0..5000).map(|k| k + salf.samples.len() as u32 / 3).collect();
    let seconds = median((0..20).map(|k| {
        time(|| {
            splatter.update(&Painted(k % 2 == 0), &changed).expect("in range");
        })
    }));
    report("dab of 5000 samples in a row", seconds);
}

fn psnr(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.radiance.iter().flatten().zip(b.radiance.iter().flatten());
    let square: f64 = pairs.map(|(a, b)| (a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).powi(2) as f64).sum();
    -10.0 * (square / (3 * a.radiance.len()) as f64).log10()
}

fn write_pfm(file: &str, picture: &Picture) {
    let mut bytes = format!("PF\n{} {}\n-1.0\n", picture.width, picture.height).into_bytes();
    for row in picture.radiance.chunks(picture.width as usize).rev() {
        bytes.extend(row.iter().flatten().flat_map(|value| value.to_le_bytes()));
    }
    std::fs::write(file, bytes).expect("a writable file");
}

fn time(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(seconds: impl Iterator<Item = f64>) -> f64 {
    let mut seconds: Vec<f64> = seconds.collect();
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

/// The median time of copying `pixels` of three floats with all cores.
fn copy_seconds(pixels: usize) -> f64 {
    let (from, mut to) = (vec![[1.0f32; 3]; pixels], vec![[0.0f32; 3]; pixels]);
    median((0..21).map(|_| {
        time(|| {
            to.par_chunks_mut(1 << 16)
                .zip(from.par_chunks(1 << 16))
                .for_each(|(to, from)| to.copy_from_slice(from));
            std::hint::black_box(&to);
        })
    }))
}
