//! Resource limits of loading a file: memory, triangles, time.

use crate::LoadOptions;
use crate::error::Fault;
use std::cell::Cell;

/// What loading may still use.
pub(crate) struct Budget {
    memory: Cell<u64>,
    triangles: Cell<u64>,
    work: Cell<u64>,
    checks: Cell<u64>,
    /// All the memory that may be used.
    limit: Cell<u64>,
    pub options: LoadOptions,
}

/// Total number of values that may be read or computed: some seconds' worth.
const MAX_WORK: u64 = 1 << 30;

/// Total number of values that may be read only to lint the file: some tenths of a second's worth.
const MAX_CHECKS: u64 = 1 << 27;

impl Budget {
    /// The budget that `options` allow for one file.
    pub fn new(options: &LoadOptions) -> Self {
        Self {
            memory: Cell::new(options.max_memory),
            triangles: Cell::new(options.max_triangles),
            work: Cell::new(MAX_WORK),
            checks: Cell::new(MAX_CHECKS),
            limit: Cell::new(options.max_memory),
            options: options.clone(),
        }
    }

    /// Takes `bytes` for `what`, which errors name.
    ///
    /// # Errors
    /// Fewer bytes are left.
    pub fn take_memory(&self, bytes: u64, what: &str) -> Result<(), Fault> {
        let limit = self.limit.get() >> 20;
        take(&self.memory, bytes, || {
            format!("{what} takes {} MiB of a limit of {limit} MiB in all", bytes >> 20)
        })
    }

    /// Takes the bytes of a file that is read for `what`, which errors name. What is made of it may take more memory the larger the file is:
    /// large models are let through, and small files that claim to be large are not.
    ///
    /// # Errors
    /// Fewer bytes are left.
    pub fn take_file(&self, bytes: u64, what: &str) -> Result<(), Fault> {
        self.take_memory(bytes, what)?;
        let more = bytes.saturating_mul(self.options.memory_per_file_byte);
        self.limit.set(self.limit.get().saturating_add(more));
        self.release_memory(more);
        Ok(())
    }

    /// The memory that is left, in bytes.
    pub fn memory_left(&self) -> u64 {
        self.memory.get()
    }

    /// Returns `bytes` of memory that were taken.
    pub fn release_memory(&self, bytes: u64) {
        self.memory.set(self.memory.get() + bytes);
    }

    /// Takes `count` triangles.
    ///
    /// # Errors
    /// Fewer triangles are left.
    pub fn take_triangles(&self, count: u64) -> Result<(), Fault> {
        take(&self.triangles, count, || format!("it has more than {} triangles", self.options.max_triangles))
    }

    /// Takes the steps for reading `count` values, on behalf of `place`, which errors name.
    ///
    /// # Errors
    /// Fewer steps are left.
    pub fn take_work(&self, count: u64, place: &str) -> Result<(), Fault> {
        take(&self.work, count, || format!("{place}: reading the scene takes too many steps"))
    }

    /// Takes the time to lint `count` values; false if it is used up and they must be skipped.
    pub fn try_take_checks(&self, count: usize) -> bool {
        let left = self.checks.get().checked_sub(count as u64);
        self.checks.set(left.unwrap_or(self.checks.get()));
        left.is_some()
    }
}

fn take(cell: &Cell<u64>, amount: u64, what: impl Fn() -> String) -> Result<(), Fault> {
    let left = cell.get().checked_sub(amount).ok_or_else(|| Fault::TooBig { what: what() })?;
    cell.set(left);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_file_may_take_more_than_a_small_one() {
        let options = LoadOptions { max_memory: 1 << 20, ..LoadOptions::default() };
        let of_file = |bytes| {
            let budget = Budget::new(&options);
            budget.take_file(bytes, "the file").map(|()| budget)
        };
        let small = of_file(1 << 10).unwrap();
        assert!(small.take_memory(2 << 20, "its mesh").is_err());
        let large = of_file(1 << 19).unwrap();
        assert!(large.take_memory(10 << 20, "its mesh").is_ok());
        let more = large.take_memory(1 << 20, "another mesh").unwrap_err().to_string();
        assert!(more.contains("of a limit of 11 MiB"), "{more}");
        assert!(of_file(2 << 20).is_err());
    }
}
