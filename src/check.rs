//! `saoms check`: finds every mistake, starts nothing.

use std::mem::ManuallyDrop;
use std::path::Path;

use saoms_core::assembly::Assembly;
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
    let (fleet, format) = (&arguments.fleet, arguments.format);
    let exit = match arguments.wiring {
        true => checked_each(fleet, asked, saoms_core::check::check)
            .map(|several| tell(&several, |one| one.components.len(), |one| Some(one), format)),
        false => checked_each(fleet, asked, saoms_core::check::count).map(|several| {
            // The process ends here: taking a large model apart takes as long as checking some of it.
            tell(&ManuallyDrop::new(several), |count| *count, |_| None, format)
        }),
    };
    exit.unwrap_or_else(|exit| exit)
}

/// Writes what was found, with the wiring report where there are assemblies.
fn tell<T>(
    several: &Several<T>,
    components: impl Fn(&T) -> usize,
    assembly: impl Fn(&T) -> Option<&Assembly>,
    format: CheckFormat,
) -> Exit {
    let Several { checked: outcome, made, fleets } = several;
    let wired: Vec<(&Path, &Assembly)> =
        made.iter().filter_map(|(path, made)| Some((path.as_path(), assembly(made)?))).collect();
    let wiring = match wired[..] {
        [] => None,
        [(_, only)] if *fleets == 1 => Some(wiring::value(only)),
        _ => {
            let by_file = wired.iter().map(|(path, one)| (path.display().to_string(), wiring::value(one)));
            Some(Value::Object(by_file.collect()))
        }
    };
    match format {
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
            for (path, assembly) in wired {
                if *fleets > 1 {
                    print(&format!("{}\n", path.display()));
                }
                print(&wiring::text(assembly));
            }
            let errors = counted(outcome.count(Severity::Error), "error");
            let warnings = counted(outcome.count(Severity::Warning), "warning");
            let components = made.iter().map(|(_, made)| components(made)).sum();
            let components = counted(components, "component");
            print(&match (*fleets, made.len()) {
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
