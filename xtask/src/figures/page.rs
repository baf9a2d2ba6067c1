//! A page with marks between which figures stand, and what such a page must keep to.

use super::set::{Set, Sets};
use crate::chore::Failure;

/// Where the plots are written, as `FILE/SET.svg`.
pub const PLOTS: &str = "docs/figures";

const BEGIN: &str = "<!-- figures: ";
const END: &str = "<!-- end -->";

/// Units that a number must not have outside the marks.
const UNITS: [&str; 26] = [
    "s", "ms", "µs", "min", "h", "dB", "GB", "MB", "KB", "GiB", "MiB", "KiB", "byte", "bytes", "px", "×",
    "%", "F", "fps", "Hz", "mm", "m", "rad", "stops", "rays", "times",
];

/// A page that shows figures.
#[derive(Clone, Copy)]
pub struct Page {
    /// Its path in the repository.
    pub file: &'static str,
    /// How many characters it may have.
    pub most_characters: usize,
}

impl Page {
    /// The page's text with what its marks name between them; the sets it shows are added to `shown`.
    ///
    /// # Errors
    /// When a mark is not closed, or names no set.
    pub fn filled(&self, text: &str, sets: &Sets, shown: &mut Vec<String>) -> Result<String, Failure> {
        let failure = |problem: String| Failure::new(format!("{}: {problem}", self.file));
        let mut filled = String::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once(BEGIN) {
            let (name, after) =
                after.split_once(" -->\n").ok_or_else(|| failure("a mark has no name".into()))?;
            let (old, after) =
                after.split_once(END).ok_or_else(|| failure(format!("{name}: the mark {END} is missing")))?;
            if old.contains(BEGIN) {
                return Err(failure(format!("{name}: the mark {END} is missing")));
            }
            let set = sets.get(name).ok_or_else(|| failure(format!("{name}: there are no such figures")))?;
            let shown_set = self.markdown(set, sets).map_err(failure)?;
            filled += &format!("{before}{BEGIN}{name} -->\n{shown_set}\n{END}");
            shown.push(name.to_owned());
            rest = after;
        }
        Ok(filled + rest)
    }

    fn markdown(&self, set: &Set, sets: &Sets) -> Result<String, String> {
        let plots = PLOTS.strip_prefix("docs/").filter(|_| self.file.starts_with("docs/")).unwrap_or(PLOTS);
        set.markdown(sets, plots)
    }

    /// Why a filled page is not good: too long, or with figures outside the marks.
    pub fn problems(&self, text: &str) -> Vec<String> {
        let mut problems = Vec::new();
        let characters = text.chars().count();
        if characters > self.most_characters {
            problems.push(format!(
                "{}: has {characters} characters, {} at most (move text to docs/notebook)",
                self.file, self.most_characters
            ));
        }
        let stray = numbers_with_units(&outside_marks(text));
        problems.extend(stray.into_iter().map(|figure| {
            format!("{}: {figure:?} stands outside the marks (make it a record of docs/figures)", self.file)
        }));
        problems
    }
}

/// What of a page is written by hand.
fn outside_marks(text: &str) -> String {
    let mut parts = text.split(BEGIN);
    let first = parts.next().unwrap_or_default().to_owned();
    let after = parts.map(|part| part.split_once(END).map_or("", |(_, after)| after));
    std::iter::once(first).chain(after.map(str::to_owned)).collect::<Vec<_>>().join("\n")
}

/// Numbers that are followed by a unit, each as it is written.
fn numbers_with_units(text: &str) -> Vec<String> {
    let characters: Vec<char> = text.chars().collect();
    let is_part = |at: usize| {
        let next = characters.get(at + 1);
        characters[at].is_ascii_digit()
            || ([',', '.'].contains(&characters[at]) && next.is_some_and(char::is_ascii_digit))
    };
    let mut found = Vec::new();
    let mut at = 0;
    while at < characters.len() {
        // Digits within a word are a name.
        let begins = characters[at].is_ascii_digit() && (at == 0 || !characters[at - 1].is_alphanumeric());
        let from = at;
        at += 1;
        if !begins {
            continue;
        }
        while at < characters.len() && is_part(at) {
            at += 1;
        }
        let mut unit_from = at;
        while unit_from < characters.len()
            && [' ', '\n', '\u{a0}', '\u{202f}'].contains(&characters[unit_from])
        {
            unit_from += 1;
        }
        let is_word = |c: &char| c.is_alphanumeric() || ['×', '%', 'µ'].contains(c);
        let unit: String = characters[unit_from..].iter().take_while(|c| is_word(c)).collect();
        if UNITS.contains(&&*unit) || unit.starts_with(['×', '%']) {
            found.push(characters[from..unit_from + unit.chars().count()].iter().collect());
        }
    }
    found
}
