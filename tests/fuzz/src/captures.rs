//! What other programs leave: cameras, meshes, depth, light fields. Each target changes one file among intact ones.

use crate::folder::{file, folder, once};
use crate::outcome::read_or_refused;
use crate::scenes::limits;
use capture::{CaptureOptions, DepthPictureOptions, DepthQuantity, LightFieldOptions};
use image::{DynamicImage, ImageFormat, Rgb, RgbImage};
use progress::Unwatched;
use std::io::Cursor;
use std::path::Path;
use std::sync::{LazyLock, Once};

const CAMERAS: &[u8] = b"1 PINHOLE 16 16 16 16 8 8\n2 OPENCV 16 16 16 16 8 8 0.01 0 0 0\n";
const IMAGES: &[u8] = b"1 0 1 0 0 0.2 0 3 1 1.png\n\n2 0 1 0 0 -0.2 0 3 2 2.png\n\n";
const SQUARE: &[u8] = b"v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n";
const TRANSFORMS: &[u8] = br#"{"w": 16, "h": 16, "fl_x": 16, "fl_y": 16, "cx": 8, "cy": 8, "frames": [
{"file_path": "1.png", "transform_matrix": [[1, 0, 0, -0.2], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]},
{"file_path": "2.png", "transform_matrix": [[1, 0, 0, 0.2], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]}]}"#;

/// A picture of 16 × 16 pixels with some detail, as PNG.
static PICTURE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let pixel = |x: u32, y: u32| Rgb([(x * 9) as u8, (y * 11) as u8, (x * y) as u8]);
    let mut bytes = Cursor::new(Vec::new());
    let picture = DynamicImage::ImageRgb8(RgbImage::from_fn(16, 16, pixel));
    picture.write_to(&mut bytes, ImageFormat::Png).expect("memory takes any picture");
    bytes.into_inner()
});

/// Opens the capture in the folder, where two pictures and a square are, once they are written.
fn open_capture() {
    static PICTURES: Once = Once::new();
    once(&PICTURES, &[("1.png", &PICTURE), ("2.png", &PICTURE)]);
    let options = CaptureOptions { load: limits(), ..CaptureOptions::default() };
    read_or_refused(capture::open(folder(), &options, &Unwatched));
}

fn write_square() {
    static MESH: Once = Once::new();
    once(&MESH, &[("mesh.obj", SQUARE)]);
}

/// A model of COLMAP. The first byte chooses which file the others are: cameras or images, as text or binary.
pub fn colmap(bytes: &[u8]) {
    let Some((choice, bytes)) = bytes.split_first() else { return };
    write_square();
    let (cameras, images) = match choice % 4 {
        0 => (("cameras.txt", bytes), ("images.txt", IMAGES)),
        1 => (("cameras.txt", CAMERAS), ("images.txt", bytes)),
        // A binary file of cameras, then one of images.
        _ => {
            let length = bytes.first_chunk().map_or(0, |length| usize::from(u16::from_le_bytes(*length)));
            let rest = bytes.get(2..).unwrap_or_default();
            let (cameras, images) = rest.split_at(length.min(rest.len()));
            (("cameras.bin", cameras), ("images.bin", images))
        }
    };
    for name in ["cameras.txt", "images.txt", "cameras.bin", "images.bin"] {
        let _ = std::fs::remove_file(folder().join("sparse/0").join(name));
    }
    for (name, bytes) in [cameras, images] {
        file(&format!("sparse/0/{name}"), bytes);
    }
    open_capture();
}

/// nerfstudio's `transforms.json`.
pub fn nerfstudio(bytes: &[u8]) {
    write_square();
    file("transforms.json", bytes);
    open_capture();
}

/// Bundler's `bundle.out`.
pub fn bundler(bytes: &[u8]) {
    static LIST: Once = Once::new();
    write_square();
    once(&LIST, &[("list.txt", b"1.png\n2.png\n")]);
    file("bundle.out", bytes);
    open_capture();
}

/// VisualSFM's cameras.
pub fn visualsfm(bytes: &[u8]) {
    write_square();
    file("cameras.nvm", bytes);
    open_capture();
}

/// Metashape's cameras.
pub fn metashape(bytes: &[u8]) {
    write_square();
    file("cameras.xml", bytes);
    open_capture();
}

/// The mesh of a capture: PLY by its first bytes, else OBJ.
pub fn mesh(bytes: &[u8]) {
    static CAMERAS: Once = Once::new();
    once(&CAMERAS, &[("transforms.json", TRANSFORMS)]);
    let (name, other) =
        if bytes.starts_with(b"ply") { ("mesh.ply", "mesh.obj") } else { ("mesh.obj", "mesh.ply") };
    let _ = std::fs::remove_file(folder().join(other));
    file(name, bytes);
    open_capture();
}

/// A map of depths or disparities: OpenEXR or PFM by its first bytes, else a picture of levels.
pub fn depth_map(bytes: &[u8]) {
    let name = match bytes {
        [0x76, 0x2f, 0x31, 0x01, ..] => "map.exr",
        [b'P', ..] => "map.pfm",
        _ => "map.png",
    };
    let map = file(name, bytes);
    let quantity = Some(DepthQuantity::Depth);
    read_or_refused(capture::read_depth_map(&map, quantity, None, &limits()));
}

/// A picture with its depth in it: OpenEXR by its first bytes, else JPEG.
pub fn depth_picture(bytes: &[u8]) {
    let name = if bytes.starts_with(b"\x76\x2f\x31\x01") { "depth/picture.exr" } else { "depth/picture.jpg" };
    let options = DepthPictureOptions { load: limits(), ..DepthPictureOptions::default() };
    read_or_refused(capture::open_depth_picture(&file(name, bytes), &options));
}

/// What describes the views of a light field. The first byte chooses: its parameters, its older attributes, the list of its views,
/// or a mosaic of micro-images.
pub fn light_field(bytes: &[u8]) {
    static VIEWS: Once = Once::new();
    let Some((choice, bytes)) = bytes.split_first() else { return };
    let views = [0, 1, 2, 3].map(|view| format!("views/input_Cam{view:03}.png"));
    let views: Vec<(&str, &[u8])> = views.iter().map(|name| (name.as_str(), PICTURE.as_slice())).collect();
    once(&VIEWS, &views);
    let names = ["parameters.cfg", "attributes.dat", "views.json"];
    for name in names {
        let _ = std::fs::remove_file(folder().join("views").join(name));
    }
    let options = LightFieldOptions { load: limits(), ..LightFieldOptions::default() };
    let open = |path: &Path, options: &LightFieldOptions| {
        read_or_refused(capture::open_light_field(path, options, &Unwatched));
    };
    match names.get(usize::from(choice % 4)) {
        Some(name) => {
            file(&format!("views/{name}"), bytes);
            open(&folder().join("views"), &options);
        }
        None => {
            let mosaic = file("mosaic.png", bytes);
            open(&mosaic, &options);
            open(&mosaic, &LightFieldOptions { pitch: Some([4, 4]), ..options.clone() });
        }
    }
}
