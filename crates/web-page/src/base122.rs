//! Bytes as text: seven bits in a byte of UTF-8, a seventh less than base64 (after [base122](https://github.com/kevinAlbs/Base122)).
//!
//! A group of seven bits is the character of ASCII with that code, control characters included. Six of them would need escaping in a string of
//! a script, or are changed by a reader of HTML: such a group is joined with the next one to a character of two bytes. Bits go from the lowest
//! of each byte, the last group is filled up with zeros. The viewer decodes it (`viewer/base122.js`).

/// Bits of a group.
const BITS: u32 = 7;
/// The groups that are no character of their own: NUL, the ends of lines, `"`, `<` and `\`.
const JOINED: [u8; 6] = [0, b'\n', b'\r', b'"', b'<', b'\\'];
/// The first code of characters that are one of these groups, with none after it.
const ALONE: u32 = (1 + JOINED.len() as u32) << BITS;

/// `bytes` as text.
pub fn encode_base122(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len() * 8 / 7 + 2);
    let mut groups = groups(bytes);
    while let Some(group) = groups.next() {
        let joined = JOINED.iter().position(|joined| *joined == group);
        let code = joined.map_or(u32::from(group), |index| match groups.next() {
            Some(next) => (1 + index as u32) << BITS | u32::from(next),
            None => ALONE + index as u32,
        });
        text.extend(char::from_u32(code));
    }
    text
}

/// The bits of `bytes`, seven at a time.
fn groups(bytes: &[u8]) -> impl Iterator<Item = u8> {
    let (mut bits, mut count) = (0u32, 0);
    let mut bytes = bytes.iter();
    std::iter::from_fn(move || {
        if count < BITS {
            match bytes.next() {
                Some(byte) => {
                    bits |= u32::from(*byte) << count;
                    count += 8;
                }
                None if count == 0 => return None,
                None => count = BITS,
            }
        }
        let group = (bits & ((1 << BITS) - 1)) as u8;
        bits >>= BITS;
        count -= BITS;
        Some(group)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the viewer does it.
    fn decode(text: &str) -> Vec<u8> {
        let (mut bytes, mut bits, mut count) = (Vec::new(), 0u32, 0);
        let mut take = |group: u32| {
            bits |= group << count;
            count += BITS;
            if count >= 8 {
                bytes.push(bits as u8);
                bits >>= 8;
                count -= 8;
            }
        };
        let joined = |index: u32| u32::from(JOINED[index as usize]);
        for code in text.chars().map(u32::from) {
            match code {
                ..128 => take(code),
                ALONE.. => take(joined(code - ALONE)),
                _ => [joined((code >> BITS) - 1), code & 127].into_iter().for_each(&mut take),
            }
        }
        bytes
    }

    #[test]
    fn characters_need_no_escaping() {
        let all: Vec<u8> = (0..=255).collect();
        for bytes in [all.repeat(7), vec![0; 100], vec![b'<'; 100], b"\\\"\r\n</script>".to_vec()] {
            let text = encode_base122(&bytes);
            assert!(!text.contains(['\0', '\n', '\r', '"', '<', '\\', '\u{2028}', '\u{2029}']));
            assert_eq!(decode(&text), bytes);
        }
    }

    #[test]
    fn bytes_come_back_whatever_their_number() {
        let bytes: Vec<u8> = (0..1000u32).map(|k| (k * k * 31 / 7) as u8).collect();
        for length in (0..40).chain([999, 1000]) {
            let text = encode_base122(&bytes[..length]);
            assert_eq!(decode(&text), bytes[..length], "{length}");
            assert!(text.len() <= length * 8 / 7 + 2, "{length}: {}", text.len());
        }
        for extreme in [vec![0; 33], vec![255; 33], vec![0; 7], vec![0; 8]] {
            assert_eq!(decode(&encode_base122(&extreme)), extreme);
        }
    }
}
