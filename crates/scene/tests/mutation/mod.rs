//! Damage to files, the same every time: for the readers of every crate.

/// A linear congruential generator (Knuth).
pub struct Random(pub u64);

impl Random {
    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }
}

/// Changes bytes in up to four places: to one that means something in a text, by a bit, or by leaving some out.
pub fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len().max(1));
        match random.below(3) {
            _ if bytes.is_empty() => {}
            0 => bytes[at] = b"0123456789-.e[]{},:\"\0\xff"[random.below(22)],
            1 => bytes[at] ^= 1 << random.below(8),
            _ => drop(bytes.drain(at..(at + 1 + random.below(8)).min(bytes.len()))),
        }
    }
}
