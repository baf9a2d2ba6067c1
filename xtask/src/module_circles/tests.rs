//! Small crates, each with a circle of one kind or without any.

use super::{check, circles_in};
use std::path::Path;

/// The circles of a crate of these files; the first is its root.
fn circles(files: &[(&str, &str)]) -> Vec<String> {
    let read = |file: &Path| {
        files.iter().find(|(name, _)| Path::new(name) == file).map(|(_, text)| text.to_string())
    };
    circles_in(Path::new(files[0].0), &read).unwrap_or_else(|error| panic!("{error}"))
}

/// The arrows of the one circle there must be.
fn arrows(files: &[(&str, &str)]) -> Vec<String> {
    let circles = circles(files);
    assert_eq!(circles.len(), 1, "{circles:?}");
    circles[0].lines().skip(1).map(|line| line.trim().to_string()).collect()
}

const NONE: [String; 0] = [];

#[test]
fn the_workspace_has_no_circle() {
    check().unwrap_or_else(|failure| panic!("{failure}"));
}

#[test]
fn two_modules_that_use_each_other_are_a_circle() {
    let files = [
        ("src/lib.rs", "mod a; mod b; mod c;"),
        ("src/a.rs", "use crate::b::B;\npub struct A(B);"),
        ("src/b.rs", "use super::{a::A as Other, c::*};\npub struct B;\nfn f(_: Other) {}"),
        ("src/c.rs", "pub fn c() {}"),
    ];
    assert_eq!(arrows(&files), ["a.rs -> b.rs: B", "b.rs -> a.rs: A"]);
}

#[test]
fn three_modules_in_a_ring_are_a_circle() {
    let files = [
        ("src/lib.rs", "mod a; mod b; mod c;"),
        ("src/a.rs", "use crate::b::{self, B};\npub fn a() { b::b(B) }"),
        ("src/b.rs", "use crate::c::*;\npub struct B; pub fn b(_: B) { c() }"),
        ("src/c.rs", "pub fn c() { use crate::a; a::a() }"),
    ];
    assert_eq!(arrows(&files), ["a.rs -> b.rs: B, b", "b.rs -> c.rs: *", "c.rs -> a.rs: a"]);
}

#[test]
fn one_way_is_no_circle() {
    let files = [
        ("src/lib.rs", "mod a; mod b; mod c;\npub use a::A; pub use b::B;"),
        ("src/a.rs", "use crate::{B, c::C};\npub struct A(B, C);"),
        ("src/b.rs", "use crate::c::C;\npub struct B(C);"),
        ("src/c.rs", "pub struct C;"),
    ];
    assert_eq!(circles(&files), NONE);
}

#[test]
fn a_name_is_followed_through_the_root_to_where_it_is_defined() {
    let files = [
        ("src/lib.rs", "mod a; mod b;\npub use a::A;\npub use b::*;"),
        ("src/a.rs", "use crate::B;\npub struct A(B);"),
        ("src/b.rs", "use crate::A;\npub struct B; impl B { fn a(_: A) {} }"),
    ];
    assert_eq!(arrows(&files), ["a.rs -> b.rs: B", "b.rs -> a.rs: A"]);
}

#[test]
fn a_parent_and_its_child_are_a_circle() {
    let files = [
        ("src/lib.rs", "mod a;"),
        ("src/a.rs", "mod b;\npub struct Width(f32);\npub fn a() { b::b(Width(1.0)) }"),
        ("src/a/b.rs", "use super::*;\npub fn b(_: Width) {}"),
    ];
    assert_eq!(arrows(&files), ["a.rs -> a/b.rs: b", "a/b.rs -> a.rs: *"]);
}

#[test]
fn a_parent_that_only_passes_on_is_not_in_a_circle() {
    let passes_on = ("src/a/mod.rs", "mod b; mod c;\npub(crate) use b::B;\nuse c::C;\npub fn a(_: C) {}");
    let c = ("src/a/c.rs", "use super::B;\npub struct C(B);");
    let b = ("src/a/b.rs", "pub struct B;");
    assert_eq!(circles(&[("src/lib.rs", "mod a;"), passes_on, b, c]), NONE);
    let uses_itself = ("src/a/b.rs", "use super::a;\npub struct B;");
    assert_eq!(
        arrows(&[("src/lib.rs", "mod a;"), passes_on, uses_itself, c]),
        ["a/mod.rs -> a/c.rs: C", "a/b.rs -> a/mod.rs: a", "a/c.rs -> a/b.rs: B"]
    );
}

#[test]
fn folders_that_use_each_other_are_a_circle_even_where_their_files_are_none() {
    let root = ("src/lib.rs", "mod draw; mod seen;");
    let draw = ("src/draw.rs", "pub mod pen; pub mod paper;");
    let pen = ("src/draw/pen.rs", "use crate::seen::runs::Run;\npub struct Pen(Run);");
    let paper = ("src/draw/paper.rs", "pub struct Paper;");
    let seen = ("src/seen.rs", "pub mod runs; pub mod area;");
    let runs = ("src/seen/runs.rs", "pub struct Run;");
    let apart = ("src/seen/area.rs", "pub struct Area;");
    assert_eq!(circles(&[root, draw, pen, paper, seen, runs, apart]), NONE);
    let area = ("src/seen/area.rs", "use crate::draw::paper::Paper;\npub struct Area(Paper);");
    assert_eq!(
        arrows(&[root, draw, pen, paper, seen, runs, area]),
        ["draw -> seen: Run (draw/pen.rs)", "seen -> draw: Paper (seen/area.rs)"]
    );
}

#[test]
fn what_is_passed_on_and_used_as_well_ties() {
    let files = [
        ("src/lib.rs", "mod a;\npub use a::Ray;\npub trait Light { fn toward(&self, ray: Ray); }"),
        ("src/a.rs", "pub struct Ray;\nfn f(_: &dyn crate::Light) {}"),
    ];
    assert_eq!(arrows(&files), ["lib.rs -> a.rs: Ray", "a.rs -> lib.rs: Light"]);
}

#[test]
fn a_path_within_code_ties() {
    let files = [
        ("src/main.rs", "mod a; mod b;\nfn main() { a::a() }"),
        ("src/a.rs", "pub fn a() { Vec::<crate::b::B>::new(); }"),
        ("src/b.rs", "pub struct B;\nimpl B { const A: fn() = super::a::a; }"),
    ];
    assert_eq!(arrows(&files), ["a.rs -> b.rs: B", "b.rs -> a.rs: a"]);
}

#[test]
fn what_only_tests_comments_and_texts_name_does_not_tie() {
    let b = r##"
        //! [`crate::a::A`] /* " */
        pub struct B<'a>(&'a str);
        const QUOTE: char = '"';
        const TEXT: &str = r#"use crate::a::A;"#; // "
        #[cfg(test)]
        use crate::a::{A, A as C};
        #[cfg(test)]
        mod elsewhere;
        #[cfg(all(test, unix))]
        pub(super) const ONE: crate::a::A = crate::a::A { width: [0; 2] }.with(crate::a::A, 1);
        struct C { #[cfg(test)] pub a: crate::a::A, b: u8 }
        /* /* nested */ use crate::a::A; */
        #[cfg(test)]
        pub fn only<T, U>(_: crate::a::A) -> [T; 2] { todo!() }
        #[cfg(test)]
        mod tests { use super::*; use crate::a::A; }
    "##;
    let root = ("src/lib.rs", "mod a; mod b;");
    let a = ("src/a.rs", "use crate::b::B;\npub struct A(B<'static>);");
    assert_eq!(circles(&[root, a, ("src/b.rs", b)]), NONE);
    // What follows is read again.
    let b = format!("{b}\nuse crate::a::A;");
    assert_eq!(arrows(&[root, a, ("src/b.rs", &b)]), ["a.rs -> b.rs: B", "b.rs -> a.rs: A"]);
}

#[test]
fn another_crate_of_a_module_s_name_is_not_that_module() {
    let files = [
        ("src/lib.rs", "mod scene; mod a;"),
        ("src/a.rs", "use scene::Scene;\npub struct A(Scene, scene::Model);"),
        ("src/scene.rs", "use crate::a::A;\npub struct Scene(A);"),
    ];
    assert_eq!(circles(&files), NONE);
}

#[test]
fn a_module_within_a_file_belongs_to_the_file() {
    let files = [
        ("src/lib.rs", "mod a; mod b;"),
        ("src/a.rs", "pub struct A;\nmod inner { pub fn f(_: super::A, _: crate::b::B) {} }"),
        ("src/b.rs", "pub struct B; fn f(_: crate::a::A) {}"),
    ];
    assert_eq!(arrows(&files), ["a.rs -> b.rs: B", "b.rs -> a.rs: A"]);
}

#[test]
fn a_module_without_a_file_is_an_error() {
    let error =
        circles_in(Path::new("src/lib.rs"), &|file| file.ends_with("lib.rs").then(|| "mod a;".into()));
    assert_eq!(error, Err("src/lib.rs: module a has no file".to_string()));
}
