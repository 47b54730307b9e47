//! `saoms expand`: shows what is left of composites when all is resolved.

use std::sync::Arc;

use clap::Args;
use saoms_lang::diagnostic::Severity;
use saoms_lang::source::FileId;
use saoms_lang::syntax;
use saoms_tools::expand::expanded;
use saoms_tools::format::{Formatted, WIDTH};

use crate::Exit;
use crate::arguments::FleetArguments;
use crate::fleet::{DiagnosticReport, compiled};
use crate::output::{counted, eprint, eprint_coloured, print_as_is};

const EXIT_CODES: &str = "\
Exit codes:
  0  printed
  1  standard output could not be written
  2  the input is wrong: a composite, a value, the command line, a plugin; nothing was printed";

/// Print the fleet as one composite, with includes, inner composites, replicas, property sources and wires resolved
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ExpandArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,
}

pub(crate) fn expand(arguments: &ExpandArguments) -> Exit {
    let compilation = match compiled(&arguments.fleet, |project, classes| project.compile(classes)) {
        Ok(compilation) => compilation,
        Err(exit) => return exit,
    };
    let shown = DiagnosticReport::from(&compilation);
    eprint_coloured(&shown.human(Severity::Error));
    let Some(text) = expanded(&compilation) else {
        eprint(&format!("\n{}: nothing to expand\n", counted(shown.count(Severity::Error), "error")));
        return Exit::WrongInput;
    };
    let text = Arc::new(text);
    // In the layout of `saoms fmt`, so that what it writes needs no formatting.
    match syntax::parse(FileId(0), &text).well_formed() {
        Ok(document) => print_as_is(&Formatted { document: &document, width: WIDTH }),
        Err(_) => print_as_is(&text),
    }
    Exit::Done
}
