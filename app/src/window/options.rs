//! Start options of the window.

use std::path::PathBuf;
use std::time::Duration;

/// Start options of the window.
#[derive(Clone, Debug)]
pub struct WindowOptions {
    /// A scene or project to open.
    pub file: Option<PathBuf>,
    /// Whether to open the demo if there is no file.
    pub demo: bool,
    /// Whether to restore the settings and layout of the last run.
    pub remember: bool,
    /// Longest side of the preview, px; `None` for the user's setting.
    pub preview_size: Option<u32>,
    /// Idle time after which the exact picture is drawn; `None`: never.
    pub exact_after: Option<Duration>,
    /// Maximum number of passes by which its light is then refined; 0: none.
    pub light_passes: u32,
    /// Disk cache of light fields; `None`: they are baked every time.
    pub light_fields: Option<render::LightFieldStore>,
    /// What work on documents may use.
    pub resources: light::Resources,
    /// Device that sums the live picture.
    pub backend: graphics_card::BackendChoice,
    /// How scenes are unwrapped.
    pub unwrap: atlas::UnwrapOptions,
    /// Whether to use the system's file dialogs; otherwise paths are typed.
    pub system_dialogs: bool,
    /// Folder of the user's own presets, if any.
    pub presets: Option<PathBuf>,
    /// A recording to play once the file is open.
    pub replay: Option<Vec<project::RecordedStep>>,
    /// Output file for the latencies of the recording; the window closes after writing it.
    pub trace: Option<PathBuf>,
    /// Delay from a change to writing the recovery file (`FOCUS_BRUSH_RECOVERY_DELAY`, in seconds).
    pub recovery_delay: Duration,
    /// Output file for the durations of frames (`FOCUS_BRUSH_FRAME_LOG`): a line a second.
    pub frame_log: Option<PathBuf>,
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
            resources: light::Resources::default(),
            backend: graphics_card::BackendChoice::Auto,
            unwrap: atlas::UnwrapOptions::default(),
            system_dialogs: system_dialogs_available(),
            presets: project::PresetLibrary::default_folder(),
            replay: None,
            trace: None,
            recovery_delay: recovery_delay(),
            frame_log: std::env::var_os("FOCUS_BRUSH_FRAME_LOG").map(PathBuf::from),
        }
    }
}

/// What `FOCUS_BRUSH_RECOVERY_DELAY` says, or the session's default.
fn recovery_delay() -> Duration {
    let seconds = std::env::var("FOCUS_BRUSH_RECOVERY_DELAY").ok().and_then(|text| text.parse().ok());
    let delay = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    delay.unwrap_or(session::SessionOptions::default().recovery_delay)
}

/// Whether to try the system's file dialogs: not without a session bus, because there is no portal then, and
/// not if `FOCUS_BRUSH_FILE_DIALOG=typed`.
fn system_dialogs_available() -> bool {
    let prefers_typed_paths =
        std::env::var_os("FOCUS_BRUSH_FILE_DIALOG").is_some_and(|value| value == "typed");
    let no_portal = cfg!(target_os = "linux") && std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_none();
    !(prefers_typed_paths || no_portal)
}
