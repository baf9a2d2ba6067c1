//! Sibling modules, each with its folder, and the dependencies between them.

use super::crate_modules::Arrow;

/// The sibling modules of a crate that depend on one another, each standing for all files in its folder.
pub struct Siblings {
    /// Paths of modules below the crate's root, such as `preview/worker`.
    names: Vec<String>,
    arrows: Vec<Arrow>,
}

impl Siblings {
    /// The siblings above `arrows` between files of these paths below the folder of the crate's root file: the
    /// first modules at which the paths of both files part. A file and a module above it are no siblings.
    pub fn new(paths: &[String], arrows: &[Arrow]) -> Self {
        let modules: Vec<Vec<&str>> = paths.iter().map(|path| module_path(path)).collect();
        let mut siblings = Self { names: Vec::new(), arrows: Vec::new() };
        for arrow in arrows {
            let (from, to) = (&modules[arrow.from], &modules[arrow.to]);
            let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
            if common == from.len() || common == to.len() {
                continue;
            }
            let [from, to] = [from, to].map(|module| siblings.index_of(module[..=common].join("/")));
            let name = format!("{} ({})", arrow.name, paths[arrow.from]);
            siblings.arrows.push(Arrow { from, to, name });
        }
        siblings.arrows.sort();
        siblings.arrows.dedup();
        siblings
    }

    /// Paths of the siblings below the crate's root.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The dependencies between them; the name tells the used item and the file that uses it.
    pub fn arrows(&self) -> &[Arrow] {
        &self.arrows
    }

    fn index_of(&mut self, name: String) -> usize {
        self.names.iter().position(|known| *known == name).unwrap_or_else(|| {
            self.names.push(name);
            self.names.len() - 1
        })
    }
}

/// The module that a file below the crate's root holds; empty for the root itself.
fn module_path(path: &str) -> Vec<&str> {
    let without_extension = path.strip_suffix(".rs").unwrap_or(path);
    let mut module: Vec<&str> = without_extension.split('/').collect();
    if module.len() == 1 && ["lib", "main"].contains(&module[0]) || module.last() == Some(&"mod") {
        module.pop();
    }
    module
}
