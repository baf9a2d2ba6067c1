//! The page of slices: its data, and how it is written.

use crate::base122::encode_base122;
use crate::error::WebPageError;
use crate::escaping::script_value;
use crate::page_frame::{Caption, PageContent, PageFrame, PublicAddress};
use crate::pixel_map::{DistanceRange, PixelMap};
use crate::screen_picture::ScreenPicture;
use serde::Serialize;

/// The parts of the viewer, in the order in which they are joined to one script.
const VIEWER: [&str; 18] = [
    include_str!("viewer/page_data.js"),
    include_str!("viewer/elements.js"),
    include_str!("viewer/base122.js"),
    include_str!("viewer/slice_cache.js"),
    include_str!("viewer/pixel_map.js"),
    include_str!("viewer/packed_map.js"),
    include_str!("viewer/rack.js"),
    include_str!("viewer/picture_screen.js"),
    include_str!("viewer/paint_tint.js"),
    include_str!("viewer/zoom.js"),
    include_str!("viewer/gestures.js"),
    include_str!("viewer/player.js"),
    include_str!("viewer/message.js"),
    include_str!("viewer/choices.js"),
    include_str!("viewer/mark.js"),
    include_str!("viewer/focus_bar.js"),
    include_str!("viewer/controls.js"),
    include_str!("viewer/viewer.js"),
];
const BAR: &str = include_str!("viewer/slice_bar.html");
/// The picture at one focus distance.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// 1/s, 1/length; 0 at infinity.
    pub inverse_distance: f64,
    /// Index of the slice of the same stack that the picture is the difference from, 128 where there is none; `None`: it is whole.
    pub base: Option<usize>,
    /// The picture, a WebP file.
    pub webp: Vec<u8>,
}

/// The pictures of one aperture at all focus distances.
#[derive(Clone, Debug, PartialEq)]
pub struct SliceStack {
    /// The aperture's name, such as `f/2.8`.
    pub aperture: String,
    /// Whether it is focused as painted, or by the ordinary lens.
    pub is_painted: bool,
    /// From the farthest to the nearest; at least one.
    pub slices: Vec<Slice>,
}

/// The slice that is shown first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct OpeningSlice {
    /// Index of its stack.
    pub stack: usize,
    /// Its index there.
    pub slice: usize,
}

/// A page.
#[derive(Clone, Debug)]
pub struct WebPage {
    /// Columns and rows of each slice, px.
    pub size: [u32; 2],
    /// Texts below the picture.
    pub caption: Caption,
    /// What is shown first; its picture at full quality.
    pub opening: OpeningSlice,
    /// That picture as it was before it was encoded.
    pub opening_picture: ScreenPicture,
    /// All stacks; those of one kind from the widest aperture to the smallest.
    pub stacks: Vec<SliceStack>,
    /// What the codes of `sharp_distances` and `painted_sharp_distances` span.
    pub range: DistanceRange,
    /// Code of the focus distance that makes the first surface of a pixel sharp, for the ordinary lens.
    pub sharp_distances: PixelMap,
    /// The same as painted, and codes of the paint; `None` if nothing is painted. Of the size of `sharp_distances`.
    pub paint: Option<PaintMaps>,
    /// Whether the focus moves by itself until somebody touches the page.
    pub is_autoplaying: bool,
    /// Where the page is going to be published.
    pub address: Option<PublicAddress>,
}

/// What is known of the paint, pixel by pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PaintMaps {
    /// Code of the focus distance that makes the first surface sharp; 0 where none does.
    pub sharp_distances: PixelMap,
    /// Code of the paint (`lens::blur_scale::paint_code`).
    pub paint: PixelMap,
}

/// What the viewer reads; the type `PageData` of `viewer/page_data.js`.
#[derive(Serialize)]
struct PageData<'a> {
    title: &'a str,
    size: [u32; 2],
    opening: OpeningSlice,
    stacks: Vec<StackData<'a>>,
    range: [f64; 2],
    maps: MapData,
    autoplays: bool,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct StackData<'a> {
    aperture: &'a str,
    is_painted: bool,
    inverse_distances: Vec<f64>,
    bases: Vec<Option<usize>>,
    /// In base 122; the opening slice is `null`, since the document shows it before the script runs.
    slices: Vec<Option<String>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct MapData {
    size: [u32; 2],
    /// `None` where no stack has the ordinary lens.
    sharp_distances: Option<String>,
    painted_sharp_distances: Option<String>,
    paint: Option<String>,
}

impl WebPage {
    /// The page as HTML.
    ///
    /// # Errors
    /// [`WebPageError::Inconsistent`]: the fields contradict each other. [`WebPageError::Encoder`]: the thumbnail cannot be encoded.
    pub fn to_html(&self) -> Result<String, WebPageError> {
        self.check()?;
        let opening = &self.stacks[self.opening.stack].slices[self.opening.slice];
        let frame = PageFrame {
            caption: &self.caption,
            picture: &self.opening_picture,
            poster: &opening.webp,
            address: self.address.as_ref(),
        };
        frame.fill(&PageContent {
            policy: "'unsafe-inline'",
            hint: "Click or tap to focus. Drag to rack the focus. Scroll or pinch to zoom.",
            bar: BAR,
            viewer: &VIEWER,
            call: "showPage",
            data: script_value(&self.data()?)
                .map_err(|_| WebPageError::Inconsistent("a number has no form in JSON"))?,
        })
    }

    fn check(&self) -> Result<(), WebPageError> {
        let require = |holds: bool, what| if holds { Ok(()) } else { Err(WebPageError::Inconsistent(what)) };
        let opening = self.stacks.get(self.opening.stack).map(|stack| stack.slices.len());
        require(opening.is_some_and(|slices| self.opening.slice < slices), "there is no slice to open with")?;
        let is_whole = |stack: &SliceStack| stack.slices[self.opening.slice].base.is_none();
        require(self.stacks.get(self.opening.stack).is_some_and(is_whole), "the opening slice is not whole")?;
        require(self.opening_picture.size() == self.size, "the opening picture is of another size")?;
        require(
            (self.range.nearest - self.range.farthest).is_finite(),
            "the range of distances is not finite",
        )?;
        for stack in &self.stacks {
            require(!stack.slices.is_empty(), "a stack has no slice")?;
            let are_ascending =
                stack.slices.windows(2).all(|pair| pair[0].inverse_distance < pair[1].inverse_distance);
            let are_finite = stack.slices.iter().all(|slice| slice.inverse_distance.is_finite());
            require(are_ascending && are_finite, "slices are not sorted by distance")?;
            let is_whole = |index: usize| stack.slices.get(index).is_some_and(|slice| slice.base.is_none());
            let have_bases = stack.slices.iter().filter_map(|slice| slice.base).all(is_whole);
            require(have_bases, "a slice is the difference from none that is whole")?;
        }
        let are_of_one_size = self.paint.iter().all(|maps| {
            [&maps.sharp_distances, &maps.paint].iter().all(|map| map.size == self.sharp_distances.size)
        });
        require(are_of_one_size, "the maps differ in size")
    }

    fn data(&self) -> Result<PageData<'_>, WebPageError> {
        let packed = |map: &PixelMap| map.packed().map(|bytes| encode_base122(&bytes));
        let has_ordinary = self.stacks.iter().any(|stack| !stack.is_painted);
        let stack_data = |(index, stack)| self.stack_data(index, stack);
        Ok(PageData {
            title: self.caption.page_title(),
            size: self.size,
            opening: self.opening,
            stacks: self.stacks.iter().enumerate().map(stack_data).collect(),
            range: [self.range.farthest, self.range.nearest],
            maps: MapData {
                size: self.sharp_distances.size,
                sharp_distances: has_ordinary.then(|| packed(&self.sharp_distances)).transpose()?,
                painted_sharp_distances: self
                    .paint
                    .as_ref()
                    .map(|maps| packed(&maps.sharp_distances))
                    .transpose()?,
                paint: self.paint.as_ref().map(|maps| packed(&maps.paint)).transpose()?,
            },
            autoplays: self.is_autoplaying,
        })
    }

    fn stack_data<'a>(&self, index: usize, stack: &'a SliceStack) -> StackData<'a> {
        let picture = |(slice_index, slice): (usize, &Slice)| {
            let is_opening = self.opening == OpeningSlice { stack: index, slice: slice_index };
            (!is_opening).then(|| encode_base122(&slice.webp))
        };
        StackData {
            aperture: &stack.aperture,
            is_painted: stack.is_painted,
            inverse_distances: stack.slices.iter().map(|slice| slice.inverse_distance).collect(),
            bases: stack.slices.iter().map(|slice| slice.base).collect(),
            slices: stack.slices.iter().enumerate().map(picture).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoding::encode_picture;
    use base64::Engine;
    use base64::engine::general_purpose::STANDARD;

    /// A page of three slices at one aperture.
    fn page() -> WebPage {
        let grain = |k: u8| [k.wrapping_mul(37) % 40; 3];
        let grey = |level: u8| {
            ScreenPicture::new([8, 4], (0..32).map(|k| grain(k).map(|g| level + g)).collect()).unwrap()
        };
        let slice = |k: u8| Slice {
            inverse_distance: f64::from(k),
            base: None,
            webp: encode_picture(&grey(40 * k), 40.0, 75).unwrap().webp,
        };
        WebPage {
            size: [8, 4],
            caption: Caption { title: "Fox & <owl>".into(), author: String::new(), licence: "CC0".into() },
            opening: OpeningSlice { stack: 0, slice: 1 },
            opening_picture: grey(40),
            stacks: vec![SliceStack {
                aperture: "f/2".into(),
                is_painted: false,
                slices: (0..3).map(slice).collect(),
            }],
            range: DistanceRange { farthest: 0.0, nearest: 2.0 },
            sharp_distances: PixelMap { size: [4, 2], codes: vec![1; 8] },
            paint: None,
            is_autoplaying: false,
            address: None,
        }
    }

    #[test]
    fn a_slice_is_stored_once_and_links_lead_nowhere() {
        let html = page().to_html().unwrap();
        let page = page();
        let [first, opening, last] = [0, 1, 2].map(|k| &page.stacks[0].slices[k].webp);
        for slice in [encode_base122(first), STANDARD.encode(opening), encode_base122(last)] {
            assert_eq!(html.matches(&slice).count(), 1);
        }
        assert!(!html.contains(&encode_base122(opening)));
        assert!(html.contains("<title>Fox &amp; &lt;owl&gt;</title>"));
        assert!(html.contains(
            "<span class=\"title\">Fox &amp; &lt;owl&gt;</span><span class=\"licence\">CC0</span></footer>"
        ));
        assert!(html.contains("property=\"og:image\" content=\"data:image/webp;base64,"));
        assert!(!html.contains("og:url") && !html.contains("https://"));
        assert_eq!(html.matches("http://").count(), 1, "the name space of the icon");
    }

    #[test]
    fn a_published_page_names_its_poster() {
        let address = PublicAddress::new("https://example.org/a/?x=1/2#top", "der Fuchs.png").unwrap();
        assert_eq!(address.poster, "https://example.org/a/der%20Fuchs.png");
        let html = WebPage { address: Some(address.clone()), ..page() }.to_html().unwrap();
        assert!(html.contains(&format!("property=\"og:image\" content=\"{}\"", address.poster)));
        assert!(html.contains("property=\"og:url\" content=\"https://example.org/a/?x=1/2#top\""));
        for wrong in ["page.html", "ftp://example.org/page.html", "https://example.org", "https:///page.html"]
        {
            assert_eq!(PublicAddress::new(wrong, "p.png"), None, "{wrong}");
        }
    }

    #[test]
    fn contradictions_are_refused() {
        let is_refused = |change: &dyn Fn(&mut WebPage)| {
            let mut wrong = page();
            change(&mut wrong);
            matches!(wrong.to_html(), Err(WebPageError::Inconsistent(_)))
        };
        assert!(!is_refused(&|_| {}));
        assert!(is_refused(&|page| page.opening.slice = 3));
        assert!(is_refused(&|page| page.opening.stack = 1));
        assert!(is_refused(&|page| page.size = [4, 8]));
        assert!(is_refused(&|page| page.stacks[0].slices.reverse()));
        assert!(is_refused(&|page| page.stacks[0].slices[2].inverse_distance = f64::NAN));
        assert!(is_refused(&|page| page
            .stacks
            .push(SliceStack { slices: Vec::new(), ..page.stacks[0].clone() })));
        assert!(!is_refused(&|page| page.stacks[0].slices[2].base = Some(0)));
        assert!(is_refused(&|page| page.stacks[0].slices[2].base = Some(2)));
        assert!(is_refused(&|page| page.stacks[0].slices[2].base = Some(3)));
        assert!(is_refused(&|page| page.stacks[0].slices[1].base = Some(0)), "it opens with it");
        assert!(is_refused(&|page| page.range.nearest = f64::INFINITY));
        assert!(is_refused(&|page| page.sharp_distances.codes.push(1)));
        assert!(is_refused(&|page| {
            let sharp_distances = page.sharp_distances.clone();
            let paint = PixelMap { size: [2, 4], ..sharp_distances.clone() };
            page.paint = Some(PaintMaps { sharp_distances, paint });
        }));
    }
}
