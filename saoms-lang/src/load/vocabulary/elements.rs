//! The tables.

use super::{Kind, Known};

attributes! {
    REQUIRES = known "requires" Names: "The intents of policies that apply.";
    POLICY_SETS = known "policySets" Names: "The policy sets that apply.";
    AUTOWIRE = known "autowire" Boolean: "Whether references without a target are wired to services that fit them; what is said further inside wins.";
    CONSTRAINING_TYPE = old "constrainingType" Text: "The type that this has to conform to. Not looked at.";
    MULTIPLICITY = known "multiplicity" Multiplicity: "How many targets the reference takes: at least 0 or 1, at most 1 or n. As the class says unless given; it may narrow that only.";
    WIRED_BY_IMPL = known "wiredByImpl" Boolean: "Whether the implementation finds the targets itself at run time; nothing here may wire it then.";
    TARGET = known "target" Ends: "The components that the reference calls, or their services as `Component/service`, between blanks.";
}

kinds! {
    /// The root of a file.
    pub COMPOSITE = "composite": "Components, what they are told by properties, and how they are wired: a fleet, or a part of one." {
        required "name" Name: "The composite's name. Others refer to it by its target namespace and this name.";
        known "targetNamespace" Namespace: "The namespace of the composite's name, such as `urn:example:fleet`.";
        known "local" Boolean: "Whether its components have to run together in one process; a local composite is included by local ones only.";
        AUTOWIRE; CONSTRAINING_TYPE; REQUIRES; POLICY_SETS;
    } ["component", "property", "service", "reference", "wire", "include", "requires", "policySetAttachment",
        "documentation", "extensions"]

    /// An include in a composite.
    pub INCLUDE = "include": "Puts everything in another composite here, as if it were written here." {
        required "name" Composite: "The name of the composite, with a prefix of its target namespace.";
        known "uri" Uri: "Where it is. Composites are found by their names.";
    } ["documentation"]

    /// A wire in a composite.
    pub WIRE = "wire": "Connects a reference of one component to a service of another one, as `target` of the reference does." {
        required "source" End: "The reference that calls: `Component/reference`.";
        required "target" End: "The service that is called: `Component`, or `Component/service`.";
        new "replace" Boolean: "Whether this wire takes the place of the targets that the reference names itself.";
    } ["documentation", "extensions"]

    /// A component in a composite.
    pub COMPONENT = "component": "One instance of a class, or of a whole composite, with values for its properties and targets for its references." {
        required "name" Name: "The component's name, which no other one in this composite has.";
        AUTOWIRE; CONSTRAINING_TYPE; REQUIRES; POLICY_SETS;
    } ["implementation.", "property", "service", "reference", "requires", "policySetAttachment",
        "documentation", "extensions"]

    /// A loop of a component: of SAOMS, not of SCA.
    pub LOOP = "loop": "Adds a loop to the component, or replaces, moves, removes or parametrises one that its class brings." {
        required "name" LoopName: "The loop's name within the component; that of a loop it has already changes that one.";
        known "class" LoopClass: "The class of a loop that is added, or that takes the place of the one of this name.";
        known "before" LoopName: "The loop directly before which it stands.";
        known "after" LoopName: "The loop directly behind which it stands.";
        known "remove" Boolean: "Whether the loop of this name is removed.";
    } ["property", "documentation"]
}

const CONTRACT: &[&str] = &[
    "interface.", "binding.", "callback", "operation", "requires", "policySetAttachment", "documentation", "extensions",
];

kinds! {
    /// A service of a component.
    pub COMPONENT_SERVICE = "service": "Says more about a service that the component's class offers." {
        required "name" ServiceName: "The service's name, as the class has it.";
        REQUIRES; POLICY_SETS;
    } CONTRACT

    /// A service of a composite.
    pub COMPOSITE_SERVICE = "service": "A service that the composite offers: that of a component in it." {
        required "name" Name: "The service's name, by which the composite's users know it.";
        required "promote" End: "The component in this composite, or its service as `Component/service`.";
        REQUIRES; POLICY_SETS;
    } CONTRACT

    /// A reference of a component.
    pub COMPONENT_REFERENCE = "reference": "Says whom the component calls through a reference that its class has." {
        required "name" ReferenceName: "The reference's name, as the class has it.";
        TARGET; MULTIPLICITY; AUTOWIRE; WIRED_BY_IMPL;
        new "nonOverridable" Boolean: "Whether composites around this one must not give it other targets.";
        REQUIRES; POLICY_SETS;
    } CONTRACT

    /// A reference of a composite.
    pub COMPOSITE_REFERENCE = "reference": "A reference that the composite has: those of components in it, wired by whoever uses the composite." {
        required "name" Name: "The reference's name, by which the composite's users know it.";
        required "promote" Ends: "The components in this composite, or their references as `Component/reference`, between blanks.";
        known "target" Ends: "The components around the one that the composite implements, or their services as `Component/service`, between blanks; they count where that component wires nothing.";
        MULTIPLICITY;
        old "autowire" Boolean: AUTOWIRE.doc;
        WIRED_BY_IMPL; REQUIRES; POLICY_SETS;
    } CONTRACT
}

attributes! {
    TYPE = known "type" Type: "The type of the value, such as `xsd:string` or `xsd:int`.";
    ELEMENT = known "element" Element: "The global element of a schema, instead of a type: the value is such an element, and components take what is inside.";
    MANY = known "many" Boolean: "Whether it has any number of values, each in a `value`.";
    VALUE = new "value" Value: "The value, instead of the text inside.";
}

kinds! {
    /// A property of a component, or of a loop.
    pub COMPONENT_PROPERTY = "property": "Gives a property of the component a value: as text inside, as `value`, from a composite's property or from a file." {
        required "name" PropertyName: "The property's name, as the class has it.";
        VALUE; TYPE; ELEMENT; MANY;
        known "source" Source: "The property of the composite that the value comes from: `$name`, or a part of a complex one: `$name/part`, `$name/part[2]/@attribute`.";
        known "file" File: "The file whose text is the value, beside this one.";
        old "mustSupply" Boolean: "Of a composite's properties; not looked at here.";
    } ["value"]

    /// A property of a composite.
    pub COMPOSITE_PROPERTY = "property": "A value that components take with `source=\"$name\"`, and that can be set from outside." {
        required "name" Name: "The property's name.";
        VALUE; TYPE; ELEMENT; MANY;
        known "mustSupply" Boolean: "Whether whoever uses the composite has to give a value, since there is none here.";
    } ["value"]

    /// A callback of a service or a reference.
    pub CALLBACK = "callback": "How the service calls back those who call it." {
        known "name" Name: "The callback's name.";
        REQUIRES; POLICY_SETS;
    } ["binding.", "requires", "policySetAttachment", "documentation", "extensions"]
}

const POLICY_CHILDREN: &[&str] = &["operation", "requires", "policySetAttachment", "documentation", "extensions"];

attributes! {
    INTERFACE = required "interface" Interface: "The interface's name.";
    CALLBACK_INTERFACE = known "callbackInterface" Interface: "The interface by which the service calls back.";
    REMOTABLE = new "remotable" Boolean: "Whether calls may come from other processes.";
    NEW_REQUIRES = new "requires" Names: "The intents of policies that apply.";
    NEW_POLICY_SETS = new "policySets" Names: "The policy sets that apply.";
}

kinds! {
    /// An interface by its name, as composites of others write it.
    pub INTERFACE_JAVA = "interface.java": "The operations that can be called, by the name of the interface." {
        INTERFACE; CALLBACK_INTERFACE; REMOTABLE; NEW_REQUIRES; NEW_POLICY_SETS;
    } POLICY_CHILDREN

    /// An interface by its name.
    pub INTERFACE_RUST = "interface.rust": "The operations that can be called, by the name of the interface." {
        INTERFACE; CALLBACK_INTERFACE; REMOTABLE; NEW_REQUIRES; NEW_POLICY_SETS;
    } POLICY_CHILDREN

    /// An interface of a web service.
    pub INTERFACE_WSDL = "interface.wsdl": "The operations that can be called, by the URI of a port type in WSDL." {
        INTERFACE; CALLBACK_INTERFACE; REMOTABLE; NEW_REQUIRES; NEW_POLICY_SETS;
    } POLICY_CHILDREN

    /// A class by its name, as composites of others write it.
    pub IMPLEMENTATION_JAVA = "implementation.java": "The class of the component, by a name that is registered; `saoms components` lists them." {
        required "class" Class: "The name of the class.";
        REQUIRES; POLICY_SETS;
    } POLICY_CHILDREN

    /// A composite as implementation.
    pub IMPLEMENTATION_COMPOSITE = "implementation.composite": "Another composite: the component stands for all that is in it." {
        required "name" Composite: "The name of the composite, with a prefix of its target namespace.";
        REQUIRES; POLICY_SETS;
    } POLICY_CHILDREN

    /// A class by its name.
    pub IMPLEMENTATION_RUST = "implementation.rust": "The class of the component, by a name that is registered; `saoms components` lists them." {
        required "class" Class: "The name of the class.";
        known "library" Library: "The plugin that has the class.";
        REQUIRES; POLICY_SETS;
    } POLICY_CHILDREN

    /// The binding of SCA itself.
    pub BINDING_SCA = "binding.sca": "A connection within the fleet, which is what there is without any binding." {
        known "name" Name: "The binding's name, by which targets choose it: `Component/service/binding`.";
        known "uri" Uri: "What a reference is bound to, written as a target.";
        REQUIRES; POLICY_SETS;
    } ["operation", "wireFormat.", "operationSelector.", "requires", "policySetAttachment", "documentation",
        "extensions"]
}

// Elements that name intents, policy sets and operations (SCA Policy 1.1, 4.2 and 4.3; SCA 1.0 for operations).
kinds! {
    /// Intents, in an element of their own.
    pub INTENTS = "requires": "Intents of policies. SAOMS does not look at them." {
        known "intents" Names: "The intents that apply.";
    } []

    /// A policy set, in an element of its own.
    pub POLICY_SET = "policySetAttachment": "A set of policies. SAOMS does not look at it." {
        known "name" Names: "The policy set that applies.";
    } []

    /// Policies of an operation.
    pub OPERATION = "operation": "Policies of an operation. SAOMS does not look at them." {
    } []

    /// Elements of other vendors.
    pub EXTENSIONS = "extensions": "Elements of other namespaces, which SAOMS does not look at." {
    } []
}

/// The elements of composites whose parts are known. Of two of one name, the first is that of a composite, the other
/// that of a component.
pub(super) const KINDS: [&Kind; 18] = [
    &COMPOSITE, &COMPONENT, &INCLUDE, &WIRE, &COMPOSITE_PROPERTY, &COMPOSITE_SERVICE, &COMPOSITE_REFERENCE,
    &COMPONENT_PROPERTY, &COMPONENT_SERVICE, &COMPONENT_REFERENCE, &CALLBACK, &IMPLEMENTATION_JAVA,
    &IMPLEMENTATION_COMPOSITE, &IMPLEMENTATION_RUST, &INTERFACE_JAVA, &INTERFACE_RUST, &INTERFACE_WSDL, &BINDING_SCA,
];

/// Those that the model does not keep.
pub(in crate::load) const POLICIES: [&Kind; 4] = [&INTENTS, &POLICY_SET, &OPERATION, &EXTENSIONS];

/// The purposes of elements whose parts are not known here.
pub(super) const OTHERS: &[(&str, &str)] = &[
    ("value", "One value of the property."),
    ("documentation", "Text for people; anything can stand inside."),
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

// Elements and attributes of SAOMS in its own namespace.
attributes! {
    PATH = known "path" Text: "The path that the component had before `saoms expand` resolved the composites around it.";
    COUNT = known "count" Number: "How many replicas there are of the component. Its name has to hold an expression such as `${index}` or `${index:03}`; its values and targets can.";
    FROM = known "from" Number: "The index of the first replica; 1 unless given.";
    OVERRIDES = known "overrides" Table: "A table (CSV) beside the composite: a line for each replica that differs, a column for each property that does.";
    SITE = known "site" Text: "The site of the component and of all that is inside it: its name is put before the names of their topics, as in `North/orders`, and IDs and numbers have to differ within a site alone.";
    IF = known "if" Condition: "It is there only where this is true: a comparison of properties of the composite, as `robots > 10 and site == 'north'`.";
    ENV = known "env" Variable: "The environment variable that the value is taken from, where it is set and nothing else gives one.";
}

/// The attributes that SAOMS adds in its own namespace, each with the element that has it; `composite/property` is that
/// of a composite.
pub const OWN_ATTRIBUTES: &[(&str, Known)] = &[
    ("component", PATH),
    ("component", COUNT),
    ("component", FROM),
    ("component", OVERRIDES),
    ("component", SITE),
    ("component", IF),
    ("include", IF),
    ("wire", IF),
    ("composite/property", ENV),
];

/// The elements that SAOMS adds in its own namespace.
pub const OWN_ELEMENTS: &[&str] = &["implementation.rust", "interface.rust", "loop", "severity"];

/// The elements of SCA that a `severity` stands in.
pub const SEVERITY_PARENTS: &[&str] = &["composite", "component", "service", "reference", "wire", "include"];

/// The elements of SCA that an element of SAOMS stands in.
pub(in crate::load) fn own_parents(name: &str) -> &'static [&'static str] {
    match name {
        "severity" => SEVERITY_PARENTS,
        "interface.rust" => &["service", "reference"],
        _ => &["component"],
    }
}

kinds! {
    /// Severities of diagnostics in a composite.
    pub SEVERITY = "severity": "Sets how bad the diagnostics of one code are: in a composite for all of it, in a component, service, reference, wire or include for that." {
        required "code" Code: "The code of the diagnostics, such as `S4001`.";
        required "level" Level: "What they become: `allow`, `note`, `warning` or `error`.";
        required "reason" Text: "Why; it stands in the output for machines.";
    } ["documentation"]
}

/// The namespace of XML Schema.
pub const XML_SCHEMA: &str = "http://www.w3.org/2001/XMLSchema";

/// The simple types that XML Schema 1.0 and 1.1 have, and their common ancestor.
pub const BUILT_IN_TYPES: &[&str] = &[
    "anyType", "anySimpleType", "anyAtomicType", "string", "boolean", "decimal", "float", "double", "duration",
    "dateTime", "time", "date", "gYearMonth", "gYear", "gMonthDay", "gDay", "gMonth", "hexBinary", "base64Binary",
    "anyURI", "QName", "NOTATION", "normalizedString", "token", "language", "NMTOKEN", "NMTOKENS", "Name", "NCName",
    "ID", "IDREF", "IDREFS", "ENTITY", "ENTITIES", "integer", "nonPositiveInteger", "negativeInteger", "long", "int",
    "short", "byte", "nonNegativeInteger", "unsignedLong", "unsignedInt", "unsignedShort", "unsignedByte",
    "positiveInteger", "yearMonthDuration", "dayTimeDuration", "dateTimeStamp",
];
