//! SOG.

use super::{smallest_three, unit_byte};
use gaussians::{GaussianCloud, Splat};
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder};
use serde_json::{Value, json};
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// The files of a scene, by name: `meta.json` and pictures, version 1 or 2.
pub fn sog_files(cloud: &GaussianCloud, version: u32) -> Vec<(String, Vec<u8>)> {
    let splats: Vec<Splat> = (0..cloud.len()).map(|index| cloud.splat(index)).collect();
    let logarithm = |x: f32| f64::from(x).signum() * f64::from(x).abs().ln_1p();
    let means: Vec<[f64; 3]> = splats.iter().map(|splat| splat.mean.to_array().map(logarithm)).collect();
    let (mean_mins, mean_maxs) = ends(&means);
    let shares: Vec<[u16; 3]> = means
        .iter()
        .map(|mean| {
            [0, 1, 2]
                .map(|k| ((mean[k] - mean_mins[k]) / (mean_maxs[k] - mean_mins[k]) * 65535.0).round() as u16)
        })
        .collect();
    let bytes_of = |high: bool| {
        let part = move |share: u16| share.to_le_bytes()[usize::from(high)];
        shares.iter().map(move |[x, y, z]| [part(*x), part(*y), part(*z), 255]).collect::<Vec<_>>()
    };
    let scales = Quantised::new(
        splats.iter().map(|splat| splat.log_scale.to_array().map(f64::from)).collect(),
        version,
    );
    let colors = Quantised::new(
        splats.iter().map(|splat| splat.base_color.to_array().map(f64::from)).collect(),
        version,
    );
    let logits: Vec<[f64; 1]> =
        splats.iter().map(|s| [f64::from(Splat::logit_of_opacity(s.opacity))]).collect();
    let (logit_min, logit_max) = ends(&logits);
    let opacity = |index: usize| match version {
        1 => unit_byte(((logits[index][0] - logit_min[0]) / (logit_max[0] - logit_min[0])) as f32),
        _ => unit_byte(splats[index].opacity),
    };
    let rotations = splats.iter().map(|splat| {
        let (largest, others) = smallest_three(splat);
        let [a, b, c] = others.map(|x| unit_byte((x + 1.0) / 2.0));
        [a, b, c, 252 + largest as u8]
    });
    let color_pixels =
        colors.pixels.iter().enumerate().map(|(index, [r, g, b])| [*r, *g, *b, opacity(index)]);
    let mut files = vec![
        ("means_l.webp".to_string(), picture(bytes_of(false))),
        ("means_u.webp".into(), picture(bytes_of(true))),
        ("scales.webp".into(), picture(scales.pixels.iter().map(|[a, b, c]| [*a, *b, *c, 255]).collect())),
        ("quats.webp".into(), picture(rotations.collect())),
        ("sh0.webp".into(), picture(color_pixels.collect())),
    ];
    let mut sh0 = colors.description("sh0.webp");
    let mut meta = json!({
        "means": {"shape": [cloud.len(), 3], "mins": mean_mins, "maxs": mean_maxs, "files": ["means_l.webp", "means_u.webp"]},
        "scales": scales.description("scales.webp"),
        "quats": {"files": ["quats.webp"]},
    });
    if version == 1 {
        sh0["mins"].as_array_mut().expect("a list").push(logit_min[0].into());
        sh0["maxs"].as_array_mut().expect("a list").push(logit_max[0].into());
    } else {
        meta["version"] = 2.into();
        meta["count"] = cloud.len().into();
        meta["antialias"] = true.into();
    }
    meta["sh0"] = sh0;
    if cloud.degree() > 0 {
        meta["shN"] = palette(cloud, version, &mut files);
    }
    files.insert(0, ("meta.json".into(), meta.to_string().into_bytes()));
    files
}

/// An entry of the palette for each splat.
fn palette(cloud: &GaussianCloud, version: u32, files: &mut Vec<(String, Vec<u8>)>) -> Value {
    let count = cloud.coefficients(0).len() / 3;
    let all: Vec<f64> =
        (0..cloud.len()).flat_map(|k| cloud.coefficients(k).iter().map(|x| x.to_f64())).collect();
    let (least, most) =
        all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    let rows = cloud.len().div_ceil(64);
    let mut centroids = vec![[0, 0, 0, 255]; 64 * count * rows];
    for (index, rgb) in all.chunks(3).enumerate() {
        let (splat, k) = (index / count, index % count);
        let byte = |x: f64| unit_byte(((x - least) / (most - least)) as f32);
        centroids[splat / 64 * 64 * count + splat % 64 * count + k] =
            [byte(rgb[0]), byte(rgb[1]), byte(rgb[2]), 255];
    }
    files.push(("shN_centroids.webp".into(), webp(&centroids, 64 * count, rows)));
    let label = |index: usize| [(index & 255) as u8, (index >> 8) as u8, 0, 255];
    files.push(("shN_labels.webp".into(), picture((0..cloud.len()).map(label).collect())));
    let names = ["shN_centroids.webp", "shN_labels.webp"];
    match version {
        1 => json!({"mins": least, "maxs": most, "files": names}),
        _ => {
            let codebook: Vec<f64> =
                (0..256).map(|k| least + (most - least) * f64::from(k) / 255.0).collect();
            json!({"count": cloud.len(), "bands": cloud.degree(), "codebook": codebook, "files": names})
        }
    }
}

/// Vectors as bytes.
struct Quantised {
    pixels: Vec<[u8; 3]>,
    mins: [f64; 3],
    maxs: [f64; 3],
    version: u32,
}

impl Quantised {
    /// Version 1 has a range for each channel, 2 a codebook for all: here even steps over their common range.
    fn new(values: Vec<[f64; 3]>, version: u32) -> Self {
        let (mut mins, mut maxs) = ends(&values);
        if version != 1 {
            mins = [mins.into_iter().fold(f64::INFINITY, f64::min); 3];
            maxs = [maxs.into_iter().fold(f64::NEG_INFINITY, f64::max); 3];
        }
        let byte =
            |value: &[f64; 3], k: usize| unit_byte(((value[k] - mins[k]) / (maxs[k] - mins[k])) as f32);
        let pixels = values.iter().map(|value| [0, 1, 2].map(|k| byte(value, k))).collect();
        Self { pixels, mins, maxs, version }
    }

    fn description(&self, file: &str) -> Value {
        if self.version == 1 {
            return json!({"mins": self.mins, "maxs": self.maxs, "files": [file]});
        }
        let step = (self.maxs[0] - self.mins[0]) / 255.0;
        let codebook: Vec<f64> = (0..256).map(|k| self.mins[0] + step * f64::from(k)).collect();
        json!({"codebook": codebook, "files": [file]})
    }
}

fn ends<const N: usize>(values: &[[f64; N]]) -> ([f64; N], [f64; N]) {
    let (mut mins, mut maxs) = ([f64::INFINITY; N], [f64::NEG_INFINITY; N]);
    for value in values {
        for k in 0..N {
            (mins[k], maxs[k]) = (mins[k].min(value[k]), maxs[k].max(value[k]));
        }
    }
    (mins, maxs)
}

/// A picture as wide as high, rounded up to four.
fn picture(mut pixels: Vec<[u8; 4]>) -> Vec<u8> {
    let width = ((pixels.len() as f64).sqrt() / 4.0).ceil() as usize * 4;
    let height = pixels.len().div_ceil(width).next_multiple_of(4);
    pixels.resize(width * height, [0; 4]);
    webp(&pixels, width, height)
}

fn webp(pixels: &[[u8; 4]], width: usize, height: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    WebPEncoder::new_lossless(&mut bytes)
        .write_image(pixels.as_flattened(), width as u32, height as u32, ExtendedColorType::Rgba8)
        .expect("memory can be written");
    bytes
}

/// An archive of files.
pub fn zipped(files: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, bytes) in files {
        writer.start_file(name, options).expect("memory can be written");
        writer.write_all(bytes).expect("memory can be written");
    }
    writer.finish().expect("memory can be written").into_inner()
}
