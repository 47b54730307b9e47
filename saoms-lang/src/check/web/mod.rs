//! The web: services that are offered over HTTP, and references that lead to HTTP servers (`binding.rest`).

mod references;
mod services;

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::OperationSchema;
use crate::assembly::{WebService, WebTarget};
use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::check::wiring::WebEnds;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::AddressFault;
use crate::registry::InterfaceDeclaration;
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// What a fleet offers over the web and calls there, as far as it is right.
pub(crate) struct Web {
    /// The services of each component that are offered.
    pub(crate) services: BTreeMap<usize, Vec<WebService>>,
    /// Where references lead: by the component, and the place of the reference in its class.
    pub(crate) targets: BTreeMap<(usize, usize), Vec<WebTarget>>,
}

/// Checks what is offered over the web, and what is called there.
pub(crate) fn check(fleet: &Fleet<'_>, ends: &WebEnds<'_>, report: &mut Report<'_>) -> Web {
    let services = services::check(fleet, report);
    let targets = references::check(fleet, ends, report);
    references::tokens(fleet, report);
    services::unused_deadlines(fleet, report);
    Web { services, targets }
}

/// The operations of an interface, or why they cannot be shown as JSON.
fn operations(interface: &InterfaceDeclaration) -> Result<Arc<[OperationSchema]>, String> {
    let all = OperationSchema::all(interface).map_err(|error| error.to_string())?;
    if all.is_empty() {
        return Err("it has no operations".to_owned());
    }
    Ok(all.into())
}

/// The diagnostic of a wrong address.
fn wrong_address(text: &Text, at: Location, fault: AddressFault) -> Diagnostic {
    let message = format!("{} {}", quoted(text), fault.message);
    let one = Diagnostic::new(&codes::WEB_ADDRESS, at, message).help(fault.help);
    match fault.meant {
        Some(meant) => one.mend(format!("replace it with {}", quoted(&meant)), escaped(&meant)),
        None => one,
    }
}
