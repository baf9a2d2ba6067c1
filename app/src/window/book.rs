//! Locates the book: its pages beside the program, in its share folder, or in the source tree it was built from.

use std::path::{Path, PathBuf};

/// The address of the book's first page; `None` if it is not there.
pub fn book_url() -> Option<String> {
    let program = std::env::current_exe().ok();
    let beside = program.as_deref().and_then(Path::parent);
    let folders = [
        beside.map(|folder| folder.join("../share/doc/focus-brush/docs")),
        Some(Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/book")),
        Some(PathBuf::from("target/book")),
    ];
    let page =
        folders.into_iter().flatten().map(|folder| folder.join("index.html")).find(|page| page.is_file())?;
    let page = page.canonicalize().unwrap_or(page);
    // Characters that end or escape a part of an address.
    let mut address = String::from("file://");
    for character in page.to_str()?.chars() {
        match character {
            '%' | '#' | '?' | ' ' => address += &format!("%{:02X}", u32::from(character)),
            _ => address.push(character),
        }
    }
    Some(address)
}
