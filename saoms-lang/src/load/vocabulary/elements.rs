//! The tables.

use super::{Kind, Known};

attributes! {
    REQUIRES = known "requires" Names: "The intents of policies that apply.";
    POLICY_SETS = known "policySets" Names: "The policy sets that apply.";
    AUTOWIRE = known "autowire" Boolean: "Whether references without a target are wired to matching services. The value of an inner element takes precedence.";
    CONSTRAINING_TYPE = old "constrainingType" Text: "The type that this has to conform to. SAOMS ignores it.";
    MULTIPLICITY = known "multiplicity" Multiplicity: "How many targets the reference takes: at least 0 or 1, at most 1 or n. The default is the multiplicity of the class; it can only be narrowed.";
    WIRED_BY_IMPL = known "wiredByImpl" Boolean: "Whether the implementation finds the targets itself at run time. If so, the composite must not wire the reference.";
    TARGET = known "target" Ends: "The components that the reference calls, or their services as `Component/service`, separated by blanks.";
}

kinds! {
    /// The root of a file.
    pub COMPOSITE = "composite": "A fleet, or a part of one: its components, the values of their properties, and the wires between them." {
        required "name" Name: "The composite's name. Other composites refer to it by its target namespace and this name.";
        known "targetNamespace" Namespace: "The namespace of the composite's name, such as `urn:example:fleet`.";
        known "local" Boolean: "Whether its components must run together in one process. Only local composites can include a local composite.";
        AUTOWIRE; CONSTRAINING_TYPE; REQUIRES; POLICY_SETS;
    } ["component", "property", "service", "reference", "wire", "include", "requires", "policySetAttachment",
        "documentation", "extensions"]

    /// An include in a composite.
    pub INCLUDE = "include": "Inserts the content of another composite here." {
        required "name" Composite: "The name of the composite, with a prefix of its target namespace.";
        known "uri" Uri: "The location of the composite. SAOMS ignores it: it finds composites by their names.";
    } ["documentation"]

    /// A wire in a composite.
    pub WIRE = "wire": "Connects a reference of one component to a service of another component, as the attribute `target` of a reference does." {
        required "source" End: "The reference that calls: `Component/reference`.";
        required "target" End: "The service that is called: `Component`, or `Component/service`.";
        new "replace" Boolean: "Whether this wire replaces the targets that the reference itself names.";
    } ["documentation", "extensions"]

    /// A component in a composite.
    pub COMPONENT = "component": "An instance of a class or of a composite, with values for its properties and targets for its references." {
        required "name" Name: "The component's name. It is unique in the composite.";
        AUTOWIRE; CONSTRAINING_TYPE; REQUIRES; POLICY_SETS;
    } ["implementation.", "property", "service", "reference", "requires", "policySetAttachment",
        "documentation", "extensions"]

    /// A loop of a component: of SAOMS, not of SCA.
    pub LOOP = "loop": "Adds a loop to the component; or replaces, moves, removes or configures a loop of its class." {
        required "name" LoopName: "The loop's name within the component. The name of an existing loop changes that loop.";
        known "class" LoopClass: "The class of the loop that is added, or that replaces the loop of this name.";
        known "before" LoopName: "The loop before which to place this loop.";
        known "after" LoopName: "The loop after which to place this loop.";
        known "remove" Boolean: "Whether to remove the loop of this name.";
    } ["property", "documentation"]
}

const CONTRACT: &[&str] = &[
    "interface.", "binding.", "callback", "operation", "requires", "policySetAttachment", "documentation", "extensions",
];

kinds! {
    /// A service of a component.
    pub COMPONENT_SERVICE = "service": "Configures a service that the component's class offers." {
        required "name" ServiceName: "The name of the service in the class.";
        REQUIRES; POLICY_SETS;
    } CONTRACT

    /// A service of a composite.
    pub COMPOSITE_SERVICE = "service": "A service that the composite offers: the promoted service of a component in it." {
        required "name" Name: "The name of the service for users of the composite.";
        required "promote" End: "The component in this composite, or its service as `Component/service`.";
        REQUIRES; POLICY_SETS;
    } CONTRACT

    /// A reference of a component.
    pub COMPONENT_REFERENCE = "reference": "Sets which components are called through a reference of the component's class." {
        required "name" ReferenceName: "The name of the reference in the class.";
        TARGET; MULTIPLICITY; AUTOWIRE; WIRED_BY_IMPL;
        new "nonOverridable" Boolean: "Whether outer composites must not give the reference other targets.";
        REQUIRES; POLICY_SETS;
    } CONTRACT

    /// A reference of a composite.
    pub COMPOSITE_REFERENCE = "reference": "A reference of the composite: it promotes references of components in it, and the user of the composite wires it." {
        required "name" Name: "The name of the reference for users of the composite.";
        required "promote" Ends: "The components in this composite, or their references as `Component/reference`, separated by blanks.";
        known "target" Ends: "The default targets, used where the component that this composite implements has no target: components beside that component, or their services as `Component/service`, separated by blanks.";
        MULTIPLICITY;
        old "autowire" Boolean: AUTOWIRE.doc;
        WIRED_BY_IMPL; REQUIRES; POLICY_SETS;
    } CONTRACT
}

attributes! {
    TYPE = known "type" Type: "The type of the value, such as `xsd:string` or `xsd:int`.";
    ELEMENT = known "element" Element: "The global element of a schema, in place of a type: the value is such an element, and components take its content.";
    MANY = known "many" Boolean: "Whether the property has any number of values, each in a `value` element.";
    VALUE = new "value" Value: "The value, in place of the text inside the element.";
}

kinds! {
    /// A property of a component, or of a loop.
    pub COMPONENT_PROPERTY = "property": "Gives a property of the component a value: as text inside, as `value`, from a composite's property or from a file." {
        required "name" PropertyName: "The name of the property in the class.";
        VALUE; TYPE; ELEMENT; MANY;
        known "source" Source: "The property of the composite that gives the value: `$name`, or a part of a complex property: `$name/part`, `$name/part[2]/@attribute`.";
        known "file" File: "The file that contains the value, by its path from this file.";
        old "mustSupply" Boolean: "An attribute for properties of composites; SAOMS ignores it here.";
    } ["value"]

    /// A property of a composite.
    pub COMPOSITE_PROPERTY = "property": "A value that components take with `source=\"$name\"`, and that can be set from outside." {
        required "name" Name: "The property's name.";
        VALUE; TYPE; ELEMENT; MANY;
        known "mustSupply" Boolean: "Whether the user of the composite must give a value, since there is no default.";
    } ["value"]

    /// A callback of a service or a reference.
    pub CALLBACK = "callback": "How the service calls back its callers." {
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
    pub IMPLEMENTATION_JAVA = "implementation.java": "The class of the component; `saoms components` lists the classes." {
        required "class" Class: "The name of the class.";
        REQUIRES; POLICY_SETS;
    } POLICY_CHILDREN

    /// A composite as implementation.
    pub IMPLEMENTATION_COMPOSITE = "implementation.composite": "The composite that implements the component: the component contains everything in it." {
        required "name" Composite: "The name of the composite, with a prefix of its target namespace.";
        REQUIRES; POLICY_SETS;
    } POLICY_CHILDREN

    /// A class by its name.
    pub IMPLEMENTATION_RUST = "implementation.rust": "The class of the component; `saoms components` lists the classes." {
        required "class" Class: "The name of the class.";
        known "library" Library: "The plugin that contains the class.";
        REQUIRES; POLICY_SETS;
    } POLICY_CHILDREN

    /// A class in Python.
    pub IMPLEMENTATION_PYTHON = "implementation.python": "A class in Python, which the plugin `saoms_python` runs." {
        required "module" Text: "The module that contains the class, such as `counter` for `counter.py` beside the composite.";
        required "class" Text: "The name of the class in its module.";
        REQUIRES; POLICY_SETS;
    } POLICY_CHILDREN

    /// The binding of SCA itself.
    pub BINDING_SCA = "binding.sca": "A connection within the fleet: the default if there is no binding." {
        known "name" Name: "The name of the binding, for targets such as `Component/service/binding`.";
        known "uri" Uri: "The target of a reference, written as in `target`.";
        REQUIRES; POLICY_SETS;
    } ["operation", "wireFormat.", "operationSelector.", "requires", "policySetAttachment", "documentation",
        "extensions"]

    /// The binding to the web.
    pub BINDING_REST = "binding.rest": "Calls over HTTP with JSON: the control server of the run offers the service, or the reference leads to an HTTP server." {
        known "name" Name: "The name of the binding.";
        known "uri" Uri: "Of a service, its path on the server, such as `/stock`; the default is `/services/COMPONENT/SERVICE`. Of a reference, the address of the service, such as `http://host:8080/stock`.";
        REQUIRES; POLICY_SETS;
    } ["operation", "wireFormat.", "operationSelector.", "requires", "policySetAttachment", "documentation",
        "extensions"]
}

// Elements that name intents, policy sets and operations (SCA Policy 1.1, 4.2 and 4.3; SCA 1.0 for operations).
kinds! {
    /// Intents, in an element of their own.
    pub INTENTS = "requires": "Intents of policies. SAOMS ignores them." {
        known "intents" Names: "The intents that apply.";
    } []

    /// A policy set, in an element of its own.
    pub POLICY_SET = "policySetAttachment": "A set of policies. SAOMS ignores it." {
        known "name" Names: "The policy set that applies.";
    } []

    /// Policies of an operation.
    pub OPERATION = "operation": "Policies of an operation. SAOMS ignores them." {
    } []

    /// Elements of other vendors.
    pub EXTENSIONS = "extensions": "Elements of other namespaces. SAOMS ignores them." {
    } []
}

/// The elements of composites whose parts are known. Of two of one name, the first is that of a composite, the other
/// that of a component.
pub(super) const KINDS: [&Kind; 20] = [
    &COMPOSITE, &COMPONENT, &INCLUDE, &WIRE, &COMPOSITE_PROPERTY, &COMPOSITE_SERVICE, &COMPOSITE_REFERENCE,
    &COMPONENT_PROPERTY, &COMPONENT_SERVICE, &COMPONENT_REFERENCE, &CALLBACK, &IMPLEMENTATION_JAVA,
    &IMPLEMENTATION_COMPOSITE, &IMPLEMENTATION_RUST, &IMPLEMENTATION_PYTHON, &INTERFACE_JAVA, &INTERFACE_RUST,
    &INTERFACE_WSDL, &BINDING_SCA, &BINDING_REST,
];

/// Those that the model does not keep.
pub(in crate::load) const POLICIES: [&Kind; 4] = [&INTENTS, &POLICY_SET, &OPERATION, &EXTENSIONS];

/// The purposes of elements whose parts are not known here.
pub(super) const OTHERS: &[(&str, &str)] = &[
    ("value", "One value of the property."),
    ("documentation", "Documentation; it can contain anything."),
    ("implementation.bpel", "A process of BPEL. SAOMS cannot run it."),
    ("implementation.spring", "An application of Spring. SAOMS cannot run it."),
    ("implementation.ejb", "A session bean. SAOMS cannot run it."),
    ("implementation.jee", "An archive of Java EE. SAOMS cannot run it."),
    ("implementation.web", "A web application. SAOMS cannot run it."),
    ("implementation.c", "A component in C. SAOMS cannot run it."),
    ("implementation.cpp", "A component in C++. SAOMS cannot run it."),
    ("interface.c", "An interface by a header in C."),
    ("interface.cpp", "An interface by a header in C++."),
    ("interface.partnerLinkType", "An interface by a partner link type of BPEL."),
    ("binding.ws", "A web service. SAOMS does not support it."),
    ("binding.jms", "A queue or a topic of JMS. SAOMS does not support it."),
    ("binding.jca", "A resource adapter of JCA. SAOMS does not support it."),
    ("binding.ejb", "A session bean. SAOMS does not support it."),
    ("wireFormat.jmsDefault", "The default format of JMS messages."),
    ("wireFormat.jmsdefault", "The default format of JMS messages."),
    ("operationSelector.jmsDefault", "The default way in which JMS messages name an operation."),
    ("operationSelector.jmsdefault", "The default way in which JMS messages name an operation."),
];

// Elements and attributes of SAOMS in its own namespace.
attributes! {
    PATH = known "path" Text: "The path that the component had before `saoms expand` resolved the composites around it.";
    COUNT = known "count" Number: "The number of replicas of the component. Its name must contain an expression such as `${index}` or `${index:03}`; its values and targets can contain expressions.";
    FROM = known "from" Number: "The index of the first replica. The default is 1.";
    OVERRIDES = known "overrides" Table: "A CSV table beside the composite, with a row for each replica that differs and a column for each property that differs.";
    SITE = known "site" Text: "The site of the component and of everything inside it. The names of its topics start with the name of the site, as in `North/orders`; IDs and numbers must be unique only within a site.";
    NODE = known "node" Text: "The node that runs the component and everything inside it: `saoms run --node` runs the components of one node. An inner component with a node of its own is in that one.";
    IF = known "if" Condition: "The condition for including this element: a comparison of properties of the composite, such as `robots > 10 and site == 'north'`.";
    ENV = known "env" Variable: "The environment variable that gives the value, if it is set and neither `--set` nor a component gives one.";
    ALERT_URL = known "alertUrl" Uri: "The address that each change of an alert is sent to, as an HTTP POST of JSON: `http://host:port/path`. `saoms run` sends with `--alerts` alone.";
    ALERT_TOKEN_ENV = known "alertTokenEnv" Variable: "The environment variable with the token for the address of `alertUrl`, which is sent as `Authorization: Bearer ...`. The token itself is in no composite.";
    ALERT_COMMAND = known "alertCommand" Text: "The command of the shell that is run for each change of an alert, in the folder of the composite; it reads the change as JSON. `saoms run` runs it with `--alerts` alone.";
    HANGUP = known "hangup" Hangup: "What a lost terminal (SIGHUP) leads to: `end`, the default, ends the run; `hold` stops all that moves until it is released, as `saoms estop` does; `goOn` changes nothing. SIGTERM always ends the run.";
    LOST_LINK = known "lostLink" Hangup: "What a lost link to the other programs of a network leads to: `goOn`, the default, changes nothing; `hold` stops all that moves in this program until it is released, as `saoms estop` does; `end` ends the run.";
    DEADLINE = known "deadline" Duration: "The time within which a call has to be answered, such as `10s` or `500ms`; the default is 3 s. The call fails if it is not. Of a reference, calls of components of other nodes and of web servers have a deadline; of a service, calls from the web. A number without a unit is milliseconds.";
    TOKEN_ENV = known "tokenEnv" Variable: "The environment variable with the token for the web server of the reference (`binding.rest`), which is sent as `Authorization: Bearer ...`. The token itself is in no composite.";
    DEFAULT_NODE = known "defaultNode" Text: "The node of the components that are in no other one (`saoms:node`).";
}

/// The attributes that SAOMS adds in its own namespace, each with the element that has it; `composite/property` is that
/// of a composite, `component/reference` that of a component, `reference` that of a composite, and `service` both.
pub const OWN_ATTRIBUTES: &[(&str, Known)] = &[
    ("composite", ALERT_URL),
    ("composite", ALERT_TOKEN_ENV),
    ("composite", ALERT_COMMAND),
    ("composite", HANGUP),
    ("composite", LOST_LINK),
    ("composite", DEFAULT_NODE),
    ("component", PATH),
    ("component", COUNT),
    ("component", FROM),
    ("component", OVERRIDES),
    ("component", SITE),
    ("component", NODE),
    ("component", IF),
    ("include", IF),
    ("wire", IF),
    ("composite/property", ENV),
    ("component/reference", DEADLINE),
    ("component/reference", TOKEN_ENV),
    ("reference", TOKEN_ENV),
    ("service", DEADLINE),
];

/// The elements that SAOMS adds in its own namespace.
pub const OWN_ELEMENTS: &[&str] =
    &["binding.rest", "implementation.python", "implementation.rust", "interface.rust", "loop", "severity"];

/// The elements of SCA that a `severity` stands in.
pub const SEVERITY_PARENTS: &[&str] = &["composite", "component", "service", "reference", "wire", "include"];

/// The elements of SCA that an element of SAOMS stands in.
pub(in crate::load) fn own_parents(name: &str) -> &'static [&'static str] {
    match name {
        "severity" => SEVERITY_PARENTS,
        "binding.rest" | "interface.rust" => &["service", "reference"],
        _ => &["component"],
    }
}

kinds! {
    /// Severities of diagnostics in a composite.
    pub SEVERITY = "severity": "Sets the severity of the diagnostics of one code for the element that contains it: a composite, component, service, reference, wire or include." {
        required "code" Code: "The code of the diagnostics, such as `S4001`.";
        required "level" Level: "The new severity: `allow`, `note`, `warning` or `error`.";
        required "reason" Text: "The reason. It is part of the JSON and SARIF output.";
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
