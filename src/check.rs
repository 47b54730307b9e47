//! `saoms check`: finds every mistake, starts nothing.

use saoms_core::check::Options;
use saoms_core::diagnostic::Severity;
use serde_json::{Value, json};

use crate::Exit;
use crate::arguments::{CheckArguments, CheckFormat};
use crate::fleet::checked;
use crate::output::{counted, eprint, print};
use crate::wiring;

pub(crate) fn check(arguments: &CheckArguments) -> Exit {
    let asked =
        Options { assume_classes: arguments.assume_classes, wiring: arguments.wiring, ..Options::default() };
    let outcome = match checked(&arguments.fleet, asked) {
        Ok(outcome) => outcome,
        Err(exit) => return exit,
    };
    let wired = outcome.assembly.as_ref().filter(|_| arguments.wiring);
    let wiring = wired.map(wiring::value);
    match arguments.format {
        CheckFormat::Json => print(&written(outcome.json(), wiring)),
        CheckFormat::Sarif => {
            let mut log = outcome.sarif();
            if let Some(wiring) = wiring {
                log["runs"][0]["properties"] = json!({ "wiring": wiring });
            }
            print(&written(log, None));
        }
        CheckFormat::Human => {
            eprint(&outcome.human(Severity::Note));
            if let Some(assembly) = wired {
                print(&wiring::text(assembly));
            }
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

/// JSON as text, with the wiring report in it where there is one.
fn written(mut value: Value, wiring: Option<Value>) -> String {
    if let Some(wiring) = wiring {
        value["wiring"] = wiring;
    }
    format!("{value:#}\n")
}
