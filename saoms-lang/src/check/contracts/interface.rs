//! Interfaces that files name, held against those of classes.

use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{InterfaceElement, InterfaceKind, Part};
use crate::registry::InterfaceDeclaration;

/// Checks that the interface that a file names is that of the class.
pub(crate) fn check(
    given: Option<&InterfaceElement>,
    declared: &InterfaceDeclaration,
    of: &str,
    rule: &'static str,
    report: &mut Report<'_>,
) {
    let Some(given) = given else { return };
    let named = given.interface.as_ref();
    if named.is_some_and(|name| name.as_str() == declared.name && can_name(given.kind)) {
        return;
    }
    let (of, expected) = (quoted(of), quoted(&declared.name));
    let one = match &given.interface {
        Some(name) if can_name(given.kind) => {
            let message = format!("the interface of {of} is {expected}, not {}", quoted(name));
            Diagnostic::new(&codes::INTERFACE_DIFFERS, name.location, message)
                .replace(name, name.location, &declared.name)
        }
        // One without its name, which is reported.
        None if matches!(given.kind, InterfaceKind::Java | InterfaceKind::Rust) => return,
        _ => {
            let message = format!("the interface of {of} is {expected}, which this element cannot name");
            Diagnostic::new(&codes::INTERFACE_DIFFERS, given.tag(), message)
                .help(format!("write `<interface.java interface=\"{}\"/>`, or leave it out", declared.name))
        }
    };
    report.push(one.rule(rule));
}

/// True if elements of this kind can name an interface of a class.
const fn can_name(kind: InterfaceKind) -> bool {
    matches!(kind, InterfaceKind::Java | InterfaceKind::Rust | InterfaceKind::Other)
}
