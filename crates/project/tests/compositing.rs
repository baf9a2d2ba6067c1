//! Pictures for compositors, as others read them: windows, types, compression, colours.

use exr::meta::attribute::SampleType;
use exr::prelude as ox;
use lens::{Exposure, Picture};
use project::{ColorSpace, Compression, Layer, PictureOptions, read_picture, write_picture};
use std::path::Path;
use tempfile::TempDir;

/// Eight columns and six rows, of which two on each side lie around the frame.
fn picture() -> (Picture, Vec<Layer>) {
    let mut picture = Picture::black(8, 6);
    for (pixel, rgb) in picture.radiance.iter_mut().enumerate() {
        *rgb = [pixel as f32 / 16.0, 0.5, 1e6];
    }
    picture.coverage.fill(1.0);
    let layer = |name: &str, value: f32| Layer { name: name.into(), values: vec![value; 48] };
    let layers = vec![layer("A", 0.5), layer("depth.Z", 0.1), layer("coc", -0.3)];
    (picture, layers)
}

fn meta(file: &Path) -> exr::meta::header::Header {
    exr::meta::MetaData::read_from_file(file, false).unwrap().headers.remove(0)
}

#[test]
fn windows_types_and_compression_are_as_requested() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("x.exr");
    let (picture, layers) = picture();
    let stored = [
        (Compression::Zips, ox::Compression::ZIP1),
        (Compression::Zip, ox::Compression::ZIP16),
        (Compression::Piz, ox::Compression::PIZ),
        (Compression::Dwaa, ox::Compression::DWAA(None)),
        (Compression::None, ox::Compression::Uncompressed),
    ];
    for (compression, stored) in stored {
        let options = PictureOptions {
            exposure: Exposure::Conserve,
            half: true,
            compression,
            overscan: 2,
            ..PictureOptions::default()
        };
        write_picture(&file, &picture, &layers, &options).unwrap();
        let header = meta(&file);
        assert_eq!(header.compression.to_string(), stored.to_string());
        let display = header.shared_attributes.display_window;
        assert_eq!((display.position, display.size), (ox::Vec2(0, 0), ox::Vec2(4, 2)));
        let data = header.data_window();
        assert_eq!((data.position, data.size), (ox::Vec2(-2, -2), ox::Vec2(8, 6)));
        for channel in &header.channels.list {
            let name = channel.name.to_string();
            let expected = if name.len() == 1 { SampleType::F16 } else { SampleType::F32 };
            assert_eq!(channel.sample_type, expected, "{name}");
        }
        let read = read_picture(&file).unwrap();
        assert_eq!((read.width, read.height), (4, 2));
        assert_eq!(read.layers["depth.Z"], [0.1; 8]);
        assert_eq!(read.layers["A"], [0.5; 8]);
        let tolerance = if compression.is_lossless() { 1e-3 } else { 0.05 };
        for (pixel, rgb) in read.rgb.iter().enumerate() {
            let (x, y) = (pixel % 4 + 2, pixel / 4 + 2);
            let expected = (y * 8 + x) as f32 / 16.0;
            assert!((rgb[0] - expected).abs() <= tolerance * expected.max(1.0), "{compression:?} {rgb:?}");
            assert!(rgb[2].is_finite(), "what no half holds is as bright as one can be");
        }
    }
}

#[test]
fn colours_declare_their_space() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("x.exr");
    let (mut picture, _) = picture();
    picture.radiance.fill([1.0, 0.0, 0.0]);
    let layers = Layer::from_colors(Layer::PINHOLE, &picture.radiance);
    for (space, red, white) in [
        (ColorSpace::Rec709, [1.0, 0.0, 0.0], ox::Vec2(0.3127, 0.329)),
        (ColorSpace::AcesCg, [0.613_097, 0.070_194, 0.020_616], ox::Vec2(0.32168, 0.33767)),
    ] {
        let options = PictureOptions { color_space: space, ..PictureOptions::default() };
        write_picture(&file, &picture, &layers, &options).unwrap();
        assert_eq!(meta(&file).shared_attributes.chromaticities.unwrap().white, white);
        let stored = ox::read_first_flat_layer_from_file(&file).unwrap();
        for (prefix, c) in ["", "pinhole."].iter().flat_map(|prefix| (0..3).map(move |c| (prefix, c))) {
            let name = format!("{prefix}{}", ["R", "G", "B"][c]);
            let channel =
                stored.layer_data.channel_data.list.iter().find(|channel| channel.name.eq(&name)).unwrap();
            let value = channel.sample_data.values_as_f32().next().unwrap();
            assert!((value - red[c]).abs() < 1e-5, "{name}: {value}");
        }
        // Whoever knows what they mean gets the same colour.
        let read = read_picture(&file).unwrap().rgb[0];
        assert!((read[0] - 1.0).abs() < 1e-5 && read[1].abs() < 1e-5 && read[2].abs() < 1e-5, "{read:?}");
    }
}

#[test]
fn cryptomatte_is_never_compressed_with_loss() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("x.exr");
    let (picture, _) = picture();
    let layers = [Layer { name: "CryptoObject00.R".into(), values: vec![1.5e-20; 48] }];
    let lossy = PictureOptions { compression: Compression::Dwaa, half: true, ..PictureOptions::default() };
    let refused = write_picture(&file, &picture, &layers, &lossy).unwrap_err().to_string();
    assert!(refused.contains("x.exr") && refused.contains("Cryptomatte"), "{refused}");
    assert!(!file.exists());
    let options = PictureOptions { compression: Compression::Piz, ..lossy };
    write_picture(&file, &picture, &layers, &options).unwrap();
    assert_eq!(read_picture(&file).unwrap().layers["CryptoObject00.R"], layers[0].values);
}
