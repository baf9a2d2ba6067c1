//! The page of the engine: the program that draws, and a light field.

use crate::base122::encode_base122;
use crate::deflate::deflate;
use crate::error::WebPageError;
use crate::escaping::script_value;
use crate::page_frame::{Caption, PageContent, PageFrame, PublicAddress};
use crate::screen_picture::ScreenPicture;
use serde::Serialize;

/// The parts of the viewer, in the order in which they are joined to one script.
const VIEWER: [&str; 19] = [
    include_str!("viewer/elements.js"),
    include_str!("viewer/base122.js"),
    include_str!("viewer/pixel_map.js"),
    include_str!("viewer/paint_tint.js"),
    include_str!("viewer/zoom.js"),
    include_str!("viewer/gestures.js"),
    include_str!("viewer/player.js"),
    include_str!("viewer/message.js"),
    include_str!("viewer/choices.js"),
    include_str!("viewer/mark.js"),
    include_str!("viewer/focus_bar.js"),
    include_str!("viewer/engine/engine_data.js"),
    include_str!("viewer/engine/engine.js"),
    include_str!("viewer/engine/lens_rack.js"),
    include_str!("viewer/engine/engine_screen.js"),
    include_str!("viewer/engine/recorded_strokes.js"),
    include_str!("viewer/engine/brush_tool.js"),
    include_str!("viewer/engine/engine_controls.js"),
    include_str!("viewer/engine/engine_viewer.js"),
];
/// The crate `web-engine` as a WebAssembly module: `cargo xtask web-engine` builds it.
const PROGRAM: &[u8] = include_bytes!("../../../assets/web-engine/engine.wasm");
const BAR: &str = include_str!("viewer/engine/engine_bar.html");

/// A page whose visitors choose any lens, and paint.
#[derive(Clone, Debug)]
pub struct EnginePage {
    /// Texts below the picture.
    pub caption: Caption,
    /// What is shown until the program runs.
    pub opening_picture: ScreenPicture,
    /// That picture, a WebP file.
    pub poster: Vec<u8>,
    /// The light field that the program opens, as `web-engine` has it.
    pub field: Vec<u8>,
    /// The view in which strokes are recorded, as strokes files have it.
    pub view: serde_json::Value,
    /// Whether the exported aperture is a plain disc.
    pub has_disc: bool,
    /// Whether any of the field's samples is painted.
    pub is_painted: bool,
    /// Whether the focus moves by itself until somebody touches the page.
    pub is_autoplaying: bool,
    /// Where the page is going to be published.
    pub address: Option<PublicAddress>,
}

/// What the viewer reads; the type `EngineData` of `viewer/engine/engine_data.js`.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct EngineData<'a> {
    title: &'a str,
    program: String,
    field: String,
    view: &'a serde_json::Value,
    has_disc: bool,
    is_painted: bool,
    autoplays: bool,
}

impl EnginePage {
    /// The page as HTML.
    ///
    /// # Errors
    /// [`WebPageError::Encoder`]: the thumbnail cannot be encoded, or the program or the light field not compressed.
    pub fn to_html(&self) -> Result<String, WebPageError> {
        let frame = PageFrame {
            caption: &self.caption,
            picture: &self.opening_picture,
            poster: &self.poster,
            address: self.address.as_ref(),
        };
        let data = EngineData {
            title: self.caption.page_title(),
            program: encode_base122(&deflate(PROGRAM)?),
            field: encode_base122(&deflate(&self.field)?),
            view: &self.view,
            has_disc: self.has_disc,
            is_painted: self.is_painted,
            autoplays: self.is_autoplaying,
        };
        frame.fill(&PageContent {
            policy: "'unsafe-inline' 'wasm-unsafe-eval'",
            hint: "Click or tap to focus. Drag to rack the focus. Choose a brush to paint.",
            bar: BAR,
            viewer: &VIEWER,
            call: "showEnginePage",
            data: script_value(&data)
                .map_err(|_| WebPageError::Inconsistent("a number has no form in JSON"))?,
        })
    }
}
