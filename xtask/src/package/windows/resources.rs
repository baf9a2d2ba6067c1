//! What Windows reads of a program before it runs: icon, version, manifest.

use super::toolchain::Toolchain;
use crate::chore::{Failure, copy, execute, file_failure, repository};
use crate::package::release::Release;
use crate::package::staging::write;
use std::path::{Path, PathBuf};

/// Width and height of the icon, pixels.
const ICON_SIZE: u8 = 128;

/// Compiles the resources into an object file in `folder`.
///
/// # Errors
/// A file cannot be read or written, or `windres` fails.
pub fn compile(toolchain: &Toolchain, release: &Release, folder: &Path) -> Result<PathBuf, Failure> {
    let assets = repository().join("assets");
    let picture = assets.join("desktop/focus-brush.png");
    let png = std::fs::read(&picture).map_err(|error| file_failure(&picture, &error))?;
    let icon = folder.join("focus-brush.ico");
    std::fs::write(&icon, icon_file(&png)).map_err(|error| file_failure(&icon, &error))?;
    copy(&assets.join("windows/focus-brush.manifest"), &folder.join("focus-brush.manifest"))?;
    write(&folder.join("focus-brush.rc"), &resource_script(&release.version))?;
    let object = folder.join("focus-brush-resources.o");
    let mut windres = toolchain.tool("windres");
    windres.arg("--input=focus-brush.rc").arg("--output").arg(&object).current_dir(folder);
    execute(&mut windres)?;
    Ok(object)
}

/// An icon file of one picture, which is stored as it is ("ICONDIR", "ICONDIRENTRY" of the Windows documentation).
fn icon_file(png: &[u8]) -> Vec<u8> {
    const HEAD: u32 = 6 + 16;
    let mut file = Vec::with_capacity(HEAD as usize + png.len());
    // Reserved; icon; one picture.
    [0u16, 1, 1].iter().for_each(|number| file.extend(number.to_le_bytes()));
    // Width, height, colours of a palette (none), reserved.
    file.extend([ICON_SIZE, ICON_SIZE, 0, 0]);
    // Planes, bits of a pixel.
    [1u16, 32].iter().for_each(|number| file.extend(number.to_le_bytes()));
    [png.len() as u32, HEAD].iter().for_each(|number| file.extend(number.to_le_bytes()));
    file.extend(png);
    file
}

/// The script that `windres` compiles. 24 is the type of manifests (`RT_MANIFEST`), and 1 the number of a program's own.
fn resource_script(version: &str) -> String {
    let numbers = version.split(['.', '-']).map(|part| part.parse::<u16>().unwrap_or(0));
    let mut numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
    numbers.resize(4, "0".into());
    let numbers = numbers.join(",");
    format!(
        "1 ICON \"focus-brush.ico\"\n\
         1 24 \"focus-brush.manifest\"\n\
         1 VERSIONINFO\n\
         FILEVERSION {numbers}\n\
         PRODUCTVERSION {numbers}\n\
         FILEOS 0x40004\n\
         FILETYPE 1\n\
         BEGIN\n\
         BLOCK \"StringFileInfo\"\n\
         BEGIN\n\
         BLOCK \"040904b0\"\n\
         BEGIN\n\
         VALUE \"FileDescription\", \"Focus Brush\"\n\
         VALUE \"ProductName\", \"Focus Brush\"\n\
         VALUE \"FileVersion\", \"{version}\"\n\
         VALUE \"ProductVersion\", \"{version}\"\n\
         VALUE \"LegalCopyright\", \"the Focus Brush developers, MIT or Apache-2.0\"\n\
         END\n\
         END\n\
         BLOCK \"VarFileInfo\"\n\
         BEGIN\n\
         VALUE \"Translation\", 0x409, 1200\n\
         END\n\
         END\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_icon_has_the_size_that_its_head_says() {
        let png = std::fs::read(repository().join("assets/desktop/focus-brush.png")).unwrap();
        let picture = image::load_from_memory(&png).unwrap();
        assert_eq!([picture.width(), picture.height()], [u32::from(ICON_SIZE); 2]);
        let icon = icon_file(&png);
        assert_eq!(&icon[..6], [0, 0, 1, 0, 1, 0]);
        assert_eq!(&icon[22..], &png[..]);
    }

    #[test]
    fn versions_have_four_numbers() {
        assert!(resource_script("0.12.3").contains("FILEVERSION 0,12,3,0\n"));
        assert!(resource_script("1.0.0-rc.2").contains("FILEVERSION 1,0,0,0\n"));
    }
}
