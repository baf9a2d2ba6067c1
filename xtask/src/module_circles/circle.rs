//! Cycles in the dependency graph of files.

use super::crate_modules::Arrow;
use std::collections::BTreeSet;

/// A strongly connected set of files: each uses every other, directly or indirectly.
#[derive(Debug, PartialEq, Eq)]
pub struct Circle {
    /// The files, in order.
    pub files: Vec<usize>,
    /// The arrows between them.
    pub arrows: Vec<Arrow>,
}

/// All cycles in the graph of `arrows`; no file is in two of them.
pub fn circles_of(arrows: &[Arrow]) -> Vec<Circle> {
    let files: BTreeSet<usize> = arrows.iter().map(|arrow| arrow.from).collect();
    let mut circles: Vec<Circle> = Vec::new();
    for file in files {
        let is_listed = circles.iter().any(|circle| circle.files.contains(&file));
        let reached = reached_from(file, arrows);
        if is_listed || !reached.contains(&file) {
            continue;
        }
        let files: Vec<usize> =
            reached.iter().copied().filter(|other| reached_from(*other, arrows).contains(&file)).collect();
        let within = |arrow: &&Arrow| files.contains(&arrow.from) && files.contains(&arrow.to);
        let arrows = arrows.iter().filter(within).cloned().collect();
        circles.push(Circle { files, arrows });
    }
    circles
}

/// The files reachable from `start` in one step or more.
fn reached_from(start: usize, arrows: &[Arrow]) -> BTreeSet<usize> {
    let mut reached = BTreeSet::new();
    let mut open = vec![start];
    while let Some(file) = open.pop() {
        let next = arrows.iter().filter(|arrow| arrow.from == file).map(|arrow| arrow.to);
        open.extend(next.filter(|next| reached.insert(*next)));
    }
    reached
}
