//! The package for Debian and its derivatives.

use super::layout::PROGRAM;
use super::release::Release;
use super::staging::{empty_folder, lay_out, set_rights, write};
use crate::chore::{Failure, copy, execute, output_of, repository};
use crate::packages::{TO_RUN, names};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Builds the package with Debian's own tools.
///
/// # Errors
/// A file cannot be written, or a tool fails.
pub fn make(release: &Release, program: &Path) -> Result<PathBuf, Failure> {
    let root = empty_folder(release, "deb")?;
    lay_out(&root.join("usr"), program)?;
    copyright(&root)?;
    let architecture = trimmed(output_of(Command::new("dpkg").arg("--print-architecture"))?);
    let depends = depends(release, &root.join("usr").join(PROGRAM))?;
    let size = trimmed(output_of(Command::new("du").args(["-sk", "--apparent-size"]).arg(&root))?);
    let size = size.split_whitespace().next().unwrap_or("0");
    let control = format!(
        "Package: focus-brush\n\
         Version: {}\n\
         Architecture: {architecture}\n\
         Maintainer: Focus Brush developers <focus-brush@localhost>\n\
         Installed-Size: {size}\n\
         Depends: {depends}\n\
         Recommends: {}\n\
         Section: graphics\n\
         Priority: optional\n\
         Description: Paint onto a 3D scene how it is focused\n \
         Focus Brush opens a 3D scene, a photogrammetric capture, a light field or a\n \
         photograph with depth, and lets you paint onto it, point by point, how it is\n \
         focused. The picture of the wide aperture follows the brush.\n",
        release.version,
        names(TO_RUN).replace(' ', ", "),
    );
    write(&root.join("DEBIAN/control"), &control)?;
    set_rights(&root)?;
    let package = release.output.join(format!("focus-brush_{}_{architecture}.deb", release.version));
    let mut build = Command::new("dpkg-deb");
    build.args(["--root-owner-group", "-Zxz", "--build"]).arg(&root).arg(&package);
    execute(build.env("SOURCE_DATE_EPOCH", &release.time))?;
    Ok(package)
}

/// Licences and changelog at Debian's locations and in its formats.
fn copyright(root: &Path) -> Result<(), Failure> {
    let folder = root.join("usr/share/doc/focus-brush");
    let apache = "/usr/share/common-licenses/Apache-2.0";
    let mit = std::fs::read_to_string(folder.join("LICENSE-MIT")).unwrap_or_default();
    let mit: String = mit
        .trim()
        .lines()
        .map(|line| if line.trim().is_empty() { " .\n".into() } else { format!(" {line}\n") })
        .collect();
    let text = format!(
        "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n\
         Upstream-Name: Focus Brush\n\n\
         Files: *\n\
         Copyright: the Focus Brush developers\n\
         License: MIT or Apache-2.0\n\n\
         License: MIT\n{mit}\n\
         License: Apache-2.0\n On Debian systems the whole text is in {apache}.\n"
    );
    write(&folder.join("copyright"), &text)?;
    // The same texts in other places.
    for twice in ["LICENSE-MIT", "LICENSE-APACHE"] {
        let file = folder.join(twice);
        std::fs::remove_file(&file).map_err(|error| crate::chore::file_failure(&file, &error))?;
    }
    let changes = folder.join("changelog");
    copy(&repository().join("CHANGELOG.md"), &changes)?;
    std::fs::remove_file(folder.join("CHANGELOG.md"))
        .map_err(|e| crate::chore::file_failure(&changes, &e))?;
    execute(Command::new("gzip").args(["--best", "--no-name", "--force"]).arg(&changes))
}

/// The libraries that the program is linked with, and their minimum versions.
fn depends(release: &Release, program: &Path) -> Result<String, Failure> {
    let place = empty_folder(release, "shlibdeps")?;
    write(&place.join("debian/control"), "Source: focus-brush\n\nPackage: focus-brush\nArchitecture: any\n")?;
    let mut shlibdeps = Command::new("dpkg-shlibdeps");
    let dependencies = trimmed(output_of(shlibdeps.arg("-O").arg("-e").arg(program).current_dir(&place))?);
    Ok(dependencies.strip_prefix("shlibs:Depends=").unwrap_or(&dependencies).to_owned())
}

fn trimmed(bytes: Vec<u8>) -> String {
    String::from_utf8_lossy(&bytes).trim().to_owned()
}
