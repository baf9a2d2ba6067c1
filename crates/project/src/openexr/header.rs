//! The header of an OpenEXR file as bytes: what the decoder does not expose, and the order of attributes.
//!
//! ```text
//! magic, version and flags    2 × u32
//! for each part               attributes, then a 0
//! if there are several parts  one more 0
//! attribute                   name, 0, type, 0, length as i32, that many bytes
//! ```

/// Offset of the first attribute.
const FIRST_ATTRIBUTE: usize = 8;

/// The flag of a file with several parts.
const MULTIPART_FLAG: u32 = 1 << 12;

/// The attributes of each part; `None` if the bytes end within them.
fn split_parts(bytes: &[u8]) -> Option<Vec<Vec<&[u8]>>> {
    let flags = u32::from_le_bytes(bytes.get(4..FIRST_ATTRIBUTE)?.try_into().ok()?);
    let mut rest = &bytes[FIRST_ATTRIBUTE..];
    let mut parts = Vec::new();
    loop {
        let mut attributes = Vec::new();
        while *rest.first()? != 0 {
            let (attribute, after) = rest.split_at_checked(attribute_length(rest)?)?;
            attributes.push(attribute);
            rest = after;
        }
        rest = &rest[1..];
        let is_end = attributes.is_empty();
        if !is_end {
            parts.push(attributes);
        }
        if is_end || flags & MULTIPART_FLAG == 0 {
            return Some(parts);
        }
    }
}

/// Length in bytes of the attribute at the start of the bytes.
fn attribute_length(bytes: &[u8]) -> Option<usize> {
    let name = bytes.iter().position(|&byte| byte == 0)? + 1;
    let value = name + bytes.get(name..)?.iter().position(|&byte| byte == 0)? + 1 + 4;
    let length = i32::from_le_bytes(bytes.get(value - 4..value)?.try_into().ok()?);
    value.checked_add(usize::try_from(length).ok()?)
}

/// Name, type, and length with value of an attribute.
fn attribute_fields(attribute: &[u8]) -> impl Iterator<Item = &[u8]> {
    attribute.splitn(3, |&byte| byte == 0)
}

fn attribute_name(attribute: &[u8]) -> &[u8] {
    attribute_fields(attribute).next().unwrap_or_default()
}

/// Sorts the attributes of each part by name: the encoder writes some of them in the order of its hash map, which is
/// different each time.
pub(crate) fn sort_attributes(bytes: &mut [u8]) {
    let Some(mut parts) = split_parts(bytes) else { return };
    let mut sorted = Vec::new();
    for attributes in &mut parts {
        attributes.sort_by_key(|attribute| attribute_name(attribute));
        sorted.extend(attributes.concat());
        sorted.push(0);
    }
    bytes[FIRST_ATTRIBUTE..][..sorted.len()].copy_from_slice(&sorted);
}

/// Byte range of the value of an attribute of the first part, after its length.
pub(crate) fn attribute_value_range(bytes: &[u8], target: &str) -> Option<std::ops::Range<usize>> {
    let mut at = FIRST_ATTRIBUTE;
    let parts = split_parts(bytes)?;
    for attribute in parts.first()? {
        if attribute_name(attribute) == target.as_bytes() {
            let kind = attribute_fields(attribute).nth(1)?;
            return Some(at + target.len() + 1 + kind.len() + 1 + 4..at + attribute.len());
        }
        at += attribute.len();
    }
    None
}

/// The file with a text attribute added at the end of its first part. The offsets of the pixel chunks, which follow
/// the header, are adjusted.
pub(crate) fn with_text_attribute(bytes: &[u8], name: &str, text: &[u8]) -> Option<Vec<u8>> {
    let parts = split_parts(bytes)?;
    let length =
        |attributes: &Vec<&[u8]>| attributes.iter().map(|attribute| attribute.len()).sum::<usize>() + 1;
    let at = FIRST_ATTRIBUTE + length(parts.first()?) - 1;
    let several = u32::from_le_bytes(bytes[4..FIRST_ATTRIBUTE].try_into().ok()?) & MULTIPART_FLAG != 0;
    let table = FIRST_ATTRIBUTE + parts.iter().map(length).sum::<usize>() + usize::from(several);
    let size = i32::try_from(text.len()).ok()?.to_le_bytes();
    let attribute = [name.as_bytes(), b"\0string\0", &size, text].concat();
    // The table ends where the first chunk begins, which is that of its first entry.
    let offset = |at: usize| Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?));
    let end =
        usize::try_from(offset(table)?).ok().filter(|end| *end > table && (end - table).is_multiple_of(8))?;
    let mut changed = Vec::with_capacity(bytes.len() + attribute.len());
    changed.extend([bytes.get(..at)?, &attribute, bytes.get(at..table)?].concat());
    for entry in (table..end).step_by(8) {
        let chunk = offset(entry)?;
        // If the chunks are in another order, so that the first is not that of the first entry, it shows here.
        if chunk < end as u64 || chunk >= bytes.len() as u64 {
            return None;
        }
        changed.extend((chunk + attribute.len() as u64).to_le_bytes());
    }
    changed.extend(&bytes[end..]);
    Some(changed)
}

/// The first window of any part whose upper left corner is not above and left of its lower right one, so that it has
/// no pixel. The decoder would take it for a mirrored one.
pub(crate) fn empty_window(bytes: &[u8]) -> Option<&'static str> {
    let windows = [("dataWindow", "data window"), ("displayWindow", "display window")];
    let attributes = split_parts(bytes)?.into_iter().flatten();
    attributes
        .filter_map(|attribute| {
            let (_, window_name) =
                windows.into_iter().find(|(window, _)| window.as_bytes() == attribute_name(attribute))?;
            let (words, _) = attribute_fields(attribute).nth(2)?.as_chunks::<4>();
            let [_length, left, top, right, bottom] = words else { return None };
            let [left, top, right, bottom] = [left, top, right, bottom].map(|word| i32::from_le_bytes(*word));
            (left > right || top > bottom).then_some(window_name)
        })
        .next()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::slice::from_ref;

    fn attribute(name: &str, value: &[u8]) -> Vec<u8> {
        let length = (value.len() as i32).to_le_bytes();
        [name.as_bytes(), b"\0kind\0", &length, value].concat()
    }

    fn window(name: &str, corners: [i32; 4]) -> Vec<u8> {
        attribute(name, &corners.map(i32::to_le_bytes).concat())
    }

    fn file(flags: u32, parts: &[&[Vec<u8>]]) -> Vec<u8> {
        let parts = parts.iter().map(|attributes| [attributes.concat(), vec![0]].concat());
        let end: &[u8] = if flags == 0 { b"pixels" } else { b"\0pixels" };
        [&[0; 4], &flags.to_le_bytes()[..], &parts.collect::<Vec<_>>().concat(), end].concat()
    }

    #[test]
    fn attributes_are_sorted_within_their_part_and_nothing_else_moves() {
        let [a, b, c] = [attribute("a", b"\0\0"), attribute("b", b""), attribute("c", &[7; 300])];
        let mut one = file(0, &[&[c.clone(), a.clone(), b.clone()]]);
        sort_attributes(&mut one);
        assert_eq!(one, file(0, &[&[a.clone(), b.clone(), c.clone()]]));
        let mut two = file(MULTIPART_FLAG, &[&[b.clone(), a.clone()], &[c.clone(), b.clone()]]);
        sort_attributes(&mut two);
        assert_eq!(two, file(MULTIPART_FLAG, &[&[a, b.clone()], &[b, c]]));
    }

    #[test]
    fn an_inserted_text_is_read_back_and_chunks_move() {
        let [a, b] = [attribute("a", b"\0\0"), attribute("b", b"12")];
        for (flags, parts) in
            [(0, vec![&[a.clone(), b.clone()][..]]), (MULTIPART_FLAG, vec![from_ref(&a), from_ref(&b)])]
        {
            let mut whole = file(flags, &parts);
            whole.truncate(whole.len() - b"pixels".len());
            let end = whole.len() as u64 + 16;
            whole.extend([end, end + 6].iter().flat_map(|offset| offset.to_le_bytes()));
            whole.extend(b"chunk1chunk2");
            let longer = with_text_attribute(&whole, "told", b"so").unwrap();
            assert_eq!(&longer[attribute_value_range(&longer, "told").unwrap()], b"so");
            assert_eq!(attribute_value_range(&whole, "told"), None);
            let moved = (longer.len() - whole.len()) as u64;
            let table = longer.len() - 12 - 16;
            let offset = |at: usize| u64::from_le_bytes(longer[at..at + 8].try_into().unwrap());
            assert_eq!([offset(table), offset(table + 8)], [end + moved, end + 6 + moved]);
            assert_eq!(&longer[offset(table + 8) as usize..], b"chunk2");
            for length in 0..whole.len() - 12 {
                assert_eq!(with_text_attribute(&whole[..length], "told", b"so"), None, "cut at {length}");
            }
        }
    }

    #[test]
    fn bytes_that_are_cut_short_stay_as_they_are() {
        let whole = file(MULTIPART_FLAG, &[&[window("dataWindow", [9, 0, 0, 9]), attribute("b", b"12")]]);
        for length in 0..whole.len() - b"\0pixels".len() {
            let mut cut = whole[..length].to_vec();
            sort_attributes(&mut cut);
            assert_eq!(cut, &whole[..length]);
            assert_eq!(empty_window(&cut), None);
        }
        let mut endless = whole.clone();
        endless[FIRST_ATTRIBUTE + 16..][..4].copy_from_slice(&(-1i32).to_le_bytes());
        assert!(split_parts(&endless).is_none());
    }

    #[test]
    fn a_window_without_pixels_differs_from_one_of_a_pixel() {
        let [data, display] = ["dataWindow", "displayWindow"];
        let empty = |data, display| empty_window(&file(0, &[&[data, display]]));
        assert_eq!(empty(window(data, [-3, 5, -3, 5]), window(display, [0, 0, 0, 0])), None);
        assert_eq!(empty(window(data, [1, 0, 0, 0]), window(display, [0, 0, 0, 0])), Some("data window"));
        assert_eq!(empty(window(data, [0, 0, 0, 0]), window(display, [0, 0, 0, -1])), Some("display window"));
        assert_eq!(empty(window("other", [1, 0, 0, 0]), attribute(display, b"1")), None);
    }
}
