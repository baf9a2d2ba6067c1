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
        let checksum = if entry.deflated { 0 } else { crc32fast::hash(&entry.stored) };
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
