//! Classes in Python, which the plugin for Python has read.

use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::LibraryLink;
use crate::source::Text;

/// True if the class is in the registry. What keeps it from that is reported where the composite names it.
pub(super) fn is_declared(
    (module, class): (&Text, &Text),
    link: Option<&LibraryLink>,
    assume_classes: bool,
    report: &mut Report<'_>,
) -> bool {
    let push = |one: Diagnostic, report: &mut Report<'_>| {
        if !assume_classes {
            report.push(one);
        }
    };
    match link {
        Some(LibraryLink::To(_)) => return true,
        Some(LibraryLink::Undeclared(faults)) => {
            for fault in faults {
                let written = if fault.part == "module" { module } else { class };
                let mut one = Diagnostic::new(&codes::LIBRARY, written.location, fault.message.as_str());
                for meant in &fault.instead {
                    one = one.replace(written, written.location, meant);
                }
                push(fault.help.iter().fold(one, |one, help| one.help(help.as_str())), report);
            }
        }
        Some(LibraryLink::Faulty(message)) => {
            push(Diagnostic::new(&codes::LIBRARY, module.location, message.as_str()), report);
        }
        Some(LibraryLink::Outside(_) | LibraryLink::Missing(_)) | None => {
            let message = format!("no plugin runs {}", quoted("implementation.python"));
            let one = Diagnostic::new(&codes::LIBRARY, module.location, message);
            push(
                one.help(
                    "it is `libsaoms_python.so`, of `cargo build --release -p saoms-python`: put it beside the command or \
                    into `lib/saoms`, or name it with `--plugin`",
                ),
                report,
            );
        }
    }
    false
}
