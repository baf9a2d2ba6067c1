//! The pages are what the figures give, short, and without figures of their own; and each of these checks fails on a page that is not.

use super::page::Page;
use super::set::{Set, Sets};
use super::{PAGES, generate};
use crate::chore::repository;

const PAGE: Page = Page { file: "docs/page.md", most_characters: 600 };

const SETS: &str = r#"{
"speed": {"rows": "scene", "columns": [["plain", "unpainted"], ["paint", "painted"]],
 "plot": {"title": "A <refocus>", "columns": ["plain", "paint"], "axis": "log"},
 "records": [
  {"id": "demo/plain", "scene": "the demo", "command": "focus-brush report", "machine": "M", "commit": "abcdef0", "date": "2026-11-24", "value": 71, "unit": "ms"},
  {"id": "demo/paint", "scene": "the demo", "command": "focus-brush report", "machine": "M", "commit": "abcdef0", "date": "2026-11-24", "value": [1.5, 24400], "unit": "ms", "note": "twice"},
  {"id": "fox/plain", "scene": "Fox", "command": "focus-brush report", "machine": "N", "commit": "abcdef0", "date": "2026-11-25", "value": -0.5, "bound": ">", "unit": "ms"}]},
"answer": {"text": ["It takes {speed:demo/plain}."]}
}"#;

fn filled(page: &str, sets: &str) -> Result<String, String> {
    let sets = Sets::from_text("file", sets)?;
    PAGE.filled(page, &sets, &mut Vec::new()).map_err(|failure| failure.to_string())
}

#[test]
fn figures_pages_are_what_the_figures_give() {
    let root = repository();
    for (file, text) in generate(&root).unwrap() {
        let written = std::fs::read_to_string(root.join(&file)).unwrap_or_default();
        assert!(written == text, "{file} is not what docs/figures gives (run cargo xtask figures)");
    }
}

#[test]
fn figures_pages_are_short_and_have_no_figures_outside_their_marks() {
    for page in PAGES {
        let text = std::fs::read_to_string(repository().join(page.file)).unwrap();
        assert_eq!(page.problems(&text), Vec::<String>::new());
    }
}

#[test]
fn figures_stand_between_marks_as_a_table() {
    let page = filled("# A\n\n<!-- figures: speed -->\nold\n<!-- end -->\n\nB\n", SETS).unwrap();
    let expected = "# A\n\n<!-- figures: speed -->\n\
        | scene | unpainted, ms | painted, ms |\n|---|---:|---:|\n\
        | the demo | 71 | 1.5 to 24,400 ¹ |\n| Fox | > −0.5 | |\n\n¹ twice.\n\n\
        *`focus-brush report`: M, 2026-11-24 (abcdef0); N, 2026-11-25 (abcdef0).*\n\n\
        ![A <refocus>](figures/file/speed.svg)\n<!-- end -->\n\nB\n";
    assert_eq!(page, expected);
    assert_eq!(filled(&page, SETS).unwrap(), expected, "a second run changes nothing");
    let answer = filled("<!-- figures: answer -->\n<!-- end -->", SETS).unwrap();
    assert_eq!(answer, "<!-- figures: answer -->\nIt takes 71 ms.\n<!-- end -->");
}

#[test]
fn figures_that_change_make_a_page_stale() {
    let page = filled("<!-- figures: answer -->\n<!-- end -->", SETS).unwrap();
    let changed = filled(&page, &SETS.replace("\"value\": 71", "\"value\": 72")).unwrap();
    assert_ne!(page, changed);
}

#[test]
fn figures_outside_marks_and_long_pages_are_found() {
    let good = "# A\n\nIn 2026 it took two cores and 18 triangles; `--size 480x270`, P3, H200, f/2.\n\n<!-- figures: speed -->\n| 71 ms |\n<!-- end -->\n";
    assert_eq!(PAGE.problems(good), Vec::<String>::new());
    for figure in [
        "71 ms",
        "5 s",
        "45.2 dB",
        "1.5 GB",
        "634 MiB",
        "16 bytes",
        "6 px",
        "600 ×",
        "1920 × 1080",
        "0.5 %",
        "60 %",
        "39 F",
        "1,560 ×",
        "60\nms",
        "3px",
    ] {
        let page = format!("{good}It takes {figure}, or so.\n");
        let problems = PAGE.problems(&page);
        assert_eq!(problems.len(), 1, "{figure}: {problems:?}");
        assert!(problems[0].contains("outside the marks"));
    }
    let long = good.replace("two", &"x".repeat(600));
    assert!(PAGE.problems(&long)[0].contains("600 at most"));
    let all_long = PAGES.map(|page| page.problems(&"x".repeat(page.most_characters + 1)).len());
    assert_eq!(all_long, PAGES.map(|_| 1));
}

#[test]
fn figures_of_a_wrong_form_are_refused() {
    for (from, to, problem) in [
        ("\"commit\": \"abcdef0\", ", "", "demo/plain: \"commit\" must be a text"),
        ("\"abcdef0\"", "\"abc\"", "seven hexadecimal digits"),
        ("2026-11-24", "24 November", "YYYY-MM-DD"),
        ("\"demo/plain\"", "\"demo\"", "ROW/COLUMN"),
        ("\"demo/paint\"", "\"demo/plain\"", "exists twice"),
        ("\"demo/paint\"", "\"demo/other\"", "no column"),
        ("71", "\"71\"", "\"value\" must be a number"),
        ("\"note\"", "\"notes\"", "unknown field"),
        ("\">\"", "\"~\"", "\"bound\""),
        ("71, \"unit\": \"ms\"", "71, \"unit\": \"s\"", "units differ"),
        ("{speed:demo/plain}", "{speed:demo/none}", "no such record"),
    ] {
        assert!(SETS.contains(from), "{from}");
        let found =
            filled("<!-- figures: answer -->\n<!-- end -->", &SETS.replacen(from, to, 1)).unwrap_err();
        assert!(found.contains(problem), "{found}");
    }
    for page in ["<!-- figures: none -->\n<!-- end -->", "<!-- figures: speed -->\n"] {
        assert!(filled(page, SETS).is_err(), "{page}");
    }
}

#[test]
fn figures_are_plotted_with_a_dot_each() {
    let sets = Sets::from_text("file", &SETS.replace("-0.5", "0.5")).unwrap();
    let (name, svg) = sets.get("speed").and_then(Set::plot).unwrap();
    assert_eq!(name, "file/speed.svg");
    assert_eq!(svg.matches("<circle").count(), 2);
    assert_eq!(svg.matches("Z\" fill").count(), 1, "a triangle for the bound");
    assert_eq!(svg.matches("stroke-width=\"3\"").count(), 1, "a line for the range");
    assert!(svg.contains("A &lt;refocus&gt;") && !svg.contains("NaN"));
    assert!(matches!(sets.get("answer"), Some(Set::Text(_))));
}
