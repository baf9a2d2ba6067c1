//! What all promises share.
//!
//! * `promise`: plays cases and counts what broke; `ledger`: adds counts up in `docs/promises.md`.
//! * `program`: runs the program and measures it; `system_calls`: the same under strace.
//! * `made_files`: inputs made by code; `made_splats`: of Gaussian splats; `archive`: ZIP and zlib; `seeded`: random numbers of a case.

pub mod archive;
pub mod ledger;
pub mod made_files;
pub mod made_splats;
pub mod program;
pub mod promise;
pub mod seeded;
pub mod system_calls;
