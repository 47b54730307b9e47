//! The language of composites as XML schemas, for editors that know XML and not SAOMS.
//!
//! A schema has one namespace, so there is one for each version of SCA and one for what SAOMS adds, which the others
//! import. It holds the names of all classes, properties, services, references, interfaces and loops of a registry as
//! well, each documented.
//!
//! In XSD 1.0 the type of an element cannot depend on an attribute, and what properties a component has depends on the
//! attribute `class` of another element. So these names are enumerations in a union with any name: an editor offers and
//! explains them, and refuses none that a composite of somebody else could have. What values they take is said in their
//! documentation. XSD 1.1 has assertions, which hold components to the properties of their classes, too; few editors
//! read it.

mod assertions;
mod catalog;
mod node;
mod own;
mod sca;
#[cfg(test)]
mod tests;
mod words;

pub use catalog::catalog;

use self::node::{Documented, NewElement};
use self::words::Words;
use saoms_lang::model::{SAOMS_NAMESPACE, Version};
use saoms_lang::registry::Registry;

/// A schema, which is one file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct XsdSchema {
    /// The name of the file; schemas refer to each other by these names.
    pub file: &'static str,
    /// The namespace that it describes.
    pub namespace: &'static str,
    /// The text of the file.
    pub text: String,
}

/// A version of XML Schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Xsd {
    /// The version that every editor reads.
    V1_0,
    /// With assertions: each component has the properties of its class, with values that these take.
    V1_1,
}

/// The file of what SAOMS adds.
const OWN_FILE: &str = "saoms.xsd";

/// The schemas of all namespaces, with the classes and loops of this registry.
///
/// ```
/// use saoms_lang::registry::Registry;
/// use saoms_tools::xsd::{Xsd, schemas};
///
/// let all = schemas(&Registry::new(), Xsd::V1_0);
/// let files: Vec<&str> = all.iter().map(|schema| schema.file).collect();
/// assert_eq!(files, ["sca-1.1.xsd", "sca-1.1-draft.xsd", "sca-1.0.xsd", "saoms.xsd"]);
/// assert!(all[0].text.contains("targetNamespace=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\""));
/// ```
pub fn schemas(registry: &Registry, xsd: Xsd) -> Vec<XsdSchema> {
    let sca = Version::ALL.map(|version| {
        let assertions = match xsd {
            Xsd::V1_0 => Vec::new(),
            Xsd::V1_1 => assertions::of_components(registry, version),
        };
        let text = sca::schema(version, assertions).document();
        XsdSchema { file: file(version), namespace: version.namespace(), text }
    });
    let own =
        XsdSchema { file: OWN_FILE, namespace: SAOMS_NAMESPACE, text: own::schema(&Words::of(registry)).document() };
    sca.into_iter().chain([own]).collect()
}

fn file(version: Version) -> &'static str {
    match version {
        Version::Osoa10 => "sca-1.0.xsd",
        Version::Oasis200903 => "sca-1.1-draft.xsd",
        Version::Oasis200912 => "sca-1.1.xsd",
    }
}

/// The root of a schema.
fn root(namespace: &str, doc: &str) -> NewElement {
    NewElement::new("xs:schema")
        .with("xmlns:xs", "http://www.w3.org/2001/XMLSchema")
        .with("xmlns:saoms", SAOMS_NAMESPACE)
        .with("targetNamespace", namespace)
        .with("elementFormDefault", "qualified")
        .doc(doc)
}
