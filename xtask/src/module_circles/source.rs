//! The contents of one module: the modules and items it declares, its imports, and the paths in its code.

use super::tokens::{Token, after_brackets};
use std::collections::{BTreeMap, BTreeSet};

/// A module's text, parsed.
#[derive(Debug, Default)]
pub struct Source {
    /// `mod x;`: modules with files of their own.
    pub child_files: BTreeSet<String>,
    /// `mod x { … }`
    pub inline: BTreeMap<String, Source>,
    /// The names of its own types, functions, constants and macros.
    pub items: BTreeSet<String>,
    /// Every name of every `use`, anywhere in the module.
    pub imports: Vec<Import>,
    /// The paths of two or more names in its code.
    pub paths: BTreeSet<Vec<String>>,
    /// The names in its code that follow neither another name nor a dot.
    pub words: BTreeSet<String>,
}

/// A name of a `use`.
#[derive(Debug, PartialEq, Eq)]
pub struct Import {
    /// The imported path; `a` for `use a::*`.
    pub path: Vec<String>,
    /// Its local name; `None` for `*`.
    pub name: Option<String>,
    /// Whether it is re-exported, with any visibility.
    pub public: bool,
}

const DECLARATIONS: [&str; 10] =
    ["struct", "enum", "union", "trait", "type", "fn", "const", "static", "macro_rules", "mod"];

/// Parses the module with these `tokens`.
pub fn source_of(tokens: &[Token]) -> Source {
    let mut source = Source::default();
    source.read(tokens, true);
    source
}

impl Source {
    /// Reads tokens; declarations count `at_top` only, outside all braces.
    fn read(&mut self, tokens: &[Token], at_top: bool) {
        let mut at = 0;
        let mut public = false;
        while let Some(token) = tokens.get(at) {
            let next = tokens.get(at + 1);
            let name = next.and_then(Token::word);
            match token {
                Token::Mark('{') => {
                    let end = after_brackets(tokens, at);
                    self.read(within(tokens, at, end), false);
                    at = end;
                }
                Token::Word(word) if word == "pub" => {
                    at += 1;
                    if next == Some(&Token::Mark('(')) {
                        at = after_brackets(tokens, at);
                    }
                    public = true;
                    continue;
                }
                // Not the `use<'a>` of a type.
                Token::Word(word) if word == "use" && next != Some(&Token::Mark('<')) => {
                    let end = end_of_statement(tokens, at);
                    read_use(&tokens[at + 1..end], &[], public, &mut self.imports);
                    at = end + 1;
                }
                Token::Word(word) if at_top && word == "mod" && name.is_some() => {
                    let name = name.unwrap_or_default().to_string();
                    let end = after_brackets(tokens, at + 2);
                    if tokens.get(at + 2) == Some(&Token::Mark('{')) {
                        self.inline.insert(name, source_of(within(tokens, at + 2, end)));
                    } else {
                        self.child_files.insert(name);
                    }
                    at = end;
                }
                Token::Word(word) if at_top && DECLARATIONS.contains(&word.as_str()) => {
                    let name = match next {
                        Some(Token::Mark('!')) => tokens.get(at + 2).and_then(Token::word),
                        _ => name,
                    };
                    self.items.extend(name.map(str::to_string));
                    at += 1;
                }
                Token::Word(_) => at = self.read_path(tokens, at),
                _ => at += 1,
            }
            public = false;
        }
    }

    /// Reads the path that begins at `at`. Returns its end.
    fn read_path(&mut self, tokens: &[Token], at: usize) -> usize {
        let mut end = at + 1;
        let mut path = vec![tokens[at].word().unwrap_or_default().to_string()];
        while let [Token::PathSeparator, Token::Word(name), ..] = &tokens[end.min(tokens.len())..] {
            path.push(name.clone());
            end += 2;
        }
        let before = at.checked_sub(1).map(|before| &tokens[before]);
        if !matches!(before, Some(Token::PathSeparator | Token::Mark('.'))) {
            self.words.insert(path[0].clone());
            if path.len() > 1 {
                self.paths.insert(path);
            }
        }
        end
    }
}

/// The tokens between the bracket at `open` and its closing bracket, before `end`.
fn within(tokens: &[Token], open: usize, end: usize) -> &[Token] {
    tokens.get(open + 1..end - 1).unwrap_or_default()
}

fn end_of_statement(tokens: &[Token], at: usize) -> usize {
    let length = tokens[at..].iter().position(|token| *token == Token::Mark(';'));
    length.map_or(tokens.len(), |length| at + length)
}

/// Reads the tree of a `use`, or of a bracket in it: `a::{b as c, d::*}`.
fn read_use(tokens: &[Token], before: &[String], public: bool, imports: &mut Vec<Import>) {
    let mut path = before.to_vec();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        match token {
            Token::PathSeparator => at += 1,
            Token::Word(word) if word == "as" => {
                let name = tokens.get(at + 1).and_then(Token::word).map(str::to_string);
                imports.push(Import { path, name, public });
                return;
            }
            Token::Word(word) => {
                path.push(word.clone());
                at += 1;
            }
            Token::Mark('*') => {
                imports.push(Import { path, name: None, public });
                return;
            }
            Token::Mark('{') => {
                let end = after_brackets(tokens, at);
                for branch in branches(within(tokens, at, end)) {
                    read_use(branch, &path, public, imports);
                }
                return;
            }
            _ => at += 1,
        }
    }
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    if let Some(name) = path.last().cloned().filter(|_| !tokens.is_empty()) {
        imports.push(Import { path, name: Some(name), public });
    }
}

/// The parts between the commas outside all brackets.
fn branches(tokens: &[Token]) -> Vec<&[Token]> {
    let mut branches = Vec::new();
    let (mut start, mut at) = (0, 0);
    while at < tokens.len() {
        match tokens[at] {
            Token::Mark('{') => at = after_brackets(tokens, at),
            Token::Mark(',') => {
                branches.push(&tokens[start..at]);
                at += 1;
                start = at;
            }
            _ => at += 1,
        }
    }
    branches.push(&tokens[start..]);
    branches
}
