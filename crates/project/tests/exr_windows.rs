//! EXRs whose data window is not their display window, and other forms that programs give them.

use exr::image::write::channels::WritableChannels;
use exr::math::RoundingMode;
use exr::meta::attribute::{AttributeValue, IntegerBounds, Text};
use exr::prelude as ox;
use exr::prelude::{Levels, WritableImage};
use lens::FocusOffset;
use project::{FocusMapFile, ProjectError, read_aperture_mask, read_picture};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Columns and rows of the map.
const SIZE: [usize; 2] = [19, 11];

/// What is painted at a place of the plane that the map's upper left corner is the origin of. All that is painted lies in
/// the columns 4 to 12 and the rows 2 to 8.
fn painted(x: i32, y: i32) -> [f32; 2] {
    let is_painted = (4..13).contains(&x) && (2..9).contains(&y);
    if is_painted { [1.0 + (x as f32 * 0.03) - y as f32 * 0.01, y as f32 / 16.0] } else { [1.0, 0.0] }
}

fn map() -> Vec<[f32; 2]> {
    let [width, height] = SIZE.map(|side| side as i32);
    (0..height).flat_map(|y| (0..width).map(move |x| painted(x, y))).collect()
}

/// How a map is written.
#[derive(Clone, Copy)]
struct Form {
    /// Where the display window's corner lies.
    origin: [i32; 2],
    /// Columns and rows of the display window.
    display: [usize; 2],
    /// Corner of the data window as seen from that of the display window.
    corner: [i32; 2],
    /// Columns and rows of the data window.
    data: [usize; 2],
    encoding: ox::Encoding,
}

impl Form {
    const PLAIN: Self = Self {
        origin: [0, 0],
        display: SIZE,
        corner: [0, 0],
        data: SIZE,
        encoding: ox::Encoding::SMALL_LOSSLESS,
    };

    /// A channel of the data window.
    fn values(&self, of: impl Fn([f32; 2]) -> f32) -> ox::FlatSamples {
        let [width, height] = self.data.map(|side| side as i32);
        let [left, top] = self.corner;
        let rows = (0..height).flat_map(|y| (0..width).map(move |x| painted(left + x, top + y)));
        ox::FlatSamples::F32(rows.map(of).collect())
    }

    fn layer<C: WritableChannels<'static> + 'static>(&self, name: Option<&str>, channels: C) -> ox::Layer<C> {
        let [left, top] = [0, 1].map(|k| self.origin[k] + self.corner[k]);
        let mut attributes = ox::LayerAttributes {
            layer_name: name.map(Text::from),
            layer_position: ox::Vec2(left, top),
            ..ox::LayerAttributes::default()
        };
        attributes.other.insert(Text::from("focusBrush.backgroundT"), AttributeValue::F64(0.5));
        attributes.other.insert(Text::from("focusBrush.backgroundAnchor"), AttributeValue::F64(0.25));
        ox::Layer::new((self.data[0], self.data[1]), attributes, self.encoding, channels)
    }

    fn image(&self) -> ox::ImageAttributes {
        let bounds = IntegerBounds::new((self.origin[0], self.origin[1]), (self.display[0], self.display[1]));
        ox::ImageAttributes::new(bounds)
    }

    fn channels(&self, names: [&str; 2]) -> ox::AnyChannels<ox::FlatSamples> {
        let [t, anchor] = names;
        let channels = [
            ox::AnyChannel::new(t, self.values(|texel| texel[0])),
            ox::AnyChannel::new(anchor, self.values(|texel| texel[1])),
        ];
        ox::AnyChannels::sort(channels.into_iter().collect())
    }

    fn write(&self, file: &Path) {
        let layer = self.layer(None, self.channels(["focus.t", "focus.anchor"]));
        let image = ox::Image::from_layers(self.image(), vec![layer]);
        image.write().non_parallel().to_file(file).unwrap();
    }
}

fn read(file: &Path) -> Vec<[f32; 2]> {
    let map = FocusMapFile::read(file).unwrap();
    assert_eq!([map.image.width as usize, map.image.height as usize], SIZE);
    assert_eq!(map.background, Some(FocusOffset::new(0.5, 0.25)));
    map.image.texels
}

fn scratch() -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("map.exr");
    (folder, file)
}

#[test]
fn a_map_is_its_display_window_wherever_its_pixels_lie() {
    let (_folder, file) = scratch();
    let plain = Form::PLAIN;
    let whole = [
        plain,
        Form { corner: [-8, -8], data: [SIZE[0] + 16, SIZE[1] + 16], ..plain },
        Form { corner: [-3, 0], data: [SIZE[0] + 4, SIZE[1]], ..plain },
        // Cut to the box of what is painted, and to one that reaches outside.
        Form { corner: [4, 2], data: [9, 7], ..plain },
        Form { corner: [-5, 2], data: [40, 7], ..plain },
        Form { corner: [4, -6], data: [9, 30], ..plain },
    ];
    for form in whole {
        for origin in [[0, 0], [100, 40], [-17, -3], [-200, 9]] {
            for encoding in [ox::Encoding::SMALL_LOSSLESS, ox::Encoding::FAST_LOSSLESS] {
                Form { origin, encoding, ..form }.write(&file);
                assert_eq!(read(&file), map(), "{:?} {:?} at {origin:?}", form.corner, form.data);
            }
        }
    }
    // Negative control: the same pixels elsewhere are another map.
    Form { corner: [5, 2], data: [9, 7], ..plain }.write(&file);
    let shifted = Form { corner: [5, 2], data: [9, 7], ..plain };
    let texels = read(&file);
    assert_ne!(texels, map());
    assert_eq!(texels[2 * SIZE[0] + 5], painted(shifted.corner[0], shifted.corner[1]));
}

#[test]
fn what_lies_outside_the_data_window_is_not_painted() {
    let (_folder, file) = scratch();
    for (corner, data) in [([19, 0], [5, 5]), ([0, -30], [19, 30]), ([-4, -4], [4, 4]), ([500, 500], [1, 1])]
    {
        Form { corner, data, ..Form::PLAIN }.write(&file);
        assert!(read(&file).iter().all(|texel| *texel == [1.0, 0.0]), "{corner:?}");
    }
    Form { corner: [6, 4], data: [1, 2], ..Form::PLAIN }.write(&file);
    let texels = read(&file);
    for (n, texel) in texels.iter().enumerate() {
        let (x, y) = ((n % SIZE[0]) as i32, (n / SIZE[0]) as i32);
        let is_in = x == 6 && (4..6).contains(&y);
        assert_eq!(*texel, if is_in { painted(x, y) } else { [1.0, 0.0] }, "{x} {y}");
    }
}

#[test]
fn the_largest_of_several_levels_counts() {
    let (_folder, file) = scratch();
    let blocks = ox::Blocks::Tiles(ox::Vec2(4, 4));
    let encoding = ox::Encoding { blocks, ..ox::Encoding::SMALL_LOSSLESS };
    let form = Form { origin: [-7, 3], corner: [4, 2], data: [9, 7], encoding, ..Form::PLAIN };
    let levels = |of: fn([f32; 2]) -> f32| {
        // 9×7, 4×3, 2×1, 1×1; the small ones say nothing true.
        let small = [12, 2, 1].map(|count| ox::FlatSamples::F32(vec![0.125; count]));
        let level_data = std::iter::once(form.values(of)).chain(small).collect();
        Levels::Mip { rounding_mode: RoundingMode::Down, level_data }
    };
    let channels = [
        ox::AnyChannel::new("focus.t", levels(|texel| texel[0])),
        ox::AnyChannel::new("focus.anchor", levels(|texel| texel[1])),
    ];
    let layer = form.layer(None, ox::AnyChannels::sort(channels.into_iter().collect()));
    ox::Image::from_layers(form.image(), vec![layer]).write().non_parallel().to_file(&file).unwrap();
    assert_eq!(read(&file), map());
}

#[test]
fn the_map_may_lie_in_any_part_under_either_name() {
    let (_folder, file) = scratch();
    let cropped = Form { corner: [4, 2], data: [9, 7], ..Form::PLAIN };
    let overscan = Form { corner: [-2, -2], data: [30, 20], ..Form::PLAIN };
    for names in [["t", "anchor"], ["focus.t", "focus.anchor"]] {
        for (colour, focus) in [(overscan, cropped), (cropped, overscan), (Form::PLAIN, cropped)] {
            let colour = colour.layer(Some("rgb"), colour.channels(["R", "G"]));
            let focus = focus.layer(Some("focus"), focus.channels(names));
            let image = ox::Image::from_layers(cropped.image(), vec![colour, focus]);
            image.write().non_parallel().to_file(&file).unwrap();
            assert_eq!(read(&file), map());
        }
    }
}

#[test]
fn pictures_and_masks_are_their_display_window_too() {
    let (_folder, file) = scratch();
    for form in [
        Form::PLAIN,
        Form { corner: [-8, -8], data: [60, 60], ..Form::PLAIN },
        Form { origin: [5, -5], corner: [4, 2], data: [9, 7], ..Form::PLAIN },
    ] {
        // Black where nothing is painted.
        let lit = || form.values(|[t, anchor]| t - 1.0 + anchor);
        let channels = ["R", "G", "B", "depth"].map(|name| ox::AnyChannel::new(name, lit()));
        let layer = form.layer(None, ox::AnyChannels::sort(channels.into_iter().collect()));
        ox::Image::from_layers(form.image(), vec![layer]).write().non_parallel().to_file(&file).unwrap();
        let expected: Vec<f32> = map().iter().map(|[t, anchor]| t - 1.0 + anchor).collect();
        let picture = read_picture(&file).unwrap();
        assert_eq!([picture.width as usize, picture.height as usize], SIZE);
        assert_eq!(picture.rgb, expected.iter().map(|&value| [value; 3]).collect::<Vec<_>>());
        assert_eq!(picture.layers["depth"], expected);
        let mask = read_aperture_mask(&file, "mask.exr").unwrap();
        let clipped = expected.iter().map(|value| (3.0 * value.clamp(0.0, 1.0)) / 3.0);
        assert!(mask.transmission.iter().zip(clipped).all(|(a, b)| (a - b).abs() < 1e-6));
        assert_eq!([mask.width as usize, mask.height as usize], SIZE);
    }
}

/// Replaces the window of this name in the file's bytes.
fn set_window(file: &Path, name: &str, corners: [i32; 4]) {
    let mut bytes = std::fs::read(file).unwrap();
    let name = [name.as_bytes(), b"\0box2i\0\x10\0\0\0"].concat();
    let found = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len();
    bytes[found..found + 16].copy_from_slice(&corners.map(i32::to_le_bytes).concat());
    std::fs::write(file, bytes).unwrap();
}

#[test]
fn windows_that_cannot_be_are_refused_in_a_sentence() {
    let (_folder, file) = scratch();
    for (name, corners) in [
        ("displayWindow", [0, 0, -1, -1]),
        ("displayWindow", [5, 0, 4, 10]),
        ("displayWindow", [0, 0, 32768, 0]),
        ("displayWindow", [0, 0, 1 << 28, 1 << 28]),
        ("displayWindow", [0, 0, 32767, 16383]),
        ("displayWindow", [i32::MIN, i32::MIN, i32::MAX, i32::MAX]),
        ("dataWindow", [0, 0, -1, 10]),
        ("dataWindow", [18, 10, 0, 0]),
        ("dataWindow", [0, 0, i32::MAX, i32::MAX]),
    ] {
        Form::PLAIN.write(&file);
        set_window(&file, name, corners);
        let error: ProjectError = FocusMapFile::read(&file).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("window") && !text.contains('\n'), "{name} {corners:?}: {text}");
    }
}

#[test]
fn subsampled_channels_are_refused_in_a_sentence() {
    let (_folder, file) = scratch();
    Form::PLAIN.write(&file);
    let mut bytes = std::fs::read(&file).unwrap();
    for name in [&b"focus.t\0"[..], b"focus.anchor\0"] {
        // Behind the name: the kind of number, a flag with three bytes to spare, and each how many pixels there is a sample.
        let sampling = bytes.windows(name.len()).position(|found| found == name).unwrap() + name.len() + 8;
        bytes[sampling..sampling + 8].copy_from_slice(&[2, 0, 0, 0, 2, 0, 0, 0]);
    }
    std::fs::write(&file, bytes).unwrap();
    let text = FocusMapFile::read(&file).unwrap_err().to_string();
    assert!(text.contains("subsampl"), "{text}");
}
