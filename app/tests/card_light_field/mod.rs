//! A synthetic light field of a card in front of a wall, and pictures of it.

use image::{Rgb, RgbImage};
use std::path::Path;

/// Columns and rows of views, and steps to the outermost on each side.
pub const SIZE: [u32; 2] = [96, 72];
pub const STEPS: i32 = 2;
/// Disparities of the card and of the wall.
pub const CARD: f64 = 1.5;
pub const WALL: f64 = -0.5;

/// The linear radiance and disparity that a view at (u, v) shows at a position.
pub fn shown(x: f64, y: f64, [u, v]: [f64; 2]) -> ([f64; 3], f64) {
    let of = |d: f64| (x + d * u, y + d * v);
    let (cx, cy) = of(CARD);
    let wave = |x: f64, y: f64, k: f64| 0.4 + 0.3 * (0.45 * k * x).sin() * (0.4 * k * y + k).cos();
    if (30.0..62.0).contains(&cx) && (20.0..52.0).contains(&cy) {
        return ([wave(cx, cy, 1.0), 0.5 * wave(cx, cy, 1.4), 0.1], CARD);
    }
    let (wx, wy) = of(WALL);
    ([0.2, 0.7 * wave(wx, wy, 0.8), wave(wx, wy, 1.1)], WALL)
}

/// The same with a highlight on the card that moves with the view.
#[allow(dead_code, reason = "not every test wants it")]
pub fn glossy(x: f64, y: f64, [u, v]: [f64; 2]) -> ([f64; 3], f64) {
    let (mut color, disparity) = shown(x, y, [u, v]);
    if disparity == CARD {
        let at = |at: f64, view: f64, middle: f64| at + CARD * view - middle - 2.0 * view;
        let (x, y) = (at(x, u, 46.0), at(y, v, 36.0));
        let light = 0.3 * (-(x * x + y * y) / 40.0).exp();
        color.iter_mut().for_each(|channel| *channel += light);
    }
    (color, disparity)
}

/// A scene: the radiance and disparity that a view at (u, v) shows at a position.
pub type Scene = fn(f64, f64, [f64; 2]) -> ([f64; 3], f64);

/// A pixel of a view, from 4 × 4 samples.
#[allow(dead_code, reason = "not every test wants it")]
pub fn pixel(x: u32, y: u32, view: [f64; 2]) -> [f64; 3] {
    pixel_at(shown, x.into(), y.into(), view)
}

/// The same for any scene, for the pixel whose upper left corner is at a position.
pub fn pixel_at(scene: Scene, x: f64, y: f64, view: [f64; 2]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for k in 0..16u32 {
        let at = |at: f64, k: u32| at + (f64::from(k) + 0.5) / 4.0;
        let (color, _) = scene(at(x, k % 4), at(y, k / 4), view);
        (0..3).for_each(|c| sum[c] += color[c] / 16.0);
    }
    sum
}

fn encoded(linear: f64) -> u8 {
    let encoded = if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

#[allow(dead_code, reason = "not every test wants it")]
pub fn view(view: [f64; 2]) -> RgbImage {
    view_of(shown, view)
}

fn view_of(scene: Scene, view: [f64; 2]) -> RgbImage {
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| Rgb(pixel_at(scene, x.into(), y.into(), view).map(encoded)))
}

/// Values of the middle view's pixels as a PFM, rows from the bottom.
pub fn pfm(file: &Path, of: impl Fn(f64) -> f64) {
    let mut bytes = format!("Pf\n{} {}\n-1.0\n", SIZE[0], SIZE[1]).into_bytes();
    for y in (0..SIZE[1]).rev() {
        for x in 0..SIZE[0] {
            let (_, disparity) = shown(f64::from(x) + 0.5, f64::from(y) + 0.5, [0.0; 2]);
            bytes.extend((of(disparity) as f32).to_le_bytes());
        }
    }
    std::fs::write(file, bytes).unwrap();
}

/// Five by five views, by row and column, and the disparities of the middle one.
pub fn write(folder: &Path) {
    write_of(shown, folder);
}

/// The same for any scene.
pub fn write_of(scene: Scene, folder: &Path) {
    std::fs::create_dir_all(folder).unwrap();
    for (row, v) in (-STEPS..=STEPS).enumerate() {
        for (column, u) in (-STEPS..=STEPS).enumerate() {
            view_of(scene, [u.into(), v.into()])
                .save(folder.join(format!("{row:02}_{column:02}.png")))
                .unwrap();
        }
    }
    pfm(&folder.join("disparity.pfm"), |disparity| disparity);
}

/// The same scene from cameras that converge, and in other units: views and map have `scale`·d + `offset` for
/// each disparity d, and positions divided by `scale`.
#[allow(dead_code, reason = "not every test moves it")]
pub fn write_moved(folder: &Path, scale: f64, offset: f64) {
    std::fs::create_dir_all(folder).unwrap();
    let mut views = Vec::new();
    for v in -STEPS..=STEPS {
        for u in -STEPS..=STEPS {
            let (u, v) = (f64::from(u), f64::from(v));
            let [across, down] = [u, v].map(|at| at * offset / scale);
            let file = format!("view {u} {v}.png");
            let picture = RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
                Rgb(pixel_at(shown, f64::from(x) + across, f64::from(y) + down, [u, v]).map(encoded))
            });
            picture.save(folder.join(&file)).unwrap();
            views.push(format!("{{\"file\": \"{file}\", \"position\": [{}, {}]}}", u / scale, v / scale));
        }
    }
    let list = format!(
        "{{\"views\": [{}], \"reference\": \"view 0 0.png\", \"disparity\": \"middle.pfm\"}}",
        views.join(", ")
    );
    std::fs::write(folder.join("views.json"), list).unwrap();
    pfm(&folder.join("middle.pfm"), |disparity| scale * disparity + offset);
}

/// Writes the depth of the middle view: white is near.
#[allow(dead_code, reason = "not every test needs it")]
pub fn write_depth(file: &Path) {
    let [width, height] = SIZE;
    let depth = image::GrayImage::from_fn(width, height, |x, y| {
        let (_, disparity) = shown(f64::from(x) + 0.5, f64::from(y) + 0.5, [0.0; 2]);
        image::Luma([if disparity == CARD { 220 } else { 40 }])
    });
    depth.save(file).unwrap();
}
