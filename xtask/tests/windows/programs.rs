//! The program of this system, and that of Windows with the Wine that runs it.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Both programs.
pub struct Programs {
    here: PathBuf,
    /// The folder of the package, as it was made.
    package: PathBuf,
    /// A copy of it, in a folder with spaces, and with what Wine lacks.
    windows: PathBuf,
    /// Wine's settings and drives.
    prefix: PathBuf,
}

impl Programs {
    /// Finds them, once for all tests; where something is missing, says what, loudly.
    pub fn find() -> Option<&'static Self> {
        static FOUND: OnceLock<Option<Programs>> = OnceLock::new();
        let found =
            FOUND.get_or_init(|| Self::prepare().inspect_err(|what| eprintln!("SKIPPED: {what}")).ok());
        found.as_ref()
    }

    fn prepare() -> Result<Self, String> {
        let chore = PathBuf::from(env!("CARGO_BIN_EXE_xtask"));
        let here = chore.with_file_name("focus-brush");
        let target = chore.parent().and_then(Path::parent).ok_or("no target folder")?.to_owned();
        if !here.exists() {
            return Err(format!("there is no {} (cargo test --workspace builds it)", here.display()));
        }
        let package = match std::env::var_os("FOCUS_BRUSH_WINDOWS") {
            Some(folder) => PathBuf::from(folder),
            None => unpacked(&target.join("package/staging"))
                .ok_or("there is no package for Windows (cargo xtask package --windows makes it)")?,
        };
        let windows = target.join("windows under wine");
        copy(&package, &windows)?;
        let prefix = target.join("wine");
        // What earlier runs kept would not be computed again.
        for user in std::fs::read_dir(prefix.join("drive_c/users")).into_iter().flatten().flatten() {
            let _ = std::fs::remove_dir_all(user.path().join("AppData/Local/focus-brush"));
        }
        let ready = Self { here, package, windows: windows.clone(), prefix };
        let runs = |programs: &Self| {
            let output = programs.command(true, &target).arg("--version").output();
            let output =
                output.map_err(|error| format!("Wine does not start: {error} (apt-get install wine64)"))?;
            match output.status.success() {
                true => Ok(()),
                false => Err(format!("{}: {}", output.status, String::from_utf8_lossy(&output.stderr))),
            }
        };
        if runs(&ready).is_err() {
            supply_random_numbers(&windows.join("bin"))?;
            runs(&ready)?;
        }
        Ok(ready)
    }

    /// A command of either program, run in `folder`, without a screen and without what earlier runs kept.
    pub fn command(&self, on_windows: bool, folder: &Path) -> Command {
        let mut command = if on_windows {
            let mut wine = self.wine();
            wine.arg(self.windows.join("bin/focus-brush.exe"));
            wine
        } else {
            Command::new(&self.here)
        };
        command.current_dir(folder).env("XDG_CACHE_HOME", folder.join("cache"));
        for variable in ["DISPLAY", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR", "LD_LIBRARY_PATH"] {
            command.env_remove(variable);
        }
        command
    }

    fn wine(&self) -> Command {
        let mut wine = Command::new("wine");
        wine.env("WINEPREFIX", &self.prefix).env("WINEDEBUG", "-all");
        wine
    }

    /// Runs a program of Wine's in the folder of the package: whether it succeeded, and what it printed.
    pub fn tool(&self, arguments: &[&str]) -> (bool, String) {
        let output = self.wine().args(arguments).current_dir(&self.windows).output().unwrap();
        (output.status.success(), String::from_utf8_lossy(&output.stdout).into_owned())
    }

    /// The names of the files beside and below which the programs lie.
    pub fn packed(&self) -> Vec<String> {
        let names = |folder: &Path| {
            let entries = std::fs::read_dir(folder).unwrap().flatten();
            entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect::<Vec<_>>()
        };
        [names(&self.package), names(&self.package.join("bin"))].concat()
    }
}

/// The folder of the package that was made last.
fn unpacked(staging: &Path) -> Option<PathBuf> {
    let folders = std::fs::read_dir(staging).ok()?.flatten().map(|entry| entry.path());
    folders.filter(|folder| folder.join("bin/focus-brush.exe").is_file()).max()
}

/// The function of Windows that Wine 8 lacks, beside the program; see its source.
fn supply_random_numbers(folder: &Path) -> Result<(), String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/windows/bcryptprimitives.c");
    let library = folder.join("bcryptprimitives.dll");
    let mut compiler = Command::new("x86_64-w64-mingw32-gcc");
    let status = compiler.args(["-shared", "-o"]).arg(library).arg(source).arg("-ladvapi32").status();
    match status.is_ok_and(|status| status.success()) {
        true => Ok(()),
        false => {
            Err("this Wine lacks bcryptprimitives.dll, and x86_64-w64-mingw32-gcc cannot make one".into())
        }
    }
}

/// Copies a folder.
fn copy(from: &Path, to: &Path) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: {error}", from.display());
    std::fs::create_dir_all(to).map_err(failed)?;
    for entry in std::fs::read_dir(from).map_err(failed)? {
        let (path, name) = entry.map(|entry| (entry.path(), entry.file_name())).map_err(failed)?;
        if path.is_dir() {
            copy(&path, &to.join(name))?;
        } else {
            std::fs::copy(&path, to.join(name)).map_err(failed)?;
        }
    }
    Ok(())
}
