//! The tables of `sca-contribution.xml`, of component types, and of `definitions.xml`.

use super::{Holds, Kind, Known};

attributes! {
    COMPOSITE = required "composite" Composite: "The name of the composite, with a prefix of its namespace.";
    LOCATION = known "location" Uri: "The folder of the contribution that exports it.";
    PACKAGE = required "package" Text: "A package of classes.";
    NAMESPACE = required "namespace" Namespace: "The target namespace of composites.";
    NAME = required "name" Text: "The name under which files are exported.";
    FROM = required "location" Uri: "The folder of the contribution that exports it.";
    PATH = known "path" Text: "The folder of the files in the contribution.";
    URI = required "uri" Uri: "A file of the contribution.";
}

kinds! {
    /// The root of the file.
    pub CONTRIBUTION = "contribution": "Describes a folder of composites: what it runs, exports and imports." {
        known "targetNamespace" Uri: "Allowed as in composites. SAOMS ignores it.";
    } ["deployable", "import", "import.java", "import.resource", "import.c", "import.cpp", "export",
        "export.java", "export.resource", "export.c", "export.cpp", "documentation", "extensions"]

    /// The root of a component type.
    pub(in crate::load) COMPONENT_TYPE = "componentType": "Describes the services, references and properties of the implementation of the same name." {
        old "constrainingType" Text: "The type that this has to conform to. SAOMS ignores it.";
        known "requires" Names: "The intents of policies that apply.";
        known "policySets" Names: "The policy sets that apply.";
    } ["implementation.", "service", "reference", "property", "requires", "policySetAttachment",
        "documentation", "extensions"]
}

/// The elements of a contribution that have attributes.
pub(super) static PARTS: [Kind; 11] = [
    Kind { doc: "A composite that runs by itself.", ..part("deployable", &[COMPOSITE]) },
    part("import", &[NAMESPACE, LOCATION]),
    part("import.java", &[PACKAGE, LOCATION]),
    part("import.resource", &[URI, LOCATION]),
    part("import.c", &[NAME, FROM]),
    part("import.cpp", &[NAME, FROM]),
    part("export.c", &[NAME, PATH]),
    part("export.cpp", &[NAME, PATH]),
    part("export", &[NAMESPACE]),
    part("export.java", &[PACKAGE]),
    part("export.resource", &[URI]),
];

const fn part(name: &'static str, attributes: &'static [Known]) -> Kind {
    Kind {
        name,
        doc: "What contributions share with each other.",
        attributes,
        children: &["documentation", "extensions"],
    }
}

/// The root of `definitions.xml`. Of this file, names alone are looked at, as the XML schemas of SCA Policy 1.0 or 1.1
/// allow them.
pub(crate) static DEFINITIONS: Kind = definition_of(
    "definitions",
    &[any("targetNamespace")],
    &["intent", "policySet", "bindingType", "implementationType", "externalAttachment", "binding.", "documentation"],
);

static DEFINITION_PARTS: [Kind; 8] = [
    definition_of(
        "intent",
        &[
            needed("name"),
            any("constrains"),
            any("requires"),
            any("excludes"),
            any("mutuallyExclusive"),
            any("intentType"),
        ],
        &["description", "qualifier"],
    ),
    definition_of("qualifier", &[needed("name"), any("default")], &["description", "intentMap"]),
    definition_of(
        "policySet",
        &[needed("name"), any("provides"), any("appliesTo"), any("attachTo")],
        &[
            "policySetReference", "intentMap", "allow", "permitAll", "denyAll", "runAs", "authorization",
            "securityIdentity",
        ],
    ),
    definition_of("policySetReference", &[needed("name")], &[]),
    definition_of("intentMap", &[needed("provides"), any("default")], &["qualifier"]),
    definition_of("bindingType", &[needed("type"), any("alwaysProvides"), any("mayProvide")], &["documentation"]),
    definition_of(
        "implementationType",
        &[needed("type"), any("alwaysProvides"), any("mayProvide")],
        &["documentation"],
    ),
    definition_of("externalAttachment", &[any("intents"), any("policySets"), needed("attachTo")], &[]),
];

const fn definition_of(name: &'static str, attributes: &'static [Known], children: &'static [&'static str]) -> Kind {
    Kind { name, doc: "", attributes, children }
}

const fn any(name: &'static str) -> Known {
    super::known(name, Holds::Text, "")
}

const fn needed(name: &'static str) -> Known {
    super::required(name, Holds::Text, "")
}

/// The element of this name inside, where its parts are known.
pub(in crate::load) fn definition(name: &str) -> Option<&'static Kind> {
    DEFINITION_PARTS.iter().find(|kind| kind.name == name)
}

/// True if an element stands in `definitions.xml` alone.
pub(in crate::load) fn is_of_definitions(name: &str) -> bool {
    name != "qualifier" && definition(name).is_some()
}
