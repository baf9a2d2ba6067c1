//! Photographs left out, and what the light from the others makes of them.
//!
//! ```text
//! left_out CAPTURE NAME,NAME,… [texels a side of the atlas] [card]
//! ```
//!
//! CAPTURE has `images`, `sparse/cameras.txt`, `sparse/images.txt` (COLMAP; PINHOLE or SIMPLE_RADIAL) and `mesh.ply` (binary). Prints PSNR
//! (linear, of the photograph's own exposure, clipped to [0, 1], where at least two others see the surface) of the light, its constant
//! part, and of the photograph that sees the surface most squarely. A gain by channel is fitted to what was left out.

use atlas::{Atlas, Density, UnwrapOptions};
use glam::{DMat3, DMat4, DQuat, DVec2, DVec3, Vec3, Vec4};
use lens::{CalibratedLens, Distortion, Intrinsics, Projection};
use progress::Unwatched;
use rayon::prelude::*;
use scene::{LoadOptions, Photograph, Scene, SurfaceMesh, SurfacePoint, View};
use slf::{PhotographLight, PhotographOptions};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use trace::{Radiance, Ray, Tracer};

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, capture, left_out, ..] = arguments.as_slice() else { panic!("left_out CAPTURE NAME,NAME") };
    let capture = Path::new(capture);
    let side = arguments.get(3).and_then(|side| side.parse().ok());
    let mut views = views(capture);
    let scene = Arc::new(Scene::of_mesh(mesh(&capture.join("mesh.ply")), &LoadOptions::default()).unwrap());
    let tracer = Tracer::new(scene.clone());
    let clock = Instant::now();
    let atlas = kept_atlas(capture, &scene, side);
    println!(
        "atlas {} × {}, {} charts: {:.1} s",
        atlas.width,
        atlas.height,
        atlas.charts.len(),
        clock.elapsed().as_secs_f64()
    );
    if arguments.iter().any(|argument| argument == "card") {
        paint_cards(&mut views);
    }
    let (left, kept): (Vec<View>, Vec<View>) =
        views.into_iter().partition(|view| left_out.split(',').any(|name| name == view.name));
    let clock = Instant::now();
    let light =
        PhotographLight::solve(&tracer, &atlas, &kept, &PhotographOptions::default(), &Unwatched).unwrap();
    println!("light: {:.1} s, peak {} MB", clock.elapsed().as_secs_f64(), peak_megabytes());
    exposure_errors(capture, &kept, &light);
    let mut sums = [0.0; 4];
    for view in &left {
        let photograph = view.photograph(&LoadOptions::default()).unwrap();
        let compared = Compared::of(&tracer, view, &kept);
        let db = [
            compared.psnr(
                view,
                &tracer,
                &photograph,
                &|point, eye| light.toward(point, eye),
                &light,
                "light",
            ),
            compared.psnr(view, &tracer, &photograph, &|point, _| light.constant(point), &light, "constant"),
            compared.psnr_inside(view, &tracer, &photograph, &|point, eye| light.toward(point, eye), &light),
            compared.psnr_inside(view, &tracer, &photograph, &|point, _| light.constant(point), &light),
        ];
        println!(
            "{} light {:.2} constant {:.2}   inside: light {:.2} constant {:.2}",
            view.name, db[0], db[1], db[2], db[3]
        );
        sums.iter_mut().zip(db).for_each(|(sum, db)| *sum += db);
    }
    let [light, constant, inside, constant_inside] = sums.map(|sum| sum / left.len() as f64);
    println!(
        "all light {light:.2} constant {constant:.2}   inside: light {inside:.2} constant {constant_inside:.2}"
    );
}

/// Pixels of a left out view that count, and the points that they show.
struct Compared {
    width: u32,
    counts: Vec<bool>,
    inner: Vec<bool>,
}

/// Rays a pixel, each way.
const RAYS: u32 = 3;

fn hit(tracer: &Tracer, view: &View, pixel: DVec2) -> Option<SurfacePoint> {
    let direction = view.direction(pixel)?;
    let ray = Ray { origin: view.position(), direction, t_min: 0.0, t_max: f64::INFINITY, skip: None };
    tracer.first_hit(&ray).map(|hit| hit.point)
}

impl Compared {
    fn of(tracer: &Tracer, view: &View, others: &[View]) -> Self {
        let [width, height] = view.lens.size_px();
        let scene = tracer.scene();
        let counts: Vec<bool> = (0..width * height)
            .into_par_iter()
            .map(|number| {
                let pixel = DVec2::new(f64::from(number % width) + 0.5, f64::from(number / width) + 0.5);
                let Some(point) = hit(tracer, view, pixel) else { return false };
                let position = point.position(scene);
                let normal = scene.area_normal(point.triangle).normalize_or_zero();
                let sees = |other: &&View| {
                    let toward = (other.position() - position).normalize_or_zero();
                    let is_in = other.project(position).is_some_and(|pixel| {
                        let size = DVec2::from(other.lens.size_px().map(f64::from));
                        pixel.min(size - pixel).min_element() > 1.5
                    });
                    is_in && normal.dot(toward).abs() > 0.15 && !tracer.occluded(point, other.position())
                };
                others.iter().filter(sees).take(2).count() == 2
            })
            .collect();
        let at = |x: i64, y: i64| {
            x >= 0
                && y >= 0
                && x < i64::from(width)
                && y < i64::from(height)
                && counts[(y * i64::from(width) + x) as usize]
        };
        let inner = (0..i64::from(width * height)).map(|n| {
            let (x, y) = (n % i64::from(width), n / i64::from(width));
            (-2..=2).all(|dy| (-2..=2).all(|dx| at(x + dx, y + dy)))
        });
        let inner = inner.collect();
        Self { width, counts, inner }
    }

    fn psnr(
        &self,
        view: &View,
        tracer: &Tracer,
        photograph: &Photograph,
        of: &(dyn Fn(SurfacePoint, DVec3) -> Vec3 + Sync),
        light: &PhotographLight,
        name: &str,
    ) -> f64 {
        self.psnr_of(&self.counts, view, tracer, photograph, of, light, Some(name))
    }

    fn psnr_inside(
        &self,
        view: &View,
        tracer: &Tracer,
        photograph: &Photograph,
        of: &(dyn Fn(SurfacePoint, DVec3) -> Vec3 + Sync),
        light: &PhotographLight,
    ) -> f64 {
        self.psnr_of(&self.inner, view, tracer, photograph, of, light, None)
    }

    #[allow(clippy::too_many_arguments, reason = "an example")]
    fn psnr_of(
        &self,
        counts: &[bool],
        view: &View,
        tracer: &Tracer,
        photograph: &Photograph,
        of: &(dyn Fn(SurfacePoint, DVec3) -> Vec3 + Sync),
        light: &PhotographLight,
        name: Option<&str>,
    ) -> f64 {
        let eye = view.position();
        let shown: Vec<(usize, Vec3)> = (0..counts.len())
            .into_par_iter()
            .filter(|&number| counts[number])
            .map(|number| {
                let (x, y) = (number as u32 % self.width, number as u32 / self.width);
                let mut sum = Vec3::ZERO;
                for k in 0..RAYS * RAYS {
                    let inside =
                        DVec2::new(f64::from(k % RAYS) + 0.5, f64::from(k / RAYS) + 0.5) / f64::from(RAYS);
                    let pixel = DVec2::new(x.into(), y.into()) + inside;
                    sum += match hit(tracer, view, pixel) {
                        Some(point) => of(point, eye),
                        None => view
                            .direction(pixel)
                            .map_or(Vec3::ZERO, |direction| light.from_infinity(direction)),
                    };
                }
                (number, sum / (RAYS * RAYS) as f32)
            })
            .collect();
        let gain = Vec3::from_array(std::array::from_fn(|channel| {
            let mut ratios: Vec<f32> = shown
                .iter()
                .map(|&(number, light)| (photograph.pixels[number][channel], light[channel]))
                .filter(|&(photo, light)| (0.01..0.97).contains(&photo) && light > 0.001)
                .map(|(photo, light)| photo / light)
                .collect();
            ratios.sort_by(f32::total_cmp);
            ratios.get(ratios.len() / 2).copied().unwrap_or(1.0)
        }));
        if let (Some(name), Ok(folder)) = (name, std::env::var("PICTURES")) {
            let mut bytes = vec![0u8; photograph.pixels.len() * 3 * 2];
            let mut put = |number: usize, right: bool, light: Vec3| {
                let (x, y) = (number % self.width as usize, number / self.width as usize);
                let at = (y * 2 * self.width as usize + x + usize::from(right) * self.width as usize) * 3;
                for channel in 0..3 {
                    bytes[at + channel] =
                        (light[channel].clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0 + 0.5) as u8;
                }
            };
            for &(number, light) in &shown {
                put(number, false, light * gain);
            }
            for (number, pixel) in photograph.pixels.iter().enumerate() {
                put(number, true, Vec3::from_array(*pixel));
            }
            let file = format!("{folder}/{}.{name}.png", view.name);
            image::save_buffer(
                file,
                &bytes,
                self.width * 2,
                photograph.height,
                image::ExtendedColorType::Rgb8,
            )
            .unwrap();
        }
        let error: f64 = shown
            .iter()
            .map(|&(number, light)| {
                let photo = Vec3::from_array(photograph.pixels[number]);
                let off = (light * gain).clamp(Vec3::ZERO, Vec3::ONE) - photo.clamp(Vec3::ZERO, Vec3::ONE);
                f64::from(off.length_squared()) / 3.0
            })
            .sum();
        -10.0 * (error / shown.len() as f64).log10()
    }
}

/// How far the exposures are off those of `exposures.json`, if there are any.
fn exposure_errors(capture: &Path, kept: &[View], light: &PhotographLight) {
    let Ok(text) = std::fs::read_to_string(capture.join("exposures.json")) else { return };
    let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
    let wanted: Vec<f64> = kept.iter().map(|view| truth[&view.name].as_f64().unwrap()).collect();
    let mean = wanted.iter().sum::<f64>() / wanted.len() as f64;
    let errors: Vec<f64> = light
        .exposures()
        .iter()
        .zip(&wanted)
        .flat_map(|(found, wanted)| found.gain_stops.map(|gain| (gain - (wanted - mean)).abs()))
        .collect();
    if std::env::var("VERBOSE").is_ok() {
        for (view, (found, wanted)) in kept.iter().zip(light.exposures().iter().zip(&wanted)) {
            println!("{} {:.3?} wanted {:.3}", view.name, found.gain_stops, wanted - mean);
        }
    }
    let worst = errors.iter().copied().fold(0.0, f64::max);
    println!(
        "exposures off by {:.3} stops in the mean, {worst:.3} at most; vignetting {:?}",
        errors.iter().sum::<f64>() / errors.len() as f64,
        light.exposures()[0].vignetting_stops
    );
}

/// Paints a card into every fifth picture, into a copy.
fn paint_cards(views: &mut [View]) {
    let folder = std::env::temp_dir().join("left_out_cards");
    std::fs::create_dir_all(&folder).unwrap();
    for (number, view) in views.iter_mut().enumerate().filter(|(number, _)| number % 5 == 2) {
        let mut picture = image::open(&view.picture).unwrap().into_rgb8();
        let (width, height) = picture.dimensions();
        let corner =
            [width / 3 + (number as u32 * 7) % (width / 6), height / 3 + (number as u32 * 5) % (height / 6)];
        for y in corner[1]..(corner[1] + height / 4).min(height) {
            for x in corner[0]..(corner[0] + width / 5).min(width) {
                picture.put_pixel(x, y, image::Rgb([230, 60, 200]));
            }
        }
        view.picture = folder.join(format!("{number}.png"));
        picture.save(&view.picture).unwrap();
    }
}

fn peak_megabytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or("VmHWM: 0 kB");
    line.split_whitespace().nth(1).and_then(|kb| kb.parse::<u64>().ok()).unwrap_or(0) / 1024
}

fn kept_atlas(capture: &Path, scene: &Scene, side: Option<u32>) -> Atlas {
    let density = side.map_or(Density::Auto, Density::Side);
    let file = capture.join(format!("atlas-{}.bin", side.unwrap_or(0)));
    if let Ok(bytes) = std::fs::read(&file) {
        return Atlas::from_bytes(&bytes, scene).unwrap();
    }
    let atlas =
        Atlas::unwrap(scene, &UnwrapOptions { density, ..UnwrapOptions::default() }, &Unwatched).unwrap();
    std::fs::write(file, atlas.to_bytes()).unwrap();
    atlas
}

fn views(capture: &Path) -> Vec<View> {
    let folder = if capture.join("sparse").exists() { "sparse" } else { "sparse_txt" };
    let lines = |name: &str| std::fs::read_to_string(capture.join(folder).join(name)).unwrap();
    let cameras = lines("cameras.txt");
    let camera: Vec<&str> =
        cameras.lines().find(|line| !line.starts_with('#')).unwrap().split_whitespace().collect();
    let numbers: Vec<f64> = camera[2..].iter().map(|word| word.parse().unwrap()).collect();
    let size_px = [numbers[0] as u32, numbers[1] as u32];
    let (focal_px, principal_px, distortion) = match camera[1] {
        "PINHOLE" => ([numbers[2], numbers[3]], [numbers[4], numbers[5]], Distortion::default()),
        "SIMPLE_RADIAL" => ([numbers[2]; 2], [numbers[3], numbers[4]], Distortion::radial(&[numbers[5]])),
        other => panic!("{other}"),
    };
    let intrinsics = Intrinsics { size_px, focal_px, skew_px: 0.0, principal_px };
    let lens = CalibratedLens::new(intrinsics, Projection::Perspective, distortion).unwrap();
    let view = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let n: Vec<f64> = words[1..8].iter().map(|word| word.parse().unwrap()).collect();
        let camera_from_world = DMat3::from_quat(DQuat::from_xyzw(n[1], n[2], n[3], n[0]).normalize());
        let world_from_camera = camera_from_world.transpose();
        let position = world_from_camera * -DVec3::new(n[4], n[5], n[6]);
        let axes = world_from_camera * DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
        View {
            name: words[9].into(),
            picture: capture.join("images").join(words[9]),
            orientation: 1,
            exif_orientation: 1,
            lens,
            camera_to_world: DMat4::from_mat3_translation(axes, position),
            mask: None,
            exposure_hint: None,
        }
    };
    lines("images.txt")
        .lines()
        .filter(|line| line.split_whitespace().count() == 10 && line.contains(".jpg"))
        .map(view)
        .collect()
}

fn mesh(file: &Path) -> SurfaceMesh {
    let bytes = std::fs::read(file).unwrap();
    let end = bytes.windows(11).position(|word| word == b"end_header\n").unwrap() + 11;
    let header = String::from_utf8_lossy(&bytes[..end]).into_owned();
    let mut data = &bytes[end..];
    let mut take = |count: usize| {
        let (now, rest) = data.split_at(count);
        data = rest;
        now
    };
    let mut mesh = SurfaceMesh { path: file.into(), name: "mesh".into(), ..SurfaceMesh::default() };
    let lines: Vec<Vec<&str>> = header.lines().map(|line| line.split_whitespace().collect()).collect();
    let mut elements: Vec<(&str, usize, Vec<Vec<&str>>)> = Vec::new();
    for words in &lines {
        match words.as_slice() {
            ["element", name, count] => elements.push((name, count.parse().unwrap(), Vec::new())),
            ["property", ..] => elements.last_mut().unwrap().2.push(words.clone()),
            _ => {}
        }
    }
    for (name, count, properties) in elements {
        for _ in 0..count {
            if name == "vertex" {
                let (mut position, mut normal, mut color) = (DVec3::ZERO, Vec3::ZERO, None);
                for property in &properties {
                    let value = match property[1] {
                        "float" | "float32" => f64::from(f32::from_le_bytes(take(4).try_into().unwrap())),
                        "double" | "float64" => f64::from_le_bytes(take(8).try_into().unwrap()),
                        "uchar" | "uint8" => f64::from(take(1)[0]),
                        other => panic!("{other}"),
                    };
                    match property[2] {
                        "x" => position.x = value,
                        "y" => position.y = value,
                        "z" => position.z = value,
                        "nx" => normal.x = value as f32,
                        "ny" => normal.y = value as f32,
                        "nz" => normal.z = value as f32,
                        "red" => color.get_or_insert(Vec4::ONE).x = value as f32 / 255.0,
                        _ => {}
                    }
                }
                mesh.positions.push(position);
                if normal != Vec3::ZERO {
                    mesh.normals.push(normal);
                }
            } else {
                let corners = take(1)[0];
                assert_eq!(corners, 3);
                mesh.triangles.push(std::array::from_fn(|_| u32::from_le_bytes(take(4).try_into().unwrap())));
            }
        }
    }
    if mesh.normals.len() != mesh.positions.len() {
        mesh.normals.clear();
    }
    mesh
}
