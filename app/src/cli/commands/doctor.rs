//! `focus-brush doctor`.

use crate::cli::arguments::DoctorArguments;
use crate::cli::console::{print_json, print_line};
use crate::cli::failure::Failure;
use serde_json::json;
use std::path::{Path, PathBuf};

/// A shared library that the window loads, and the Debian package it comes with.
struct Library {
    file: &'static str,
    package: &'static str,
    purpose: &'static str,
}

/// Libraries without which the window does not open on Linux.
const LIBRARIES: [Library; 8] = [
    Library { file: "libX11.so.6", package: "libx11-6", purpose: "the window on X11" },
    Library { file: "libX11-xcb.so.1", package: "libx11-xcb1", purpose: "the window on X11" },
    Library { file: "libXcursor.so.1", package: "libxcursor1", purpose: "the window on X11" },
    Library { file: "libXi.so.6", package: "libxi6", purpose: "mouse and pen on X11" },
    Library { file: "libXrandr.so.2", package: "libxrandr2", purpose: "screens on X11" },
    Library { file: "libxkbcommon.so.0", package: "libxkbcommon0", purpose: "the keyboard" },
    Library { file: "libxkbcommon-x11.so.0", package: "libxkbcommon-x11-0", purpose: "the keyboard on X11" },
    Library { file: "libvulkan.so.1", package: "libvulkan1", purpose: "drawing the window" },
];

/// The package with software drivers, for machines without a graphics driver.
const DRIVERS: &str = "mesa-vulkan-drivers";

/// How a machine without an adapter gets one.
const ADAPTER_ADVICE: &str = if cfg!(target_os = "linux") {
    "mesa-vulkan-drivers has one in software"
} else {
    "install the driver of the graphics card's maker"
};

/// Prints which parts of the machine the program can use, what is missing and how to install it.
///
/// # Errors
/// Never; missing parts are results.
pub fn run(arguments: &DoctorArguments) -> Result<(), Failure> {
    let adapters = graphics_card::adapters();
    let missing: Vec<&Library> = if cfg!(target_os = "linux") {
        LIBRARIES.iter().filter(|library| !is_installed(library.file)).collect()
    } else {
        Vec::new()
    };
    let display = ["WAYLAND_DISPLAY", "DISPLAY"].into_iter().find(|name| std::env::var_os(name).is_some());
    let has_display = display.is_some() || !cfg!(target_os = "linux");
    let mut packages: Vec<&str> = missing.iter().map(|library| library.package).collect();
    if adapters.is_empty() && cfg!(target_os = "linux") {
        packages.push(DRIVERS);
    }
    let install_command = (!packages.is_empty()).then(|| format!("apt-get install {}", packages.join(" ")));
    let threads = rayon::current_num_threads();
    let window_can_open = missing.is_empty() && has_display && !adapters.is_empty();
    if arguments.json {
        print_json(&json!({
            "version": env!("CARGO_PKG_VERSION"),
            "threads": threads,
            "adapters": adapters.iter().map(|adapter| json!({
                "name": adapter.name, "kind": adapter.kind, "backend": adapter.interface, "used": adapter.is_used,
            })).collect::<Vec<_>>(),
            "missing_libraries": missing.iter().map(|library| library.file).collect::<Vec<_>>(),
            "display": display.map(|name| json!({ name: std::env::var(name).unwrap_or_default() })),
            "install": install_command,
            "window_can_open": window_can_open,
            "command_line_works": true,
        }));
        return Ok(());
    }
    print_line(format!("Focus Brush {}", env!("CARGO_PKG_VERSION")));
    let used = adapters.iter().find(|adapter| adapter.is_used);
    let processor_use = used.map_or("every picture is computed here", |_| "light fields are baked here");
    print_line(format!("  processor    {threads} threads: {processor_use}"));
    if adapters.is_empty() {
        print_line(format!("  graphics     no adapter (the window needs one: {ADAPTER_ADVICE})"));
    }
    for adapter in &adapters {
        let graphics_card::AdapterDescription { name, kind, interface, is_used } = adapter;
        let adapter_use = match (is_used, &**kind) {
            (true, _) => "pictures are summed here",
            (false, "cpu") => "in software: only with render --backend gpu",
            (false, _) => "only with render --adapter",
        };
        print_line(format!("  graphics     {name} ({kind}, {interface}): {adapter_use}"));
    }
    match missing.as_slice() {
        [] => print_line("  libraries    all there"),
        missing => missing.iter().for_each(|library| {
            print_line(format!(
                "  libraries    {} is missing: {} (package {})",
                library.file, library.purpose, library.package
            ));
        }),
    }
    match display {
        Some(name) => {
            print_line(format!("  display      {name}={}", std::env::var(name).unwrap_or_default()))
        }
        None if has_display => print_line("  display      the system's own"),
        None => print_line(
            "  display      none: DISPLAY and WAYLAND_DISPLAY are not set (start it on a desktop, or under \
             xvfb-run)",
        ),
    }
    print_line(if window_can_open {
        "  the window can open, and the command line works"
    } else {
        "  the window cannot open; the command line works"
    });
    if let Some(install_command) = install_command {
        print_line(format!("to get what is missing: {install_command}"));
    }
    Ok(())
}

/// Whether the dynamic linker would find `file` in one of its usual folders.
fn is_installed(file: &str) -> bool {
    let own = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    let own = std::env::split_paths(&own).collect::<Vec<_>>();
    let usual = ["/lib", "/usr/lib", "/lib64", "/usr/lib64", "/usr/local/lib"].map(PathBuf::from);
    let triplet = format!("{}-linux-gnu", std::env::consts::ARCH);
    let folders = own.into_iter().chain(usual.into_iter().flat_map(|folder| [folder.join(&triplet), folder]));
    folders.into_iter().any(|folder| Path::new(&folder).join(file).exists())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_are_found_where_they_are() {
        assert!(!is_installed("libnothing-of-the-kind.so.9"));
        assert!(
            !cfg!(target_os = "linux") || is_installed("libc.so.6") || is_installed("libc.musl-x86_64.so.1")
        );
    }
}
