//! The metadata segments of a JPEG: EXIF and XMP, including extended XMP in further segments; and the end of a JPEG.
//!
//! ```text
//! segment         0xFF, marker, length as u16 (itself included), data
//! XMP             APP1, "http://ns.adobe.com/xap/1.0/", 0, text
//! extended XMP    APP1, "http://ns.adobe.com/xmp/extension/", 0, GUID of 32 letters, whole length, offset as u32, a piece of the text
//! ```
//!
//! (ITU T.81, annex B; XMP Specification Part 3, 1.1.3.) Numbers are big endian.

/// A result whose error has its byte position.
pub(super) type At<T> = Result<T, (usize, String)>;

/// The metadata of a JPEG's segments.
#[derive(Default)]
pub(super) struct Segments<'a> {
    /// A TIFF structure.
    pub exif: Option<&'a [u8]>,
    pub xmp: Option<&'a [u8]>,
    pieces: Vec<Piece<'a>>,
}

/// A piece of extended XMP.
struct Piece<'a> {
    /// The byte of the file where its segment begins.
    at: usize,
    guid: &'a [u8],
    /// Of the whole text.
    length: u32,
    offset: u32,
    text: &'a [u8],
}

const START: [u8; 2] = [0xFF, 0xD8];
const XMP: &[u8] = b"http://ns.adobe.com/xap/1.0/\0";
const EXTENDED: &[u8] = b"http://ns.adobe.com/xmp/extension/\0";

/// Whether bytes are those of a JPEG.
pub(super) fn is_jpeg(bytes: &[u8]) -> bool {
    bytes.starts_with(&START)
}

/// Whether bytes are those of a picture format that is embedded in others.
pub(super) fn is_picture(bytes: &[u8]) -> bool {
    is_jpeg(bytes)
        || bytes.starts_with(b"\x89PNG\r\n\x1a\n")
        || (bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP"))
}

impl<'a> Segments<'a> {
    /// Parses the segments of a JPEG before the picture's pixels; what is wrong with it is text.
    pub fn parse(bytes: &'a [u8]) -> At<Self> {
        let mut segments = Self::default();
        let mut at = START.len();
        while let Some((marker, data, end)) = segment(bytes, at)? {
            if marker == 0xE1 {
                segments.take(at, data);
            }
            at = end;
            // The start of the scan: pixels follow.
            if marker == 0xDA {
                break;
            }
        }
        Ok(segments)
    }

    fn take(&mut self, at: usize, data: &'a [u8]) {
        if let Some(exif) = data.strip_prefix(b"Exif\0\0") {
            self.exif = self.exif.or(Some(exif));
        } else if let Some(xmp) = data.strip_prefix(XMP) {
            self.xmp = self.xmp.or(Some(xmp));
        } else if let Some((guid, rest)) =
            data.strip_prefix(EXTENDED).and_then(|data| data.split_at_checked(32))
        {
            let Some((numbers, text)) = rest.split_at_checked(8) else { return };
            let number = |at: usize| {
                u32::from_be_bytes([numbers[at], numbers[at + 1], numbers[at + 2], numbers[at + 3]])
            };
            self.pieces.push(Piece { at, guid, length: number(0), offset: number(4), text });
        }
    }

    /// Assembles the extended XMP with this GUID from its pieces; what is wrong with it is text.
    pub fn extended(&self, guid: &str) -> At<Vec<u8>> {
        let mut pieces: Vec<&Piece> =
            self.pieces.iter().filter(|piece| piece.guid.eq_ignore_ascii_case(guid.as_bytes())).collect();
        pieces.sort_by_key(|piece| piece.offset);
        let Some(first) = pieces.first() else {
            return Err((0, "its XMP continues in segments that are missing (the file was truncated, or saved by a program that drops them)".into()));
        };
        let length = first.length as usize;
        let mut text = Vec::new();
        for piece in pieces {
            let offset = piece.offset as usize;
            if piece.length as usize != length || offset > text.len() || offset + piece.text.len() > length {
                let what = format!(
                    "this piece of its extended XMP is for bytes {offset} to {} of {}, after {} of {length}",
                    offset + piece.text.len(),
                    piece.length,
                    text.len()
                );
                return Err((piece.at, what));
            }
            // A piece may come twice.
            if offset + piece.text.len() > text.len() {
                text.extend_from_slice(&piece.text[text.len() - offset..]);
            }
        }
        if text.len() < length {
            return Err((
                0,
                format!("only {} of {length} bytes of its extended XMP are present", text.len()),
            ));
        }
        Ok(text)
    }
}

/// The segment that begins at a byte: its marker, its data, its end; `None` at the end of the picture.
fn segment(bytes: &[u8], at: usize) -> At<Option<(u8, &[u8], usize)>> {
    let mut at = at;
    // Any number of fill bytes.
    while bytes.get(at) == Some(&0xFF) && bytes.get(at + 1) == Some(&0xFF) {
        at += 1;
    }
    match (bytes.get(at), bytes.get(at + 1)) {
        (None, _) | (Some(0xFF), None | Some(0xD9)) => Ok(None),
        // Markers without a length.
        (Some(0xFF), Some(&marker @ (0x01 | 0xD0..=0xD8))) => Ok(Some((marker, &[], at + 2))),
        (Some(0xFF), Some(&marker)) => {
            let length = bytes.get(at + 2..at + 4).map(|length| u16::from_be_bytes([length[0], length[1]]));
            let end = at + 2 + usize::from(length.unwrap_or(0));
            match length {
                Some(2..) if end <= bytes.len() => Ok(Some((marker, &bytes[at + 4..end], end))),
                _ => Err((at, "a segment of the JPEG does not fit into the file".into())),
            }
        }
        _ => Err((at, "no segment of a JPEG begins here".into())),
    }
}

/// The byte after the end of the JPEG that begins the bytes; `None` if it does not end.
pub(super) fn end_of_jpeg(bytes: &[u8]) -> Option<usize> {
    if !is_jpeg(bytes) {
        return None;
    }
    let mut at = START.len();
    loop {
        match segment(bytes, at).ok()? {
            Some((0xDA, _, end)) => {
                // Within pixels 0xFF is followed by 0 or a restart marker.
                let pixels = &bytes[end..];
                let is_marker = |pair: &[u8]| pair[0] == 0xFF && !matches!(pair[1], 0 | 0xFF | 0xD0..=0xD7);
                at = end + pixels.windows(2).position(is_marker)?;
            }
            Some((.., end)) => at = end,
            None => {
                return (bytes.get(at..).is_some_and(|rest| rest.len() >= 2))
                    .then_some(end_marker(bytes, at));
            }
        }
    }
}

/// The byte after the end marker, which is at `at` or after fill bytes.
fn end_marker(bytes: &[u8], at: usize) -> usize {
    let fill = bytes[at..].iter().take_while(|byte| **byte == 0xFF).count();
    (at + fill + 1).min(bytes.len())
}

/// The byte after the end of the PNG that begins the bytes; `None` if it does not end.
pub(super) fn end_of_png(bytes: &[u8]) -> Option<usize> {
    let mut at = 8;
    loop {
        let head = bytes.get(at..at + 8)?;
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        at = at.checked_add(length)?.checked_add(12)?;
        if at > bytes.len() {
            return None;
        }
        if &head[4..] == b"IEND" {
            return Some(at);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_segment(head: &[u8], rest: &[u8]) -> Vec<u8> {
        let length = (2 + head.len() + rest.len()) as u16;
        [&[0xFF, 0xE1][..], &length.to_be_bytes(), head, rest].concat()
    }

    fn piece(length: u32, offset: u32, text: &[u8]) -> Vec<u8> {
        let head = [EXTENDED, &[b'A'; 32], &length.to_be_bytes(), &offset.to_be_bytes()].concat();
        with_segment(&head, text)
    }

    fn jpeg(segments: &[Vec<u8>]) -> Vec<u8> {
        [&START[..], &segments.concat(), &[0xFF, 0xDA, 0, 3, 9, 1, 2, 0xFF, 0, 3, 0xFF, 0xD0, 4, 0xFF, 0xD9]]
            .concat()
    }

    fn extended(segments: &[Vec<u8>]) -> Result<Vec<u8>, String> {
        let bytes = jpeg(segments);
        let segments = Segments::parse(&bytes).map_err(|(_, what)| what)?;
        segments.extended(&"a".repeat(32)).map_err(|(_, what)| what)
    }

    #[test]
    fn pieces_in_any_order_and_twice() {
        let [a, b, c] = [piece(6, 0, b"ab"), piece(6, 2, b"cd"), piece(6, 4, b"ef")];
        for order in [[&a, &b, &c, &a], [&c, &a, &b, &b], [&b, &c, &c, &a]] {
            assert_eq!(extended(&order.map(Clone::clone)).unwrap(), b"abcdef");
        }
        assert!(extended(&[a.clone(), c.clone()]).unwrap_err().contains("bytes 4 to 6 of 6, after 2 of 6"));
        assert!(extended(&[a.clone(), b.clone()]).unwrap_err().contains("only 4 of 6 bytes"));
        assert!(extended(&[a, piece(4_000_000_000, 2, b"x")]).is_err());
        assert!(extended(&[]).unwrap_err().contains("are missing"));
    }

    #[test]
    fn the_end_is_behind_the_pixels() {
        let whole = jpeg(&[with_segment(b"Exif\0\0", b"\xFF\xD9")]);
        let behind = [&whole[..], b"more"].concat();
        assert_eq!(end_of_jpeg(&behind), Some(whole.len()));
        for end in 0..whole.len() {
            assert_eq!(end_of_jpeg(&whole[..end]), None, "{end}");
        }
        assert_eq!(Segments::parse(&behind).ok().unwrap().exif, Some(&b"\xFF\xD9"[..]));
    }
}
