//! What SCA's elements can have and hold (the XML schemas of SCA 1.0 and SCA Assembly 1.1).
//!
//! Where the schemas of the two versions differ and both could be meant, what either allows is known.

use crate::model::Version;

/// An element that is checked.
#[derive(Debug)]
pub(super) struct Kind {
    /// Its name.
    pub(super) name: &'static str,
    /// Its attributes.
    pub(super) attributes: &'static [Known],
    /// The SCA elements that it can hold; a name that ends with a dot stands for all that start so.
    pub(super) children: &'static [&'static str],
}

/// An attribute that is known.
#[derive(Debug)]
pub(super) struct Known {
    pub(super) name: &'static str,
    /// Whether it is of 1.0 alone: a mistake in 1.1. Those of 1.1 alone are understood in 1.0 as well.
    only_1_0: bool,
}

impl Kind {
    /// Whether an element of this version has the attribute.
    pub(super) fn has(&self, name: &str, version: Version) -> bool {
        self.attributes.iter().any(|known| known.name == name && !(known.only_1_0 && version.is_1_1()))
    }

    /// The names of the attributes in this version.
    pub(super) fn names(&self, version: Version) -> impl Iterator<Item = &'static str> {
        self.attributes
            .iter()
            .filter(move |known| !(known.only_1_0 && version.is_1_1()))
            .map(|known| known.name)
    }
}

const fn known(name: &'static str) -> Known {
    Known { name, only_1_0: false }
}

const fn old(name: &'static str) -> Known {
    Known { name, only_1_0: true }
}

const REQUIRES: Known = known("requires");
const POLICY_SETS: Known = known("policySets");

pub(super) static COMPOSITE: Kind = Kind {
    name: "composite",
    attributes: &[
        known("name"),
        known("targetNamespace"),
        known("local"),
        known("autowire"),
        old("constrainingType"),
        REQUIRES,
        POLICY_SETS,
    ],
    children: &[
        "component",
        "property",
        "service",
        "reference",
        "wire",
        "include",
        "requires",
        "policySetAttachment",
        "documentation",
        "extensions",
    ],
};

pub(super) static INCLUDE: Kind =
    Kind { name: "include", attributes: &[known("name"), known("uri")], children: &["documentation"] };

pub(super) static WIRE: Kind = Kind {
    name: "wire",
    attributes: &[known("source"), known("target"), known("replace")],
    children: &["documentation", "extensions"],
};

pub(super) static COMPONENT: Kind = Kind {
    name: "component",
    attributes: &[known("name"), known("autowire"), old("constrainingType"), REQUIRES, POLICY_SETS],
    children: &[
        "implementation.",
        "property",
        "service",
        "reference",
        "requires",
        "policySetAttachment",
        "documentation",
        "extensions",
    ],
};

/// Of SAOMS, not of SCA.
pub(super) static LOOP: Kind = Kind {
    name: "loop",
    attributes: &[known("name"), known("class"), known("before"), known("after"), known("remove")],
    children: &["property", "documentation"],
};

const CONTRACT: &[&str] = &[
    "interface.",
    "binding.",
    "callback",
    "operation",
    "requires",
    "policySetAttachment",
    "documentation",
    "extensions",
];

pub(super) static COMPONENT_SERVICE: Kind =
    Kind { name: "service", attributes: &[known("name"), REQUIRES, POLICY_SETS], children: CONTRACT };

pub(super) static COMPOSITE_SERVICE: Kind = Kind {
    name: "service",
    attributes: &[known("name"), known("promote"), REQUIRES, POLICY_SETS],
    children: CONTRACT,
};

pub(super) static COMPONENT_REFERENCE: Kind = Kind {
    name: "reference",
    attributes: &[
        known("name"),
        known("target"),
        known("multiplicity"),
        known("autowire"),
        known("wiredByImpl"),
        known("nonOverridable"),
        REQUIRES,
        POLICY_SETS,
    ],
    children: CONTRACT,
};

pub(super) static COMPOSITE_REFERENCE: Kind = Kind {
    name: "reference",
    attributes: &[
        known("name"),
        known("promote"),
        known("target"),
        known("multiplicity"),
        old("autowire"),
        known("wiredByImpl"),
        REQUIRES,
        POLICY_SETS,
    ],
    children: CONTRACT,
};

pub(super) static COMPONENT_PROPERTY: Kind = Kind {
    name: "property",
    attributes: &[
        known("name"),
        known("value"),
        known("type"),
        known("element"),
        known("many"),
        known("source"),
        known("file"),
        old("mustSupply"),
    ],
    children: &["value"],
};

pub(super) static COMPOSITE_PROPERTY: Kind = Kind {
    name: "property",
    attributes: &[
        known("name"),
        known("value"),
        known("type"),
        known("element"),
        known("many"),
        known("mustSupply"),
    ],
    children: &["value"],
};

pub(super) static CALLBACK: Kind = Kind {
    name: "callback",
    attributes: &[known("name"), REQUIRES, POLICY_SETS],
    children: &["binding.", "requires", "policySetAttachment", "documentation", "extensions"],
};

const POLICY_CHILDREN: &[&str] =
    &["operation", "requires", "policySetAttachment", "documentation", "extensions"];

const INTERFACE_ATTRIBUTES: &[Known] =
    &[known("interface"), known("callbackInterface"), known("remotable"), REQUIRES, POLICY_SETS];

pub(super) static INTERFACE_JAVA: Kind =
    Kind { name: "interface.java", attributes: INTERFACE_ATTRIBUTES, children: POLICY_CHILDREN };

pub(super) static INTERFACE_RUST: Kind =
    Kind { name: "interface.rust", attributes: INTERFACE_ATTRIBUTES, children: POLICY_CHILDREN };

pub(super) static INTERFACE_WSDL: Kind =
    Kind { name: "interface.wsdl", attributes: INTERFACE_ATTRIBUTES, children: POLICY_CHILDREN };

pub(super) static IMPLEMENTATION_JAVA: Kind = Kind {
    name: "implementation.java",
    attributes: &[known("class"), REQUIRES, POLICY_SETS],
    children: POLICY_CHILDREN,
};

pub(super) static IMPLEMENTATION_COMPOSITE: Kind = Kind {
    name: "implementation.composite",
    attributes: &[known("name"), REQUIRES, POLICY_SETS],
    children: POLICY_CHILDREN,
};

pub(super) static IMPLEMENTATION_RUST: Kind = Kind {
    name: "implementation.rust",
    attributes: &[known("class"), known("library"), REQUIRES, POLICY_SETS],
    children: POLICY_CHILDREN,
};

pub(super) static BINDING_SCA: Kind = Kind {
    name: "binding.sca",
    attributes: &[known("name"), known("uri"), REQUIRES, POLICY_SETS],
    children: &[
        "operation",
        "wireFormat.",
        "operationSelector.",
        "requires",
        "policySetAttachment",
        "documentation",
        "extensions",
    ],
};

/// Kinds of implementations, interfaces and bindings that SCA defines.
pub(super) const VARIANTS: &[(&str, &[&str])] = &[
    (
        "implementation.",
        &[
            "implementation.java",
            "implementation.composite",
            "implementation.rust",
            "implementation.bpel",
            "implementation.spring",
            "implementation.ejb",
            "implementation.jee",
            "implementation.web",
            "implementation.c",
            "implementation.cpp",
        ],
    ),
    (
        "interface.",
        &[
            "interface.java",
            "interface.rust",
            "interface.wsdl",
            "interface.c",
            "interface.cpp",
            "interface.partnerLinkType",
        ],
    ),
    ("binding.", &["binding.sca", "binding.ws", "binding.jms", "binding.jca", "binding.ejb"]),
    ("wireFormat.", &["wireFormat.jmsDefault", "wireFormat.jmsdefault"]),
    ("operationSelector.", &["operationSelector.jmsDefault", "operationSelector.jmsdefault"]),
];

/// The attributes that SAOMS adds in its own namespace, each with the element that has it.
pub(super) const OWN_ATTRIBUTES: &[(&str, &str)] = &[("component", "path")];

/// The elements that SAOMS adds in its own namespace.
pub(super) const OWN_ELEMENTS: &[&str] = &["implementation.rust", "interface.rust", "loop"];

/// The elements that `kind` can hold, all variants by name.
pub(super) fn children(kind: &Kind) -> impl Iterator<Item = &'static str> {
    kind.children.iter().flat_map(|child| {
        match VARIANTS.iter().find(|(prefix, _)| prefix == child) {
            Some((_, variants)) => *variants,
            None => std::slice::from_ref(child),
        }
        .iter()
        .copied()
    })
}

/// Whether SCA has an element of this name somewhere in a composite.
pub(super) fn is_known(name: &str) -> bool {
    let all = [&COMPOSITE, &COMPONENT, &COMPONENT_SERVICE, &BINDING_SCA, &COMPONENT_PROPERTY];
    name == "composite" || all.into_iter().flat_map(children).any(|known| known == name)
}
