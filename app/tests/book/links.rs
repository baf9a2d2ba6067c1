//! Links within the book lead to an existing file and heading.

use crate::pages::{lines, pages, repository};
use std::path::Path;

/// The targets of a page's links: between `](` and `)`.
fn targets(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for line in lines(text).into_iter().filter(|line| line.block.is_none()) {
        // Text between backticks is code.
        let prose: String = line.text.split('`').step_by(2).collect::<Vec<_>>().join(" ");
        let rest = prose.split("](").skip(1);
        found.extend(rest.filter_map(|rest| Some((line.number, rest.split_once(')')?.0.to_owned()))));
    }
    found
}

/// The anchor of a heading: lower case, hyphens for spaces, no other punctuation.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    kept.flat_map(char::to_lowercase).map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn anchors(page: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(page).unwrap();
    let lines = lines(&text);
    let headings = lines.iter().filter(|line| line.block.is_none() && line.text.starts_with('#'));
    headings.map(|line| anchor(line.text.trim_start_matches('#'))).collect()
}

#[test]
fn every_link_leads_somewhere() {
    let mut dead = Vec::new();
    let mut count = 0;
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        for (number, target) in targets(&text) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            count += 1;
            let (file, heading) = target.split_once('#').map_or((&*target, None), |(f, h)| (f, Some(h)));
            let file = match file {
                "" => page.clone(),
                file => page.parent().unwrap().join(file),
            };
            let is_there = match heading {
                _ if !file.exists() => false,
                None => true,
                Some(heading) => anchors(&file).iter().any(|anchor| anchor == heading),
            };
            if !is_there {
                let page = page.strip_prefix(repository()).unwrap().display();
                dead.push(format!("{page}:{number}: {target}"));
            }
        }
    }
    assert!(count > 20, "{count} links: are they looked for?");
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
}

#[test]
fn headings_have_the_addresses_that_readers_know() {
    assert_eq!(anchor(" What it needs"), "what-it-needs");
    assert_eq!(anchor(" `.fbrush` in a file manager, 2"), "fbrush-in-a-file-manager-2");
    assert_eq!(targets("see [a](b.md#c), [`d`](e.png)\n    [no](x)\n`[no](y)`").len(), 2);
}

#[test]
fn the_table_of_contents_has_every_page() {
    let docs = repository().join("docs");
    let summary = std::fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    for page in pages().iter().filter_map(|page| page.strip_prefix(&docs).ok()) {
        let name = page.to_string_lossy().replace('\\', "/");
        assert!(name == "SUMMARY.md" || summary.contains(&format!("]({name})")), "SUMMARY.md lacks {name}");
    }
}
