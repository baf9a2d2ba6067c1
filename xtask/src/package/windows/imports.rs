//! Which libraries a program for Windows loads: the system's own, and no others.

use super::toolchain::Toolchain;
use crate::chore::{Failure, output_of};
use std::path::Path;

/// Libraries that are part of every Windows 10, lower case. `api-ms-win-…` are names that it maps to some of these.
const SYSTEM_LIBRARIES: &[&str] = &[
    "advapi32.dll",
    "bcrypt.dll",
    "bcryptprimitives.dll",
    "combase.dll",
    "comctl32.dll",
    "comdlg32.dll",
    "crypt32.dll",
    "d3d11.dll",
    "d3d12.dll",
    "dcomp.dll",
    "dwmapi.dll",
    "dxgi.dll",
    "gdi32.dll",
    "imm32.dll",
    "kernel32.dll",
    "msvcrt.dll",
    "ntdll.dll",
    "ole32.dll",
    "oleaut32.dll",
    "opengl32.dll",
    "propsys.dll",
    "secur32.dll",
    "setupapi.dll",
    "shell32.dll",
    "shlwapi.dll",
    "ucrtbase.dll",
    "uiautomationcore.dll",
    "user32.dll",
    "userenv.dll",
    "uxtheme.dll",
    "version.dll",
    "winmm.dll",
    "ws2_32.dll",
];

/// Checks a program.
///
/// # Errors
/// It loads other libraries, or none at all, or cannot be read.
pub fn check(toolchain: &Toolchain, program: &Path) -> Result<(), Failure> {
    let listed = output_of(toolchain.tool("objdump").arg("-p").arg(program))?;
    let others = foreign(&String::from_utf8_lossy(&listed)).map_err(|what| {
        Failure::new(format!("{}: {what} (is it a program for Windows?)", program.display()))
    })?;
    if others.is_empty() {
        return Ok(());
    }
    let others = others.join(", ");
    Err(Failure::new(format!("{}: needs {others}, which Windows does not have", program.display())))
}

/// The libraries in a listing of `objdump -p` that are not the system's.
fn foreign(listing: &str) -> Result<Vec<String>, &'static str> {
    let loaded: Vec<String> = listing
        .lines()
        .filter_map(|line| line.trim().strip_prefix("DLL Name: "))
        .map(|name| name.trim().to_lowercase())
        .collect();
    if loaded.is_empty() {
        return Err("loads no library");
    }
    let is_system = |name: &String| {
        name.starts_with("api-ms-win-") || SYSTEM_LIBRARIES.binary_search(&name.as_str()).is_ok()
    };
    Ok(loaded.into_iter().filter(|name| !is_system(name)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_of_compilers_are_found() {
        assert!(SYSTEM_LIBRARIES.is_sorted());
        let listing = "\tDLL Name: KERNEL32.dll\n\tvma: 1\n\tDLL Name: libstdc++-6.dll\n\
                       \tDLL Name: api-ms-win-core-synch-l1-2-0.dll\n";
        assert_eq!(foreign(listing), Ok(vec!["libstdc++-6.dll".into()]));
        assert!(foreign("not a listing").is_err());
    }
}
