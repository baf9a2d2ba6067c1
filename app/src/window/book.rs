//! The book's pages, which *Help* opens.

use crate::window::installed;

/// The address of the book's first page; `None` if it is not there.
pub fn book_url() -> Option<String> {
    let page = installed::find("share/doc/focus-brush/docs", "target/book", "index.html")?;
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
