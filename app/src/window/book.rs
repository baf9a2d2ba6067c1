//! The book's pages, which *Help* opens.

use crate::window::installed;

/// The address of the book's first page; `None` if it is not there.
pub fn book_url() -> Option<String> {
    let page = installed::find("share/doc/focus-brush/docs", "target/book", "index.html")?;
    Some(file_url(page.to_str()?))
}

/// The address of a file: on Windows, whose paths begin with a drive or a server, with slashes.
fn file_url(path: &str) -> String {
    let (start, path) = match cfg!(windows) {
        true => (if path.starts_with("\\\\") { "file:" } else { "file:///" }, path.replace('\\', "/")),
        false => ("file://", path.to_owned()),
    };
    let mut address = String::from(start);
    for character in path.chars() {
        // Characters that end or escape a part of an address.
        match character {
            '%' | '#' | '?' | ' ' => address += &format!("%{:02X}", u32::from(character)),
            _ => address.push(character),
        }
    }
    address
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_of_files() {
        if cfg!(windows) {
            assert_eq!(file_url("C:\\a b\\c#.html"), "file:///C:/a%20b/c%23.html");
            assert_eq!(file_url("\\\\server\\a.html"), "file://server/a.html");
        } else {
            assert_eq!(file_url("/a b/c#.html"), "file:///a%20b/c%23.html");
        }
    }
}
