//! Synthetic light fields and pictures with depth: waves before waves, and the containers that other programs write.

use base64::Engine;
use exr::prelude as ox;
use exr::prelude::WritableImage;
use image::{GrayImage, ImageBuffer, ImageFormat, Luma, Rgb, RgbImage};
use std::fs::{create_dir_all, write};
use std::io::Cursor;
use std::path::Path;

/// Width and height of views.
pub const SIDE: u32 = 64;

/// Disparities of the left and the right half, px per step.
pub fn disparity(x: u32) -> f64 {
    if x < SIDE / 2 { 1.5 } else { -1.0 }
}

/// The picture of the view at (x, y): x right, y down.
pub fn view(x: f64, y: f64) -> RgbImage {
    let wave = |x: f64, y: f64| {
        0.5 + 0.12 * (x * 0.9 + 1.7 * (y * 0.31).sin()).sin()
            + 0.12 * (y * 0.8 + (x * 0.23).cos()).sin()
            + 0.1 * ((x + y) * 0.37).sin()
    };
    RgbImage::from_fn(SIDE, SIDE, |column, row| {
        let d = disparity(column);
        Rgb([(255.0 * wave(f64::from(column) + d * x, f64::from(row) + d * y)) as u8; 3])
    })
}

/// Saves a picture, creating its folders.
pub fn save(picture: &RgbImage, file: &Path) {
    create_dir_all(file.parent().unwrap()).unwrap();
    picture.save(file).unwrap();
}

/// A grid of views; `name` returns their names from column and row.
pub fn grid(folder: &Path, columns: u32, rows: u32, name: impl Fn(u32, u32) -> String) {
    for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))) {
        let at = |index: u32, count: u32| f64::from(index) - f64::from((count - 1) / 2);
        save(&view(at(column, columns), at(row, rows)), &folder.join(name(column, row)));
    }
}

/// A PFM, row 0 on top.
pub fn pfm(width: u32, height: u32, value: impl Fn(u32, u32) -> f32) -> Vec<u8> {
    let mut bytes = format!("Pf\n{width} {height}\n-1.0\n").into_bytes();
    for row in (0..height).rev() {
        (0..width).for_each(|column| bytes.extend(value(column, row).to_le_bytes()));
    }
    bytes
}

/// The disparities of the middle view as a PFM.
pub fn disparity_pfm() -> Vec<u8> {
    pfm(SIDE, SIDE, |x, _| disparity(x) as f32)
}

/// A channel's name, and its value at a column and row.
type Channel<'a> = (&'a str, &'a dyn Fn(usize, usize) -> f32);

/// An EXR of these channels, row 0 on top.
pub fn exr(file: &Path, width: usize, height: usize, channels: &[Channel<'_>]) {
    let list = channels.iter().map(|(name, value)| {
        let samples =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect();
        ox::AnyChannel::new(*name, ox::FlatSamples::F32(samples))
    });
    let channels = ox::AnyChannels::sort(list.collect());
    let layer = ox::Layer::new(
        (width, height),
        ox::LayerAttributes::default(),
        ox::Encoding::FAST_LOSSLESS,
        channels,
    );
    ox::Image::from_layer(layer).write().to_file(file).unwrap();
}

/// The bytes of a picture in a format.
pub fn encoded(picture: impl Into<image::DynamicImage>, form: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.into().write_to(&mut bytes, form).unwrap();
    bytes.into_inner()
}

/// A grey picture of 16 bits as PNG whose levels grow from left to right.
pub fn levels_png(width: u32, height: u32) -> Vec<u8> {
    let level = |x: u32| (65535 * x / (width - 1)) as u16;
    encoded(ImageBuffer::from_fn(width, height, |x, _| Luma([level(x)])), ImageFormat::Png)
}

/// The same of 8 bits.
pub fn levels8(width: u32, height: u32) -> GrayImage {
    GrayImage::from_fn(width, height, |x, _| Luma([(255 * x / (width - 1)) as u8]))
}

fn segment(head: &[u8], data: &[u8]) -> Vec<u8> {
    let length = (2 + head.len() + data.len()) as u16;
    [&[0xFF, 0xE1][..], &length.to_be_bytes(), head, data].concat()
}

/// A JPEG with segments put behind its start.
fn with_segments(jpeg: &[u8], segments: &[u8]) -> Vec<u8> {
    [&jpeg[..2], segments, &jpeg[2..]].concat()
}

/// EXIF data: an orientation, and a focal length of 28 mm on film.
fn exif(orientation: u8) -> Vec<u8> {
    let entry = |tag: u16, kind: u16, value: u32| {
        [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &1u32.to_le_bytes(), &value.to_le_bytes()].concat()
    };
    let mut data = b"Exif\0\0II*\0\x08\0\0\0".to_vec();
    data.extend(
        [&2u16.to_le_bytes()[..], &entry(0x0112, 3, orientation.into()), &entry(0x8769, 4, 38), &[0; 4]]
            .concat(),
    );
    data.extend([&1u16.to_le_bytes()[..], &entry(0xA405, 3, 28), &[0; 4]].concat());
    segment(&data, b"")
}

/// A JPEG of a flat grey.
pub fn jpeg(width: u32, height: u32, grey: u8) -> Vec<u8> {
    encoded(RgbImage::from_pixel(width, height, Rgb([grey; 3])), ImageFormat::Jpeg)
}

/// A JPEG with an EXIF orientation.
pub fn turned_jpeg(width: u32, height: u32, orientation: u8) -> Vec<u8> {
    with_segments(&jpeg(width, height, 90), &exif(orientation))
}

const XMP: &[u8] = b"http://ns.adobe.com/xap/1.0/\0";
const EXTENDED: &[u8] = b"http://ns.adobe.com/xmp/extension/\0";
const GUID: &str = "36BE52D449F3E6B9760D7602FF75168D";

fn described(attributes: &str) -> String {
    format!(
        "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n<rdf:Description rdf:about=\"\"\n\
         xmlns:GDepth=\"http://ns.google.com/photos/1.0/depthmap/\" xmlns:GImage=\"http://ns.google.com/photos/1.0/image/\" \
         xmlns:xmpNote=\"http://ns.adobe.com/xmp/note/\"\n{attributes}/>\n</rdf:RDF></x:xmpmeta>"
    )
}

/// A JPEG with GDepth: what its XMP says of the range, the depth map, perhaps the sharp picture; in extended XMP of pieces of `piece`
/// bytes, or in one.
pub fn gdepth_jpeg(xmp: &str, depth: &[u8], original: Option<&[u8]>, piece: Option<usize>) -> Vec<u8> {
    let text = |bytes: &[u8]| base64::engine::general_purpose::STANDARD.encode(bytes);
    let original = original.map_or_else(String::new, |bytes| {
        format!("\nGImage:Mime=\"image/jpeg\" GImage:Data=\"{}\"", text(bytes))
    });
    let data = format!("GDepth:Data=\"{}\"{original}", text(depth));
    let mut segments = exif(1);
    match piece {
        None => segments.extend(segment(XMP, described(&format!("{xmp}\n{data}")).as_bytes())),
        Some(piece) => {
            segments.extend(segment(
                XMP,
                described(&format!("{xmp}\nxmpNote:HasExtendedXMP=\"{GUID}\"")).as_bytes(),
            ));
            let whole = described(&data).into_bytes();
            for (index, part) in whole.chunks(piece).enumerate() {
                let numbers =
                    [(whole.len() as u32).to_be_bytes(), ((index * piece) as u32).to_be_bytes()].concat();
                segments.extend(segment(&[EXTENDED, GUID.as_bytes(), &numbers].concat(), part));
            }
        }
    }
    with_segments(&jpeg(80, 60, 90), &segments)
}

/// A range in GDepth's properties.
pub fn gdepth_xmp(format: &str, near: &str, far: &str) -> String {
    format!(
        "GDepth:Format=\"{format}\" GDepth:Near=\"{near}\"\nGDepth:Far=\"{far}\" GDepth:Mime=\"image/png\""
    )
}

/// A JPEG with Dynamic Depth: the items that follow its picture, by name and length, and the properties of the range.
pub fn dynamic_depth_jpeg(xmp: &str, things: &[(&str, &[u8])], between: &[u8], behind: &[u8]) -> Vec<u8> {
    let items: String = things
        .iter()
        .map(|(uri, bytes)| {
            format!(
                "<rdf:li rdf:parseType=\"Resource\">\n<Container:Item Item:Mime=\"image/jpeg\" Item:Length=\"{}\" Item:DataURI=\"{uri}\"/></rdf:li>\n",
                bytes.len()
            )
        })
        .collect();
    let xmp = format!(
        "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\"><rdf:Description rdf:about=\"\" \
         xmlns:Device=\"http://ns.google.com/photos/dd/1.0/device/\" xmlns:Container=\"http://ns.google.com/photos/dd/1.0/container/\" \
         xmlns:Item=\"http://ns.google.com/photos/dd/1.0/item/\" xmlns:Camera=\"http://ns.google.com/photos/dd/1.0/camera/\" \
         xmlns:Image=\"http://ns.google.com/photos/dd/1.0/image/\" xmlns:DepthMap=\"http://ns.google.com/photos/dd/1.0/depthmap/\">\n\
         <Device:Container><Container:Directory><rdf:Seq>\n\
         <rdf:li rdf:parseType=\"Resource\">\n<Container:Item Item:Mime=\"image/jpeg\" Item:Length=\"0\" Item:DataURI=\"primary_image\"/></rdf:li>\n\
         {items}</rdf:Seq></Container:Directory></Device:Container>\n\
         <Device:Cameras><rdf:Seq><rdf:li rdf:parseType=\"Resource\"><Device:Camera rdf:parseType=\"Resource\">\n\
         <Camera:Image><rdf:Description Image:ItemSemantic=\"Original\" Image:ItemURI=\"android/original_image\"/></Camera:Image>\n\
         <Camera:DepthMap rdf:parseType=\"Resource\">{xmp}<DepthMap:DepthURI>android/depthmap</DepthMap:DepthURI></Camera:DepthMap>\n\
         </Device:Camera></rdf:li></rdf:Seq></Device:Cameras></rdf:Description></rdf:RDF></x:xmpmeta>"
    );
    let mut bytes = with_segments(&jpeg(80, 60, 90), &[exif(1), segment(XMP, xmp.as_bytes())].concat());
    bytes.extend(between);
    things.iter().for_each(|(_, thing)| bytes.extend(*thing));
    bytes.extend(behind);
    bytes
}

/// A range in Dynamic Depth's properties.
pub fn dynamic_depth_xmp(format: &str, near: &str, far: &str, units: &str) -> String {
    format!(
        "<DepthMap:Format>{format}</DepthMap:Format>\n<DepthMap:Near>{near}</DepthMap:Near>\n<DepthMap:Far>{far}</DepthMap:Far>\n\
         <DepthMap:Units>{units}</DepthMap:Units>"
    )
}

/// Parameters as HCI writes them.
pub const PARAMETERS: &str = "[intrinsics]\nfocal_length_mm = 100.0\nsensor_size_mm = 35.0\n\n[extrinsics]\nnum_cams_x = 3\nnum_cams_y = 3\n\
    baseline_mm = 11.0\nfocus_distance_m = 2.3\n[meta]\ndisp_min = -1.0\ndisp_max = 1.5\n";

/// Attributes as HCI wrote them earlier.
pub fn attributes(side: u32) -> String {
    format!(
        "{side} //xRes\n{side} //yRes\n3 //hRes\n3 //vRes\n6.144e+002 //dH\n288 //shift\n9.375 //focalLength\n-10.8 //min_disp\n16.2 //max_disp\n"
    )
}

/// Writes a file, creating its folders.
pub fn put(file: &Path, bytes: impl AsRef<[u8]>) {
    create_dir_all(file.parent().unwrap()).unwrap();
    write(file, bytes).unwrap();
}
