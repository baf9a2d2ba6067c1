//! Distributing work: a shard is every N-th piece of it.

use std::str::FromStr;

/// Shard `index` of `count`.
///
/// ```
/// let shard: render::Shard = "2/3".parse()?;
/// assert!(shard.contains(1) && shard.contains(4) && !shard.contains(2));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the shard, from 0.
    pub index: u32,
    /// Number of shards, at least 1.
    pub count: u32,
}

impl Shard {
    /// The shard that contains everything.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// Whether the piece of this number, from 0, belongs to this shard.
    pub fn contains(self, piece: usize) -> bool {
        piece as u64 % u64::from(self.count) == u64::from(self.index)
    }

    /// The shard that a render farm assigns to this process through environment variables: a Slurm array job, an indexed Kubernetes job or
    /// a GNU parallel job. Where these do not give the number of shards, it is read from `FOCUS_BRUSH_SHARDS`. `variable` looks up an
    /// environment variable.
    ///
    /// # Errors
    /// No farm is detected, or its variables are invalid or inconsistent.
    pub fn from_environment(variable: &dyn Fn(&str) -> Option<String>) -> Result<Self, String> {
        let number = |name: &str| -> Result<Option<i64>, String> {
            let Some(text) = variable(name).filter(|text| !text.is_empty()) else { return Ok(None) };
            text.trim().parse().map(Some).map_err(|_| format!("{name} is {text:?}, which is not a number"))
        };
        // For each farm: variables of the index, of the first index, the default first index, and the variable of the count.
        let farms = [
            ("SLURM_ARRAY_TASK_ID", Some("SLURM_ARRAY_TASK_MIN"), 0, Some("SLURM_ARRAY_TASK_COUNT")),
            ("JOB_COMPLETION_INDEX", None, 0, None),
            ("PARALLEL_SEQ", None, 1, None),
        ];
        for (which, lowest, first, how_many) in farms {
            let Some(id) = number(which)? else { continue };
            let own = how_many.map(number).transpose()?.flatten();
            let count = own.or(number("FOCUS_BRUSH_SHARDS")?);
            let count = count.ok_or_else(|| {
                format!("{which} gives the number of this shard, but not how many there are (set FOCUS_BRUSH_SHARDS)")
            })?;
            let first = lowest.map(number).transpose()?.flatten().unwrap_or(first);
            let step =
                if which.starts_with("SLURM") { number("SLURM_ARRAY_TASK_STEP")?.unwrap_or(1) } else { 1 };
            let index = id.checked_sub(first).filter(|index| step > 0 && index % step == 0);
            let share = index.and_then(|index| {
                Some(Self { index: u32::try_from(index / step).ok()?, count: u32::try_from(count).ok()? })
            });
            return share.filter(|share| share.index < share.count).ok_or_else(|| {
                format!("{which} is {id}, which is not among {count} shards starting at {first}")
            });
        }
        Err("no render farm detected (none of SLURM_ARRAY_TASK_ID, JOB_COMPLETION_INDEX, PARALLEL_SEQ is set; give K/N)".into())
    }
}

impl FromStr for Shard {
    type Err = String;

    /// `K/N`, K from 1 to N.
    fn from_str(text: &str) -> Result<Self, String> {
        let parts =
            text.split_once('/').and_then(|(k, n)| Some((k.trim().parse().ok()?, n.trim().parse().ok()?)));
        match parts {
            Some((k, n)) if (1..=n).contains(&k) => Ok(Self { index: k - 1, count: n }),
            _ => Err("expected K/N with K from 1 to N, or env".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shard_of(variables: &[(&str, &str)]) -> Result<Shard, String> {
        Shard::from_environment(&|name| {
            variables.iter().find(|(key, _)| *key == name).map(|(_, value)| value.to_string())
        })
    }

    #[test]
    fn every_piece_has_one_share() {
        for count in [1, 2, 7, 64] {
            for piece in 0..100 {
                let shares = (0..count).filter(|&index| Shard { index, count }.contains(piece)).count();
                assert_eq!(shares, 1);
            }
        }
        assert_eq!("2/7".parse(), Ok(Shard { index: 1, count: 7 }));
        for wrong in ["0/7", "8/7", "1", "1/0", "a/b", "-1/2"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn farms_say_which_share() {
        let slurm =
            [("SLURM_ARRAY_TASK_ID", "7"), ("SLURM_ARRAY_TASK_COUNT", "4"), ("SLURM_ARRAY_TASK_MIN", "1")];
        assert!(shard_of(&slurm).is_err(), "7 of 1 to 4");
        let stepped = [slurm[0], slurm[1], slurm[2], ("SLURM_ARRAY_TASK_STEP", "2")];
        assert_eq!(shard_of(&stepped), Ok(Shard { index: 3, count: 4 }), "1, 3, 5, 7");
        let kubernetes = [("JOB_COMPLETION_INDEX", "0"), ("FOCUS_BRUSH_SHARDS", "3")];
        assert_eq!(shard_of(&kubernetes), Ok(Shard { index: 0, count: 3 }));
        let parallel = [("PARALLEL_SEQ", "3"), ("FOCUS_BRUSH_SHARDS", "3")];
        assert_eq!(shard_of(&parallel), Ok(Shard { index: 2, count: 3 }));
        assert!(shard_of(&[]).unwrap_err().contains("give K/N"));
        assert!(shard_of(&parallel[..1]).unwrap_err().contains("FOCUS_BRUSH_SHARDS"));
        assert!(shard_of(&[("PARALLEL_SEQ", "x")]).unwrap_err().contains("not a number"));
    }
}
