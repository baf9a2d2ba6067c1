//! A set of figures as a table in Markdown, and where its figures come from.

use super::record::Record;
use super::table_set::TableSet;

/// Signs of notes, in their order.
const SIGNS: [&str; 9] = ["¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"];

/// The table, its notes, and a line with commands, machines, days and commits.
pub fn markdown(set: &TableSet) -> String {
    let units: Vec<Option<&str>> = set.columns.iter().map(|(key, _)| common_unit(set, key)).collect();
    let mut notes: Vec<&str> = Vec::new();
    let titles = set.columns.iter().zip(&units).map(|((_, title), unit)| match unit {
        Some(unit) if !unit.is_empty() => format!("{title}, {unit}"),
        _ => title.clone(),
    });
    let mut lines = vec![line(std::iter::once(set.rows_title.clone()).chain(titles))];
    lines.push(format!("|---|{}", "---:|".repeat(set.columns.len())));
    for (title, records) in set.rows() {
        let cells = set.columns.iter().zip(&units).map(|((key, _), unit)| {
            let Some(record) = records.iter().find(|record| record.column() == key) else {
                return String::new();
            };
            let text = if unit.is_some() { record.quantity.text() } else { record.text() };
            match &record.note {
                Some(note) => format!("{text} {}", sign(&mut notes, note)),
                None => text,
            }
        });
        let cells: Vec<_> = cells.collect();
        lines.push(line(std::iter::once(title.to_owned()).chain(cells)));
    }
    let notes: Vec<_> = notes.iter().zip(SIGNS).map(|(note, sign)| format!("{sign} {note}")).collect();
    if !notes.is_empty() {
        lines.extend([String::new(), format!("{}.", notes.join(". "))]);
    }
    lines.extend([String::new(), origins(&set.records)]);
    lines.join("\n")
}

/// A row of the table.
fn line(cells: impl Iterator<Item = String>) -> String {
    let cells = cells.map(|cell| if cell.is_empty() { cell } else { format!(" {cell}") });
    format!("|{} |", cells.collect::<Vec<_>>().join(" |"))
}

/// The unit of a column's figures, if all have the same.
fn common_unit<'a>(set: &'a TableSet, key: &str) -> Option<&'a str> {
    let mut units = set.records.iter().filter(|record| record.column() == key).map(|record| &*record.unit);
    let first = units.next()?;
    units.all(|unit| unit == first).then_some(first)
}

fn sign<'a>(notes: &mut Vec<&'a str>, note: &'a str) -> &'static str {
    let at = notes.iter().position(|other| *other == note).unwrap_or_else(|| {
        notes.push(note);
        notes.len() - 1
    });
    SIGNS.get(at).copied().unwrap_or("*")
}

/// A machine, and the days on which it ran a command, each with its commits.
type Runs<'a> = (&'a str, Vec<(&'a str, Vec<&'a str>)>);

/// Commands, and for each of them on which machines and days it was run, and at which commits.
fn origins(records: &[Record]) -> String {
    let mut commands: Vec<(&str, Vec<Runs>)> = Vec::new();
    for record in records {
        let machines = entry(&mut commands, &*record.command);
        let days = entry(machines, &*record.machine);
        let commits = entry(days, &*record.date);
        if !commits.contains(&&*record.commit) {
            commits.push(&record.commit);
        }
    }
    let day = |(day, commits): (&str, Vec<&str>)| format!("{day} ({})", commits.join(", "));
    let machine = |(machine, days): Runs| {
        let days: Vec<String> = days.into_iter().map(day).collect();
        format!("{machine}, {}", days.join(", "))
    };
    let parts = commands.into_iter().map(|(command, machines)| {
        let machines: Vec<String> = machines.into_iter().map(machine).collect();
        format!("`{command}`: {}", machines.join("; "))
    });
    format!("*{}.*", parts.collect::<Vec<_>>().join(". "))
}

/// What stands beside a key, which is added at the end where it is new.
fn entry<K: PartialEq, V: Default>(list: &mut Vec<(K, V)>, key: K) -> &mut V {
    let at = list.iter().position(|(other, _)| *other == key).unwrap_or_else(|| {
        list.push((key, V::default()));
        list.len() - 1
    });
    &mut list[at].1
}
