//! Bindings of SCA at services of components that say where the service is.

use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Part, ServiceElement, Version};

/// Reports a `uri` of `binding.sca`. In SCA 1.0 it is where the service can be reached from outside.
pub(crate) fn check(service: &ServiceElement, version: Version, report: &mut Report<'_>) {
    let of_sca = service.bindings().iter().filter(|binding| binding.is_sca && binding.kind == "sca");
    for binding in of_sca.filter(|_| version.is_1_1()) {
        if let Some(uri) = &binding.uri {
            let message = format!("`binding.sca` of service {} has a `uri`", quoted(&service.name));
            let one = Diagnostic::new(
                &codes::SERVICE_BINDING_URI,
                if uri.is_empty() { binding.tag() } else { uri.location },
                message,
            );
            report.push(one.help("remove it: a service is where its component is, and references name that"));
        }
    }
}
