//! The tables of `sca-contribution.xml` and of component types.

use super::elements::{known, old, required};
use super::{Holds, Kind, Known};

const LOCATION: Known = known("location", Holds::Uri, "The folder of the contribution that it comes from.");
const PACKAGE: Known = required("package", Holds::Text, "A package of classes.");
const NAMESPACE: Known = required("namespace", Holds::Namespace, "The target namespace of composites.");
const NAME: Known = required("name", Holds::Text, "The name under which files are exported.");
const FROM: Known = required("location", Holds::Uri, "The folder of the contribution that it comes from.");
const PATH: Known = known("path", Holds::Text, "The folder of the files, in the contribution.");
const URI: Known = required("uri", Holds::Uri, "A file of the contribution.");

/// The root of the file.
pub static CONTRIBUTION: Kind = Kind {
    name: "contribution",
    doc: "What a folder of composites runs, gives to others and takes from them.",
    attributes: &[known("targetNamespace", Holds::Uri, "Often written, as in composites. It means nothing.")],
    children: &[
        "deployable",
        "import",
        "import.java",
        "import.resource",
        "import.c",
        "import.cpp",
        "export",
        "export.java",
        "export.resource",
        "export.c",
        "export.cpp",
        "documentation",
        "extensions",
    ],
};

/// The root of a component type.
pub(in crate::load) static COMPONENT_TYPE: Kind = Kind {
    name: "componentType",
    doc: "What the implementation of the same name offers, needs and can be told.",
    attributes: &[
        old("constrainingType", Holds::Text, "The type that this has to conform to. Not looked at."),
        known("requires", Holds::Names, "The intents of policies that apply."),
        known("policySets", Holds::Names, "The policy sets that apply."),
    ],
    children: &[
        "implementation.",
        "service",
        "reference",
        "property",
        "requires",
        "policySetAttachment",
        "documentation",
        "extensions",
    ],
};

/// The elements of a contribution that have attributes.
pub(super) static PARTS: [Kind; 11] = [
    Kind {
        name: "deployable",
        doc: "A composite that runs by itself.",
        attributes: &[required("composite", Holds::Composite, "Its name, with a prefix of its namespace.")],
        children: &["documentation", "extensions"],
    },
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
