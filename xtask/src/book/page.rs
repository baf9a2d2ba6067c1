//! A page of the book: the table of contents beside the text.

use crate::book::summary::Chapter;
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};

/// The style of all pages.
pub const STYLE: &str = include_str!("page/book.css");

/// The page of the chapter at `at`, whose Markdown is `text`.
pub fn html(chapters: &[Chapter], at: usize, text: &str) -> String {
    let chapter = &chapters[at];
    let depth = chapter.path.as_deref().map_or(0, |path| path.matches('/').count());
    let root = "../".repeat(depth);
    let mut body = String::new();
    html::push_html(&mut body, with_anchors(parse(text)).into_iter());
    let title = escaped(&chapter.title);
    let contents = contents(chapters, at, &root);
    let neighbours = neighbours(chapters, at, &root);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title} – Focus Brush</title>\n<link rel=\"stylesheet\" href=\"{root}book.css\">\n</head>\n<body>\n\
         <nav aria-label=\"Contents\">\n{contents}</nav>\n<main>\n{body}{neighbours}</main>\n</body>\n</html>\n"
    )
}

/// The events of a text; links to pages lead to their HTML.
fn parse(text: &str) -> Vec<Event<'_>> {
    let options = Options::ENABLE_TABLES | Options::ENABLE_FOOTNOTES | Options::ENABLE_STRIKETHROUGH;
    let relinked = |event| match event {
        Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
            Event::Start(Tag::Link { link_type, dest_url: page_link(dest_url), title, id })
        }
        other => other,
    };
    Parser::new_ext(text, options).map(relinked).collect()
}

/// `page.md#heading` as `page.html#heading`; other targets stay.
fn page_link(target: CowStr<'_>) -> CowStr<'_> {
    let (file, heading) =
        target.split_once('#').map_or((&*target, None), |(file, heading)| (file, Some(heading)));
    match file.strip_suffix(".md").filter(|file| !file.contains("://")) {
        Some(page) => {
            let heading = heading.map(|heading| format!("#{heading}")).unwrap_or_default();
            format!("{page}.html{heading}").into()
        }
        None => target,
    }
}

/// Gives headings the anchors that links within the book name: their words in lower case, joined by hyphens.
fn with_anchors(mut events: Vec<Event<'_>>) -> Vec<Event<'_>> {
    let starts: Vec<usize> = events
        .iter()
        .enumerate()
        .filter(|(_, event)| matches!(event, Event::Start(Tag::Heading { .. })))
        .map(|(at, _)| at)
        .collect();
    for at in starts {
        let words: String = events[at + 1..]
            .iter()
            .take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_))))
            .filter_map(|event| match event {
                Event::Text(text) | Event::Code(text) => Some(&**text),
                _ => None,
            })
            .collect();
        if let Event::Start(Tag::Heading { id, .. }) = &mut events[at] {
            *id = Some(anchor(&words).into());
        }
    }
    events
}

fn anchor(words: &str) -> String {
    let lower = words.to_lowercase();
    let letters = lower.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    letters.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// The table of contents, in which the chapter `current` is marked.
fn contents(chapters: &[Chapter], current: usize, root: &str) -> String {
    let mut list = String::new();
    for (at, Chapter { title, path, level }) in chapters.iter().enumerate() {
        let title = escaped(title);
        list += &match path {
            None => format!("<h2>{title}</h2>\n"),
            Some(path) => {
                let mark = if at == current { " aria-current=\"page\"" } else { "" };
                let page = page_link(path.as_str().into());
                format!("<a class=\"level-{level}\" href=\"{root}{page}\"{mark}>{title}</a>\n")
            }
        };
    }
    list
}

/// Links to the pages before and after.
fn neighbours(chapters: &[Chapter], current: usize, root: &str) -> String {
    let link = |chapter: &Chapter, arrow: [&str; 2]| {
        let page = page_link(chapter.path.as_deref()?.into());
        Some(format!("<a href=\"{root}{page}\">{}{}{}</a>", arrow[0], escaped(&chapter.title), arrow[1]))
    };
    let before = chapters[..current].iter().rev().find_map(|chapter| link(chapter, ["← ", ""]));
    let after = chapters[current + 1..].iter().find_map(|chapter| link(chapter, ["", " →"]));
    let links: Vec<String> = [before, after].into_iter().flatten().collect();
    format!("<footer>{}</footer>\n", links.join(" "))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_link_to_pages_and_headings() {
        let chapter =
            |title: &str, path: &str| Chapter { title: title.into(), path: Some(path.into()), level: 0 };
        let chapters = [chapter("One", "guide/one.md"), chapter("A & B", "two.md")];
        let text = "# One\n\n## What `t` is\n\nSee [two](../two.md#what-t-is), <https://example.org/a.md>.\n";
        let page = html(&chapters, 0, text);
        for part in [
            "<h2 id=\"what-t-is\">",
            "href=\"../two.html#what-t-is\"",
            "href=\"https://example.org/a.md\"",
            "href=\"../book.css\"",
            "aria-current=\"page\">One</a>",
            "A &amp; B →</a>",
        ] {
            assert!(page.contains(part), "{part} in {page}");
        }
    }
}
