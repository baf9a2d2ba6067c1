//! Pictures that claim to be huge.

use super::super::harness::archive::zlib_zeros;
use super::super::harness::made_files::{picture, png_chunk, png_of_zeros, put};
use super::bomb::{Bomb, bomb};

const COMPARE: &str = "compare a.png a.png";

/// Bombs in pictures.
pub const BOMBS: &[Bomb] = &[
    bomb("a PNG of 2³¹ − 1 squared pixels", COMPARE, |to| put(to, "a.png", png(i32::MAX as u32, 100))),
    bomb("a PNG of 60,000 × 60,000 pixels", COMPARE, |to| put(to, "a.png", png(60_000, 100))),
    bomb("a PNG whose pixels really inflate to 900 MB", COMPARE, |to| {
        put(to, "a.png", png_of_zeros([30_000; 2], 0, b"", 30_000 * 30_001))
    }),
    bomb("a PNG whose colour profile inflates to 4 GB", COMPARE, |to| {
        let mut profile = b"icc\0\0".to_vec();
        profile.extend(zlib_zeros(4 << 30));
        // Without pixels: what is measured is the profile.
        put(to, "a.png", png_of_zeros([8; 2], 0, &png_chunk(b"iCCP", &profile), 0))
    }),
    bomb("a JPEG of 65,500 × 65,500 pixels", "compare a.jpg a.jpg", |to| put(to, "a.jpg", jpeg(0xc0))),
    bomb("a progressive JPEG of 65,500 × 65,500 pixels", "compare a.jpg a.jpg", |to| {
        put(to, "a.jpg", jpeg(0xc2))
    }),
    bomb("a lossless WebP of 16,384 × 16,384 pixels", "compare a.webp a.webp", |to| {
        put(to, "a.webp", webp())
    }),
    bomb("a sky of 200,000 × 100,000 pixels", "info s.glb --world a.hdr", |to| {
        put(
            to,
            "s.glb",
            super::super::harness::made_files::glb_of(&super::super::harness::made_files::scene()),
        )?;
        put(to, "a.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 200000\n\x02\x02\xff\xff")
    }),
    bomb("an EXR with a window of 2³⁰ squared", "compare a.exr a.exr", |to| {
        put(to, "a.exr", exr([0, 0, 1 << 30, 1 << 30], 3))
    }),
    bomb("an EXR with a window from the lowest number to the highest", "compare a.exr a.exr", |to| {
        put(to, "a.exr", exr([i32::MIN, i32::MIN, i32::MAX, i32::MAX], 3))
    }),
    bomb("an EXR with 100,000 channels", "compare a.exr a.exr", |to| {
        put(to, "a.exr", exr([0, 0, 9999, 9999], 100_000))
    }),
    bomb("a depth map of 100,000 × 100,000", "info a.png", |to| {
        picture(&to.join("a.png"), [8, 8])?;
        put(to, "a_depth.pfm", b"Pf\n100000 100000\n-1.0\n\0\0\0\0")
    }),
];

fn png(side: u32, zeros: u64) -> Vec<u8> {
    png_of_zeros([side; 2], 2, b"", zeros)
}

/// The head of a JPEG, baseline (0xc0) or progressive (0xc2), and the start of a scan.
fn jpeg(kind: u8) -> Vec<u8> {
    let mut file = vec![0xff, 0xd8];
    let mut segment = |marker: u8, content: &[u8]| {
        file.extend([0xff, marker]);
        file.extend((content.len() as u16 + 2).to_be_bytes());
        file.extend(content);
    };
    let mut quantisation = vec![0];
    quantisation.extend([1; 64]);
    segment(0xdb, &quantisation);
    segment(kind, &[8, 0xff, 0xdc, 0xff, 0xdc, 3, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0]);
    for table in [0x00, 0x10] {
        let mut huffman = vec![table, 1];
        huffman.extend([0; 15]);
        huffman.push(0);
        segment(0xc4, &huffman);
    }
    let last_coefficient = if kind == 0xc2 { 0 } else { 63 };
    segment(0xda, &[3, 1, 0, 2, 0, 3, 0, 0, last_coefficient, 0]);
    file.extend([0; 64]);
    file.extend([0xff, 0xd9]);
    file
}

fn webp() -> Vec<u8> {
    let mut chunk = vec![0x2f, 0xff, 0xff, 0xff, 0x0f];
    chunk.extend([0; 59]);
    let mut file = b"RIFF".to_vec();
    file.extend((4 + 8 + chunk.len() as u32).to_le_bytes());
    file.extend(b"WEBPVP8L");
    file.extend((chunk.len() as u32).to_le_bytes());
    file.extend(chunk);
    file
}

/// The head of an EXR of scanlines, without pixels.
fn exr(window: [i32; 4], channels: usize) -> Vec<u8> {
    let mut file = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, content: &[u8]| {
        file.extend(name.bytes().chain([0]).chain(kind.bytes()).chain([0]));
        file.extend((content.len() as u32).to_le_bytes());
        file.extend(content);
    };
    let mut list = Vec::new();
    for channel in 0..channels {
        let name = match channels {
            3 => ["B", "G", "R"][channel].to_owned(),
            _ => format!("c{channel:06}"),
        };
        list.extend(name.bytes().chain([0]));
        list.extend([2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    }
    list.push(0);
    let window: Vec<u8> = window.iter().flat_map(|edge| edge.to_le_bytes()).collect();
    attribute("channels", "chlist", &list);
    attribute("compression", "compression", &[3]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1f32.to_le_bytes());
    file.push(0);
    file.extend([0; 64]);
    file
}
