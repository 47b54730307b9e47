//! Libraries that were found and not named: none of their code runs.

use std::collections::HashSet;
use std::path::Path;

use crate::check::component::ComponentCheck;
use crate::check::fleet::{Fleet, Kind};
use crate::check::loops;
use crate::check::options::Options;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::source::Location;

/// Tells of each such library once, where the first component or loop needs it: an error for a fleet that is to start.
pub(super) fn check(fleet: &Fleet<'_>, checks: &[ComponentCheck<'_>], options: &Options, report: &mut Report<'_>) {
    if options.without_plugin_code {
        return;
    }
    let mut told: HashSet<&Path> = HashSet::new();
    for (member, check) in fleet.members.iter().zip(checks) {
        let Kind::Class(class) = member.kind else { continue };
        let (class, name) = (fleet.classes[class].class, member.component.class());
        let own = name.map(|name| (class.origin().filter(|_| class.is_only_read()), name.location));
        let of_loops = check.loops.iter().flat_map(loops::Resolved::changed);
        let of_loops = of_loops.map(|(class, of)| (class.origin().filter(|_| class.is_only_read()), of.at));
        for (library, at) in own.into_iter().chain(of_loops) {
            if let Some(library) = library.filter(|library| told.insert(library)) {
                report.about(member);
                report.push(diagnostic(library, at, options.is_to_start));
            }
        }
    }
    report.about_all();
}

fn diagnostic(library: &Path, at: Location, is_to_start: bool) -> Diagnostic {
    let message = format!("the code of {} does not run: no option names it", quoted(&library.display().to_string()));
    let one = Diagnostic::new(&codes::ONLY_READ, at, message);
    let name = format!("if you trust it, name it: `--plugin {}`", library.display());
    match is_to_start {
        true => one.help(name),
        false => one.severity(Severity::Note).help(format!("its constructors do not check the values; {name}")),
    }
}
