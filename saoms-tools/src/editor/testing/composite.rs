//! A composite for tests, also for those of the language server of the command.

/// A composite of 1.1 with this inside.
pub(crate) fn composite(inside: &str) -> String {
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" name=\"fleet\" \
         targetNamespace=\"urn:f\">\n{inside}\n</composite>"
    )
}
