//! Speed of reading a composite: `cargo bench -p saoms-lang --bench load -- [MEGABYTES] [KIND]`. It measures the steps
//! that parse and load, each alone.
//!
//! For each kind of text it prints the megabytes per second of one core for roxmltree's tree, for ours, and for the
//! model with all checks of the vocabulary (memory given back included), the best of five, and the peak memory of the
//! process as a multiple of the text's size so far.

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Instant;

use saoms_lang::diagnostic::Diagnostics;
use saoms_lang::load::load_file;
use saoms_lang::source::{FileId, Sources};
use saoms_lang::syntax;

const ROUNDS: u32 = 5;

#[expect(clippy::print_stdout, reason = "a benchmark tells its result")]
fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|one| one.starts_with(char::is_alphabetic)).collect();
    let megabytes = std::env::args().filter_map(|argument| argument.parse::<usize>().ok()).next_back();
    let size = megabytes.unwrap_or(20) * 1_000_000;
    for (name, part) in [("robots", robot as fn(usize) -> String), ("calculators", calculator), ("tiny", tiny)] {
        if !wanted.is_empty() && !wanted.iter().any(|argument| argument == name) {
            continue;
        }
        let text: Arc<String> = Arc::new(composite(size, part));
        let tree = fastest(|| drop(syntax::parse(FileId(0), &text)));
        let mut sources = Sources::new();
        let file = sources.add("bench", text.as_str());
        let mut found = 0;
        let model = fastest(|| {
            let mut diagnostics = Diagnostics::new();
            drop(load_file(file, &sources, &mut diagnostics));
            found = diagnostics.errors();
        });
        // Before roxmltree, whose memory is not ours.
        let peak = peak();
        let options = || roxmltree::ParsingOptions { nodes_limit: u32::MAX, ..Default::default() };
        let other = fastest(|| drop(roxmltree::Document::parse_with_options(&text, options())));
        let speed = |seconds: f64| text.len() as f64 / 1e6 / seconds;
        println!(
            "{name:12} {:5.0} MB: roxmltree {:4.0} MB/s, tree {:4.0} MB/s, model {:4.0} MB/s, {found} errors, peak {:.1} x the text",
            text.len() as f64 / 1e6,
            speed(other),
            speed(tree),
            speed(model),
            peak / text.len() as f64
        );
    }
}

fn fastest(mut work: impl FnMut()) -> f64 {
    let times = (0..ROUNDS).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    });
    times.fold(f64::MAX, f64::min)
}

/// The most memory the process had, in bytes; 0 where the system does not say.
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let number = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    number.unwrap_or(0.0) * 1024.0
}

fn composite(size: usize, part: fn(usize) -> String) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<composite xmlns=\"http://www.osoa.org/xmlns/sca/1.0\"\n    \
         targetNamespace=\"http://launch\" name=\"bench\">\n",
    );
    for number in 0.. {
        if text.len() >= size {
            break;
        }
        text.push_str(&part(number));
    }
    text.push_str("</composite>\n");
    text
}

/// A robot as the manual writes it.
fn robot(number: usize) -> String {
    let mut text = format!(
        "    <component name=\"Robot{number:03}\">\n        <implementation.java class=\"robot.Robot001\" />\n"
    );
    for (name, value) in [
        ("ID", "Robot001"),
        ("period", "1000"),
        ("delay", "0"),
        ("runOnStartup", "true"),
        ("mayInterruptIfRunning", "true"),
        ("useJMS", "true"),
        ("url", "localhost:61616"),
        ("topicRename", "POS001, pos001::POS002, pos002"),
    ] {
        let _ = writeln!(text, "        <property name=\"{name}\">{value}</property>");
    }
    text.push_str(
        "        <service name=\"TaskInterface\">\n            \
         <interface.java interface=\"unibg.robotics.tca.TaskInterface\" />\n        </service>\n    </component>\n",
    );
    text
}

/// A component with wires, in short lines.
fn calculator(number: usize) -> String {
    format!(
        "<component name=\"C{number}\">\n<implementation.java class=\"calculator.CalculatorServiceImpl\"/>\n\
         <reference name=\"add\" target=\"A{number}\"/>\n<reference name=\"divide\" target=\"D{number}/Divide\">\n\
         <binding.ws uri=\"http://localhost/D{number}\"/>\n</reference>\n</component>\n"
    )
}

/// The smallest component there is: the most elements for the size.
fn tiny(_: usize) -> String {
    "<component name='a'/>".to_owned()
}
