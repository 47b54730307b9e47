//! `saoms expand`: shows what is left of composites when all is resolved.

use std::sync::Arc;

use clap::Args;
use saoms_lang::assembly::expanded;
use saoms_lang::check::{Options, check};
use saoms_lang::diagnostic::Severity;
use saoms_lang::source::FileId;
use saoms_lang::xml;
use saoms_tools::format::{Formatted, WIDTH};

use super::EXIT_CODES;
use crate::Exit;
use crate::arguments::FleetArguments;
use crate::fleet::checked;
use crate::output::{counted, eprint, print};

/// Print the one composite that is left when includes, inner composites, property sources and wires are resolved
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ExpandArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,
}

pub(crate) fn expand(arguments: &ExpandArguments) -> Exit {
    let outcome = match checked(check, &arguments.fleet, Options::default()) {
        Ok(outcome) => outcome,
        Err(exit) => return exit,
    };
    eprint(&outcome.human(Severity::Error));
    let (Some(assembly), Some(first)) = (&outcome.made, outcome.first()) else {
        eprint(&format!("\n{}: nothing to expand\n", counted(outcome.count(Severity::Error), "error")));
        return Exit::WrongInput;
    };
    let text = Arc::new(expanded(assembly, first, outcome.diagnostics()));
    // In the layout of `saoms fmt`, so that what it writes needs no formatting.
    match xml::parse(FileId(0), &text).document {
        Some(document) => print(&Formatted { document: &document, width: WIDTH }),
        None => print(&text),
    }
    Exit::Done
}
