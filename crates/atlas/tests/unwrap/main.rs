//! Unwrapping as a whole. The test program is its own unwrapping child, and so has a main of its own.

mod children;
mod data;
mod export;
mod gltf_file;
mod layout;
mod meshes;
mod nasty;
mod storage;
mod surface;
#[allow(dead_code, reason = "only its container is needed here")]
#[path = "../../../session/tests/tiny_glb/mod.rs"]
mod tiny_glb;

use std::panic::catch_unwind;
use std::process::ExitCode;

/// What a test is called and what it does.
type Test = (&'static str, fn());

fn main() -> ExitCode {
    children::misbehave_if_requested();
    atlas::child::run_if_child();
    let filters: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let groups: [&[Test]; 7] = [
        layout::TESTS,
        surface::TESTS,
        nasty::TESTS,
        children::TESTS,
        storage::TESTS,
        export::TESTS,
        data::TESTS,
    ];
    let wanted = |name: &str| filters.is_empty() || filters.iter().any(|f| name.contains(f.as_str()));
    let tests: Vec<&Test> = groups.into_iter().flatten().filter(|test| wanted(test.0)).collect();
    println!("\nrunning {} tests", tests.len());
    let failed = tests.iter().filter(|(name, test)| {
        let ok = catch_unwind(test).is_ok();
        println!("test {name} ... {}", if ok { "ok" } else { "FAILED" });
        !ok
    });
    let failed = failed.count();
    println!("\ntest result: {} passed; {failed} failed", tests.len() - failed);
    if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
