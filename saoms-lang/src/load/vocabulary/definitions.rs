//! The tables of `definitions.xml` (the XML schemas of SCA Policy 1.0 and 1.1, and of SCA Assembly for the types of bindings and implementations).

use super::elements::{known, new, required};
use super::{Holds, Kind, Known};

const NAME: Known = required("name", Holds::Name, "Its name, in the target namespace of the file.");
const INTENTS: Known = known("intents", Holds::Names, "The intents that are attached.");
const PROVIDES: Known = known("provides", Holds::Names, "The intents that it provides.");
const APPLIES_TO: Known = known("appliesTo", Holds::Text, "The elements that it can be for: an XPath.");

/// The root of the file.
pub(in crate::load) static DEFINITIONS: Kind = Kind {
    name: "definitions",
    doc: "Intents, policy sets, and the types of bindings and implementations.",
    attributes: &[known("targetNamespace", Holds::Namespace, "The namespace of the names that it gives.")],
    children: &[
        "intent",
        "policySet",
        "bindingType",
        "implementationType",
        "externalAttachment",
        "documentation",
    ],
};

/// The same in SCA 1.0, which has bindings for others to take over.
pub(in crate::load) static DEFINITIONS_1_0: Kind = Kind {
    children: &[
        "intent",
        "policySet",
        "bindingType",
        "implementationType",
        "externalAttachment",
        "binding.",
        "documentation",
    ],
    ..copy(&DEFINITIONS)
};

/// An intent.
pub(in crate::load) static INTENT: Kind = Kind {
    name: "intent",
    doc: "A requirement, by its name.",
    attributes: &[
        NAME,
        known("constrains", Holds::Names, "The elements that can require it."),
        known("requires", Holds::Names, "The intents that it stands for."),
        known("excludes", Holds::Names, "The intents that it cannot be together with."),
        new("mutuallyExclusive", Holds::Boolean, "Whether of its qualifiers only one can be asked for."),
        new("intentType", Holds::Text, "`interaction` or `implementation`."),
    ],
    children: &["description", "qualifier"],
};

/// An intent of SCA 1.0, whose qualifiers are intents of their own: `confidentiality.message`.
pub(in crate::load) static INTENT_1_0: Kind = Kind { children: &["description"], ..copy(&INTENT) };

/// A qualifier of an intent.
pub(in crate::load) static INTENT_QUALIFIER: Kind = Kind {
    name: "qualifier",
    doc: "One way to meet an intent.",
    attributes: &[NAME, known("default", Holds::Boolean, "Whether it is meant where none is said.")],
    children: &["description"],
};

/// A policy set.
pub(in crate::load) static POLICIES: Kind = Kind {
    name: "policySet",
    doc: "Policies that provide intents.",
    attributes: &[
        NAME,
        PROVIDES,
        APPLIES_TO,
        new("attachTo", Holds::Text, "The elements that it is attached to: an XPath."),
    ],
    children: &["policySetReference", "intentMap"],
};

/// A policy set of SCA 1.0, with the policies that its schema has.
pub(in crate::load) static POLICIES_1_0: Kind = Kind {
    attributes: &[NAME, PROVIDES, Known { required: true, ..APPLIES_TO }],
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
    ..copy(&POLICIES)
};

/// A policy set that another one takes over.
pub(in crate::load) static POLICY_SET_REFERENCE: Kind = Kind {
    name: "policySetReference",
    doc: "A policy set whose policies are taken over.",
    attributes: &[required("name", Holds::Names, "Its name, with a prefix of its namespace.")],
    children: &[],
};

/// The policies for the qualifiers of an intent.
pub(in crate::load) static INTENT_MAP: Kind = Kind {
    name: "intentMap",
    doc: "Policies for each qualifier of an intent.",
    attributes: &[
        required("provides", Holds::Names, "The intent."),
        known("default", Holds::Text, "In SCA 1.0 the qualifier that is meant where none is said."),
    ],
    children: &["qualifier"],
};

/// The policies for one qualifier.
pub(in crate::load) static MAP_QUALIFIER: Kind = Kind {
    name: "qualifier",
    doc: "The policies for one qualifier of an intent.",
    attributes: &[required("name", Holds::Text, "The qualifier.")],
    children: &[],
};

/// The same in SCA 1.0, where qualifiers have qualifiers.
pub(in crate::load) static MAP_QUALIFIER_1_0: Kind =
    Kind { children: &["intentMap"], ..copy(&MAP_QUALIFIER) };

const fn copy(kind: &Kind) -> Kind {
    Kind { name: kind.name, doc: kind.doc, attributes: kind.attributes, children: kind.children }
}

const TYPE_ATTRIBUTES: &[Known] = &[
    required("type", Holds::Names, "The element whose type it is, as `sca:binding.ws`."),
    known("alwaysProvides", Holds::Names, "The intents that it provides by itself."),
    known("mayProvide", Holds::Names, "The intents that it can provide."),
];

/// A type of bindings.
pub(in crate::load) static BINDING_TYPE: Kind = Kind {
    name: "bindingType",
    doc: "What bindings of a type provide by themselves.",
    attributes: TYPE_ATTRIBUTES,
    children: &["documentation"],
};

/// A type of implementations.
pub(in crate::load) static IMPLEMENTATION_TYPE: Kind = Kind {
    name: "implementationType",
    doc: "What implementations of a type provide by themselves.",
    attributes: TYPE_ATTRIBUTES,
    children: &["documentation"],
};

/// Intents and policy sets for parts of composites elsewhere.
pub(in crate::load) static ATTACHMENT: Kind = Kind {
    name: "externalAttachment",
    doc: "Attaches intents and policy sets to parts of composites.",
    attributes: &[
        INTENTS,
        known("policySets", Holds::Names, "The policy sets that are attached."),
        required("attachTo", Holds::Text, "The elements that they are attached to: an XPath."),
    ],
    children: &[],
};

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

/// The intents that SCA defines itself, in 1.0 or in 1.1 (SCA Policy 1.1, 8 to 11; SCA Policy 1.0, 1.7 and Transaction Policy 1.0; JMS Binding 1.1).
pub(in crate::load) const STANDARD_INTENTS: &[&str] = &[
    "authentication",
    "serverAuthentication",
    "clientAuthentication",
    "mutualAuthentication",
    "confidentiality",
    "integrity",
    "authorization",
    "fineGrainAuthorization",
    "atLeastOnce",
    "atMostOnce",
    "exactlyOnce",
    "ordered",
    "managedTransaction",
    "managedSharedTransaction",
    "noManagedTransaction",
    "propagatesTransaction",
    "suspendsTransaction",
    "transactedOneWay",
    "immediateOneWay",
    "conversational",
    "asyncInvocation",
    "noListener",
    "SOAP",
    "JMS",
    "EJB",
];
