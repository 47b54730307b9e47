//! The tables.

use super::{Holds, Kind, Known};

pub(super) const fn known(name: &'static str, holds: Holds, doc: &'static str) -> Known {
    Known { name, holds, doc, required: false, only_1_0: false, only_1_1: false }
}

pub(super) const fn required(name: &'static str, holds: Holds, doc: &'static str) -> Known {
    Known { required: true, ..known(name, holds, doc) }
}

pub(super) const fn old(name: &'static str, holds: Holds, doc: &'static str) -> Known {
    Known { only_1_0: true, ..known(name, holds, doc) }
}

pub(super) const fn new(name: &'static str, holds: Holds, doc: &'static str) -> Known {
    Known { only_1_1: true, ..known(name, holds, doc) }
}

const REQUIRES: Known = known("requires", Holds::Names, "The intents of policies that apply.");
const POLICY_SETS: Known = known("policySets", Holds::Names, "The policy sets that apply.");
const AUTOWIRE: Known = known(
    "autowire",
    Holds::Boolean,
    "Whether references without a target are wired to services that fit them; what is said further inside wins.",
);
const CONSTRAINING_TYPE: Known =
    old("constrainingType", Holds::Text, "The type that this has to conform to. Not looked at.");
const MULTIPLICITY: Known = known(
    "multiplicity",
    Holds::Multiplicity,
    "How many targets the reference takes: at least 0 or 1, at most 1 or n. As the class says unless given; it may narrow that only.",
);
const WIRED_BY_IMPL: Known = known(
    "wiredByImpl",
    Holds::Boolean,
    "Whether the implementation finds the targets itself at run time; nothing here may wire it then.",
);
const TARGET: Known = known(
    "target",
    Holds::Ends,
    "The components that the reference calls, or their services as `Component/service`, between blanks.",
);

/// The root of a file.
pub static COMPOSITE: Kind = Kind {
    name: "composite",
    doc: "Components, what they are told by properties, and how they are wired: a fleet, or a part of one.",
    attributes: &[
        required(
            "name",
            Holds::Name,
            "The composite's name. Others refer to it by its target namespace and this name.",
        ),
        known(
            "targetNamespace",
            Holds::Namespace,
            "The namespace of the composite's name, such as `urn:example:fleet`.",
        ),
        known(
            "local",
            Holds::Boolean,
            "Whether its components have to run together in one process; a local composite is included by local ones only.",
        ),
        AUTOWIRE,
        CONSTRAINING_TYPE,
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

/// An include in a composite.
pub static INCLUDE: Kind = Kind {
    name: "include",
    doc: "Puts everything in another composite here, as if it were written here.",
    attributes: &[
        required(
            "name",
            Holds::Composite,
            "The name of the composite, with a prefix of its target namespace.",
        ),
        known("uri", Holds::Uri, "Where it is. Composites are found by their names."),
    ],
    children: &["documentation"],
};

/// A wire in a composite.
pub static WIRE: Kind = Kind {
    name: "wire",
    doc: "Connects a reference of one component to a service of another one, as `target` of the reference does.",
    attributes: &[
        required("source", Holds::End, "The reference that calls: `Component/reference`."),
        required("target", Holds::End, "The service that is called: `Component`, or `Component/service`."),
        new(
            "replace",
            Holds::Boolean,
            "Whether this wire takes the place of the targets that the reference names itself.",
        ),
    ],
    children: &["documentation", "extensions"],
};

/// A component in a composite.
pub static COMPONENT: Kind = Kind {
    name: "component",
    doc: "One instance of a class, or of a whole composite, with values for its properties and targets for its references.",
    attributes: &[
        required("name", Holds::Name, "The component's name, which no other one in this composite has."),
        AUTOWIRE,
        CONSTRAINING_TYPE,
        REQUIRES,
        POLICY_SETS,
    ],
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

/// A loop of a component: of SAOMS, not of SCA.
pub static LOOP: Kind = Kind {
    name: "loop",
    doc: "Adds a loop to the component, or replaces, moves, removes or parametrises one that its class brings.",
    attributes: &[
        required(
            "name",
            Holds::LoopName,
            "The loop's name within the component; that of a loop it has already changes that one.",
        ),
        known(
            "class",
            Holds::LoopClass,
            "The class of a loop that is added, or that takes the place of the one of this name.",
        ),
        known("before", Holds::LoopName, "The loop directly before which it stands."),
        known("after", Holds::LoopName, "The loop directly behind which it stands."),
        known("remove", Holds::Boolean, "Whether the loop of this name is removed."),
    ],
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

/// A service of a component.
pub static COMPONENT_SERVICE: Kind = Kind {
    name: "service",
    doc: "Says more about a service that the component's class offers.",
    attributes: &[
        required("name", Holds::ServiceName, "The service's name, as the class has it."),
        REQUIRES,
        POLICY_SETS,
    ],
    children: CONTRACT,
};

/// A service of a composite.
pub static COMPOSITE_SERVICE: Kind = Kind {
    name: "service",
    doc: "A service that the composite offers: that of a component in it.",
    attributes: &[
        required("name", Holds::Name, "The service's name, by which the composite's users know it."),
        required(
            "promote",
            Holds::End,
            "The component in this composite, or its service as `Component/service`.",
        ),
        REQUIRES,
        POLICY_SETS,
    ],
    children: CONTRACT,
};

/// A reference of a component.
pub static COMPONENT_REFERENCE: Kind = Kind {
    name: "reference",
    doc: "Says whom the component calls through a reference that its class has.",
    attributes: &[
        required("name", Holds::ReferenceName, "The reference's name, as the class has it."),
        TARGET,
        MULTIPLICITY,
        AUTOWIRE,
        WIRED_BY_IMPL,
        new(
            "nonOverridable",
            Holds::Boolean,
            "Whether composites around this one must not give it other targets.",
        ),
        REQUIRES,
        POLICY_SETS,
    ],
    children: CONTRACT,
};

/// A reference of a composite.
pub static COMPOSITE_REFERENCE: Kind = Kind {
    name: "reference",
    doc: "A reference that the composite has: those of components in it, wired by whoever uses the composite.",
    attributes: &[
        required("name", Holds::Name, "The reference's name, by which the composite's users know it."),
        required(
            "promote",
            Holds::Ends,
            "The components in this composite, or their references as `Component/reference`, between blanks.",
        ),
        known(
            "target",
            Holds::Ends,
            "The components around the one that the composite implements, or their services as `Component/service`, between blanks; they count where that component wires nothing.",
        ),
        MULTIPLICITY,
        old("autowire", Holds::Boolean, AUTOWIRE.doc),
        WIRED_BY_IMPL,
        REQUIRES,
        POLICY_SETS,
    ],
    children: CONTRACT,
};

const TYPE: Known = known("type", Holds::Type, "The type of the value, such as `xsd:string` or `xsd:int`.");
const ELEMENT: Known = known(
    "element",
    Holds::Element,
    "The global element of a schema, instead of a type: the value is such an element, and components take what is inside.",
);
const MANY: Known = known("many", Holds::Boolean, "Whether it has any number of values, each in a `value`.");
const VALUE: Known = new("value", Holds::Value, "The value, instead of the text inside.");

/// A property of a component, or of a loop.
pub static COMPONENT_PROPERTY: Kind = Kind {
    name: "property",
    doc: "Gives a property of the component a value: as text inside, as `value`, from a composite's property or from a file.",
    attributes: &[
        required("name", Holds::PropertyName, "The property's name, as the class has it."),
        VALUE,
        TYPE,
        ELEMENT,
        MANY,
        known(
            "source",
            Holds::Source,
            "The property of the composite that the value comes from: `$name`, or a part of a complex one: `$name/part`, `$name/part[2]/@attribute`.",
        ),
        known("file", Holds::File, "The file whose text is the value, beside this one."),
        old("mustSupply", Holds::Boolean, "Of a composite's properties; not looked at here."),
    ],
    children: &["value"],
};

/// A property of a composite.
pub static COMPOSITE_PROPERTY: Kind = Kind {
    name: "property",
    doc: "A value that components take with `source=\"$name\"`, and that can be set from outside.",
    attributes: &[
        required("name", Holds::Name, "The property's name."),
        VALUE,
        TYPE,
        ELEMENT,
        MANY,
        known(
            "mustSupply",
            Holds::Boolean,
            "Whether whoever uses the composite has to give a value, since there is none here.",
        ),
    ],
    children: &["value"],
};

/// A callback of a service or a reference.
pub static CALLBACK: Kind = Kind {
    name: "callback",
    doc: "How the service calls back those who call it.",
    attributes: &[known("name", Holds::Name, "The callback's name."), REQUIRES, POLICY_SETS],
    children: &["binding.", "requires", "policySetAttachment", "documentation", "extensions"],
};

const POLICY_CHILDREN: &[&str] =
    &["operation", "requires", "policySetAttachment", "documentation", "extensions"];

const INTERFACE_ATTRIBUTES: &[Known] = &[
    required("interface", Holds::Interface, "The interface's name."),
    known("callbackInterface", Holds::Interface, "The interface by which the service calls back."),
    new("remotable", Holds::Boolean, "Whether calls may come from other processes."),
    Known { only_1_1: true, ..REQUIRES },
    Known { only_1_1: true, ..POLICY_SETS },
];

/// An interface by its name, as composites of others write it.
pub static INTERFACE_JAVA: Kind = Kind {
    name: "interface.java",
    doc: "The operations that can be called, by the name of the interface.",
    attributes: INTERFACE_ATTRIBUTES,
    children: POLICY_CHILDREN,
};

/// An interface by its name.
pub static INTERFACE_RUST: Kind = Kind {
    name: "interface.rust",
    doc: "The operations that can be called, by the name of the interface.",
    attributes: INTERFACE_ATTRIBUTES,
    children: POLICY_CHILDREN,
};

/// An interface of a web service.
pub static INTERFACE_WSDL: Kind = Kind {
    name: "interface.wsdl",
    doc: "The operations that can be called, by the URI of a port type in WSDL.",
    attributes: INTERFACE_ATTRIBUTES,
    children: POLICY_CHILDREN,
};

/// A class by its name, as composites of others write it.
pub static IMPLEMENTATION_JAVA: Kind = Kind {
    name: "implementation.java",
    doc: "The class of the component, by a name that is registered; `saoms components` lists them.",
    attributes: &[required("class", Holds::Class, "The name of the class."), REQUIRES, POLICY_SETS],
    children: POLICY_CHILDREN,
};

/// A composite as implementation.
pub static IMPLEMENTATION_COMPOSITE: Kind = Kind {
    name: "implementation.composite",
    doc: "Another composite: the component stands for all that is in it.",
    attributes: &[
        required(
            "name",
            Holds::Composite,
            "The name of the composite, with a prefix of its target namespace.",
        ),
        REQUIRES,
        POLICY_SETS,
    ],
    children: POLICY_CHILDREN,
};

/// A class by its name.
pub static IMPLEMENTATION_RUST: Kind = Kind {
    name: "implementation.rust",
    doc: "The class of the component, by a name that is registered; `saoms components` lists them.",
    attributes: &[
        required("class", Holds::Class, "The name of the class."),
        known("library", Holds::Library, "The plugin that has the class."),
        REQUIRES,
        POLICY_SETS,
    ],
    children: POLICY_CHILDREN,
};

/// The binding of SCA itself.
pub static BINDING_SCA: Kind = Kind {
    name: "binding.sca",
    doc: "A connection within the fleet, which is what there is without any binding.",
    attributes: &[
        known(
            "name",
            Holds::Name,
            "The binding's name, by which targets choose it: `Component/service/binding`.",
        ),
        known("uri", Holds::Uri, "What a reference is bound to, written as a target."),
        REQUIRES,
        POLICY_SETS,
    ],
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
pub const VARIANTS: &[(&str, &[&str])] = &[
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

/// What the elements are for whose parts are not known here.
pub const OTHERS: &[(&str, &str)] = &[
    ("value", "One value of the property."),
    ("documentation", "Text for people; anything can stand inside."),
    ("extensions", "Elements of other namespaces, which SAOMS does not look at."),
    ("requires", "Intents of policies. SAOMS does not look at them."),
    ("policySetAttachment", "A set of policies. SAOMS does not look at it."),
    ("operation", "Policies of an operation. SAOMS does not look at them."),
    ("implementation.bpel", "A process of BPEL: known, and not run by SAOMS."),
    ("implementation.spring", "An application of Spring: known, and not run by SAOMS."),
    ("implementation.ejb", "A session bean: known, and not run by SAOMS."),
    ("implementation.jee", "An archive of Java EE: known, and not run by SAOMS."),
    ("implementation.web", "A web application: known, and not run by SAOMS."),
    ("implementation.c", "A component in C: known, and not run by SAOMS."),
    ("implementation.cpp", "A component in C++: known, and not run by SAOMS."),
    ("interface.c", "An interface by a header in C."),
    ("interface.cpp", "An interface by a header in C++."),
    ("interface.partnerLinkType", "An interface by a partner link type of BPEL."),
    ("binding.ws", "A web service: known, and not served by SAOMS."),
    ("binding.jms", "A queue or a topic of JMS: known, and not served by SAOMS."),
    ("binding.jca", "A resource adapter of JCA: known, and not served by SAOMS."),
    ("binding.ejb", "A session bean: known, and not served by SAOMS."),
    ("wireFormat.jmsDefault", "The usual format of messages of JMS."),
    ("wireFormat.jmsdefault", "The usual format of messages of JMS."),
    ("operationSelector.jmsDefault", "The usual way in which messages of JMS name operations."),
    ("operationSelector.jmsdefault", "The usual way in which messages of JMS name operations."),
];
