//! `saoms explain`: what a code of a diagnostic means, with an example and its remedy.

use std::fmt::Write;

use clap::Args;
use saoms_lang::diagnostic::{Code, codes, nearest_code};
use saoms_lang::registry::Registry;

use crate::Exit;
use crate::arguments::PluginArguments;
use crate::output::{eprint, print};
use crate::plugins::registry;

const EXIT_CODES: &str = "\
Exit codes:
  0  explained
  1  standard output could not be written
  2  there is no such code, or a plugin cannot be used";

/// The pages of all codes, each below a heading with its code and name.
const PAGES: &str = include_str!("../../docs/diagnostics.md");

/// Explain the code of a diagnostic with an example, or list all codes
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ExplainArguments {
    /// The codes to explain, such as `S3004`; or their names, such as `unknown-property`, or rules of the SCA Assembly
    /// specification, such as `ASM50037`
    #[arg(value_name = "CODE")]
    pub(crate) codes: Vec<String>,

    #[command(flatten)]
    pub(crate) plugins: PluginArguments,
}

pub(crate) fn explain(arguments: &ExplainArguments) -> Exit {
    let registry = match registry(&arguments.plugins) {
        Ok(registry) => registry,
        Err(exit) => return exit,
    };
    let all = all(&registry);
    if arguments.codes.is_empty() {
        print(&list(&all));
        return Exit::Done;
    }
    let (mut pages, mut unknown) = (Vec::new(), String::new());
    for wanted in &arguments.codes {
        let found: Vec<&Code> = all.iter().copied().filter(|code| is_named(code, wanted)).collect();
        if found.is_empty() {
            unknown += &refusal(wanted, &all);
        }
        pages.extend(found.into_iter().map(page));
    }
    print(&pages.join("\n"));
    eprint(&unknown);
    if unknown.is_empty() { Exit::Done } else { Exit::WrongInput }
}

/// The codes of the language, then those of the registered rules over fleets.
fn all(registry: &Registry) -> Vec<&Code> {
    codes::ALL.iter().copied().chain(registry.rules().iter().map(|rule| rule.code())).collect()
}

fn is_named(code: &Code, wanted: &str) -> bool {
    names(code).any(|name| name.eq_ignore_ascii_case(wanted))
}

fn names(code: &Code) -> impl Iterator<Item = &str> {
    [code.id, code.name].into_iter().chain(code.rule)
}

fn list(all: &[&Code]) -> String {
    let width = all.iter().map(|code| code.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for code in all {
        let _ = writeln!(text, "{}  {:width$}  {:7}  {}", code.id, code.name, code.severity.name(), code.meaning);
    }
    text + "\n`saoms explain CODE` shows an example of one.\n"
}

/// The page of a code. A code of a plugin has no example.
fn page(code: &Code) -> String {
    let rule = code.rule.map_or_else(String::new, |rule| format!(", {rule}"));
    let head = format!("{} {} ({}{rule})\n\n{}\n", code.id, code.name, code.severity.name(), code.meaning);
    let heading = format!("\n## {} {}\n", code.id, code.name);
    let section = PAGES.split_once(&heading).map_or("", |(_, behind)| behind);
    let section = section.split("\n## ").next().unwrap_or(section);
    let example = section.split_once("```text\n").and_then(|(_, behind)| behind.split_once("```"));
    match example {
        Some((example, _)) => {
            let indented = example.lines().map(|line| format!("  {line}").trim_end().to_owned() + "\n");
            format!("{head}\nExample:\n\n{}", indented.collect::<String>())
        }
        None => head,
    }
}

fn refusal(wanted: &str, all: &[&Code]) -> String {
    let is_rule = wanted.get(..3).is_some_and(|start| start.eq_ignore_ascii_case("ASM"));
    if is_rule && wanted.bytes().skip(3).all(|byte| byte.is_ascii_digit()) {
        return format!(
            "error: no code is only about the rule `{wanted}`\n\
             help: explain the code before it in the diagnostic, such as S2021 in `error[S2021, {wanted}]`\n"
        );
    }
    let mut text = format!("error: there is no code `{wanted}`\n");
    let known: Vec<&str> = all.iter().flat_map(|code| names(code)).collect();
    // As it stands in a diagnostic: `error[S2021, ASM60047]`.
    let inside = wanted.split_once('[').map_or(wanted, |(_, inside)| inside);
    let inside = inside.split([']', ',']).next().unwrap_or(inside);
    if let Some(nearest) = nearest_code(inside, &known) {
        let _ = writeln!(text, "help: did you mean `{nearest}`?");
    }
    text + "help: `saoms explain` lists all codes; those of a plugin with `--plugin PATH`\n"
}
