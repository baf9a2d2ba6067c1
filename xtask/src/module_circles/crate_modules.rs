//! The modules of one crate, and the resolution of paths to modules.

use super::source::{Import, Source, source_of};
use super::tokens::{tokens_of, without_tests};
use std::path::{Path, PathBuf};

/// A crate: its modules, the root first.
pub struct CrateModules {
    modules: Vec<Module>,
    files: Vec<PathBuf>,
}

struct Module {
    /// Index of its file.
    file: usize,
    parent: Option<usize>,
    children: Vec<(String, usize)>,
    source: Source,
}

/// What a path names.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Named {
    Module(usize),
    Item { module: usize, name: String },
}

/// A dependency: the code of one file names an item that another defines.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Arrow {
    /// The using file, as an index into [`CrateModules::files`].
    pub from: usize,
    /// The used file.
    pub to: usize,
    /// The used name; `*` for all names of a module.
    pub name: String,
}

impl CrateModules {
    /// Reads the crate whose root is the file `root`; `read` returns the text of a file, or `None` if it does
    /// not exist.
    ///
    /// # Errors
    /// A module has no file.
    pub fn read(root: &Path, read: &dyn Fn(&Path) -> Option<String>) -> Result<Self, String> {
        let mut this = Self { modules: Vec::new(), files: Vec::new() };
        let text = read(root).ok_or_else(|| format!("{}: cannot be read", root.display()))?;
        let folder = root.parent().unwrap_or(Path::new(""));
        this.add_file(None, root, folder, &text, read)?;
        Ok(this)
    }

    /// The files of the crate.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Adds the module in `file`, whose children are in `folder`.
    fn add_file(
        &mut self,
        parent: Option<usize>,
        file: &Path,
        folder: &Path,
        text: &str,
        read: &dyn Fn(&Path) -> Option<String>,
    ) -> Result<usize, String> {
        self.files.push(file.to_path_buf());
        let source = source_of(&without_tests(&tokens_of(text)));
        self.add(parent, self.files.len() - 1, folder, source, read)
    }

    fn add(
        &mut self,
        parent: Option<usize>,
        file: usize,
        folder: &Path,
        mut source: Source,
        read: &dyn Fn(&Path) -> Option<String>,
    ) -> Result<usize, String> {
        let inline = std::mem::take(&mut source.inline);
        let child_files = source.child_files.clone();
        let this = self.modules.len();
        self.modules.push(Module { file, parent, children: Vec::new(), source });
        for (name, source) in inline {
            let child = self.add(Some(this), file, &folder.join(&name), source, read)?;
            self.modules[this].children.push((name, child));
        }
        for name in child_files {
            let inner = folder.join(&name);
            let places = [folder.join(format!("{name}.rs")), inner.join("mod.rs")];
            let source = places.iter().find_map(|place| Some((place, read(place)?)));
            let Some((place, text)) = source else {
                return Err(format!("{}: module {name} has no file", self.files[file].display()));
            };
            let child = self.add_file(Some(this), place, &inner, &text, read)?;
            self.modules[this].children.push((name, child));
        }
        Ok(this)
    }

    /// The dependencies, sorted and without duplicates.
    pub fn arrows(&self) -> Vec<Arrow> {
        let mut arrows = Vec::new();
        for (index, module) in self.modules.iter().enumerate() {
            let imports = module.source.imports.iter().filter_map(|import| self.imported(index, import));
            let walked =
                module.source.paths.iter().filter_map(|path| self.resolve(index, path, &mut Vec::new()));
            for named in imports.chain(walked) {
                // A module's name alone is no use of its items.
                let Named::Item { module: to, name } = named else { continue };
                let (from, to) = (module.file, self.modules[to].file);
                if from != to {
                    arrows.push(Arrow { from, to, name });
                }
            }
        }
        arrows.sort();
        arrows.dedup();
        arrows
    }

    /// The names that an import brings into its module.
    fn imported(&self, module: usize, import: &Import) -> Option<Named> {
        let named = self.resolve(module, &import.path, &mut Vec::new())?;
        let defining = match &named {
            Named::Module(defining) | Named::Item { module: defining, .. } => *defining,
        };
        // A re-export from a child module is no use of it.
        let passed_on = import.public && self.is_below(defining, module);
        match &import.name {
            None if passed_on => None,
            None => Some(match named {
                Named::Module(module) => Named::Item { module, name: "*".to_string() },
                Named::Item { module, name } => Named::Item { module, name: format!("{name}::*") },
            }),
            Some(name) if passed_on && !self.modules[module].source.words.contains(name) => None,
            Some(_) => Some(named),
        }
    }

    fn is_below(&self, module: usize, above: usize) -> bool {
        std::iter::successors(Some(module), |m| self.modules[*m].parent).skip(1).any(|m| m == above)
    }

    /// What `path`, written in `module`, names within this crate. `visited` are the names being resolved,
    /// so that a cycle of names ends.
    fn resolve(
        &self,
        module: usize,
        path: &[String],
        visited: &mut Vec<(usize, String, bool)>,
    ) -> Option<Named> {
        let mut at = module;
        let mut rest = path;
        while let [first, further @ ..] = rest {
            match first.as_str() {
                "crate" => at = 0,
                "super" => at = self.modules[at].parent?,
                "self" => {}
                _ => break,
            }
            rest = further;
        }
        let anchored = rest.len() < path.len();
        for (index, name) in rest.iter().enumerate() {
            let leads_on = index + 1 < rest.len();
            match self.find_name(at, name, leads_on, visited) {
                Some(Named::Module(inner)) => at = inner,
                Some(item) => return Some(item),
                // A name of another crate, or a local one.
                None if index == 0 && !anchored => return None,
                // The name is not resolvable from the text, but belongs to this module.
                None => return Some(Named::Item { module: at, name: name.clone() }),
            }
        }
        Some(Named::Module(at))
    }

    /// What `name` means within `module`. Where it leads on to another name, a module goes before a function
    /// of its name.
    fn find_name(
        &self,
        module: usize,
        name: &str,
        leads_on: bool,
        visited: &mut Vec<(usize, String, bool)>,
    ) -> Option<Named> {
        let question = (module, name.to_string(), leads_on);
        if visited.contains(&question) {
            return None;
        }
        visited.push(question);
        let answer = self.resolve_name(module, name, leads_on, visited);
        visited.pop();
        answer
    }

    fn resolve_name(
        &self,
        module: usize,
        name: &str,
        leads_on: bool,
        visited: &mut Vec<(usize, String, bool)>,
    ) -> Option<Named> {
        let here = &self.modules[module];
        let child =
            here.children.iter().find(|(child, _)| child == name).map(|(_, child)| Named::Module(*child));
        if leads_on && child.is_some() {
            return child;
        }
        if here.source.items.contains(name) {
            return Some(Named::Item { module, name: name.to_string() });
        }
        let imports = &here.source.imports;
        let mut by_name = imports.iter().filter(|import| import.name.as_deref() == Some(name));
        if let Some(named) = by_name.find_map(|import| self.resolve(module, &import.path, visited)) {
            return Some(named);
        }
        if child.is_some() {
            return child;
        }
        imports.iter().filter(|import| import.name.is_none()).find_map(|glob| {
            match self.resolve(module, &glob.path, visited)? {
                Named::Module(inner) => self.find_name(inner, name, leads_on, visited),
                Named::Item { .. } => None,
            }
        })
    }
}
