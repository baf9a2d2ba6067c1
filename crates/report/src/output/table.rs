//! A table, as Markdown and as HTML.

use super::markup::escaped;

/// A table of text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Titles of the columns, and whether they hold numbers, which are right-aligned.
    pub columns: Vec<(String, bool)>,
    /// Rows with as many cells as there are columns.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table; titles that start with `#` mark columns of numbers.
    pub fn new(titles: &[&str]) -> Self {
        let column = |title: &&str| match title.strip_prefix('#') {
            Some(title) => (title.to_string(), true),
            None => (title.to_string(), false),
        };
        Self { columns: titles.iter().map(column).collect(), rows: Vec::new() }
    }

    /// Appends a row.
    pub fn push(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// As Markdown.
    pub fn to_markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let cell = |text: &String| text.replace('|', "\\|").replace('\n', " ");
        let mut text = line(self.columns.iter().map(|(title, _)| cell(title)).collect());
        text += &line(self.columns.iter().map(|(_, n)| if *n { "---:" } else { "---" }.into()).collect());
        for row in &self.rows {
            text += &line(row.iter().map(cell).collect());
        }
        text
    }

    /// As HTML.
    pub fn to_html(&self) -> String {
        let cells = |tag: &str, row: &[String]| {
            let cell = |(text, (_, is_number)): (&String, &(String, bool))| {
                let class = if *is_number { r#" class="n""# } else { "" };
                format!("<{tag}{class}>{}</{tag}>", escaped(text))
            };
            row.iter().zip(&self.columns).map(cell).collect::<String>()
        };
        let titles: Vec<String> = self.columns.iter().map(|(title, _)| title.clone()).collect();
        let rows: String = self.rows.iter().map(|row| format!("<tr>{}</tr>\n", cells("td", row))).collect();
        format!(
            "<div class=\"wide\"><table><thead><tr>{}</tr></thead>\n<tbody>{rows}</tbody></table></div>",
            cells("th", &titles)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_hold_the_same() {
        let mut table = Table::new(&["scene", "#seconds"]);
        table.push(["a|b <c>".into(), "1.5".into()]);
        assert_eq!(table.to_markdown(), "| scene | seconds |\n| --- | ---: |\n| a\\|b <c> | 1.5 |\n");
        let html = table.to_html();
        assert!(html.contains("<td>a|b &lt;c&gt;</td><td class=\"n\">1.5</td>"), "{html}");
        assert!(html.contains("<th>scene</th><th class=\"n\">seconds</th>"), "{html}");
    }
}
