//! Common pictures with depth: one file or two, which end is near, which way they are oriented; and what may be missing.

use crate::made_light::{
    dynamic_depth_jpeg, dynamic_depth_xmp, encoded, exr, gdepth_jpeg, gdepth_xmp, jpeg, levels_png, levels8,
    pfm, put, turned_jpeg,
};
use capture::{
    CaptureError, CaptureKind, DepthContainer, DepthMeaning, DepthPicture, DepthPictureOptions,
    DepthQuantity, NearEnd, detect_capture_kind, open_depth_picture,
};
use image::{ImageFormat, Rgb, RgbImage};
use scene::{LoadOptions, Photograph};
use std::path::Path;

fn open(path: &Path) -> Result<DepthPicture, CaptureError> {
    open_depth_picture(path, &DepthPictureOptions::default())
}

fn near(path: &Path, near: NearEnd) -> Result<DepthPicture, CaptureError> {
    open_depth_picture(path, &DepthPictureOptions { near: Some(near), ..DepthPictureOptions::default() })
}

/// The error of a path that does not open.
fn refused(path: &Path) -> String {
    let text = open(path).unwrap_err().to_string();
    assert!(text.contains(": ") && text.ends_with(')') && !text.contains('\n'), "{text}");
    text
}

/// Opens a file that is recognised.
fn opened(path: &Path) -> DepthPicture {
    assert_eq!(detect_capture_kind(path).unwrap(), CaptureKind::Depth);
    open(path).unwrap()
}

fn pixels(picture: &DepthPicture) -> Photograph {
    let photograph = picture.picture.photograph(&LoadOptions::default()).unwrap();
    assert_eq!([photograph.width, photograph.height], picture.size);
    photograph
}

#[test]
fn an_exr_with_the_names_of_blender_and_of_nuke() {
    let folder = tempfile::tempdir().unwrap();
    for (index, (layer, depth)) in
        [("", "Z"), ("", "depth.Z"), ("ViewLayer.Combined.", "ViewLayer.Depth.Z"), ("Image.", "Depth.V")]
            .into_iter()
            .enumerate()
    {
        let file = folder.path().join(format!("{index}.exr"));
        let names = ["R", "G", "B"].map(|channel| format!("{layer}{channel}"));
        let color = |x: usize, y: usize| (x + 10 * y) as f32;
        // Background, and unknown depth.
        let distance = |x: usize, y: usize| match (x, y) {
            (0, 0) => 1e10,
            (1, 0) => 0.0,
            _ => 1.0 + x as f32,
        };
        exr(
            &file,
            6,
            4,
            &[
                (&names[0], &color),
                (&names[1], &color),
                (&names[2], &|_, _| 0.5),
                (depth, &distance),
                ("N.Z", &color),
                ("N.X", &color),
            ],
        );
        let picture = opened(&file);
        assert_eq!((picture.container, picture.depth.meaning), (DepthContainer::Exr, DepthMeaning::Distance));
        assert_eq!(pixels(&picture).pixels[7], [11.0, 11.0, 0.5]);
        assert_eq!(picture.depth.values[0], f32::INFINITY);
        assert!(picture.depth.values[1].is_nan());
        assert_eq!(picture.depth.range(), Some([1.0, 6.0]));
    }
}

#[test]
fn a_layer_of_an_exr_may_be_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.exr");
    let channel = |value: f32| move |_: usize, _: usize| value;
    let [one, two, four] = [1.0, 2.0, 4.0].map(channel);
    let near_layer = [
        ("ViewLayer.Combined.R", &one as &dyn Fn(usize, usize) -> f32),
        ("ViewLayer.Combined.G", &one),
        ("ViewLayer.Combined.B", &one),
        ("ViewLayer.Depth.Z", &two),
    ];
    let far_layer = [
        ("ViewLayer_001.Combined.R", &two as &dyn Fn(usize, usize) -> f32),
        ("ViewLayer_001.Combined.G", &two),
        ("ViewLayer_001.Combined.B", &two),
        ("ViewLayer_001.Depth.Z", &four),
    ];
    exr(&file, 4, 4, &[&near_layer[..], &far_layer].concat());
    let chosen = |layer: &str| {
        open_depth_picture(&file, &DepthPictureOptions { layer: Some(layer.into()), ..Default::default() })
    };
    let first = opened(&file);
    assert_eq!((pixels(&first).pixels[0][0], first.depth.range()), (1.0, Some([2.0, 2.0])));
    assert!(
        first.remarks.len() == 1
            && first.remarks[0].text.contains(
                "its layer \"ViewLayer\" is used; there are also ViewLayer_001 (choose one with --layer)"
            ),
        "{:?}",
        first.remarks
    );
    let second = chosen("ViewLayer_001").unwrap();
    assert_eq!((pixels(&second).pixels[0][0], second.depth.range()), (2.0, Some([4.0, 4.0])));
    assert!(second.remarks.is_empty(), "{:?}", second.remarks);
    let error = chosen("viewlayer").unwrap_err().to_string();
    assert!(
        error.ends_with("a.exr: has no layer \"viewlayer\" with a picture and its depth (choose among \"ViewLayer\", \"ViewLayer_001\")"),
        "{error}"
    );
    // The depth of one layer is not that of another.
    exr(&file, 4, 4, &[&near_layer[..3], &far_layer].concat());
    assert_eq!(pixels(&opened(&file)).pixels[0][0], 2.0);
    assert!(chosen("ViewLayer").is_err());
    let photo = folder.path().join("b.jpg");
    put(&photo, jpeg(8, 8, 90));
    let options = DepthPictureOptions { layer: Some("x".into()), ..Default::default() };
    let error = open_depth_picture(&photo, &options).unwrap_err().to_string();
    assert!(error.ends_with("b.jpg: is no EXR with several layers (leave out --layer)"), "{error}");
}

#[test]
fn parts_of_an_exr_are_layers() {
    use exr::prelude::*;
    let folder = tempfile::tempdir().unwrap();
    let part = |name: &str, names: [&str; 4], value: f32| {
        let channels = names.iter().zip([value, value, value, value + 1.0]);
        let channels =
            channels.map(|(name, value)| AnyChannel::new(*name, FlatSamples::F32(vec![value; 16])));
        let attributes = LayerAttributes::named(name);
        Layer::new((4, 4), attributes, Encoding::SMALL_FAST_LOSSLESS, AnyChannels::sort(channels.collect()))
    };
    for names in [["R", "G", "B", "Z"], ["Combined.R", "Combined.G", "Combined.B", "Depth.Z"]] {
        let file = folder.path().join("parts.exr");
        let parts = vec![part("inside", names, 1.0), part("outside", names, 5.0)];
        Image::from_layers(ImageAttributes::with_size((4, 4)), parts).write().to_file(&file).unwrap();
        for (layer, value) in [(None, 1.0), (Some("inside"), 1.0), (Some("outside"), 5.0)] {
            let options = DepthPictureOptions { layer: layer.map(String::from), ..Default::default() };
            let picture = open_depth_picture(&file, &options).unwrap();
            assert_eq!(pixels(&picture).pixels[0], [value; 3], "{layer:?}");
            assert_eq!(picture.depth.range(), Some([value + 1.0; 2]), "{layer:?}");
        }
    }
}

#[test]
fn exrs_without_depth_or_without_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.exr");
    let one = |_: usize, _: usize| 1.0;
    exr(&file, 4, 4, &[("R", &one), ("G", &one), ("B", &one), ("N.X", &one), ("N.Z", &one)]);
    assert!(refused(&file).contains("no depth among its channels (Z, depth.Z"));
    assert!(detect_capture_kind(&file).unwrap_err().to_string().contains("an EXR without a depth channel"));
    // Depth next to it.
    let depth = folder.path().join("a_depth.exr");
    exr(&depth, 4, 4, &[("V", &|x, _| 2.0 + x as f32)]);
    assert_eq!(opened(&file).depth.range(), Some([2.0, 5.0]));
    exr(&depth, 4, 4, &[("Z", &one)]);
    assert!(refused(&depth).contains("has a depth channel, but no picture"));
    let bytes = std::fs::read(&file).unwrap();
    put(&file, &bytes[..bytes.len() / 2]);
    assert!(refused(&file).contains("a.exr: EXR: "));
}

#[test]
fn relative_depth_requires_the_near_end() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("cat.jpg");
    put(&file, jpeg(60, 40, 90));
    assert!(
        refused(&file).contains("no depth in it or beside it (put it next to the picture as NAME_depth.png")
    );
    put(&folder.path().join("cat_depth.png"), levels_png(30, 20));
    assert_eq!(detect_capture_kind(&file).unwrap(), CaptureKind::Depth);
    assert!(
        refused(&file)
            .contains("cat_depth.png: does not specify which end is near (pass --near white, --near black")
    );
    let first_last =
        |picture: DepthPicture| (picture.depth.meaning, picture.depth.values[0], picture.depth.values[29]);
    assert_eq!(first_last(near(&file, NearEnd::White).unwrap()), (DepthMeaning::Relative, 0.0, 1.0));
    assert_eq!(first_last(near(&file, NearEnd::Black).unwrap()), (DepthMeaning::Relative, 1.0, 0.0));
    let distances = "0.5,20".parse().unwrap();
    assert_eq!(first_last(near(&file, distances).unwrap()), (DepthMeaning::Distance, 0.5, 20.0));
    let picture = near(&file, NearEnd::White).unwrap();
    assert_eq!((picture.size, picture.depth.width, picture.remarks.len()), ([60, 40], 30, 0));
    // A folder of one picture and its depth is that picture.
    assert_eq!(detect_capture_kind(folder.path()).unwrap(), CaptureKind::Depth);
    let options = DepthPictureOptions { near: Some(NearEnd::White), ..DepthPictureOptions::default() };
    assert_eq!(open_depth_picture(folder.path(), &options).unwrap().name, "cat.jpg");
    put(&folder.path().join("dog.jpg"), jpeg(60, 40, 90));
    put(&folder.path().join("dog_depth.png"), levels_png(30, 20));
    assert!(
        refused(folder.path())
            .contains("has several pictures with depth: cat.jpg, dog.jpg (give one of them)")
    );
}

#[test]
fn floats_beside_a_picture_and_files_that_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("cat.jpg");
    put(&file, jpeg(60, 40, 90));
    put(&folder.path().join("cat.pfm"), pfm(60, 40, |x, _| x as f32));
    // Floats whose name denotes no quantity.
    assert!(refused(&file).contains("cat.pfm: does not specify which end is near"));
    assert_eq!(near(&file, NearEnd::White).unwrap().depth.range(), Some([0.0, 1.0]));
    put(&folder.path().join("cat_disp.pfm"), pfm(60, 40, |x, _| x as f32 - 3.0));
    let picture = opened(&file);
    assert_eq!((picture.depth.meaning, picture.depth.range()), (DepthMeaning::Disparity, Some([-3.0, 56.0])));
    assert!(
        picture.remarks[0].text.contains("there are also") && picture.remarks[0].text.contains("cat.pfm")
    );
    let named = |as_what| {
        let depth = Some((folder.path().join("cat.pfm"), as_what));
        open_depth_picture(&file, &DepthPictureOptions { depth, ..DepthPictureOptions::default() })
            .unwrap()
            .depth
    };
    assert_eq!(
        (named(DepthQuantity::Disparity).meaning, named(DepthQuantity::Depth).meaning),
        (DepthMeaning::Disparity, DepthMeaning::Distance)
    );
    assert_eq!(named(DepthQuantity::Depth).range(), Some([1.0, 59.0]));
    // A grey disparity is near where it is white, and that is reported.
    std::fs::remove_file(folder.path().join("cat_disp.pfm")).unwrap();
    levels8(60, 40).save(folder.path().join("cat_disp.png")).unwrap();
    let picture = open(&file).unwrap();
    assert_eq!((picture.depth.meaning, picture.depth.values[59]), (DepthMeaning::Relative, 1.0));
    assert!(
        picture.remarks.iter().any(|remark| remark.text.contains("white is near")),
        "{:?}",
        picture.remarks
    );
    // Coded by colour.
    RgbImage::from_fn(60, 40, |x, _| Rgb([x as u8 * 4, 255 - x as u8 * 4, 40]))
        .save(folder.path().join("cat_disp.png"))
        .unwrap();
    assert!(refused(&file).contains("cat_disp.png: picture: is coded by colour"));
}

#[test]
fn pictures_that_lie_on_their_side() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("cat.jpg");
    put(&file, turned_jpeg(60, 40, 6));
    // As the picture is stored; as it is displayed.
    for (size, first) in [([30, 20], "a column"), ([20, 30], "a row")] {
        put(&folder.path().join("cat_depth.png"), levels_png(size[0], size[1]));
        let picture = near(&file, NearEnd::White).unwrap();
        assert_eq!((picture.size, [picture.depth.width, picture.depth.height]), ([40, 60], [20, 30]));
        // Levels grow from left to right as stored: turned, from above to below.
        let (right, below) = (picture.depth.values[19], picture.depth.values[20 * 29]);
        assert_eq!((right > 0.9, below > 0.9), (first == "a row", first == "a column"), "{right} {below}");
        pixels(&picture);
        assert!(picture.remarks.is_empty());
        let focal = picture.focal_px.unwrap();
        assert!((focal - 28.0 * f64::hypot(60.0, 40.0) / f64::hypot(36.0, 24.0)).abs() < 1e-9, "{focal}");
    }
    put(&folder.path().join("cat_depth.png"), levels_png(30, 30));
    assert!(
        near(&file, NearEnd::White).unwrap().remarks[0]
            .text
            .contains("has another shape than the picture of 40 × 60 px")
    );
}

#[test]
fn gdepth_opens_with_its_near_and_far() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("lens_blur.jpg");
    let sharp = jpeg(80, 60, 200);
    let depths = [levels_png(40, 30), encoded(levels8(40, 30), ImageFormat::Jpeg)];
    for (depth, format) in
        depths.iter().flat_map(|depth| ["RangeInverse", "RangeLinear"].map(|format| (depth, format)))
    {
        // In one segment, in many, with the picture as it was before.
        for (original, piece) in [(None, None), (None, Some(300)), (Some(&sharp[..]), Some(1000))] {
            put(&file, gdepth_jpeg(&gdepth_xmp(format, "0.5", "8"), depth, original, piece));
            let picture = opened(&file);
            assert_eq!((picture.container, picture.near_far_m), (DepthContainer::GDepth, Some([0.5, 8.0])));
            let at = |x: usize| f64::from(picture.depth.values[15 * 40 + x]);
            // JPEG changes the levels a little.
            assert!((at(0) - 0.5).abs() < 0.15 && (at(39) - 8.0).abs() < 1.6, "{} {}", at(0), at(39));
            let d = 20.0 / 39.0;
            let middle = if format == "RangeInverse" { 8.0 * 0.5 / (8.0 - d * 7.5) } else { 0.5 + d * 7.5 };
            assert!((at(20) - middle).abs() < 0.03 * middle, "{format}: {} {middle}", at(20));
            let light = pixels(&picture).pixels[0][1];
            assert_eq!(light > 0.4, original.is_some(), "{light}");
            assert!((picture.focal_px.unwrap() - 28.0 * 100.0 / f64::hypot(36.0, 24.0)).abs() < 1e-9);
        }
    }
    put(
        &file,
        gdepth_jpeg(
            &gdepth_xmp("RangeInverse", "500", "8000")
                .replace("GDepth:Mime", "GDepth:Units=\"mm\" GDepth:Mime"),
            &depths[0],
            None,
            None,
        ),
    );
    assert_eq!(opened(&file).near_far_m, Some([0.5, 8.0]));
}

#[test]
fn gdepth_that_is_broken_names_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.jpg");
    let depth = levels_png(40, 30);
    let whole = gdepth_jpeg(&gdepth_xmp("RangeInverse", "0.5", "8"), &depth, None, Some(400));
    let refused_of = |bytes: &[u8]| {
        put(&file, bytes);
        refused(&file)
    };
    let replaced = |from: &str, to: &str| {
        let at = whole.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        let mut bytes = whole.clone();
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        bytes
    };
    // A piece of the extended XMP belongs to another.
    let text = refused_of(&{
        let mut bytes = whole.clone();
        let guid = b"36BE52D449F3E6B9760D7602FF75168D";
        let last = bytes.windows(32).rposition(|window| window == guid).unwrap();
        bytes[last] = b'0';
        bytes
    });
    assert!(text.contains("a.jpg: byte 0: only"), "{text}");
    assert!(
        refused_of(&replaced("HasExtendedXMP=\"36BE", "HasExtendedXMP=\"46BE"))
            .contains("its XMP continues in segments that are missing")
    );
    assert!(
        refused_of(&replaced("Near=\"0.5\"", "Near=\"-.5\""))
            .contains("XMP: GDepth: Near is \"-.5\", not a distance")
    );
    assert!(
        refused_of(&replaced("GDepth:Data=\"iVBOR", "GDepth:Data=\"iVBO*"))
            .contains("XMP: GDepth:Data: its base64 is broken")
    );
    assert!(
        refused_of(&replaced("GDepth:Data=\"iVBOR", "GDepth:Data=\"AAAAA"))
            .contains("XMP: GDepth:Data: its depth map cannot be decoded")
    );
    assert!(refused_of(&replaced("GDepth:Data=\"", "GDepth:DatA=\"")).contains("(there is no GDepth:Data)"));
}

#[test]
fn dynamic_depth_opens_with_its_near_and_far() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("PXL.jpg");
    let (original, depth) = (jpeg(80, 60, 200), encoded(levels8(40, 30), ImageFormat::Jpeg));
    let confidence = jpeg(40, 30, 10);
    let alone: [(&str, &[u8]); 1] = [("android/depthmap", &depth)];
    let nested: [(&str, &[u8]); 3] = [
        ("android/original_image", &original),
        ("android/depthmap", &depth),
        ("android/confidencemap", &confidence),
    ];
    // Data between and behind the items that no length accounts for.
    for (things, between, behind) in [
        (&alone[..], &b""[..], &b""[..]),
        (&nested, b"", b""),
        (&nested, b"padding", b""),
        (&nested, b"", b"trailer"),
        (&nested, b"a", b"b"),
    ] {
        for (units, near, far, range) in
            [("Meters", "0.5", "8", [0.5, 8.0]), ("Diopters", "2", "0.125", [0.5, 8.0])]
        {
            let gdepth_xmp = dynamic_depth_xmp("RangeInverse", near, far, units);
            put(&file, dynamic_depth_jpeg(&gdepth_xmp, things, between, behind));
            let picture = opened(&file);
            assert_eq!((picture.container, picture.near_far_m), (DepthContainer::DynamicDepth, Some(range)));
            let at = |x: usize| f64::from(picture.depth.values[15 * 40 + x]);
            assert!((at(0) - 0.5).abs() < 0.02 && (at(39) - 8.0).abs() < 1.6, "{} {}", at(0), at(39));
            assert_eq!(pixels(&picture).pixels[0][1] > 0.4, things.len() > 1);
        }
    }
    // As Pixel phones write them.
    put(
        &file,
        dynamic_depth_jpeg(
            &dynamic_depth_xmp("RangeInverse", "0.086", "0.129", "Diopters"),
            &nested,
            b"",
            b"",
        ),
    );
    let picture = opened(&file);
    assert_eq!(picture.near_far_m, Some([0.086, 0.129]));
    assert!(
        picture.remarks.iter().any(|remark| remark.text.contains("labels its distances as dioptres")),
        "{:?}",
        picture.remarks
    );
}

#[test]
fn dynamic_depth_whose_trailer_was_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("PXL.jpg");
    let depth = encoded(levels8(40, 30), ImageFormat::Jpeg);
    let whole = dynamic_depth_jpeg(
        &dynamic_depth_xmp("RangeInverse", "0.5", "8", "Meters"),
        &[("android/depthmap", &depth)],
        b"",
        b"",
    );
    put(&file, &whole[..whole.len() - depth.len()]);
    assert!(
        refused(&file)
            .contains("XMP: Dynamic Depth: its depth map is missing: only 0 bytes follow the picture")
    );
    let other = dynamic_depth_jpeg(
        &dynamic_depth_xmp("RangeInverse", "0.5", "8", "Meters"),
        &[("android/other", &depth)],
        b"",
        b"",
    );
    put(&file, &other);
    assert!(refused(&file).contains("its depth map \"android/depthmap\" is not in its directory"));
}

#[test]
fn an_heic_gets_the_command_that_keeps_its_depth() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [("IMG_1.HEIC", &b"nothing"[..]), ("IMG_2.jpg", b"\0\0\0\x24ftypheic\0\0\0\0mif1")] {
        let file = folder.path().join(name);
        put(&file, bytes);
        for text in [refused(&file), detect_capture_kind(&file).unwrap_err().to_string()] {
            assert!(text.contains("is an HEIC picture, which cannot be read (extract picture and depth with libheif: heif-convert --with-aux"), "{text}");
            assert!(text.contains("a conversion to JPEG alone drops the depth"));
        }
    }
}

#[cfg(unix)]
#[test]
fn depth_that_is_a_link_elsewhere_is_not_followed() {
    let (folder, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    put(&folder.path().join("cat.jpg"), jpeg(60, 40, 90));
    put(&outside.path().join("secret.png"), levels_png(30, 20));
    std::os::unix::fs::symlink(outside.path().join("secret.png"), folder.path().join("cat_depth.png"))
        .unwrap();
    assert!(refused(&folder.path().join("cat.jpg")).contains("no depth in it or beside it"));
}
