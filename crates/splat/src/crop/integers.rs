//! How fine the integers are that a picture is summed in.

use crate::nodes::Scale;

/// Which sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Those of the picture as if nothing were painted.
    Standard,
    /// Those of the picture as it is painted, and of its mattes.
    Painted,
}

/// Bits behind the point of the sums of ordinary samples. A picture has the finest that hold all of it; so a crop's may have to be coarser than
/// itself needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Integers {
    /// Of [`Kind::Standard`].
    pub standard: i32,
    /// Of [`Kind::Painted`].
    pub painted: i32,
}

impl Default for Integers {
    fn default() -> Self {
        let bits = Scale::FINEST.dim_bits;
        Self { standard: bits, painted: bits }
    }
}

impl Integers {
    /// The bits of a kind of sums: 2 to their power quanta make a pixel of 1.
    pub fn bits(self, kind: Kind) -> i32 {
        match kind {
            Kind::Standard => self.standard,
            Kind::Painted => self.painted,
        }
    }

    pub(super) fn scale(self, kind: Kind) -> Scale {
        Scale { dim_bits: self.bits(kind), ..Scale::FINEST }
    }

    /// The same with the next coarser integers for a kind; `None` where there are none.
    pub fn coarser(self, kind: Kind) -> Option<Self> {
        let bits = self.scale(kind).coarser()?.dim_bits;
        Some(match kind {
            Kind::Standard => Self { standard: bits, ..self },
            Kind::Painted => Self { painted: bits, ..self },
        })
    }

    /// The coarser integers of both, kind by kind.
    pub fn coarsest(self, other: Self) -> Self {
        Self { standard: self.standard.min(other.standard), painted: self.painted.min(other.painted) }
    }

    /// Whether they are among those that pictures have.
    pub fn are_valid(self) -> bool {
        let is_valid = |bits: i32| {
            let all = std::iter::successors(Some(Scale::FINEST), |scale| scale.coarser());
            all.into_iter().any(|scale| scale.dim_bits == bits)
        };
        is_valid(self.standard) && is_valid(self.painted)
    }

    /// Whether sums of a kind hold a picture of which a pixel's largest coverage is `largest` quanta, of ordinary samples and of bright ones,
    /// and no radiance above `brightest`.
    pub fn can_hold(self, kind: Kind, largest: [i64; 2], brightest: f64) -> bool {
        let most = self.scale(kind).quanta(brightest);
        largest.into_iter().zip(most).all(|(largest, most)| largest <= most.largest_coverage)
    }
}
