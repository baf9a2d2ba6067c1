//! Tokenises Rust code, without comments, quoted text and test-only code.

/// A token, with only the distinctions that names need.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Token {
    /// A name, a keyword or a number.
    Word(String),
    /// `::`
    PathSeparator,
    /// `..`, `...`, `..=`
    Range,
    /// Any other mark.
    Mark(char),
}

impl Token {
    /// The word, if the token is one.
    pub fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word) => Some(word),
            _ => None,
        }
    }

    /// Whether this is that word.
    pub fn is(&self, word: &str) -> bool {
        self.word() == Some(word)
    }
}

/// The tokens of `text`. Quoted literals become a single mark, so that their words are not taken for names.
pub fn tokens_of(text: &str) -> Vec<Token> {
    let text: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let (here, next) = (text[at], text.get(at + 1).copied().unwrap_or('\0'));
        match here {
            '/' if next == '/' => at = end_of_line(&text, at),
            '/' if next == '*' => at = after_comment(&text, at),
            '"' => {
                at = after_quote(&text, at + 1, '"');
                tokens.push(Token::Mark('"'));
            }
            '\'' => {
                let quoted = next == '\\' || text.get(at + 2) == Some(&'\'');
                at = if quoted { after_quote(&text, at + 1, '\'') } else { after_word(&text, at + 1) };
                tokens.push(Token::Mark('\''));
            }
            ':' if next == ':' => {
                at += 2;
                tokens.push(Token::PathSeparator);
            }
            '.' if next == '.' => {
                at += text[at..].iter().take_while(|c| **c == '.').count();
                tokens.push(Token::Range);
            }
            _ if is_of_word(here) => {
                let end = after_word(&text, at);
                let word: String = text[at..end].iter().collect();
                let hashes = text[end..].iter().take_while(|c| **c == '#').count();
                let raw = word.ends_with('r') && text.get(end + hashes) == Some(&'"');
                if raw && ["r", "br", "cr"].contains(&word.as_str()) {
                    at = after_raw_quote(&text, end + hashes + 1, hashes);
                    tokens.push(Token::Mark('"'));
                } else if word == "r" && hashes == 1 {
                    // A raw name, r#type, is named by what follows.
                    at = end + 1;
                } else {
                    at = end;
                    tokens.push(Token::Word(word));
                }
            }
            _ => {
                at += 1;
                if !here.is_whitespace() {
                    tokens.push(Token::Mark(here));
                }
            }
        }
    }
    tokens
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn after_word(text: &[char], at: usize) -> usize {
    at + text[at..].iter().take_while(|c| is_of_word(**c)).count()
}

fn end_of_line(text: &[char], at: usize) -> usize {
    at + text[at..].iter().take_while(|c| **c != '\n').count()
}

/// The index after the comment that opens at `at`; block comments nest.
fn after_comment(text: &[char], mut at: usize) -> usize {
    let mut depth = 0;
    while at < text.len() {
        match (text[at], text.get(at + 1)) {
            ('/', Some('*')) => (depth, at) = (depth + 1, at + 2),
            ('*', Some('/')) => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at
}

fn after_quote(text: &[char], mut at: usize, quote: char) -> usize {
    while at < text.len() && text[at] != quote {
        at += if text[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

fn after_raw_quote(text: &[char], mut at: usize, hashes: usize) -> usize {
    let closes = |at: usize| text[at] == '"' && text[at + 1..].iter().take(hashes).all(|c| *c == '#');
    while at < text.len() && !closes(at) {
        at += 1;
    }
    at + 1 + hashes
}

/// The index after the bracket that closes the one at `at`.
pub fn after_brackets(tokens: &[Token], mut at: usize) -> usize {
    let mut depth = 0;
    while at < tokens.len() {
        match tokens[at] {
            Token::Mark('(' | '[' | '{') => depth += 1,
            Token::Mark(')' | ']' | '}') => depth -= 1,
            _ => {}
        }
        at += 1;
        if depth == 0 {
            break;
        }
    }
    at.min(tokens.len())
}

/// `tokens` without the items under `#[cfg(test)]` and `#[cfg(all(test, …))]`.
pub fn without_tests(tokens: &[Token]) -> Vec<Token> {
    let mut product_tokens = Vec::with_capacity(tokens.len());
    let mut at = 0;
    while at < tokens.len() {
        if is_for_tests(&tokens[at..]) {
            at = after_item(tokens, at);
        } else {
            product_tokens.push(tokens[at].clone());
            at += 1;
        }
    }
    product_tokens
}

fn is_for_tests(tokens: &[Token]) -> bool {
    let open = Token::Mark('(');
    match tokens {
        [Token::Mark('#'), Token::Mark('['), cfg, o, test, ..] if cfg.is("cfg") && *o == open => {
            let all = test.is("all") && tokens.get(6).is_some_and(|t| t.is("test"));
            test.is("test") || all
        }
        _ => false,
    }
}

const DECLARING: [&str; 14] = [
    "async", "const", "enum", "extern", "fn", "impl", "let", "mod", "static", "struct", "trait", "type",
    "unsafe", "use",
];
const WITH_SEMICOLON: [&str; 5] = ["const", "let", "static", "type", "use"];

/// The index after the item, field, arm or statement whose attributes begin at `at`.
fn after_item(tokens: &[Token], mut at: usize) -> usize {
    while tokens.get(at) == Some(&Token::Mark('#')) {
        at = after_brackets(tokens, at + 1);
    }
    if tokens.get(at).is_some_and(|token| token.is("pub")) {
        at += 1;
        if tokens.get(at) == Some(&Token::Mark('(')) {
            at = after_brackets(tokens, at);
        }
    }
    let words: Vec<_> = tokens[at..].iter().map_while(Token::word).collect();
    // Fields, arms and what is handed over end with a comma; declarations may hold some.
    let declares = words.first().is_some_and(|word| DECLARING.contains(word));
    // Imports and values end with a semicolon, behind whatever braces.
    let ends_with_brace = !words.iter().any(|word| WITH_SEMICOLON.contains(word)) || words.contains(&"fn");
    while at < tokens.len() {
        match tokens[at] {
            Token::Mark(';') => return at + 1,
            Token::Mark(',') if !declares => return at + 1,
            Token::Mark('{') if ends_with_brace => return after_brackets(tokens, at),
            Token::Mark('(' | '[' | '{') => at = after_brackets(tokens, at),
            Token::Mark(')' | ']' | '}') => return at,
            _ => at += 1,
        }
    }
    at
}
