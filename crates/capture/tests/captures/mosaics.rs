//! Mosaics of micro-images: views to a mosaic and back, in bounded memory; pictures that are not mosaics.

use crate::made_light::{SIDE, encoded, put, view};
use capture::{
    CaptureKind, LightField, LightFieldOptions, Mosaic, PictureSource, ViewLayout, detect_capture_kind,
    micro_images, open_light_field,
};
use image::{ImageBuffer, ImageFormat, Rgb, RgbImage};
use progress::Unwatched;
use scene::LoadOptions;
use std::path::Path;

/// The views of a grid, row by row, and the mosaic of them.
fn mosaic(columns: u32, rows: u32) -> (Vec<RgbImage>, RgbImage) {
    let at = |index: u32, count: u32| f64::from(index) - f64::from((count - 1) / 2);
    let cells = (0..rows).flat_map(|v| (0..columns).map(move |u| (u, v)));
    let views: Vec<RgbImage> = cells.map(|(u, v)| view(0.3 * at(u, columns), 0.3 * at(v, rows))).collect();
    let pixels: Vec<Vec<Rgb<u8>>> = views.iter().map(|view| view.pixels().copied().collect()).collect();
    let pixels: Vec<&[Rgb<u8>]> = pixels.iter().map(Vec::as_slice).collect();
    let all = micro_images([columns, rows], [SIDE; 2], &pixels);
    let raw = all.iter().flat_map(|pixel| pixel.0).collect();
    (views, RgbImage::from_raw(SIDE * columns, SIDE * rows, raw).unwrap())
}

fn open(file: &Path, pitch: Option<[u32; 2]>) -> Result<LightField, String> {
    let options = LightFieldOptions { pitch, ..LightFieldOptions::default() };
    open_light_field(file, &options, &Unwatched).map_err(|error| error.to_string())
}

#[test]
fn there_and_back() {
    let folder = tempfile::tempdir().unwrap();
    for (columns, rows, pitch) in [(9, 9, None), (7, 5, None), (14, 14, None), (2, 3, Some([2, 3]))] {
        let (views, whole) = mosaic(columns, rows);
        let file = folder.path().join("eslf.png");
        whole.save(&file).unwrap();
        if pitch.is_none() {
            assert_eq!(detect_capture_kind(&file).unwrap(), CaptureKind::LightField, "{columns} × {rows}");
        }
        let field = open(&file, pitch).unwrap();
        assert_eq!(
            (field.layout, field.grid, field.size),
            (ViewLayout::MicroImages, Some([columns, rows]), [SIDE; 2])
        );
        assert!(
            !field.remarks.iter().any(|remark| remark.text.contains("as parallax shows")),
            "{:?}",
            field.remarks
        );
        for (index, (view, expected)) in field.views.iter().zip(&views).enumerate() {
            assert_eq!(view.cell, Some([index as u32 % columns, index as u32 / columns]));
            let alone = folder.path().join("alone.png");
            expected.save(&alone).unwrap();
            let expected = PictureSource::File { file: alone, orientation: 1 }
                .photograph(&LoadOptions::default())
                .unwrap();
            assert_eq!(view.picture.photograph(&LoadOptions::default()).unwrap(), expected, "{}", view.name);
        }
        // The control: views differ.
        assert_ne!(views[0], views[1]);
    }
}

#[test]
fn mosaics_of_sixteen_bits_with_alpha_and_of_other_forms() {
    let folder = tempfile::tempdir().unwrap();
    let (_, whole) = mosaic(5, 5);
    let options = LoadOptions::default();
    let views = |name: &str| {
        let mosaic = Mosaic::open(&folder.path().join(name), [5, 5]).unwrap();
        mosaic.views(&[[2, 3], [0, 0], [4, 4]], &options).unwrap()
    };
    whole.save(folder.path().join("a.png")).unwrap();
    let deep = ImageBuffer::from_fn(whole.width(), whole.height(), |x, y| {
        let [r, g, b] = whole.get_pixel(x, y).0.map(|level| u16::from(level) * 257);
        image::Rgba([r, g, b, 65535])
    });
    put(&folder.path().join("b.png"), encoded(deep, ImageFormat::Png));
    put(&folder.path().join("c.webp"), encoded(whole.clone(), ImageFormat::WebP));
    for (a, b) in views("a.png").iter().zip(views("b.png")) {
        assert!(a.pixels.iter().zip(&b.pixels).all(|(a, b)| (a[0] - b[0]).abs() < 1e-5));
    }
    assert_eq!(views("a.png"), views("c.webp"));
}

#[test]
fn lenses_that_darken_toward_their_borders() {
    let folder = tempfile::tempdir().unwrap();
    let (_, mut whole) = mosaic(15, 15);
    for (x, y, pixel) in whole.enumerate_pixels_mut() {
        let [u, v] = [x % 15, y % 15].map(|at| (f64::from(at) - 7.0) / 7.0);
        let share = (1.15 - 0.75 * (u * u + v * v)).clamp(0.0, 1.0);
        pixel.0 = pixel.0.map(|level| (f64::from(level) * share) as u8);
    }
    let file = folder.path().join("illum.png");
    whole.save(&file).unwrap();
    assert_eq!(open(&file, None).unwrap().grid, Some([15, 15]));
}

#[test]
fn pictures_that_are_no_mosaic() {
    let folder = tempfile::tempdir().unwrap();
    let big = RgbImage::from_fn(640, 480, |x, y| {
        Rgb([(127.0 + 90.0 * (f64::from(x) * 0.11).sin() * (f64::from(y) * 0.07).cos()) as u8; 3])
    });
    for form in [ImageFormat::Jpeg, ImageFormat::Png] {
        let file = folder.path().join("picture");
        put(&file, encoded(big.clone(), form));
        let text = open(&file, None).unwrap_err();
        assert!(text.contains("it is not a mosaic of micro-images"), "{text}");
        let text = detect_capture_kind(&file).unwrap_err().to_string();
        assert!(text.contains("a picture alone"), "{text}");
    }
    let file = folder.path().join("picture");
    let text = open(&file, Some([400, 400])).unwrap_err();
    assert!(text.contains("pitch: 640 × 480 px hold no micro-images of 400 × 400 px"), "{text}");
    assert!(open(&file, Some([0, 3])).is_err() && open(&file, Some([1, 1])).is_err());
    // The remainder at the border is reported.
    let field = open(&file, Some([9, 9])).unwrap();
    assert_eq!(field.size, [71, 53]);
    assert!(
        field.remarks.iter().any(|remark| remark.text.contains("1 columns at the right and 3 rows")),
        "{:?}",
        field.remarks
    );
}

#[test]
fn mosaics_beyond_the_limits() {
    let folder = tempfile::tempdir().unwrap();
    let (_, whole) = mosaic(5, 5);
    let file = folder.path().join("a.png");
    whole.save(&file).unwrap();
    let mosaic = Mosaic::open(&file, [5, 5]).unwrap();
    let small = LoadOptions { max_memory: 40_000, ..LoadOptions::default() };
    assert!(mosaic.views(&[[0, 0]], &small).unwrap_err().to_string().contains("beyond the limit"));
    // The file has changed.
    RgbImage::new(90, 90).save(&file).unwrap();
    let text = mosaic.views(&[[0, 0]], &LoadOptions::default()).unwrap_err().to_string();
    assert!(text.contains("is 90 × 90 px"), "{text}");
}
