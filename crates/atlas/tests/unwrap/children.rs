//! Children that crash, hang, or are no children at all.

use crate::Test;
use crate::layout::unwrap;
use crate::meshes::{scene, sphere};
use crate::surface::check_surface;
use atlas::{Atlas, AtlasError, UnwrapOptions};
use glam::DVec3;
use progress::{Progress, Unwatched};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

pub const TESTS: &[Test] = &[
    ("children::xatlas_and_this_process_agree_on_the_area", xatlas_and_this_process_agree_on_the_area),
    ("children::a_child_that_hangs_is_killed_at_its_deadline", a_child_that_hangs_is_killed_at_its_deadline),
    ("children::a_child_that_crashes_is_replaced", a_child_that_crashes_is_replaced),
    ("children::a_program_that_is_no_child_is_not_needed", a_program_that_is_no_child_is_not_needed),
    ("children::cancelling_kills_them", cancelling_kills_them),
];

/// Tells a child of this program how to fail: `hang` or `crash`, and in which engines.
const MISBEHAVE: &str = "ATLAS_TEST_MISBEHAVE";

/// Does what the parent test wants of its child.
pub fn misbehave_if_requested() {
    let Ok(how) = std::env::var(MISBEHAVE) else { return };
    let arguments: Vec<String> = std::env::args().collect();
    let is_child = arguments.get(1).is_some_and(|a| a == "--unwrap-child");
    if !is_child || !arguments.get(2).is_some_and(|engine| how.contains(engine.as_str())) {
        return;
    }
    use std::io::Write;
    std::io::stdout().write_all(b"unwrap 1").unwrap();
    std::io::stdout().flush().unwrap();
    if how.starts_with("crash") {
        std::process::abort();
    }
    loop {
        std::thread::sleep(Duration::from_secs(1));
    }
}

/// Runs with children that misbehave. Tests run one after the other, and nothing else reads the environment.
#[allow(unsafe_code, reason = "changing the environment is unsafe in edition 2024")]
fn misbehaving<T>(how: &str, run: impl FnOnce() -> T) -> T {
    // SAFETY: no other thread of this program reads or writes the environment meanwhile.
    unsafe { std::env::set_var(MISBEHAVE, how) };
    let result = run();
    // SAFETY: as above.
    unsafe { std::env::remove_var(MISBEHAVE) };
    result
}

fn with_child(deadline_s: f64) -> UnwrapOptions {
    UnwrapOptions {
        child: Some(std::env::current_exe().unwrap()),
        deadline: Duration::from_secs_f64(deadline_s),
        ..UnwrapOptions::default()
    }
}

fn xatlas_and_this_process_agree_on_the_area() {
    let scene = scene(vec![sphere(16, 1.0, DVec3::ZERO)]);
    let (by_child, here) = (unwrap(&scene, &with_child(30.0)), unwrap(&scene, &UnwrapOptions::default()));
    assert!(by_child.notes.is_empty(), "{:?}", by_child.notes);
    assert_ne!(by_child.hash, here.hash, "two engines");
    check_surface(&scene, &by_child);
    check_surface(&scene, &here);
    assert_eq!(by_child.hash, unwrap(&scene, &with_child(30.0)).hash, "the same again");
}

fn a_child_that_hangs_is_killed_at_its_deadline() {
    let scene = scene(vec![sphere(16, 1.0, DVec3::ZERO)]);
    let start = Instant::now();
    let atlas = misbehaving("hang xatlas", || unwrap(&scene, &with_child(0.7)));
    let took = start.elapsed().as_secs_f64();
    assert!((0.7..5.0).contains(&took), "{took} s");
    assert!(atlas.notes.iter().any(|n| n.contains("xatlas")), "{:?}", atlas.notes);
    assert_eq!(atlas.hash, unwrap(&scene, &UnwrapOptions::default()).hash, "the second engine did it");
}

fn a_child_that_crashes_is_replaced() {
    let scene = scene(vec![sphere(16, 1.0, DVec3::ZERO)]);
    let atlas = misbehaving("crash xatlas", || unwrap(&scene, &with_child(30.0)));
    assert_eq!(atlas.hash, unwrap(&scene, &UnwrapOptions::default()).hash, "the second engine did it");
    // With both engines gone it is projected.
    let atlas = misbehaving("crash xatlas uvunwrap", || unwrap(&scene, &with_child(30.0)));
    assert!(atlas.notes.iter().any(|n| n.contains("projected")), "{:?}", atlas.notes);
    check_surface(&scene, &atlas);
}

fn a_program_that_is_no_child_is_not_needed() {
    let scene = scene(vec![sphere(16, 1.0, DVec3::ZERO)]);
    let here = unwrap(&scene, &UnwrapOptions::default());
    for program in ["/nowhere/at/all", "/bin/true"] {
        let options = UnwrapOptions { child: Some(PathBuf::from(program)), ..UnwrapOptions::default() };
        let atlas = unwrap(&scene, &options);
        assert_eq!(atlas.hash, here.hash);
        assert!(atlas.notes.iter().any(|n| n.contains(program)), "{:?}", atlas.notes);
    }
}

/// Asks to stop once it has been asked so many times.
struct Impatient(AtomicUsize);

impl Progress for Impatient {
    fn report(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)).is_err()
    }
}

fn cancelling_kills_them() {
    let scene = scene(vec![sphere(16, 1.0, DVec3::ZERO)]);
    for patience in [0, 1, 5, 30] {
        let start = Instant::now();
        let impatient = Impatient(AtomicUsize::new(patience));
        let result = misbehaving("hang xatlas", || Atlas::unwrap(&scene, &with_child(60.0), &impatient));
        assert!(matches!(result, Err(AtlasError::Cancelled)));
        assert!(start.elapsed().as_secs_f64() < 5.0);
    }
    assert!(Atlas::unwrap(&scene, &UnwrapOptions::default(), &Unwatched).is_ok());
}
