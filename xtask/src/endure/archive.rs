//! ZIP and zlib streams that expand to far more than they are.

/// A deflate stream of this many zeros: about a five hundredth of it.
pub fn deflated_zeros(count: u64) -> Vec<u8> {
    let mut bits = Bits::default();
    // The last block, with the fixed codes: a zero, then copies of 258 of it.
    bits.push(0b1, 1);
    bits.push(0b01, 2);
    let zero = |bits: &mut Bits| bits.push_code(0b0011_0000, 8);
    let (copies, rest) = (count.saturating_sub(1) / 258, count.saturating_sub(1) % 258);
    for _ in 0..rest + u64::from(count > 0) {
        zero(&mut bits);
    }
    for _ in 0..copies {
        bits.push_code(0b1100_0101, 8);
        bits.push_code(0, 5);
    }
    bits.push_code(0, 7);
    bits.finished()
}

/// The same as a zlib stream.
pub fn zlib_zeros(count: u64) -> Vec<u8> {
    let mut stream = vec![0x78, 0x9c];
    stream.extend(deflated_zeros(count));
    // Adler-32 of zeros: a stays 1, b counts.
    let adler = ((count % 65521) as u32) << 16 | 1;
    stream.extend(adler.to_be_bytes());
    stream
}

#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    held: u32,
    count: u32,
}

impl Bits {
    fn push(&mut self, value: u32, count: u32) {
        self.held |= value << self.count;
        self.count += count;
        while self.count >= 8 {
            self.bytes.push(self.held as u8);
            self.held >>= 8;
            self.count -= 8;
        }
    }

    /// A Huffman code, whose highest bit goes first.
    fn push_code(&mut self, code: u32, count: u32) {
        self.push(code.reverse_bits() >> (32 - count), count);
    }

    fn finished(mut self) -> Vec<u8> {
        let count = (8 - self.count) % 8;
        self.push(0, count);
        self.bytes
    }
}

/// An entry of a ZIP.
pub struct Entry<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its bytes, as stored.
    pub stored: Vec<u8>,
    /// What they expand to, bytes.
    pub size: u64,
    /// Whether they are deflated.
    pub deflated: bool,
}

impl<'a> Entry<'a> {
    /// An entry as it is.
    pub fn plain(name: &'a str, bytes: &[u8]) -> Self {
        Self { name, stored: bytes.to_vec(), size: bytes.len() as u64, deflated: false }
    }

    /// An entry of zeros.
    pub fn zeros(name: &'a str, size: u64) -> Self {
        Self { name, stored: deflated_zeros(size), size, deflated: true }
    }
}

/// A ZIP of these entries, each as it says it is.
pub fn zip(entries: &[Entry<'_>]) -> Vec<u8> {
    let (mut file, mut directory) = (Vec::new(), Vec::new());
    for entry in entries {
        let offset = file.len() as u32;
        let checksum = if entry.deflated { 0 } else { crc32(&entry.stored) };
        let mut common = Vec::new();
        common.extend([20, 0, 0, 0, u8::from(entry.deflated) * 8, 0, 0, 0, 0x21, 0]);
        common.extend(checksum.to_le_bytes());
        common.extend((entry.stored.len() as u32).to_le_bytes());
        common.extend((entry.size.min(u64::from(u32::MAX)) as u32).to_le_bytes());
        common.extend((entry.name.len() as u16).to_le_bytes());
        common.extend([0, 0]);
        file.extend(b"PK\x03\x04");
        file.extend(&common);
        file.extend(entry.name.as_bytes());
        file.extend(&entry.stored);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&common);
        directory.extend([0; 10]);
        directory.extend(offset.to_le_bytes());
        directory.extend(entry.name.as_bytes());
    }
    let start = file.len() as u32;
    let count = (entries.len() as u16).to_le_bytes();
    file.extend(&directory);
    file.extend(b"PK\x05\x06\0\0\0\0");
    file.extend(count);
    file.extend(count);
    file.extend((directory.len() as u32).to_le_bytes());
    file.extend(start.to_le_bytes());
    file.extend([0, 0]);
    file
}

/// CRC-32 as in ZIP and PNG.
pub fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc)))
}

/// SHA-256 (FIPS 180-4), in hex.
pub fn sha256(bytes: &[u8]) -> String {
    // The fractional parts of the square and cube roots of the first primes.
    let primes: Vec<u32> = (2u32..).filter(|n| (2..*n).all(|d| n % d != 0)).take(64).collect();
    let fraction = |root: f64| ((root - root.floor()) * 4_294_967_296.0) as u32;
    let mut state: [u32; 8] = std::array::from_fn(|k| fraction(f64::from(primes[k]).sqrt()));
    let rounds: Vec<u32> = primes.iter().map(|prime| fraction(f64::from(*prime).cbrt())).collect();
    let mut padded = bytes.to_vec();
    padded.push(0x80);
    padded.resize((padded.len() + 8).next_multiple_of(64) - 8, 0);
    padded.extend((8 * bytes.len() as u64).to_be_bytes());
    for block in padded.chunks_exact(64) {
        let mut words: Vec<u32> =
            block.chunks_exact(4).map(|w| u32::from_be_bytes([w[0], w[1], w[2], w[3]])).collect();
        for k in 16..64 {
            let (a, b) = (words[k - 15], words[k - 2]);
            let low = a.rotate_right(7) ^ a.rotate_right(18) ^ (a >> 3);
            let high = b.rotate_right(17) ^ b.rotate_right(19) ^ (b >> 10);
            words.push(words[k - 16].wrapping_add(low).wrapping_add(words[k - 7]).wrapping_add(high));
        }
        let [mut a, mut b, mut c, mut d, mut e, mut f, mut g, mut h] = state;
        for (word, round) in words.iter().zip(&rounds) {
            let mixed = e.rotate_right(6) ^ e.rotate_right(11) ^ e.rotate_right(25);
            let chosen = (e & f) ^ (!e & g);
            let first = h.wrapping_add(mixed).wrapping_add(chosen).wrapping_add(*round).wrapping_add(*word);
            let mixed = a.rotate_right(2) ^ a.rotate_right(13) ^ a.rotate_right(22);
            let second = mixed.wrapping_add((a & b) ^ (a & c) ^ (b & c));
            (h, g, f, e, d, c, b, a) = (g, f, e, d.wrapping_add(first), c, b, a, first.wrapping_add(second));
        }
        let added = [a, b, c, d, e, f, g, h];
        state.iter_mut().zip(added).for_each(|(state, added)| *state = state.wrapping_add(added));
    }
    state.iter().map(|word| format!("{word:08x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::sha256;

    #[test]
    fn checksums_are_those_of_the_standard() {
        assert_eq!(sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        let long = sha256(b"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq");
        assert_eq!(long, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    }
}
