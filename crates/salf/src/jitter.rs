//! Deterministic jitter: uniform numbers that depend on nothing but where they are used.

/// A well-mixed 32-bit hash of three integers (Jarzynski and Olano, "Hash functions for GPU rendering", 2020: pcg3d).
fn mix(x: u32, y: u32, z: u32) -> [u32; 3] {
    let mut v = [x, y, z].map(|k| k.wrapping_mul(1664525).wrapping_add(1013904223));
    let round = |v: &mut [u32; 3]| {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    };
    round(&mut v);
    v = v.map(|k| k ^ (k >> 16));
    round(&mut v);
    v
}

/// Three uniform numbers in [0, 1).
pub fn jitter(x: u32, y: u32, z: u32) -> [f64; 3] {
    mix(x, y, z).map(|k| k as f64 / 4294967296.0)
}

/// A place in each cell of a square of n × n cells, n a power of two: jittered, and yet one in each of the n² columns, one in
/// each of the n² rows and in each other division of the square into n² boxes that are a power of two wide (a (0, m, 2)-net in
/// base 2: Niederreiter, "Random Number Generation and Quasi-Monte Carlo Methods", 1992, chapter 4). So an edge through the
/// square, whatever its direction, has about as many places on either side as it has area there.
pub struct Net {
    seed: [u32; 2],
    /// Binary digits of n.
    bits: u32,
    flips: [usize; 2],
}

impl Net {
    /// Of 2 to `bits` cells a side; another one for each seed.
    pub fn new(bits: u32, seed: [u32; 2]) -> Self {
        let [a, b, _] = mix(seed[0], seed[1], u32::MAX);
        Self { seed, bits, flips: [a, b].map(|flips| (flips >> (u32::BITS - bits)) as usize) }
    }

    /// The place in a cell, in [0, 1)².
    pub fn place(&self, row: usize, column: usize) -> [f64; 2] {
        let [u, v, _] = jitter(self.seed[0], self.seed[1], (row << self.bits | column) as u32);
        let n = (1 << self.bits) as f64;
        // The digits of the other coordinate, in reverse.
        let slot = |k: usize, flips: usize| ((k.reverse_bits() >> (usize::BITS - self.bits)) ^ flips) as f64;
        [(slot(row, self.flips[0]) + u) / n, (slot(column, self.flips[1]) + v) / n]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_net_has_one_place_in_each_box() {
        for (bits, seed) in (0..200).map(|k| (2 + k % 3, [k, 7 * k])) {
            let (net, n) = (Net::new(bits, seed), 1usize << bits);
            for wide in 0..=2 * bits {
                let [columns, rows] = [1usize << (2 * bits - wide), 1 << wide];
                let mut found = vec![false; n * n];
                for (row, column) in (0..n * n).map(|k| (k / n, k % n)) {
                    let [u, v] = net.place(row, column);
                    let x = (column as f64 + u) / n as f64 * columns as f64;
                    let y = (row as f64 + v) / n as f64 * rows as f64;
                    found[y as usize * columns + x as usize] = true;
                }
                assert!(found.iter().all(|&found| found), "{seed:?}, {n}: {columns} × {rows}");
            }
        }
    }
}
