//! Runs the whole suite and prints it as Markdown: `cargo run -p hard-cases --example table >
//! docs/hard-cases.md`. The first argument is the filter of case names; times are printed to stderr.

use hard_cases::{Effort, suite};
use progress::Unwatched;
use std::time::Instant;

const HEAD: &str = "# Hard cases

Inputs that break careless code: each with the expected and the measured result, and a *control*, a deliberately wrong
computation that must fail the same check. `focus-brush report --hard` runs them; so does
`cargo test -p hard-cases`, with fewer rays. This page is written by
`cargo run -p hard-cases --example table > docs/hard-cases.md`.
";

fn main() {
    let filter = std::env::args().nth(1).unwrap_or_default();
    let effort = if std::env::var_os("REDUCED").is_some() { Effort::Reduced } else { Effort::Full };
    println!("{HEAD}");
    println!("| case | expected | found | pass | control fails |\n| --- | --- | --- | --- | --- |");
    let cases: Vec<_> = suite().into_iter().filter(|case| case.name.contains(&filter)).collect();
    for case in &cases {
        let start = Instant::now();
        let outcome = case.run(effort, &Unwatched).expect("nobody cancels");
        eprintln!("{:6.2} s  {}", start.elapsed().as_secs_f64(), case.name);
        let sign = |yes: bool| if yes { "yes" } else { "**no**" };
        let cells = [
            &*outcome.case,
            &*outcome.expected,
            &*outcome.measured,
            sign(outcome.pass),
            sign(outcome.control_fails),
        ];
        println!("| {} |", cells.map(|cell| cell.replace('|', "\\|")).join(" | "));
    }
    println!("\n## Why, and what each control does wrong\n");
    for case in &cases {
        println!("- **{}**: {} *Control:* {}.", case.name, case.reason, case.control);
    }
}
