//! Splats of a file that cannot be drawn.

/// Why a splat is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Its mean is not finite.
    Mean,
    /// Its rotation is not finite, or zero.
    Rotation,
    /// A scale is not a number, or the largest is 0, infinite or beyond e^±80.
    Scale,
    /// Its opacity is not in [0, 1].
    Opacity,
    /// Its colour is not finite, or beyond what 16-bit floats hold.
    Color,
    /// Its opacity is at most 1/255, so that no ray notices it.
    Transparent,
}

impl Reason {
    const ALL: [Self; 6] =
        [Self::Mean, Self::Rotation, Self::Scale, Self::Opacity, Self::Color, Self::Transparent];

    fn description(self) -> &'static str {
        match self {
            Self::Mean => "have no finite place",
            Self::Rotation => "have no rotation",
            Self::Scale => "have no usable scale",
            Self::Opacity => "have no valid opacity",
            Self::Color => "have no finite colour",
            Self::Transparent => "are transparent",
        }
    }
}

/// The rows of a file that are not in its cloud.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    rows: Vec<u32>,
    counts: [u32; Reason::ALL.len()],
}

impl LeftOut {
    pub(super) fn push(&mut self, row: u32, reason: Reason) {
        self.rows.push(row);
        self.counts[reason as usize] += 1;
    }

    /// The rows, from 0, in order.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// How many are left out for a reason.
    pub fn count(&self, reason: Reason) -> u32 {
        self.counts[reason as usize]
    }

    /// What is left out, as the rest of a sentence; `None` if nothing is.
    pub fn description(&self) -> Option<String> {
        let parts: Vec<String> = Reason::ALL
            .into_iter()
            .filter(|reason| self.count(*reason) > 0)
            .map(|reason| format!("{} {}", self.count(reason), reason.description()))
            .collect();
        (!parts.is_empty()).then(|| format!("{} splats are left out: {}", self.rows.len(), parts.join(", ")))
    }

    /// The rows of the file that are in the cloud, of a file with `file_rows` rows: row k of the cloud is the k-th.
    pub fn retained_rows(&self, file_rows: usize) -> impl Iterator<Item = usize> + '_ {
        let mut next = self.rows.iter().map(|row| *row as usize).peekable();
        (0..file_rows).filter(move |row| next.next_if_eq(row).is_none())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_the_cloud_skip_those_left_out() {
        let mut left_out = LeftOut::default();
        assert_eq!(left_out.description(), None);
        left_out.push(0, Reason::Mean);
        left_out.push(3, Reason::Transparent);
        left_out.push(4, Reason::Transparent);
        assert_eq!(left_out.retained_rows(6).collect::<Vec<_>>(), [1, 2, 5]);
        let expected = "3 splats are left out: 1 have no finite place, 2 are transparent";
        assert_eq!(left_out.description().as_deref(), Some(expected));
    }
}
