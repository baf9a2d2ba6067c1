//! Pixels of photographs: linear light, whatever file they are in, turned as their lens means them.

use glam::DMat4;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{DynamicImage, ExtendedColorType, ImageEncoder, RgbImage};
use lens::CalibratedLens;
use moxcms::ColorProfile;
use scene::{LoadOptions, Photograph, PictureError, View};
use std::path::Path;

fn view(file: &Path, size_px: [u32; 2]) -> View {
    View {
        name: "picture".into(),
        picture: file.into(),
        orientation: 1,
        exif_orientation: 1,
        lens: CalibratedLens::pinhole(size_px, 100.0).unwrap(),
        camera_to_world: DMat4::IDENTITY,
        mask: None,
        exposure_hint: None,
    }
}

fn read(file: &Path, size_px: [u32; 2]) -> Result<Photograph, PictureError> {
    view(file, size_px).read_photograph(&LoadOptions::default())
}

/// Writes a row of pixels as a PNG with this profile.
fn png_with(profile: &ColorProfile, pixels: &[[u8; 3]], file: &Path) {
    let mut encoder = PngEncoder::new(std::fs::File::create(file).unwrap());
    encoder.set_icc_profile(profile.encode().unwrap()).unwrap();
    encoder.write_image(pixels.as_flattened(), pixels.len() as u32, 1, ExtendedColorType::Rgb8).unwrap();
}

fn assert_near(found: [f32; 3], expected: [f32; 3], tolerance: f32) {
    let off = (0..3).map(|channel| (found[channel] - expected[channel]).abs()).fold(0.0, f32::max);
    assert!(off <= tolerance, "{found:?} instead of {expected:?}");
}

#[test]
fn srgb_of_8_and_16_bits_and_grey() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    RgbImage::from_raw(2, 1, vec![188, 0, 255, 128, 128, 10]).unwrap().save(&file).unwrap();
    let picture = read(&file, [2, 1]).unwrap();
    assert_near(picture.pixels[0], [0.5029, 0.0, 1.0], 1e-4);
    assert_near(picture.pixels[1], [0.21586, 0.21586, 0.003035], 1e-5);

    let deep = image::ImageBuffer::<image::Rgb<u16>, _>::from_raw(1, 1, vec![32768u16, 257, 65535]).unwrap();
    DynamicImage::from(deep).save(&file).unwrap();
    assert_near(read(&file, [1, 1]).unwrap().pixels[0], [0.2140482, 0.000303527, 1.0], 1e-6);

    let grey = image::GrayImage::from_raw(1, 1, vec![188]).unwrap();
    grey.save(&file).unwrap();
    assert_near(read(&file, [1, 1]).unwrap().pixels[0], [0.5029; 3], 1e-4);
}

#[test]
fn profiles_of_curves_and_a_matrix_are_followed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    // What their primaries are in those of sRGB, as published with them.
    png_with(&ColorProfile::new_display_p3(), &[[255, 0, 0], [128; 3]], &file);
    let picture = read(&file, [2, 1]).unwrap();
    assert_near(picture.pixels[0], [1.22494, -0.04206, -0.01964], 1e-3);
    assert_near(picture.pixels[1], [0.21586; 3], 1e-3);

    png_with(&ColorProfile::new_adobe_rgb(), &[[0, 255, 0], [128; 3]], &file);
    let picture = read(&file, [2, 1]).unwrap();
    assert_near(picture.pixels[0], [-0.39836, 1.0, -0.04293], 1e-3);
    assert_near(picture.pixels[1], [(128.0f32 / 255.0).powf(563.0 / 256.0); 3], 1e-3);

    png_with(&ColorProfile::new_srgb(), &[[188, 0, 255]], &file);
    assert_near(read(&file, [1, 1]).unwrap().pixels[0], [0.5029, 0.0, 1.0], 1e-3);
}

#[test]
fn an_unsupported_profile_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    let mut encoder = PngEncoder::new(std::fs::File::create(&file).unwrap());
    encoder.set_icc_profile(b"no profile".to_vec()).unwrap();
    encoder.write_image(&[0; 3], 1, 1, ExtendedColorType::Rgb8).unwrap();
    let error = read(&file, [1, 1]).unwrap_err().to_string();
    assert!(
        error.contains("a.png: its ICC profile") && error.ends_with("(convert the pictures to sRGB)"),
        "{error}"
    );
}

#[test]
fn the_view_decides_the_orientation_and_not_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.jpg");
    // White on the left, black on the right, 32 × 16; the file says that it wants to be turned by 90° clockwise.
    let half = RgbImage::from_fn(32, 16, |x, _| image::Rgb([if x < 16 { 255 } else { 0 }; 3]));
    let mut encoder = JpegEncoder::new_with_quality(std::fs::File::create(&file).unwrap(), 100);
    encoder
        .set_exif_metadata(b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0".to_vec())
        .unwrap();
    encoder.encode_image(&half).unwrap();

    let as_stored = read(&file, [32, 16]).unwrap();
    assert!(as_stored.pixels[0][0] > 0.9 && as_stored.pixels[31][0] < 0.1);
    let turned =
        View { orientation: 6, ..view(&file, [16, 32]) }.read_photograph(&LoadOptions::default()).unwrap();
    assert_eq!([turned.width, turned.height], [16, 32]);
    // What was on the left is on top.
    assert!(turned.pixels[15][0] > 0.9 && turned.pixels[16 * 31][0] < 0.1);
}

#[test]
fn what_is_wrong_with_a_picture_is_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    let said = |result: Result<Photograph, PictureError>, what: &str| {
        let text = result.unwrap_err().to_string();
        let form =
            text.starts_with(&file.display().to_string()) && text.ends_with(')') && !text.contains('\n');
        assert!(form && text.contains(what), "{text}");
    };
    said(read(&file, [1, 1]), "cannot be read");
    std::fs::write(&file, b"no picture").unwrap();
    said(read(&file, [1, 1]), "cannot be decoded");
    RgbImage::new(4, 2).save(&file).unwrap();
    said(read(&file, [2, 4]), "is 4 × 2 px, its camera is for 2 × 4 px");
    let few = LoadOptions { max_texels: 7, ..LoadOptions::default() };
    said(view(&file, [4, 2]).read_photograph(&few), "beyond the limit of 7 px");
}

#[test]
fn masks_are_thresholded_at_any_size() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mask.png");
    image::GrayImage::from_raw(2, 1, vec![0, 255]).unwrap().save(&file).unwrap();
    let with = View { mask: Some(file), ..view(Path::new("a.png"), [4, 2]) };
    let mask = with.read_mask(&LoadOptions::default()).unwrap().unwrap();
    assert_eq!(mask.is_valid, [false, false, true, true, false, false, true, true]);
    assert_eq!(view(Path::new("a.png"), [4, 2]).read_mask(&LoadOptions::default()).unwrap(), None);
}
