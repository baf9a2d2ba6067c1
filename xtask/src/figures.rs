//! `figures`: writes the tables and plots of the performance pages from `docs/figures/*.json`.
//!
//! A file holds *sets* by name; a set is one question: either a table of records with a plot, or text with figures of
//! other sets filled in (`record`). A page shows a set between `<!-- figures: NAME -->` and `<!-- end -->` (`page`): a table and a
//! line that says by which command, on which machine, when and at which commit its figures were taken (`table`). The plot
//! is an SVG file beside them (`plot`). Pages are short, and every number with a unit stands between marks.

mod page;
mod plot;
mod quantity;
mod record;
mod set;
mod table;
mod table_set;
#[cfg(test)]
mod tests;

use crate::chore::{Failure, repository};
use page::{PLOTS, Page};
use set::Sets;
use std::path::Path;

/// The pages that show figures, and how many characters each may have.
const PAGES: [Page; 4] = [
    Page { file: "docs/performance.md", most_characters: 9000 },
    Page { file: "docs/performance-light.md", most_characters: 6000 },
    Page { file: "docs/performance-captures.md", most_characters: 6000 },
    Page { file: "README.md", most_characters: 4000 },
];

/// Writes pages and plots; with `--check` only says which are not what the figures give.
pub fn figures(arguments: &[std::ffi::OsString]) -> Result<(), Failure> {
    let root = repository();
    let is_check = match arguments {
        [] => false,
        [only] if only == "--check" => true,
        _ => return Err(Failure::new("usage: cargo xtask figures [--check]")),
    };
    let generated = generate(&root)?;
    let stale: Vec<_> = generated
        .iter()
        .filter(|(file, text)| std::fs::read_to_string(root.join(file)).ok().as_ref() != Some(text))
        .collect();
    let problems: Vec<String> =
        PAGES.iter().zip(&generated).flat_map(|(page, (_, text))| page.problems(text)).collect();
    if is_check {
        let stale = stale
            .iter()
            .map(|(file, _)| format!("{file}: is not what docs/figures gives (run cargo xtask figures)"));
        let all: Vec<_> = stale.chain(problems).collect();
        return if all.is_empty() { Ok(()) } else { Err(Failure::new(all.join("\n"))) };
    }
    for (file, text) in stale {
        let path = root.join(file);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)
                .map_err(|e| Failure::new(format!("{}: {e}", folder.display())))?;
        }
        std::fs::write(&path, text).map_err(|e| Failure::new(format!("{file}: {e}")))?;
        println!("{file}");
    }
    if problems.is_empty() { Ok(()) } else { Err(Failure::new(problems.join("\n"))) }
}

/// What should be in every page (first, in their order) and plot: paths in the repository, and texts.
fn generate(root: &Path) -> Result<Vec<(String, String)>, Failure> {
    let sets = Sets::read(&root.join("docs/figures"))?;
    let mut files = Vec::new();
    let mut shown = Vec::new();
    for page in PAGES {
        let text = std::fs::read_to_string(root.join(page.file))
            .map_err(|e| Failure::new(format!("{}: {e}", page.file)))?;
        files.push((page.file.to_owned(), page.filled(&text, &sets, &mut shown)?));
    }
    for (name, set) in sets.iter() {
        if !shown.contains(name) {
            return Err(Failure::new(format!(
                "docs/figures: no page shows {name} (add its marks, or remove it)"
            )));
        }
        files.extend(set.plot().map(|(name, svg)| (format!("{PLOTS}/{name}"), svg)));
    }
    Ok(files)
}
