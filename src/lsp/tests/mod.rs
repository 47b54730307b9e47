//! Sessions, and the protocol's side of answers.

mod positions;
mod session;

/// A composite of 1.1 with this inside.
fn composite(inside: &str) -> String {
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" name=\"fleet\" targetNamespace=\"urn:f\">\n{inside}\n</composite>"
    )
}
