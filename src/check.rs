//! `saoms check`: finds every mistake, starts nothing.

use std::mem::ManuallyDrop;
use std::path::Path;

use saoms_core::assembly::Assembly;
use saoms_core::check::Options;
use saoms_core::diagnostic::Severity;
use serde::ser::{Serialize, SerializeMap, Serializer};
use serde_json::Value;

use crate::Exit;
use crate::arguments::{CheckArguments, CheckFormat};
use crate::folder::{Several, checked_each};
use crate::output::{counted, eprint, print, print_json};
use crate::wiring::Wiring;

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
    let wired: Vec<(&Path, Wiring<'_>)> =
        made.iter().filter_map(|(path, made)| Some((path.as_path(), Wiring(assembly(made)?)))).collect();
    let wiring = Wired { of: &wired, is_one: *fleets == 1 };
    match format {
        CheckFormat::Json if wired.is_empty() => print_json(&outcome.json()),
        CheckFormat::Json => print_json(&With(&outcome.json(), "wiring", wiring)),
        CheckFormat::Sarif if wired.is_empty() => print_json(&outcome.sarif()),
        CheckFormat::Sarif => {
            let mut log = outcome.sarif();
            let run = log["runs"][0].take();
            let properties = With(&Value::Null, "wiring", wiring);
            print_json(&With(&log, "runs", [With(&run, "properties", properties)]));
        }
        CheckFormat::Human => {
            eprint(&outcome.human(Severity::Note));
            for (path, wiring) in &wired {
                if *fleets > 1 {
                    print(&format!("{}\n", path.display()));
                }
                print(wiring);
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

/// An object in which one entry is another one.
struct With<'a, T>(&'a Value, &'static str, T);

impl<T: Serialize> Serialize for With<'_, T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let With(object, name, value) = self;
        let mut all = to.serialize_map(None)?;
        for (key, value) in object.as_object().into_iter().flatten().filter(|(key, _)| key != name) {
            all.serialize_entry(key, value)?;
        }
        all.serialize_entry(name, value)?;
        all.end()
    }
}

/// The wiring of several fleets, each by its first file; that of one alone.
struct Wired<'a> {
    of: &'a [(&'a Path, Wiring<'a>)],
    is_one: bool,
}

impl Serialize for Wired<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.of {
            [(_, only)] if self.is_one => only.serialize(to),
            all => to.collect_map(all.iter().map(|(path, wiring)| (path.display().to_string(), wiring))),
        }
    }
}
