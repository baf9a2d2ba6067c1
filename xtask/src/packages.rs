//! The Debian packages that building and running need, and how they get onto the machine.
//!
//! Everything else comes from crates.io. On another system than Debian and its kin nothing is installed: what is
//! needed is said, and the build goes on, for it may well be there under another name.

use crate::chore::{Failure, execute};
use std::io::{BufRead, IsTerminal, Write};
use std::process::{Command, Stdio};

/// A package, and a program whose presence makes it unnecessary (a compiler may come from elsewhere).
#[derive(Clone, Copy)]
pub struct Package {
    name: &'static str,
    provides: Option<&'static str>,
}

const fn package(name: &'static str) -> Package {
    Package { name, provides: None }
}

/// To build: xatlas is C++, and its bindings are made by libclang.
pub const TO_BUILD: &[Package] = &[
    Package { name: "gcc", provides: Some("cc") },
    Package { name: "g++", provides: Some("c++") },
    package("libclang-dev"),
];

/// To open a window or use a GPU interface: winit and wgpu load these while running.
pub const TO_RUN: &[Package] = &[
    package("mesa-vulkan-drivers"),
    package("libx11-6"),
    package("libx11-xcb1"),
    package("libxcursor1"),
    package("libxi6"),
    package("libxrandr2"),
    package("libxkbcommon-x11-0"),
];

/// To make packages for Debian and its kin.
pub const TO_PACKAGE: &[Package] =
    &[Package { name: "dpkg-dev", provides: Some("dpkg-shlibdeps") }, package("xz-utils"), package("git")];

/// To act on the real window without a person: a display, mouse and keys, screenshots.
pub const TO_ACT: &[Package] = &[package("xvfb"), package("xdotool"), package("imagemagick")];

/// Installs those that are missing: asks first where a person is there to answer, else just does it.
///
/// # Errors
/// When installing is refused or fails; the message holds the one command that does it by hand.
pub fn install_missing(requested: &[&[Package]]) -> Result<(), Failure> {
    if !cfg!(target_os = "linux") {
        return Ok(());
    }
    let requested = requested.iter().flat_map(|group| group.iter());
    if !has_program("apt-get") || !has_program("dpkg-query") {
        let missing: Vec<_> =
            requested.filter(|p| p.provides.is_some_and(|program| !has_program(program))).collect();
        if !missing.is_empty() {
            eprintln!("note: these may be missing here: {}", joined(missing.iter().copied()));
        }
        return Ok(());
    }
    let missing: Vec<&Package> = requested.filter(|p| !is_there(p)).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let names = joined(missing.iter().copied());
    let by_hand = format!("sudo apt-get install --no-install-recommends {names}");
    let Some(mut prefix) = privilege() else {
        return Err(Failure::new(format!("packages are missing (install them: {by_hand})")));
    };
    if a_person_is_there() {
        eprint!("Missing packages: {names}\nInstall them with apt-get now? [Y/n] ");
        let _ = std::io::stderr().flush();
        let mut answer = String::new();
        let read = std::io::stdin().lock().read_line(&mut answer);
        let yes = matches!(answer.trim().to_lowercase().as_str(), "" | "y" | "yes");
        if !matches!(read, Ok(n) if n > 0) || !yes {
            return Err(Failure::new(format!("packages are missing (install them: {by_hand})")));
        }
    } else {
        eprintln!("Installing {names}");
    }
    prefix.extend(["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-q"]);
    let apt = |arguments: &[&str]| {
        let mut command = Command::new(prefix[0]);
        command.args(&prefix[1..]).args(arguments).stdin(Stdio::null());
        // What apt says belongs to the log, not to what the chore prints.
        command.stdout(std::io::stderr());
        execute(&mut command)
    };
    let mut install = vec!["install", "-y", "--no-install-recommends"];
    install.extend(missing.iter().map(|p| p.name));
    // Stale package lists are the commonest reason for a failure, so they are fetched first; without a
    // network they may still do.
    if let Err(failure) = apt(&["update"]) {
        eprintln!("note: {failure}");
    }
    apt(&install).map_err(|failure| Failure::new(format!("{failure} (install them: {by_hand})")))
}

/// Their names, between blanks.
pub fn names(packages: &[Package]) -> String {
    joined(packages.iter())
}

fn joined<'a>(packages: impl Iterator<Item = &'a Package>) -> String {
    packages.map(|p| p.name).collect::<Vec<_>>().join(" ")
}

fn is_there(package: &Package) -> bool {
    if package.provides.is_some_and(has_program) {
        return true;
    }
    let mut query = Command::new("dpkg-query");
    query.args(["--show", "--showformat=${db:Status-Status}", package.name]).stderr(Stdio::null());
    query.output().is_ok_and(|output| output.stdout == b"installed")
}

fn has_program(name: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(name).is_file())
}

fn a_person_is_there() -> bool {
    std::env::var_os("CI").is_none() && std::io::stdin().is_terminal() && std::io::stderr().is_terminal()
}

/// What to put before a command so that it may install; nothing for root, `None` where it may not.
fn privilege() -> Option<Vec<&'static str>> {
    let user = Command::new("id").arg("-u").output().ok()?;
    if user.stdout.trim_ascii() == b"0" {
        return Some(Vec::new());
    }
    if !has_program("sudo") {
        return None;
    }
    if a_person_is_there() {
        return Some(vec!["sudo"]);
    }
    let mut silent = Command::new("sudo");
    silent.args(["-n", "true"]).stdout(Stdio::null()).stderr(Stdio::null());
    silent.status().is_ok_and(|status| status.success()).then(|| vec!["sudo", "-n"])
}
