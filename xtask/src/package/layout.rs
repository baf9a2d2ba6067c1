//! The installed files and their locations below `/usr`, or below the folder of an unpacked archive.

/// A file or folder of the repository, and its destination.
#[derive(Clone, Copy, Debug)]
pub struct Installed {
    pub from: &'static str,
    pub to: &'static str,
}

const fn installed(from: &'static str, to: &'static str) -> Installed {
    Installed { from, to }
}

/// Destination of the program, from which it locates everything else.
pub const PROGRAM: &str = "bin/focus-brush";

/// Where the pages of the book are made for the package, beside their text and pictures.
pub const BOOK: &str = "share/doc/focus-brush/docs";

/// Files needed by the program, and its integration into the desktop.
pub const SHARED: &[Installed] = &[
    installed("assets/demo", "share/focus-brush/demo"),
    installed("assets/desktop/focus-brush.desktop", "share/applications/focus-brush.desktop"),
    installed("assets/desktop/focus-brush.svg", "share/icons/hicolor/scalable/apps/focus-brush.svg"),
    installed("assets/desktop/focus-brush.png", "share/icons/hicolor/128x128/apps/focus-brush.png"),
    installed("assets/desktop/focus-brush.xml", "share/mime/packages/focus-brush.xml"),
    installed("assets/desktop/focus-brush.thumbnailer", "share/thumbnailers/focus-brush.thumbnailer"),
    installed("README.md", "share/doc/focus-brush/README.md"),
    installed("CHANGELOG.md", "share/doc/focus-brush/CHANGELOG.md"),
    installed("LICENSE-MIT", "share/doc/focus-brush/LICENSE-MIT"),
    installed("LICENSE-APACHE", "share/doc/focus-brush/LICENSE-APACHE"),
    installed("docs", "share/doc/focus-brush/docs"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chore::repository;

    #[test]
    fn everything_that_is_installed_is_there() {
        for Installed { from, .. } in SHARED {
            assert!(repository().join(from).exists(), "{from}");
        }
    }

    #[test]
    fn desktops_are_told_of_the_same_kinds_of_files_everywhere() {
        let read =
            |name: &str| std::fs::read_to_string(repository().join("assets/desktop").join(name)).expect(name);
        let (types, desktop, thumbnailer) =
            (read("focus-brush.xml"), read("focus-brush.desktop"), read("focus-brush.thumbnailer"));
        for kind in ["application/x-focus-brush-project", "application/x-focus-brush-light-field"] {
            assert!(types.contains(&format!("type=\"{kind}\"")), "{kind}");
            assert!(desktop.contains(&format!("{kind};")), "{kind}");
            assert!(thumbnailer.contains(&format!("{kind};")), "{kind}");
        }
    }
}
