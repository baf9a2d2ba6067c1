//! Sessions without a desktop: over ssh, in a container, on a farm.
//!
//! Mesa's device-select layer, which orders the graphics cards, queries a Wayland compositor; libwayland prints
//! an `error:` line when XDG_RUNTIME_DIR is not set, although there is no compositor to query. A process cannot
//! change the environment it was started with, so the program restarts itself with the layer disabled, unless
//! the user has configured the layer.

/// Restarts the program, once, with the device-select layer disabled if no compositor can be reached. Returns
/// if no restart is needed or the restart fails.
#[cfg(target_os = "linux")]
pub fn restart_if_headless() {
    use std::os::unix::process::CommandExt;
    use std::path::Path;
    const DISABLE_LAYER: &str = "NODEVICE_SELECT";
    const LAYER_VARIABLES: [&str; 3] = [DISABLE_LAYER, "MESA_VK_DEVICE_SELECT", "DRI_PRIME"];
    let has_runtime_folder =
        std::env::var_os("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).is_absolute());
    if has_runtime_folder || LAYER_VARIABLES.iter().any(|name| std::env::var_os(name).is_some()) {
        return;
    }
    let Ok(program) = std::env::current_exe() else { return };
    let mut arguments = std::env::args_os();
    let name = arguments.next().unwrap_or_else(|| program.clone().into());
    // `exec` returns only if it fails; the only consequence is that the message is printed.
    let _ = std::process::Command::new(program).arg0(name).args(arguments).env(DISABLE_LAYER, "1").exec();
}

/// Other systems have no such layer.
#[cfg(not(target_os = "linux"))]
pub fn restart_if_headless() {}
