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

/// Three uniform numbers in [0, 1), which depend on nothing but `x`, `y` and `z`.
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
    /// Binary digits of the places in their cells that are turned over: that leaves a net a net.
    shift: [u32; 2],
}

impl Net {
    /// A net of 2 to the power of `bits` cells a side; another one for each seed.
    pub fn new(bits: u32, seed: [u32; 2]) -> Self {
        let [a, b, _] = mix(seed[0], seed[1], u32::MAX);
        let digits = u32::MAX << (u32::BITS - bits);
        Self { seed, bits, shift: [a & digits, b & digits] }
    }

    /// The `k`-th of nets that together have, in each cell, places that are spread as evenly: any 4^m of them that follow each
    /// other from a multiple of 4^m on.
    pub fn for_pattern(bits: u32, k: u32) -> Self {
        Self { seed: [0, bits], bits, shift: sequence(k) }
    }

    /// The random place in the cell in row `row` and column `column`, in [0, 1)² of the cell.
    pub fn place(&self, row: usize, column: usize) -> [f64; 2] {
        let [u, v, _] = mix(self.seed[0], self.seed[1], (row << self.bits | column) as u32);
        // The digits of the other coordinate, in reverse, and what is random behind them.
        let slot = |k: usize, random: u32| (k as u32).reverse_bits() | random >> self.bits;
        let [u, v] = [slot(row, u) ^ self.shift[0], slot(column, v) ^ self.shift[1]];
        [u, v].map(|x| f64::from(x) / 4294967296.0)
    }
}

/// The `k`-th point of the (0, 2)-sequence in base 2 of van der Corput and Sobol, as 32 binary digits behind the point.
fn sequence(k: u32) -> [u32; 2] {
    let (mut sobol, mut direction, mut rest) = (0, 1u32 << 31, k);
    while rest != 0 {
        if rest & 1 == 1 {
            sobol ^= direction;
        }
        direction ^= direction >> 1;
        rest >>= 1;
    }
    [k.reverse_bits(), sobol]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_net_has_one_place_in_each_box() {
        let alone = (0..200).map(|k| (2 + k % 3, Net::new(2 + k % 3, [k, 7 * k])));
        let of_many = (0..200).map(|k| (2 + k % 3, Net::for_pattern(2 + k % 3, k)));
        for (index, (bits, net)) in alone.chain(of_many).enumerate() {
            let n = 1usize << bits;
            for wide in 0..=2 * bits {
                let [columns, rows] = [1usize << (2 * bits - wide), 1 << wide];
                let mut found = vec![false; n * n];
                for (row, column) in (0..n * n).map(|k| (k / n, k % n)) {
                    let [u, v] = net.place(row, column);
                    let x = (column as f64 + u) / n as f64 * columns as f64;
                    let y = (row as f64 + v) / n as f64 * rows as f64;
                    found[y as usize * columns + x as usize] = true;
                }
                assert!(found.iter().all(|&found| found), "{index}, {n}: {columns} × {rows}");
            }
        }
    }

    #[test]
    fn many_nets_are_spread_evenly_in_each_cell() {
        for (first, side) in [(0, 2), (12, 2), (16, 4), (192, 8), (0, 16)] {
            for (row, column) in [(0, 0), (3, 7), (15, 15)] {
                let mut found = vec![false; side * side];
                for k in first..first + (side * side) as u32 {
                    let [u, v] = Net::for_pattern(4, k).place(row, column);
                    found[(v * side as f64) as usize * side + (u * side as f64) as usize] = true;
                }
                assert!(found.iter().all(|&found| found), "{first}, {side}: {row} {column}");
            }
        }
    }
}
