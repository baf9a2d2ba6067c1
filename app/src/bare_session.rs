//! Sessions without a desktop: over ssh, in a container, on a farm.
//!
//! Mesa's layer that puts graphics cards in order asks a Wayland compositor for it, whose library prints an `error:` where
//! XDG_RUNTIME_DIR does not say where one would be. There is none to ask then. An environment is given to a process when
//! it begins, so the program begins anew with the layer turned off, unless the user has told the layer something.

/// Begins anew, once, where the layer would ask in vain; else, or where that fails, returns.
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
    // It only comes back where it fails: then the message is printed, and nothing else is lost.
    let _ = std::process::Command::new(program).arg0(name).args(arguments).env(DISABLE_LAYER, "1").exec();
}

/// Elsewhere there is no such layer.
#[cfg(not(target_os = "linux"))]
pub fn begin_anew_if_bare() {}
