//! What the window is started with.

use std::path::PathBuf;
use std::time::Duration;

/// What the window starts with.
#[derive(Clone, Debug)]
pub struct WindowOptions {
    /// A scene or project to open.
    pub file: Option<PathBuf>,
    /// Whether the demo is opened when there is no file.
    pub demo: bool,
    /// Whether settings and layout of the last run are taken up.
    pub remember: bool,
    /// The longest side that the preview is drawn at, px; none for the user's setting.
    pub preview_size: Option<u32>,
    /// For how long nothing must change until the exact picture is drawn; none: never.
    pub exact_after: Option<Duration>,
    /// By how many passes its light is refined then, at most; 0: not at all.
    pub light_passes: u32,
    /// Where light fields are kept from one run to the next; none: they are baked every time.
    pub light_fields: Option<session::LightFieldStore>,
    /// Where the live picture is summed.
    pub backend: splat::BackendChoice,
    /// How scenes are unwrapped.
    pub unwrap: atlas::UnwrapOptions,
    /// Whether the system is asked for its file dialogs; else paths are typed.
    pub system_dialogs: bool,
    /// Where the user's own presets are; none: nowhere.
    pub presets: Option<PathBuf>,
    /// What is played once the file is open.
    pub replay: Option<Vec<project::RecordedStep>>,
    /// Where the times of what is played are written; the window then closes.
    pub trace: Option<PathBuf>,
}

impl Default for WindowOptions {
    fn default() -> Self {
        Self {
            file: None,
            demo: true,
            remember: true,
            preview_size: None,
            exact_after: Some(Duration::from_millis(500)),
            light_passes: 256,
            light_fields: None,
            backend: splat::BackendChoice::Auto,
            unwrap: atlas::UnwrapOptions::default(),
            system_dialogs: system_dialogs_available(),
            presets: project::PresetLibrary::default_folder(),
            replay: None,
            trace: None,
        }
    }
}

/// Whether the system's file dialogs are worth asking: not without a session bus (no portal answers then), and not when
/// `FOCUS_BRUSH_FILE_DIALOG=typed` says so.
fn system_dialogs_available() -> bool {
    let prefers_typed_paths =
        std::env::var_os("FOCUS_BRUSH_FILE_DIALOG").is_some_and(|value| value == "typed");
    let no_portal = cfg!(target_os = "linux") && std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_none();
    !(prefers_typed_paths || no_portal)
}
