//! `book [FOLDER]`: the book as HTML pages, which *Help ▸ The book* opens: into `target/book`, and into every package.
//!
//! The pages are those of `docs/SUMMARY.md`, in its order. mdBook makes the same pages with a search from `docs/book.toml`, but is not
//! everywhere.

mod page;
mod summary;

use crate::chore::{Failure, copy, file_failure, repository};
use std::path::{Path, PathBuf};

/// Folders and files of `docs` that pages refer to, beside the pages.
const COPIED: [&str; 2] = ["pictures", "figures"];

/// Where the book is written unless a folder is given.
pub fn default_folder() -> PathBuf {
    repository().join("target/book")
}

/// Writes the book into a folder, which may exist.
///
/// # Errors
/// A page of the summary is missing, or a file cannot be written.
pub fn write(folder: &Path) -> Result<(), Failure> {
    let docs = repository().join("docs");
    let chapters = summary::parse(&read(&docs.join("SUMMARY.md"))?);
    for (at, chapter) in chapters.iter().enumerate() {
        let Some(path) = &chapter.path else { continue };
        let text = read(&docs.join(path))?;
        let page = page::html(&chapters, at, &text);
        write_file(&folder.join(path).with_extension("html"), &page)?;
    }
    for name in COPIED {
        copy(&docs.join(name), &folder.join(name))?;
    }
    write_file(&folder.join("book.css"), page::STYLE)?;
    let first = chapters.iter().find_map(|chapter| chapter.path.as_deref());
    let first = first.ok_or_else(|| Failure::new("docs/SUMMARY.md names no page"))?;
    let target = Path::new(first).with_extension("html");
    let index =
        format!("<!DOCTYPE html><meta http-equiv=\"refresh\" content=\"0; url={}\">\n", target.display());
    write_file(&folder.join("index.html"), &index)
}

fn read(file: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(file).map_err(|error| file_failure(file, &error))
}

fn write_file(file: &Path, text: &str) -> Result<(), Failure> {
    let written =
        file.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(file, text));
    written.map_err(|error| file_failure(file, &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What follows `start` in a page, up to the next quotation mark.
    fn targets<'a>(page: &'a str, start: &'a str) -> impl Iterator<Item = &'a str> {
        page.split(start).skip(1).filter_map(|rest| rest.split('"').next())
    }

    #[test]
    fn every_link_and_picture_of_the_book_is_there() {
        let folder = std::env::temp_dir().join(format!("focus-brush-book-{}", std::process::id()));
        write(&folder).unwrap();
        let mut pages = vec![folder.clone()];
        let (mut links, mut count) = (0, 0);
        while let Some(path) = pages.pop() {
            if path.is_dir() {
                pages.extend(std::fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
                continue;
            }
            if path.extension().is_none_or(|extension| extension != "html") {
                continue;
            }
            count += 1;
            let page = std::fs::read_to_string(&path).unwrap();
            for target in targets(&page, "<a href=\"").chain(targets(&page, "<img src=\"")) {
                let file = target.split('#').next().unwrap_or_default();
                if file.is_empty() || file.contains("://") {
                    continue;
                }
                links += 1;
                let place = path.parent().unwrap().join(file);
                // Pages link to files of the source, too, which only a source tree has.
                let in_source =
                    file.contains("../../../") || !place.starts_with(&folder) || file.starts_with("../../");
                assert!(place.exists() || in_source, "{}: {target}", path.display());
            }
        }
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(count > 30 && links > 300, "{count} pages, {links} links");
    }
}
