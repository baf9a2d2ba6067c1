//! The suite as a test, with fewer rays and samples than `focus-brush report --hard`.

use hard_cases::{Effort, run, suite};
use progress::{Cancelled, Progress, Unwatched};
use std::collections::HashSet;

#[test]
fn every_case_passes_and_every_control_fails() {
    let outcomes = run("", Effort::Reduced, &Unwatched).unwrap();
    assert_eq!(outcomes.len(), suite().len());
    let wrong: Vec<_> = outcomes.iter().filter(|outcome| !(outcome.pass && outcome.control_fails)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn names_are_unique_and_the_table_has_them_all() {
    let names: HashSet<_> = suite().iter().map(|case| case.name).collect();
    assert_eq!(names.len(), suite().len());
    let document = include_str!("../../../docs/hard-cases.md");
    for case in suite() {
        assert!(document.contains(case.name), "docs/hard-cases.md lacks \"{}\": write it again", case.name);
    }
}

#[test]
fn a_filter_chooses_by_name() {
    let outcomes = run("all black", Effort::Reduced, &Unwatched).unwrap();
    assert_eq!(outcomes.len(), 1);
    assert_eq!(outcomes[0].case, "aperture mask all black");
    assert!(run("no such case", Effort::Reduced, &Unwatched).unwrap().is_empty());
}

#[test]
fn it_stops_when_cancelled() {
    struct Impatient;
    impl Progress for Impatient {
        fn report(&self, _fraction: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    assert_eq!(run("", Effort::Full, &Impatient), Err(Cancelled));
}
