//! Bytes as text: 13 bits in two of 91 characters, a thirteenth less than base64.
//!
//! The characters are those of ASCII from `!` to `~` without `"`, `<` and `\`: they need no escaping in a string of a script. Bits go from the
//! lowest of each byte; a rest of at most six bits takes one character. The viewer decodes it (`viewer/base91.js`).

/// The number of characters.
const BASE: u32 = 91;
/// Bits in two of them: 2¹³ ≤ 91².
const BITS: u32 = 13;
/// Bits that one of them holds: 2⁶ ≤ 91.
const BITS_OF_ONE: u32 = 6;

/// `bytes` as text.
pub fn encode_base91(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len() * 16 / 13 + 2);
    let (mut bits, mut count) = (0u32, 0);
    for &byte in bytes {
        bits |= u32::from(byte) << count;
        count += 8;
        if count >= BITS {
            let pair = bits & ((1 << BITS) - 1);
            text.extend([pair % BASE, pair / BASE].map(digit));
            bits >>= BITS;
            count -= BITS;
        }
    }
    if count > 0 {
        text.push(digit(bits % BASE));
    }
    if count > BITS_OF_ONE {
        text.push(digit(bits / BASE));
    }
    text
}

/// The character of a number below 91.
fn digit(number: u32) -> char {
    let without_quote = number + if number < 1 { 33 } else { 34 };
    let without_less = without_quote + u32::from(without_quote >= 60);
    let code = without_less + u32::from(without_less >= 92);
    char::from(code as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the viewer does it.
    fn decode(text: &str) -> Vec<u8> {
        let digits: Vec<char> = (0..BASE).map(digit).collect();
        let number = |c: char| digits.iter().position(|&d| d == c).unwrap() as u32;
        let characters: Vec<char> = text.chars().collect();
        let (mut bytes, mut bits, mut count) = (Vec::new(), 0u32, 0);
        for pair in characters.chunks(2) {
            let (value, width) = match *pair {
                [low, high] => (number(low) + BASE * number(high), BITS),
                [low] => (number(low), BITS_OF_ONE),
                _ => unreachable!(),
            };
            bits |= value << count;
            count += width;
            while count >= 8 {
                bytes.push(bits as u8);
                bits >>= 8;
                count -= 8;
            }
        }
        bytes
    }

    #[test]
    fn characters_need_no_escaping() {
        let digits: String = (0..BASE).map(digit).collect();
        let expected: String = ('!'..='~').filter(|c| !['"', '<', '\\'].contains(c)).collect();
        assert_eq!(digits, expected);
    }

    #[test]
    fn bytes_come_back_whatever_their_number() {
        let bytes: Vec<u8> = (0..1000u32).map(|k| (k * k * 31 / 7) as u8).collect();
        for length in (0..40).chain([999, 1000]) {
            let text = encode_base91(&bytes[..length]);
            assert_eq!(decode(&text), bytes[..length], "{length}");
            assert!(text.len() <= length * 16 / 13 + 2);
        }
        for extreme in [vec![0; 33], vec![255; 33]] {
            assert_eq!(decode(&encode_base91(&extreme)), extreme);
        }
    }
}
