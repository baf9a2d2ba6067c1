//! A page whose slices are easy to tell apart: each has its own grey.

use web_page::{
    Caption, DistanceRange, OpeningSlice, PaintMaps, PixelMap, ScreenPicture, Slice, SliceStack, WebPage,
    encode_picture,
};

/// Columns and rows of the pictures, px.
pub const SIZE: [u32; 2] = [192, 128];
/// Columns and rows of the patches that are sharp at distances of their own.
pub const PATCHES: [u32; 2] = [6, 4];
/// Slices of the stacks at the two apertures.
pub const SLICES: [usize; 2] = [21, 11];
/// Texts that are to change nothing.
pub const HOSTILE: &str = "</script><script>hacked=1</script> \"it's\" <!-- & 🦊 {{data}}";

const RANGE: DistanceRange = DistanceRange { farthest: 0.0, nearest: 2.0 };

/// The reciprocal distance that makes a patch sharp for the ordinary lens.
pub fn ordinary(patch: u32) -> f64 {
    2.0 * f64::from(patch) / f64::from(PATCHES[0] * PATCHES[1] - 1)
}

/// The same as painted: every sixth patch stays as it is, the others are reversed.
pub fn painted(patch: u32) -> Option<f64> {
    (patch % 6 != 5).then(|| 2.0 - ordinary(patch))
}

/// The grey of a slice, of all stacks and slices.
pub fn grey(stack: usize, slice: usize) -> u8 {
    (20 + 11 * slice + 3 * stack) as u8
}

/// The page: two apertures as painted, and one of the ordinary lens.
pub fn page() -> WebPage {
    let stack = |stack: usize, aperture: &str, count: usize, is_painted| {
        let slice = |slice: usize| {
            let inverse_distance = 2.0 * slice as f64 / (count - 1) as f64;
            // Every third is the difference from the one before it.
            let base = (slice % 3 == 2).then(|| slice - 1);
            let own = grey(stack, slice);
            let level = base.map_or(own, |base| 128 + own - grey(stack, base));
            let webp = encode_picture(&uniform(level), 45.0, 75).unwrap().webp;
            Slice { inverse_distance, base, webp }
        };
        SliceStack { aperture: aperture.into(), is_painted, slices: (0..count).map(slice).collect() }
    };
    let map = |code: &dyn Fn(u32) -> u8| PixelMap {
        size: [SIZE[0] / 2, SIZE[1] / 2],
        codes: (0..SIZE[0] / 2 * (SIZE[1] / 2))
            .map(|k| code(patch_at(k % (SIZE[0] / 2), k / (SIZE[0] / 2))))
            .collect(),
    };
    WebPage {
        size: SIZE,
        caption: Caption { title: HOSTILE.into(), author: HOSTILE.into(), licence: "CC0".into() },
        opening: OpeningSlice { stack: 0, slice: 7 },
        opening_picture: uniform(grey(0, 7)),
        stacks: vec![
            stack(0, "f/1.4", SLICES[0], true),
            stack(1, "f/2.8", SLICES[1], true),
            stack(2, "f/1.4", SLICES[0], false),
        ],
        range: RANGE,
        sharp_distances: map(&|patch| RANGE.code(Some(ordinary(patch)))),
        paint: Some(PaintMaps {
            sharp_distances: map(&|patch| RANGE.code(painted(patch))),
            paint: map(&|patch| if patch % 6 == 5 { 128 } else { 0 }),
        }),
        is_autoplaying: false,
        address: None,
    }
}

fn uniform(grey: u8) -> ScreenPicture {
    ScreenPicture::new(SIZE, vec![[grey; 3]; (SIZE[0] * SIZE[1]) as usize]).unwrap()
}

/// The patch of a pixel of the maps.
fn patch_at(x: u32, y: u32) -> u32 {
    let [column, row] = [x * PATCHES[0] / (SIZE[0] / 2), y * PATCHES[1] / (SIZE[1] / 2)];
    row * PATCHES[0] + column
}
