//! The tables of `sca-contribution.xml` and of component types.

use super::{Kind, Known};

attributes! {
    COMPOSITE = required "composite" Composite: "Its name, with a prefix of its namespace.";
    LOCATION = known "location" Uri: "The folder of the contribution that it comes from.";
    PACKAGE = required "package" Text: "A package of classes.";
    NAMESPACE = required "namespace" Namespace: "The target namespace of composites.";
    NAME = required "name" Text: "The name under which files are exported.";
    FROM = required "location" Uri: "The folder of the contribution that it comes from.";
    PATH = known "path" Text: "The folder of the files, in the contribution.";
    URI = required "uri" Uri: "A file of the contribution.";
}

kinds! {
    /// The root of the file.
    pub CONTRIBUTION = "contribution": "What a folder of composites runs, gives to others and takes from them." {
        known "targetNamespace" Uri: "Often written, as in composites. It means nothing.";
    } ["deployable", "import", "import.java", "import.resource", "import.c", "import.cpp", "export",
        "export.java", "export.resource", "export.c", "export.cpp", "documentation", "extensions"]

    /// The root of a component type.
    pub(in crate::load) COMPONENT_TYPE = "componentType": "What the implementation of the same name offers, needs and can be told." {
        old "constrainingType" Text: "The type that this has to conform to. Not looked at.";
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
        doc: "What contributions take from each other.",
        attributes,
        children: &["documentation", "extensions"],
    }
}
