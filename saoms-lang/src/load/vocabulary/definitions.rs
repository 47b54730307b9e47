//! The elements of `definitions.xml`, as the XML schemas of SCA Policy 1.0 or 1.1 allow them.

use super::elements::{known, required};
use super::{Holds, Kind, Known};

const NAME: Known = required("name", Holds::Name, "Its name, in the target namespace of the file.");
const PROVIDES: Known = known("provides", Holds::Names, "The intents that it provides.");
const ATTACH_TO: Known = known("attachTo", Holds::Text, "The elements that it is attached to: an XPath.");
const TYPE_ATTRIBUTES: &[Known] = &[
    required("type", Holds::Names, "The element whose type it is, as `sca:binding.ws`."),
    known("alwaysProvides", Holds::Names, "The intents that it provides by itself."),
    known("mayProvide", Holds::Names, "The intents that it can provide."),
];

/// The root of the file.
pub(crate) static DEFINITIONS: Kind = Kind {
    name: "definitions",
    doc: "Intents, policy sets, and the types of bindings and implementations.",
    attributes: &[known("targetNamespace", Holds::Namespace, "The namespace of the names that it gives.")],
    children: &[
        "intent",
        "policySet",
        "bindingType",
        "implementationType",
        "externalAttachment",
        "binding.",
        "documentation",
    ],
};

/// The elements inside.
static PARTS: [Kind; 8] = [
    Kind {
        name: "intent",
        doc: "A requirement, by its name.",
        attributes: &[
            NAME,
            known("constrains", Holds::Names, "The elements that can require it."),
            known("requires", Holds::Names, "The intents that it stands for."),
            known("excludes", Holds::Names, "The intents that it cannot be together with."),
            known(
                "mutuallyExclusive",
                Holds::Boolean,
                "Whether only one of its qualifiers can be asked for.",
            ),
            known("intentType", Holds::Text, "`interaction` or `implementation`."),
        ],
        children: &["description", "qualifier"],
    },
    Kind {
        name: "qualifier",
        doc: "One way to meet an intent, or the policies for it.",
        attributes: &[NAME, known("default", Holds::Boolean, "Whether it is meant where none is said.")],
        children: &["description", "intentMap"],
    },
    Kind {
        name: "policySet",
        doc: "Policies that provide intents.",
        attributes: &[
            NAME,
            PROVIDES,
            known("appliesTo", Holds::Text, "The elements that it can be for: an XPath."),
            ATTACH_TO,
        ],
        children: &[
            "policySetReference",
            "intentMap",
            "allow",
            "permitAll",
            "denyAll",
            "runAs",
            "authorization",
            "securityIdentity",
        ],
    },
    Kind {
        name: "policySetReference",
        doc: "A policy set whose policies are taken over.",
        attributes: &[required("name", Holds::Names, "Its name, with a prefix of its namespace.")],
        children: &[],
    },
    Kind {
        name: "intentMap",
        doc: "Policies for each qualifier of an intent.",
        attributes: &[
            required("provides", Holds::Names, "The intent."),
            known("default", Holds::Text, "In SCA 1.0 the qualifier that is meant where none is said."),
        ],
        children: &["qualifier"],
    },
    Kind {
        name: "bindingType",
        doc: "What bindings of a type provide by themselves.",
        attributes: TYPE_ATTRIBUTES,
        children: &["documentation"],
    },
    Kind {
        name: "implementationType",
        doc: "What implementations of a type provide by themselves.",
        attributes: TYPE_ATTRIBUTES,
        children: &["documentation"],
    },
    Kind {
        name: "externalAttachment",
        doc: "Attaches intents and policy sets to parts of composites.",
        attributes: &[
            known("intents", Holds::Names, "The intents that are attached."),
            known("policySets", Holds::Names, "The policy sets that are attached."),
            Known { required: true, ..ATTACH_TO },
        ],
        children: &[],
    },
];

/// The element of this name, where its parts are known.
pub(in crate::load) fn definition(name: &str) -> Option<&'static Kind> {
    PARTS.iter().find(|kind| kind.name == name)
}

/// Elements that stand in `definitions.xml` alone.
pub(in crate::load) const IN_DEFINITIONS: &[&str] = &[
    "intent",
    "policySet",
    "policySetReference",
    "intentMap",
    "bindingType",
    "implementationType",
    "externalAttachment",
];
