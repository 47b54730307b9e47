//! `saoms check`: finds every mistake, starts nothing.

use saoms_core::diagnostic::Severity;

use crate::Exit;
use crate::arguments::{CheckArguments, CheckFormat};
use crate::fleet::checked;
use crate::output::{counted, eprint, print};

pub(crate) fn check(arguments: &CheckArguments) -> Exit {
    let outcome = match checked(&arguments.fleet, arguments.assume_classes) {
        Ok(outcome) => outcome,
        Err(exit) => return exit,
    };
    match arguments.format {
        CheckFormat::Json => print(&outcome.json()),
        CheckFormat::Sarif => print(&outcome.sarif()),
        CheckFormat::Human => {
            eprint(&outcome.human(Severity::Note));
            let errors = counted(outcome.count(Severity::Error), "error");
            let warnings = counted(outcome.count(Severity::Warning), "warning");
            print(&match &outcome.assembly {
                Some(assembly) => {
                    format!("{}: {errors}, {warnings}\n", counted(assembly.components.len(), "component"))
                }
                None => format!("{errors}, {warnings}\n"),
            });
        }
    }
    if outcome.count(Severity::Error) == 0 { Exit::Done } else { Exit::WrongInput }
}
