//! `saoms check`: finds every mistake, starts nothing.

use saoms_core::check::Options;
use saoms_core::diagnostic::Severity;
use serde_json::{Value, json};

use crate::Exit;
use crate::arguments::{CheckArguments, CheckFormat};
use crate::folder::{Several, checked_each};
use crate::output::{counted, eprint, print};
use crate::wiring;

pub(crate) fn check(arguments: &CheckArguments) -> Exit {
    let asked =
        Options { assume_classes: arguments.assume_classes, wiring: arguments.wiring, ..Options::default() };
    let Several { checked: outcome, assemblies, fleets } = match checked_each(&arguments.fleet, asked) {
        Ok(outcome) => outcome,
        Err(exit) => return exit,
    };
    let wired = || assemblies.iter().filter(|_| arguments.wiring);
    let wiring = match (arguments.wiring, &assemblies[..]) {
        (false, _) | (true, []) => None,
        (true, [(_, only)]) if fleets == 1 => Some(wiring::value(only)),
        (true, _) => {
            let by_file = wired().map(|(path, one)| (path.display().to_string(), wiring::value(one)));
            Some(Value::Object(by_file.collect()))
        }
    };
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
            for (path, assembly) in wired() {
                if fleets > 1 {
                    print(&format!("{}\n", path.display()));
                }
                print(&wiring::text(assembly));
            }
            let errors = counted(outcome.count(Severity::Error), "error");
            let warnings = counted(outcome.count(Severity::Warning), "warning");
            let components = assemblies.iter().map(|(_, assembly)| assembly.components.len()).sum();
            let components = counted(components, "component");
            print(&match (fleets, assemblies.len()) {
                (2.., _) => format!("{fleets} fleets, {components}: {errors}, {warnings}\n"),
                (_, 1) => format!("{components}: {errors}, {warnings}\n"),
                _ => format!("{errors}, {warnings}\n"),
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
