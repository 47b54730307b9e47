//! Response times of the language server in large composites, hostile texts and many files. See `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a measurement is for the person who waits for it")]

mod editor;
mod texts;

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::fmt::Write as _;
use std::time::Duration;

use clap::Parser;
use serde::Serialize;

use common::composite::{Airport, Phases, airport};
use common::{Outcome, median, verdict};
use editor::Editor;
use texts::Case;

/// Measures the language server.
#[derive(Parser)]
#[command(name = "cargo bench --bench lsp --")]
struct Arguments {
    /// Number of times that each request is sent.
    #[arg(long, default_value_t = 100)]
    rounds: usize,
    /// Numbers of components.
    #[arg(long, value_delimiter = ',', default_value = "1000,10000")]
    sizes: Vec<u32>,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// The row of the first diagnostics.
const OPENED: &str = "diagnostics after opening";
/// End of the names of the rows of completion.
const COMPLETED: &str = "typed and completed";
/// Number of measured checks.
const CHECKS: usize = 10;
/// Maximum number of times that each request about a hostile text is sent.
const HOSTILE_ROUNDS: usize = 5;

/// Maximum time of a response about 1,000 components, in ms.
const GOAL_MS: f64 = 50.0;
/// Size for which the goal applies.
const GOAL_SIZE: u32 = 1000;

/// Positions for typing: their names, the text before them in the last robot, and the text that is typed.
const PLACES: [(&str, &str, &str); 5] = [
    ("element", "\n    ", "<"),
    ("class", "<implementation.java class=\"", "s"),
    ("property", "<property name=\"", "r"),
    ("value of a property", "<property name=\"period\">", "1"),
    ("component in a target", "<reference name=\"world\" target=\"", "W"),
];

/// Requests about the name of the world in a target of the last robot, which thousands of targets name.
const QUESTIONS: [&str; 5] = ["hover", "definition", "references", "rename", "documentSymbol"];

/// All requests about a place.
const ALL_QUESTIONS: [&str; 13] = [
    "hover", "definition", "references", "documentHighlight", "prepareRename", "rename", "documentSymbol",
    "linkedEditingRange", "codeAction", "foldingRange", "selectionRange", "documentLink", "formatting",
];

#[derive(Serialize)]
struct Row {
    text: String,
    what: String,
    median_ms: f64,
    worst_ms: f64,
}

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    if !arguments.bench {
        eprintln!("a benchmark is run with `cargo bench --bench lsp`");
        return Ok(());
    }
    let mut rows = Vec::new();
    for &size in &arguments.sizes {
        eprintln!("{} ...", components(&size));
        measure(size, arguments.rounds, &mut rows)?;
    }
    let mut verdicts = Vec::new();
    for case in texts::cases() {
        eprintln!("{} ...", case.name);
        let worst = measure_all(&case, arguments.rounds.min(HOSTILE_ROUNDS), &mut rows)?;
        verdicts.push(format!(
            "The worst answer about {} took {worst:.1} ms (goal: {} ms; {}).",
            case.name,
            case.goal_ms,
            verdict(worst <= case.goal_ms)
        ));
    }
    let mut page = format!("The language server. {}.\n\n", common::description());
    page.push_str("| text | what | median ms | worst ms |\n| --- | --- | ---: | ---: |\n");
    for Row { text, what, median_ms, worst_ms } in &rows {
        writeln!(page, "| {text} | {what} | {median_ms:.1} | {worst_ms:.1} |")?;
    }
    let goal: Vec<String> = arguments.sizes.iter().filter(|size| **size <= GOAL_SIZE).map(components).collect();
    let judged = rows.iter().filter(|row| goal.contains(&row.text) && row.what.ends_with(COMPLETED));
    if let Some(worst) = judged.map(|row| row.worst_ms).max_by(f64::total_cmp) {
        writeln!(
            page,
            "\nThe worst completion of up to {GOAL_SIZE} components took {worst:.1} ms (goal: {GOAL_MS} ms; {}).",
            verdict(worst <= GOAL_MS)
        )?;
    }
    verdicts.iter().try_for_each(|one| writeln!(page, "\n{one}"))?;
    common::write("lsp", &page, &rows)
}

/// The name of an airport of this size.
fn components(size: &u32) -> String {
    format!("{size} components")
}

fn row(text: &str, what: &str, times: &[f64]) -> Row {
    Row {
        text: text.to_owned(),
        what: what.to_owned(),
        median_ms: median(times.iter().copied()).unwrap_or(f64::NAN),
        worst_ms: times.iter().copied().fold(0.0, f64::max),
    }
}

fn measure(size: u32, rounds: usize, rows: &mut Vec<Row>) -> Outcome<()> {
    // A world, two masters and an environment are among the components.
    let period = Duration::from_millis(100);
    let text = airport(Airport::new(size.saturating_sub(4).max(1), period, Phases::Together), Duration::from_secs(1));
    let mut editor = Editor::open("airport", &[("fleet.composite".to_owned(), text.clone())])?;
    let name = components(&size);
    let mut row = |what: &str, times: &[f64]| rows.push(row(&name, what, times));
    row(OPENED, &[editor.diagnostics()?]);
    for (what, before, typed) in PLACES {
        let component = text.rfind("<component").ok_or("no component")?;
        let found = text[component..].find(before).ok_or("no such place")?;
        let at = component + found + before.len();
        let times: Outcome<Vec<f64>> = (0..rounds).map(|_| editor.complete(&text, at, typed, false)).collect();
        row(&format!("{what} {COMPLETED}"), &times?);
    }
    let world = text.rfind("target=\"World").ok_or("no target")? + "target=\"".len();
    for what in QUESTIONS {
        let method = format!("textDocument/{what}");
        let times: Outcome<Vec<f64>> = (0..rounds).map(|_| editor.question(&method, &text, world + 1, false)).collect();
        row(what, &times?);
    }
    // A blank changes the text, but not its meaning.
    let times: Outcome<Vec<f64>> = (0..CHECKS.min(rounds)).map(|_| editor.check(&text, world - 8, " ")).collect();
    row("diagnostics after a change", &times?);
    editor.close()
}

/// Asks everything at the places of a case, each time about a text that has just changed; returns the worst time of an
/// answer, in ms.
fn measure_all(case: &Case, rounds: usize, rows: &mut Vec<Row>) -> Outcome<f64> {
    let text = &case.files.last().ok_or("no file")?.1;
    let mut editor = Editor::open("case", &case.files)?;
    let opened = editor.diagnostics()?;
    let mut answers = Vec::new();
    let mut typed = Vec::new();
    for &at in &case.places {
        for _ in 0..rounds {
            typed.push(editor.complete(text, at, " ", true)?);
        }
    }
    answers.push(row(&case.name, COMPLETED, &typed));
    for what in ALL_QUESTIONS {
        let method = format!("textDocument/{what}");
        let mut times = Vec::new();
        for &at in &case.places {
            for _ in 0..rounds {
                times.push(editor.question(&method, text, at, true)?);
            }
        }
        answers.push(row(&case.name, what, &times));
    }
    let worst = answers.iter().map(|row| row.worst_ms).fold(0.0, f64::max);
    let last = *case.places.last().ok_or("no place")?;
    let checks: Outcome<Vec<f64>> = (0..CHECKS.min(rounds)).map(|_| editor.check(text, last, " ")).collect();
    rows.push(row(&case.name, OPENED, &[opened]));
    rows.append(&mut answers);
    rows.push(row(&case.name, "diagnostics after a change", &checks?));
    editor.close()?;
    Ok(worst)
}
