//! Reproducible pseudo-random numbers.

use glam::{DVec2, DVec3};

/// The `k`-th point of Roberts's R2 sequence, which fills the unit square evenly.
pub fn spread(k: u32) -> DVec2 {
    (DVec2::new(0.754_877_666, 0.569_840_291) * f64::from(k) + 0.5).fract()
}

/// SplitMix64 (Steele, Lea and Flood 2014).
pub struct Random(pub u64);

impl Random {
    /// A uniform word.
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// A number below `n`, nearly uniform; 0 if `n` is 0.
    pub fn below(&mut self, n: u64) -> u64 {
        self.word() % n.max(1)
    }

    /// True once in `n` times.
    pub fn one_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }

    /// One of the choices, of which there must be one.
    pub fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize]
    }

    /// A uniform number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Three uniform numbers in [0, 1).
    pub fn three(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.unit())
    }

    /// A uniform point in [−1, 1)³.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| 2.0 * self.unit() - 1.0))
    }

    /// A uniform unit vector.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.in_cube();
            if (1e-3..=1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// Barycentric coordinates, uniform over the triangle.
    pub fn in_triangle(&mut self) -> DVec2 {
        let (a, b) = (self.unit(), self.unit());
        if a + b > 1.0 { DVec2::new(1.0 - a, 1.0 - b) } else { DVec2::new(a, b) }
    }

    /// Barycentric coordinates, in two thirds of the cases on an edge or a corner.
    pub fn barycentric(&mut self) -> DVec2 {
        let (mut a, mut b) = (self.unit(), self.unit());
        match (self.unit() * 6.0) as u32 {
            0 => a = 0.0,
            1 => b = 0.0,
            2 => b = 1.0 - a,
            3 => (a, b) = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)][(self.unit() * 3.0) as usize],
            _ => {}
        }
        if a + b > 1.0 { DVec2::new(1.0 - a, 1.0 - b) } else { DVec2::new(a, b) }
    }

    /// Barycentric coordinates on a corner (in a third of the cases) or an edge.
    pub fn on_outline(&mut self) -> DVec2 {
        let along = self.unit();
        match (self.unit() * 6.0) as u32 {
            0 => DVec2::new(0.0, along),
            1 => DVec2::new(along, 0.0),
            2 | 3 => DVec2::new(along, 1.0 - along),
            _ => [DVec2::ZERO, DVec2::X, DVec2::Y][(along * 3.0) as usize],
        }
    }
}
